// Properties of every surface kind.
#include "patches/surface/surface.h"

#include "patches/surface/bezier_patch.h"
#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240608;
constexpr int kRounds = 12;

// Largest coordinate in use: rounding errors are shares of it.
double size_of(const SurfaceCase& c) {
  const Box3 box = bounds(c.surface, c.uv);
  return glm::length(glm::max(glm::abs(box.lo), glm::abs(box.hi)));
}

template <class Check>
void for_every_kind(std::uint64_t seed, Check check) {
  Random random(seed);
  for (int round = 0; round < kRounds; ++round) {
    const auto cases = random_surfaces(random);
    ASSERT_EQ(cases.size(), kSurfaceCases);
    for (const SurfaceCase& c : cases) {
      ASSERT_EQ(problem_of(c.surface), "") << c.name;
      check(random, c);
    }
  }
}

std::string at(const SurfaceCase& c, const UV& uv) { return fmt::format("{} at ({:.17g}, {:.17g})", c.name, uv.x, uv.y); }

TEST(Surface, PointIsTheJetsPoint) {
  Tally tally("point = jet", kSeed);
  for_every_kind(kSeed, [&](Random& random, const SurfaceCase& c) {
    for (int k = 0; k < 20; ++k) {
      const UV uv = point_in(random, c.uv);
      tally.within(glm::length(point(c.surface, uv) - jet2(c.surface, uv).S), 8 * kEps * size_of(c), [&] { return at(c, uv); });
    }
  });
  tally.finish(kRounds * kSurfaceCases * 20);
}

// Mean errors of central differences against Su, Sv, Suu, Suv, Svv.
std::array<double, 5> difference_errors(const AnySurface& s, const std::vector<UV>& at, double h) {
  std::array<double, 5> e{};
  for (const UV& uv : at) {
    const Jet2 j = jet2(s, uv);
    const auto S = [&](double du, double dv) { return point(s, {uv.x + du * h, uv.y + dv * h}); };
    e[0] += glm::length((S(1, 0) - S(-1, 0)) / (2 * h) - j.Su);
    e[1] += glm::length((S(0, 1) - S(0, -1)) / (2 * h) - j.Sv);
    e[2] += glm::length((S(1, 0) - 2.0 * j.S + S(-1, 0)) / (h * h) - j.Suu);
    e[3] += glm::length((S(1, 1) - S(1, -1) - S(-1, 1) + S(-1, -1)) / (4 * h * h) - j.Suv);
    e[4] += glm::length((S(0, 1) - 2.0 * j.S + S(0, -1)) / (h * h) - j.Svv);
  }
  for (double& x : e) x /= static_cast<double>(at.size());
  return e;
}

TEST(Surface, DerivativesConvergeWithSecondOrder) {
  Tally tally("derivatives", kSeed + 1);
  int slopes = 0;
  for_every_kind(kSeed + 1, [&](Random& random, const SurfaceCase& c) {
    const double h = 0.004;
    std::vector<UV> samples;
    for (int k = 0; k < 16; ++k)
      samples.push_back({away_from(random, breaks(c.surface, 0), c.uv.lo.x, c.uv.hi.x, 2 * h),
                         away_from(random, breaks(c.surface, 1), c.uv.lo.y, c.uv.hi.y, 2 * h)});
    const auto coarse = difference_errors(c.surface, samples, h), fine = difference_errors(c.surface, samples, h / 2);
    for (std::size_t i = 0; i < 5; ++i) {
      const double noise = 40 * kEps * size_of(c) / std::pow(h / 2, i < 2 ? 1 : 2);
      if (coarse[i] > 1000 * noise) {
        ++slopes;
        const double ratio = coarse[i] / fine[i];
        tally.check(ratio > 3.3 && ratio < 4.8, [&] { return fmt::format("{}: derivative {} converges with ratio {}", c.name, i, ratio); });
      } else {
        tally.check(fine[i] <= 1001 * noise, [&] { return fmt::format("{}: derivative {} is off by {}", c.name, i, fine[i]); });
      }
    }
  });
  tally.finish(kRounds * kSurfaceCases * 5);
  EXPECT_GE(slopes, kRounds * static_cast<int>(kSurfaceCases) * 2) << "too few slopes were above rounding";
}

TEST(Surface, BoundsContainSamples) {
  Tally tally("bounds", kSeed + 2);
  double volume_ratio = 0;
  for_every_kind(kSeed + 2, [&](Random& random, const SurfaceCase& c) {
    for (int k = 0; k < 4; ++k) {
      const UV a = point_in(random, c.uv), b = point_in(random, c.uv);
      const Box2 part{glm::min(a, b), glm::max(a, b)};
      const Box3 box = bounds(c.surface, part);
      Box3 seen;
      for (int i = 0; i < 50; ++i) {
        const UV uv = i == 0 ? part.lo : i == 1 ? part.hi : point_in(random, part);
        const Point3 p = point(c.surface, uv);
        seen.include(p);
        tally.check(box.contains(p),
                    [&] { return fmt::format("{} lies outside the box of [{}, {}] x [{}, {}]", at(c, uv), a.x, b.x, a.y, b.y); });
      }
      volume_ratio = std::max(volume_ratio, seen.diagonal() > 0 ? box.diagonal() / seen.diagonal() : 1.0);
    }
  });
  tally.finish(kRounds * kSurfaceCases * 200);
  fmt::print("[ measured ] largest box is {:.3g} times its samples' box\n", volume_ratio);
}

TEST(Surface, BezierPiecesReproduceTheSurface) {
  Tally tally("pieces", kSeed + 3), covered("cover", kSeed + 3), weights("weights", kSeed + 3);
  for_every_kind(kSeed + 3, [&](Random& random, const SurfaceCase& c) {
    const UV a = point_in(random, c.uv), b = point_in(random, c.uv);
    const Box2 part{glm::min(a, b), glm::max(a, b)};
    const auto pieces = bezier_pieces(c.surface, part);
    ASSERT_FALSE(pieces.empty()) << c.name;
    const double size = size_of(c);
    double area = 0;
    bool positive = true;
    for (const BezierPiece& p : pieces) {
      area += p.native_box().size().x * p.native_box().size().y;
      for (const Vec4& h : p.patch.net) positive = positive && h.w > 0;
    }
    weights.check(positive, [&] { return c.name + " has a piece with a weight that is not positive"; });
    covered.within(std::abs(area - part.size().x * part.size().y), 1e-13 * area,
                   [&] { return c.name + ": the pieces do not cover the box once"; });
    for (int k = 0; k < 60; ++k) {
      const BezierPiece& p = pieces[static_cast<std::size_t>(whole(random, 0, static_cast<int>(pieces.size()) - 1))];
      const Vec2 st = k < 4 ? Vec2(k & 1, k >> 1) : Vec2(between(random, 0, 1), between(random, 0, 1));
      const UV uv = p.to_native(st);
      tally.within(glm::length(project(homogeneous_jet(p.patch, st).H) - point(c.surface, uv)), 1e-14 * size, [&] { return at(c, uv); });
    }
  });
  tally.finish(kRounds * kSurfaceCases * 60);
  covered.finish(kRounds * kSurfaceCases);
  weights.finish(kRounds * kSurfaceCases);
}

TEST(Surface, TranslationMovesThePointAndNothingElse) {
  Tally tally("translation", kSeed + 4);
  for_every_kind(kSeed + 4, [&](Random& random, const SurfaceCase& c) {
    const Vec3 by = random_vector<Vec3>(random, 10);
    AnySurface moved = c.surface;
    translate(moved, by);
    const double limit = 64 * kEps * (size_of(c) + glm::length(by));
    for (int k = 0; k < 10; ++k) {
      const UV uv{away_from(random, breaks(c.surface, 0), c.uv.lo.x, c.uv.hi.x, 1e-6),
                  away_from(random, breaks(c.surface, 1), c.uv.lo.y, c.uv.hi.y, 1e-6)};
      const Jet2 j = jet2(c.surface, uv), k2 = jet2(moved, uv);
      tally.within(glm::length(k2.S - j.S - by), limit, [&] { return at(c, uv); });
      // Derivatives of a B-spline carry rounding of poles times degree / knot width per order.
      tally.within(glm::length(k2.Su - j.Su) + glm::length(k2.Sv - j.Sv), 200 * limit, [&] { return at(c, uv) + ", first derivatives"; });
    }
  });
  tally.finish(kRounds * kSurfaceCases * 20);
}

TEST(Surface, PeriodsAreRight) {
  Tally tally("periods", kSeed + 5);
  for_every_kind(kSeed + 5, [&](Random& random, const SurfaceCase& c) {
    const Vec2 period = periods(c.surface);
    for (const int d : {0, 1}) {
      if (!(period[d] > 0)) continue;
      for (int k = 0; k < 5; ++k) {
        UV uv = point_in(random, c.uv), shifted = uv;
        shifted[d] += period[d];
        tally.within(glm::length(point(c.surface, uv) - point(c.surface, shifted)), 1e-14 * size_of(c), [&] { return at(c, uv); });
      }
    }
  });
  tally.finish(kRounds * 5 * (1 + 1 + 1 + 4 + (kCurveCases + 2)));  // u: cylinder, cone, sphere, ellipse and revolutions; both: tori
}

TEST(Surface, SubpatchesAndHalvesAreTheSamePatch) {
  Random random(kSeed + 6);
  Tally tally("halves", kSeed + 6);
  for (int i = 0; i < 200; ++i) {
    const int pu = whole(random, 1, 12), pv = whole(random, 1, 12);
    const NurbsSurface s = random_nurbs(random, Knots::bezier, Knots::bezier, pu, pv, i % 2 == 0);
    const BezierPatch patch = bezier_pieces(s, natural_domain(s)).front().patch;
    BezierPatch low, high;
    const double size = hull_box(patch).diagonal() + glm::length(hull_box(patch).middle());
    for (const int d : {0, 1}) {
      split_in_half(patch, d, low, high);
      for (int k = 0; k < 10; ++k) {
        const Vec2 st{between(random, 0, 1), between(random, 0, 1)};
        Vec2 half = st;
        half[d] = st[d] < 0.5 ? 2 * st[d] : 2 * st[d] - 1;
        const Point3 whole_point = project(homogeneous_jet(patch, st).H),
                     half_point = project(homogeneous_jet(st[d] < 0.5 ? low : high, half).H);
        tally.within(glm::length(whole_point - half_point), 1e-14 * size,
                     [&] { return fmt::format("half in {} of degree {} x {}", d, pu, pv); });
      }
    }
    const Vec2 a{between(random, 0, 1), between(random, 0, 1)}, b{between(random, 0, 1), between(random, 0, 1)}, lo = glm::min(a, b),
                                                                                                                 hi = glm::max(a, b);
    const BezierPatch part = part_of(patch, lo, hi);
    for (int k = 0; k < 10; ++k) {
      const Vec2 st{between(random, 0, 1), between(random, 0, 1)};
      const Point3 p = project(homogeneous_jet(part, st).H), q = project(homogeneous_jet(patch, lo + st * (hi - lo)).H);
      tally.within(glm::length(p - q), 1e-14 * size, [&] { return fmt::format("part of degree {} x {}", pu, pv); });
    }
  }
  tally.finish(200 * 30);
}

}  // namespace
}  // namespace iso::test
