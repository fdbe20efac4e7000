// Bounds of second derivatives: they hold for every surface, are tight, and are those known in closed form.
#include "patches/bend.h"

#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20250311;

// What the second derivatives do at a point.
struct Sample {
  std::array<double, 3> form{}, length{};
  double curvature = 0;
  bool regular = false;
};
Sample sample_at(const AnySurface& surface, const UV& uv) {
  const Jet2 j = jet2(surface, uv);
  Sample s;
  s.length = {glm::length(j.Suu), glm::length(j.Suv), glm::length(j.Svv)};
  const Vec3 cross = glm::cross(j.Su, j.Sv);
  s.regular = glm::length(cross) > 1e-6 * glm::length(j.Su) * glm::length(j.Sv) && glm::length(j.Su) > 0 && glm::length(j.Sv) > 0;
  if (!s.regular) return s;
  const Vec3 n = glm::normalize(cross);
  s.form = {glm::dot(n, j.Suu), glm::dot(n, j.Suv), glm::dot(n, j.Svv)};
  const Curvatures k = principal_curvatures(j, n);
  s.curvature = std::max(std::abs(k.k1), std::abs(k.k2));
  return s;
}

Box2 random_box(Random& random, const Box2& domain) {
  const Vec2 size = domain.size() * Vec2(std::pow(10.0, between(random, -3, 0)), std::pow(10.0, between(random, -3, 0)));
  const Vec2 lo = domain.lo + (domain.size() - size) * Vec2(between(random, 0, 1), between(random, 0, 1));
  return {lo, glm::min(lo + size, domain.hi)};
}

bool inside(const Range& r, double x, double by) { return r.lo - by <= x && x <= r.hi + by; }

// The evaluation by jets rounds in the size of the largest second derivatives, and in that of the coordinates over the spans' widths.
constexpr double kRounding = 1e-10;

// The largest second derivatives found at a hundred places.
std::array<double, 3> sizes(Random& random, const SurfaceCase& c) {
  std::array<double, 3> most{};
  for (int i = 0; i < 100; ++i) {
    const Sample s = sample_at(c.surface, point_in(random, c.uv));
    for (std::size_t k = 0; k < 3; ++k) most[k] = std::max(most[k], s.length[k]);
  }
  return most;
}

struct BendTallies {
  Tally forms{"forms", kSeed}, lengths{"lengths", kSeed}, curvatures{"curvatures", kSeed};
};

void check_sample(const SurfaceCase& c, const Bend& b, const UV& uv, const std::array<double, 3>& size, BendTallies& t) {
  const Sample s = sample_at(c.surface, uv);
  const std::array<Range, 3> ranges{b.uu, b.uv, b.vv};
  const std::array<double, 3> M{b.Muu, b.Muv, b.Mvv};
  for (std::size_t e = 0; e < 3; ++e) {
    const double by = kRounding * (size[e] + s.length[e]);
    t.lengths.check(s.length[e] <= M[e] + by, [&] {
      return fmt::format("{} at ({}, {}): derivative {} is {} long, bound {}", c.name, uv.x, uv.y, e, s.length[e], M[e]);
    });
    if (!s.regular) continue;
    t.forms.check(inside(ranges[e], s.form[e], by), [&] {
      return fmt::format("{} at ({}, {}): form {} is {}, not in [{}, {}]", c.name, uv.x, uv.y, e, s.form[e], ranges[e].lo, ranges[e].hi);
    });
  }
  if (s.regular && finite(s.curvature))
    t.curvatures.check(s.curvature <= b.curvature * (1 + 1e-7) + 1e-7,
                       [&] { return fmt::format("{} at ({}, {}): curvature {}, bound {}", c.name, uv.x, uv.y, s.curvature, b.curvature); });
}

TEST(Bend, HoldsEverySampleOfEverySurface) {
  BendTallies t;
  Random random(kSeed);
  for (int round = 0; round < 2; ++round)
    for (const SurfaceCase& c : random_surfaces(random)) {
      const BendTree tree(c.surface, c.uv);
      const std::array<double, 3> size = sizes(random, c);
      for (int i = 0; i < 30; ++i) {
        const Box2 box = random_box(random, c.uv);
        const Bend b = tree.over(box);
        for (int k = 0; k < 30; ++k) check_sample(c, b, point_in(random, box), size, t);
      }
    }
  t.forms.finish_at_least(300000);
  t.lengths.finish_at_least(300000);
  t.curvatures.finish_at_least(100000);
}

// The Taylor form itself: no point of a flat triangle is farther from the surface's point at its (u, v) than the suprema and kinks say.
TEST(Bend, FlatTrianglesAreAsNearAsToldAlsoAcrossKinks) {
  Tally near{"distances", kSeed};
  Random random(kSeed);
  for (const SurfaceCase& c : random_surfaces(random)) {
    const BendTree tree(c.surface, c.uv);
    for (int i = 0; i < 100; ++i) {
      const Box2 box = random_box(random, c.uv);
      const BoxBend b = tree.over(box);
      const Vec2 d = box.size();
      const double bound = (b.Muu * d.x * d.x + 2 * b.Muv * d.x * d.y + b.Mvv * d.y * d.y) / 6 + (b.kink_u * d.x + b.kink_v * d.y) / 4;
      const std::array<UV, 3> p{point_in(random, box), point_in(random, box), point_in(random, box)};
      const double l = between(random, 0, 1), m = between(random, 0, 1 - l), k = 1 - l - m;
      const Vec3 flat = l * point(c.surface, p[0]) + m * point(c.surface, p[1]) + k * point(c.surface, p[2]);
      const Vec3 S = point(c.surface, l * p[0] + m * p[1] + k * p[2]);
      near.check(glm::length(S - flat) <= bound + 1e-12 * (1 + glm::length(S)),
                 [&] { return fmt::format("{}: {} away, bound {}", c.name, glm::length(S - flat), bound); });
    }
  }
  near.finish(100 * kSurfaceCases);
}

// ---- truths ------------------------------------------------------------------------------------------------------------

void expect_range(const Range& r, double lo, double hi) {
  EXPECT_NEAR(r.lo, lo, 1e-13 * (1 + std::abs(lo)));
  EXPECT_NEAR(r.hi, hi, 1e-13 * (1 + std::abs(hi)));
}

TEST(Bend, ClosedFormsAreTheKnownValuesInBothHands) {
  for (const double hand : {1.0, -1.0}) {
    const Frame f{{1, 2, 3}, {1, 0, 0}, {0, hand, 0}, {0, 0, 1}};
    const Box2 box{{0.2, 0.5}, {0.9, 1.0}};
    const double c0 = std::cos(1.0), c1 = std::cos(0.5);
    const auto over = [&](const AnySurface& s) { return BendTree(s, box).over(box); };
    const auto turned = [&](const Range& r, double lo, double hi) { hand > 0 ? expect_range(r, lo, hi) : expect_range(r, -hi, -lo); };
    const Bend cylinder = over(Cylinder{f, 2.5});
    turned(cylinder.uu, -2.5, -2.5);
    EXPECT_NEAR(cylinder.curvature, 0.4, 1e-13);
    const Bend sphere = over(Sphere{f, 2});
    turned(sphere.uu, -2 * c1 * c1, -2 * c0 * c0);
    turned(sphere.vv, -2, -2);
    EXPECT_NEAR(sphere.Muv, 2 * std::sin(1.0), 1e-13);
    EXPECT_NEAR(sphere.curvature, 0.5, 1e-13);
    const Bend cone = over(Cone{f, 1, 0.3});
    turned(cone.uu, -(1 + std::sin(0.3)) * std::cos(0.3), -(1 + 0.5 * std::sin(0.3)) * std::cos(0.3));
    EXPECT_NEAR(cone.Muv, std::sin(0.3), 1e-14);
    const Bend torus = over(Torus{f, 3, 1});
    turned(torus.uu, -(3 + c1) * c1, -(3 + c0) * c0);
    turned(torus.vv, -1, -1);
    EXPECT_NEAR(torus.curvature, 1.0, 1e-13);
    EXPECT_EQ(over(Plane{f}).Muu, 0.0);
  }
}

// Two routes: a sphere and a torus as revolutions of circles.
TEST(Bend, RevolutionsOfCirclesComeNearTheClosedForms) {
  const Box2 box{{0, 0.2}, {2, 0.7}};
  const std::array<AnySurface, 2> exact{Sphere{{}, 2}, Torus{{}, 5, 2}};
  for (const double R : {0.0, 5.0}) {
    const Revolution turned{Ellipse<Vec3>{{R, 0, 0}, {2, 0, 0}, {0, 0, 2}}, {0, 0, 0}, {0, 0, 1}, {-1, 1}};
    const Bend a = BendTree(exact[R == 0 ? 0 : 1], box).over(box), b = BendTree(turned, {{0, -1}, {3, 1}}).over(box);
    for (const auto& [x, y] : {std::pair{a.uu, b.uu}, {a.uv, b.uv}, {a.vv, b.vv}}) {
      EXPECT_LE(y.lo, x.lo + 1e-13);
      EXPECT_GE(y.hi, x.hi - 1e-13);
      EXPECT_LE(y.width(), x.width() + 0.5 * 5);
    }
    EXPECT_LE(b.curvature, 1.5 * a.curvature);
  }
}

// ---- tightness ---------------------------------------------------------------------------------------------------------

// The entries weighed by the box's extents: returned spread and magnitude against those of 15 x 15 samples.
TEST(Bend, RangesOfSmoothSurfacesAreTight) {
  Random random(kSeed);
  double width = 0, magnitude = 0;
  int count = 0;
  for (int round = 0; round < 60; ++round) {
    NurbsSurface s = random_nurbs(random, Knots::bezier, Knots::bezier, whole(random, 2, 4), whole(random, 2, 4), round % 2 == 1);
    for (int i = 0; i < s.count_u; ++i)
      for (int j = 0; j < s.count_v; ++j) {
        const double w = 1 + 0.1 * (s.poles[static_cast<std::size_t>(i * s.count_v + j)].w - 1);
        s.poles[static_cast<std::size_t>(i * s.count_v + j)] = homogeneous(Vec3(i, j, 0) + random_vector<Vec3>(random, 0.25), w);
      }
    const Box2 domain = natural_domain(s);
    const BendTree tree(s, domain);
    for (int k = 0; k < 20; ++k, ++count) {
      const Vec2 size = 0.25 * domain.size(), lo = domain.lo + Vec2(between(random, 0, 0.75), between(random, 0, 0.75)) * domain.size();
      const Bend b = tree.over({lo, lo + size});
      std::array<Range, 3> sampled;
      for (int i = 0; i < 225; ++i) {
        const Sample at = sample_at(s, lo + size * Vec2(i / 15, i % 15) / 14.0);
        for (std::size_t e = 0; e < 3; ++e) sampled[e].include(at.form[e]);
      }
      const auto total = [&](const auto& of) {
        return size.x * size.x * of(b.uu, sampled[0]) + 2 * size.x * size.y * of(b.uv, sampled[1]) + size.y * size.y * of(b.vv, sampled[2]);
      };
      const auto largest = [](const Range& r) { return std::max(std::abs(r.lo), std::abs(r.hi)); };
      width +=
          total([](const Range& x, const Range&) { return x.width(); }) / total([](const Range&, const Range& y) { return y.width(); });
      magnitude +=
          total([&](const Range& x, const Range&) { return largest(x); }) / total([&](const Range&, const Range& y) { return largest(y); });
    }
  }
  fmt::print("[ measured ] spread {:.3f}, magnitude {:.3f} of the sampled ones\n", width / count, magnitude / count);
  EXPECT_LT(width / count, 1.6);
  EXPECT_LT(magnitude / count, 1.25);
}

// ---- knots and poles ---------------------------------------------------------------------------------------------------

// A profile of two Bezier spans over [0, 1] and [1, 1 + width], with a double knot, that leaves (2, 0) toward `next`.
NurbsCurve<Vec3> two_spans(const Vec3& next, double width) {
  NurbsCurve<Vec3> c;
  c.degree = 2;
  c.knots = {0, 0, 0, 1, 1, 1 + width, 1 + width, 1 + width};
  for (const Vec3& p : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), next, Vec3(4, 1, 0)}) c.poles.push_back(homogeneous(p, 1.0));
  return c;
}

TEST(Bend, OnlyACreaseStopsABoxAndOnlyOneThatReachesAcross) {
  const Box2 left{{0.5, 0}, {1, 1}}, right{{1, 0}, {1.5, 1}}, across{{0.5, 0}, {1.5, 1}};
  const auto tree = [](const Vec3& next, double width) {
    return BendTree(Extrusion{two_spans(next, width), {0, 0, 1}, {0, 1 + width}}, {{0, 0}, {1 + width, 1}});
  };
  const BendTree smooth = tree({3, 0, 0}, 1), kink = tree({3, 0, 0}, 2), crease = tree({3, 0.5, 0}, 1);
  EXPECT_TRUE(smooth.creases_u().empty() && kink.creases_u().empty());
  EXPECT_EQ(crease.creases_u(), std::vector<double>{1});
  for (const BendTree* t : {&smooth, &kink, &crease})
    for (const Box2& box : {left, right, left.inflated(1e-16)}) EXPECT_TRUE(finite(t->over(box).Muu) && finite(t->over(box).uu.hi));
  EXPECT_TRUE(finite(smooth.over(across).uu.hi) && finite(kink.over(across).uu.hi));
  EXPECT_EQ(smooth.over(across).kink_u, 0);
  EXPECT_NEAR(kink.over(across).kink_u, 1, 1e-12);  // |(2, 0) - (1, 0)|
  EXPECT_EQ(kink.over(left).kink_u, 0);
  EXPECT_EQ(crease.over(across).Muu, kInf);
  EXPECT_EQ(crease.over(across).uu.hi, kInf);
  const BendTree turned(Revolution{two_spans({3, 0.5, 0}, 1), {0, -1, 0}, {1, 0, 0}, {0, 2}}, {{0, 0}, {1, 2}});
  EXPECT_EQ(turned.creases_v(), std::vector<double>{1});
  EXPECT_EQ(turned.over({{0, 0.5}, {1, 1.5}}).Mvv, kInf);
  EXPECT_TRUE(finite(turned.over({{0, 1}, {1, 1.5}}).Mvv));
}

// Three arcs whose weights make kinks of the homogeneous curve but none of the circle.
TEST(Bend, ACircleOfArcsHasNoKinks) {
  NurbsCurve<Vec3> c;
  c.degree = 2;
  c.knots = {0, 0, 0, 1, 1, 2, 2, 3, 3, 3};
  for (int i = 0; i < 7; ++i) {
    const double angle = i * kPi / 3, r = i % 2 ? 2 : 1;
    c.poles.push_back(homogeneous(Vec3(r * std::cos(angle), r * std::sin(angle), 0), i % 2 ? 0.5 : 1.0));
  }
  const BendTree tree(Extrusion{c, {0, 0, 1}, {0, 3}}, {{0, 0}, {3, 1}});
  const BoxBend all = tree.over({{0, 0}, {3, 1}});
  EXPECT_TRUE(tree.creases_u().empty());
  EXPECT_EQ(all.kink_u, 0);
  EXPECT_TRUE(finite(all.uu.lo) && all.uu.lo < 0 && all.uu.hi < 0);
  EXPECT_LT(all.curvature, 1.5);
  EXPECT_GE(all.curvature, 1);
}

TEST(Bend, APoleHasFiniteSuprema) {
  NurbsSurface s{2, 2, 3, 3, {0, 0, 0, 1, 1, 1}, {0, 0, 0, 1, 1, 1}, {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s.poles.push_back(homogeneous(Vec3(j, j * (i - 1), 0.2 * j * j), 1.0));
  const BendTree tree(s, natural_domain(s));
  const Bend pole = tree.over({{0, 0}, {1, 0.01}}), away = tree.over({{0, 0.5}, {1, 1}});
  EXPECT_EQ(pole.uu.lo, -kInf);
  EXPECT_EQ(pole.curvature, kInf);
  EXPECT_TRUE(finite(pole.Muu) && finite(pole.Muv) && finite(pole.Mvv));
  EXPECT_TRUE(finite(away.uu.lo) && finite(away.curvature));
  EXPECT_EQ(BendTree(Cone{{}, 0, 0.5}, {{0, -1}, {1, 1}}).over({{0, -1}, {1, 1}}).uu.hi, kInf);
  EXPECT_TRUE(finite(BendTree(Cone{{}, 0, 0.5}, {{0, 0}, {1, 1}}).over({{0, 0}, {1, 1}}).uu.lo));
}

}  // namespace
}  // namespace iso::test
