// Trim regions of curves against closed forms.
#include "patches/trim.h"

#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240611;

Face face_of(AnySurface surface, std::vector<TrimLoop> loops) {
  Face face;
  face.surface = std::move(surface);
  face.loops = std::move(loops);
  return face;
}

TrimLoop circle_loop(const UV& centre, double r, double start = 0, bool backward = false) {
  return {{{Ellipse<Vec2>{centre, {r, 0}, {0, r}}, backward ? start + kTwoPi : start, backward ? start : start + kTwoPi, -1}}};
}

// Distance outward from a circle, in long double.
long double outside_by(const UV& p, const UV& centre, double r) {
  return std::hypot(static_cast<long double>(p.x) - centre.x, static_cast<long double>(p.y) - centre.y) - r;
}

// Half of the points anywhere in the box, half at 1e-12 .. 0.1 from the circle, on both sides.
UV near_or_far(Random& random, int i, const UV& centre, double r) {
  if (i % 2 == 0) return centre + random_vector<Vec2>(random, 1.2 * r);
  const double angle = between(random, 0, kTwoPi), off = std::pow(10.0, between(random, -12, -1)) * (i % 4 == 1 ? 1 : -1);
  return centre + (r + off) * Vec2(std::cos(angle), std::sin(angle));
}

TEST(Trim, CircleAgainstItsClosedForm) {
  Random random(kSeed);
  Tally tally("circle", kSeed);
  std::uint64_t undecided = 0, inside = 0;
  const int rounds = 10, points = 100000;
  for (int round = 0; round < rounds; ++round) {
    const UV centre = random_vector<Vec2>(random, 1);
    const double r = between(random, 0.2, 1);
    const Face face = face_of(Plane{}, {circle_loop(centre, r, between(random, -4, 4), round % 2 == 1)});
    const TrimRegion trim(face, {}, 0);
    for (int i = 0; i < points; ++i) {
      const UV p = near_or_far(random, i, centre, r);
      const long double out = outside_by(p, centre, r);
      if (std::abs(out) <= 1e-12) {
        ++undecided;
        continue;
      }
      inside += out < 0;
      tally.check(trim.contains(p, face.surface).inside == (out < 0), [&] {
        return fmt::format("({:.17g}, {:.17g}), {:.3g} from the circle of radius {:.17g} about ({:.17g}, {:.17g})", p.x, p.y, double(out),
                           r, centre.x, centre.y);
      });
    }
  }
  EXPECT_LE(undecided, 2000u) << "too few points were decided";
  EXPECT_GE(inside, 300000u);
  tally.finish(static_cast<std::uint64_t>(rounds) * points - undecided);
}

// Area of an ellipse with an elliptic hole, by a regular grid: within the grid's own error.
TEST(Trim, AreaOfAnEllipseWithAHole) {
  const Face face = face_of(Plane{}, {{{{Ellipse<Vec2>{{0.1, 0.2}, {2, 0.5}, {-0.25, 1}}, 0, kTwoPi, -1}}}, circle_loop({0.3, 0.1}, 0.5)});
  const TrimRegion trim(face, {}, 0);
  const int n = 1000;
  int inside = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) inside += trim.contains({-2.5 + 5.0 * (i + 0.5) / n, -2.5 + 5.0 * (j + 0.5) / n}, face.surface).inside;
  const double area = 25.0 * inside / (double(n) * n), exact = kPi * (2 * 1 + 0.5 * 0.25) - kPi * 0.25;
  // Boundary length about 12, each boundary pixel of side 0.005 errs by less than its area, independently: a few tens of pixels in all.
  EXPECT_NEAR(area, exact, 100 * 25.0 / (double(n) * n));
}

TEST(Trim, NestedHolesAlternate) {
  Random random(kSeed + 1);
  Tally tally("nested circles", kSeed + 1);
  std::vector<TrimLoop> loops;
  for (int k = 1; k <= 7; ++k) loops.push_back(circle_loop({0.01 * k, 0}, 0.3 * k, k, k % 3 == 0));
  std::shuffle(loops.begin(), loops.end(), random);
  const Face face = face_of(Plane{}, loops);
  const TrimRegion trim(face, {}, 0);
  std::uint64_t wanted = 0;
  for (int i = 0; i < 200000; ++i) {
    const UV p = random_vector<Vec2>(random, 2.3);
    int holders = 0;
    bool near = false;
    for (int k = 1; k <= 7; ++k) {
      const long double out = outside_by(p, {0.01 * k, 0}, 0.3 * k);
      near = near || std::abs(out) <= 1e-12;
      holders += out < 0;
    }
    if (near) continue;
    ++wanted;
    tally.check(trim.contains(p, face.surface).inside == (holders % 2 == 1),
                [&] { return fmt::format("({}, {}) in {} circles", p.x, p.y, holders); });
  }
  EXPECT_GE(wanted, 199990u);
  tally.finish(wanted);
}

// Circles whose extreme points lie on grid lines to the last bit. The lines are taken from the cover of the same region.
TEST(Trim, CurvesThatTouchGridLines) {
  Random random(kSeed + 2);
  Tally tally("touching circles", kSeed + 2);
  const TrimLoop outer = circle_loop({0, 0}, 2);
  const TrimRegion first(face_of(Plane{}, {outer, circle_loop({0, 0}, 0.5)}), {}, 0);
  const auto cells = first.cover();
  ASSERT_GE(cells.size(), 30u);
  std::uint64_t wanted = 0;
  for (int round = 0; round < 40; ++round) {
    const Box2 cell = cells[static_cast<std::size_t>(whole(random, 0, static_cast<int>(cells.size()) - 1))];
    const double r = between(random, 0.1, 0.9);
    const int side = whole(random, 0, 3);
    UV centre{between(random, -0.2, 0.2), between(random, -0.2, 0.2)};
    if (std::abs(side < 2 ? cell.lo.x : cell.lo.y) > 1) continue;
    centre[side / 2] = (side < 2 ? cell.lo.x : cell.lo.y) + (side % 2 ? r : -r);
    if (glm::length(centre) + r > 1.95) continue;
    const Face face = face_of(Plane{}, {outer, circle_loop(centre, r, 0.5 * kPi * whole(random, 0, 3))});
    const TrimRegion trim(face, {}, 0);
    for (int i = 0; i < 20000; ++i) {
      UV p = near_or_far(random, i, centre, r);
      if (i % 3 == 0) p[side / 2] = side < 2 ? cell.lo.x : cell.lo.y;  // queries on the touched line itself
      const long double hole = outside_by(p, centre, r), rim = outside_by(p, {0, 0}, 2);
      if (std::abs(hole) <= 1e-12 || std::abs(rim) <= 1e-12) continue;
      ++wanted;
      tally.check(trim.contains(p, face.surface).inside == (rim < 0 && hole > 0),
                  [&] { return fmt::format("({:.17g}, {:.17g}), round {}", p.x, p.y, round); });
    }
  }
  EXPECT_GE(wanted, 150000u);
  tally.finish(wanted);
}

// ---- rational B-spline loops -------------------------------------------------------------------------------------------

// A star-shaped closed rational Bezier chain about the origin: each span's control points lie in its own sector.
std::vector<BezierSpan<Vec2>> random_star(Random& random, int spans, int degree, NurbsCurve<Vec2>& curve) {
  curve = {};
  curve.degree = degree;
  const int count = spans * degree + 1;
  curve.knots.assign(static_cast<std::size_t>(degree) + 1, 0.0);
  for (int k = 1; k < spans; ++k) curve.knots.insert(curve.knots.end(), static_cast<std::size_t>(degree), k);
  curve.knots.insert(curve.knots.end(), static_cast<std::size_t>(degree) + 1, spans);
  for (int i = 0; i + 1 < count; ++i) {
    const double angle = kTwoPi * i / (count - 1), r = between(random, 0.7, 1.3);
    curve.poles.push_back(homogeneous(r * Vec2(std::cos(angle), std::sin(angle)), i % degree == 0 ? 1.0 : between(random, 0.3, 3)));
  }
  curve.poles.push_back(curve.poles.front());
  return bezier_spans(Curve2(curve), 0, spans);
}

TEST(Trim, HighDegreeRationalLoops) {
  Random random(kSeed + 3);
  Tally tally("rational stars", kSeed + 3);
  std::uint64_t wanted = 0;
  for (int round = 0; round < 60; ++round) {
    const int spans = whole(random, 3, 9), degree = whole(random, 2, 12);
    NurbsCurve<Vec2> curve;
    random_star(random, spans, degree, curve);
    const bool backward = round % 2 == 1;
    const Face face = face_of(Plane{}, {{{{curve, backward ? spans : 0.0, backward ? 0.0 : spans, -1}}}});
    const TrimRegion trim(face, {}, 0);
    for (int i = 0; i < 1000; ++i) {
      // A point of the curve, moved along its ray from the centre: star-shaped with control angles that rise, so r alone decides.
      const auto j = jet(Curve2(curve), between(random, 0, spans));
      const double share = std::pow(10.0, between(random, -11, -0.1)) * (i % 2 ? 1 : -1);
      const UV p = (1 + share) * j.C;
      // Distance from the tangent: how much of the move leads off the curve.
      const double off = std::abs(share) * std::abs(j.C.x * j.Ct.y - j.C.y * j.Ct.x) / glm::length(j.Ct);
      if (off <= 1e-12) continue;
      ++wanted;
      tally.check(trim.contains(p, face.surface).inside == (share < 0),
                  [&] { return fmt::format("degree {}, ({:.17g}, {:.17g}), {:.3g} times off the curve", degree, p.x, p.y, share); });
    }
  }
  EXPECT_GE(wanted, 50000u);
  tally.finish(wanted);
}

// ---- tolerance ---------------------------------------------------------------------------------------------------------

// Beyond a circle, outward or into a hole, by up to twice what the tolerance lets in: a ray that grazes stretches it, up to kMostStretch.
TEST(Trim, ToleranceAlongCirclesForRaysThatGraze) {
  Random random(kSeed + 5);
  Tally tally("circles with a tolerance", kSeed + 5);
  std::uint64_t wanted = 0, let_in = 0;
  for (int round = 0; round < 100; ++round) {
    const double r = std::pow(10.0, between(random, -2, 3)), tolerance = r * std::pow(10.0, between(random, -9, -2.5));
    const Face face = face_of(Plane{}, {circle_loop({0, 0}, 3 * r, round), circle_loop({0.1 * r, 0}, r, round, true)});
    const TrimRegion trim(face, {}, tolerance);
    for (int i = 0; i < 400; ++i) {
      const double cosine = std::pow(10.0, between(random, -1.5, 0)), share = between(random, 0, 2), angle = between(random, 0, kTwoPi);
      if (std::abs(share - 1) < 0.001) continue;
      ++wanted;
      const bool ray = i % 3 != 0;
      const double most = tolerance * (ray ? std::min(1 / cosine, TrimRegion::kMostStretch) : 1.0);
      const UV way{std::cos(angle), std::sin(angle)};
      const UV p = i % 2 ? (3 * r + share * most) * way : UV(0.1 * r, 0) + (r - share * most) * way;
      const Vec3 direction = ray ? 5.0 * Vec3(std::sqrt(1 - cosine * cosine), 0, -cosine) : Vec3(0.0);
      const auto answer = trim.contains(p, face.surface, direction);
      let_in += answer.by_tolerance;
      tally.check(answer.inside == (share < 1) && answer.by_tolerance == (share < 1), [&] {
        return fmt::format("{} of {} off a circle of radius {}, ray {} of cosine {}: inside = {}, by tolerance = {}", share, most, r, ray,
                           cosine, answer.inside, answer.by_tolerance);
      });
    }
  }
  EXPECT_GE(wanted, 39500u);
  EXPECT_GE(let_in, 18000u);
  tally.finish(wanted);
}

// Loops of every degree on a plane whose parameter lines are askew, against the least distance of many points of the curve.
TEST(Trim, ToleranceIsTheDistanceFromTheCurveWhereParametersAreAskew) {
  Random random(kSeed + 6);
  Tally tally("askew", kSeed + 6);
  std::uint64_t near = 0, far = 0;
  constexpr int kPoints = 4000;
  for (int round = 0; round < 60; ++round) {
    NurbsCurve<Vec2> curve;
    const int spans = whole(random, 3, 9), degree = whole(random, 2, 12);
    random_star(random, spans, degree, curve);
    const double slant = between(random, -3, 3);
    const AnySurface surface = Extrusion{Line<Vec3>{{1, 2, 3}, {2, 0, 0}}, {slant, 0.5, 0}, {-10, 10}};
    const Face face = face_of(surface, {{{{curve, 0, double(spans), -1}}}});
    const double tolerance = std::pow(10.0, between(random, -3, -1));
    const TrimRegion trim(face, {}, tolerance);
    const auto in_world = [&](Vec2 d) { return Vec3(2 * d.x + slant * d.y, 0.5 * d.y, 0); };
    std::vector<UV> points;
    double longest = 0;
    for (int k = 0; k <= kPoints; ++k) {
      points.push_back(jet(Curve2(curve), double(spans) * k / kPoints).C);
      if (k > 0) longest = std::max(longest, glm::length(in_world(points[k] - points[k - 1])));
    }
    for (int i = 0; i < 600; ++i) {
      const UV p = points[static_cast<std::size_t>(whole(random, 0, kPoints))] + random_vector<Vec2>(random, 4 * tolerance);
      double distance = kInf;
      for (const UV& q : points) distance = std::min(distance, glm::length(in_world(q - p)));
      const auto answer = trim.contains(p, surface);
      if (answer.inside && !answer.by_tolerance) continue;
      if (std::abs(distance - tolerance) <= longest) continue;  // the curve may come nearer between two of the points
      (answer.inside ? near : far)++;
      tally.check(answer.inside == (distance < tolerance), [&] {
        return fmt::format("degree {}, slant {}, ({:.17g}, {:.17g}), {:.3g} tolerances off: inside = {}", degree, slant, p.x, p.y,
                           distance / tolerance, answer.inside);
      });
    }
  }
  EXPECT_GE(near, 500u);
  EXPECT_GE(far, 2000u);
  tally.finish(near + far);
}

// ---- classification ----------------------------------------------------------------------------------------------------

TEST(Trim, ClassifyNeverContradictsContains) {
  Random random(kSeed + 4);
  Tally tally("boxes", kSeed + 4);
  std::array<std::uint64_t, 3> kinds{};
  for (int round = 0; round < 40; ++round) {
    NurbsCurve<Vec2> curve;
    const int spans = whole(random, 3, 9);
    random_star(random, spans, whole(random, 1, 6), curve);
    // On a plane, or wrapped around a cylinder far off its principal period.
    AnySurface surface = Plane{};
    const double shift = kTwoPi * whole(random, -2, 2);
    if (round % 2) {
      surface = Cylinder{};
      for (Vec3& h : curve.poles) h.x += shift * h.z;
    }
    const Face face = face_of(surface, {{{{curve, 0, double(spans), -1}}}, circle_loop({round % 2 ? shift : 0.0, 0}, 0.3)});
    const TrimRegion trim(face, {}, round % 3 ? 0 : 1e-6);
    for (int i = 0; i < 500; ++i) {
      const UV middle = random_vector<Vec2>(random, 1.6) + Vec2(round % 2 ? kTwoPi * whole(random, -1, 1) : 0.0, 0);
      const Vec2 half = std::pow(10.0, between(random, -5, -0.5)) * Vec2(between(random, 0.1, 1), between(random, 0.1, 1));
      const Box2 box{middle - half, middle + half};
      const auto kind = trim.classify(box);
      ++kinds[static_cast<std::size_t>(kind)];
      for (int k = 0; k < 8; ++k) {
        const UV p = k < 4 ? Vec2(k & 1 ? box.lo.x : box.hi.x, k & 2 ? box.lo.y : box.hi.y) : point_in(random, box);
        const bool inside = trim.contains(p, face.surface).inside;
        const bool agrees = kind == TrimRegion::Kind::crossing || inside == (kind == TrimRegion::Kind::inside);
        tally.check(agrees, [&] {
          return fmt::format("box about ({}, {}), half {}: kind {}, but ({}, {}) inside = {}", middle.x, middle.y, half.x, int(kind), p.x,
                             p.y, inside);
        });
      }
    }
  }
  for (const std::uint64_t n : kinds) EXPECT_GE(n, 500u) << "a kind was hardly met";
  tally.finish(40 * 500 * 8);
}

}  // namespace
}  // namespace iso::test
