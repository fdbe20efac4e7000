// Properties that every kind of n-sided patch has.
#include <gtest/gtest.h>

#include <map>

#include "patches/surface/patch_basis-inl.h"
#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

TEST(PatchBasis, WeightsSumToOneAndTheirDerivativesToZero) {
  Numbers random(1);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const std::vector<Vec3> points = random.points(basis);
    const Mat3 linear(random.vector(), random.vector(), random.vector());
    const Vec3 shift = random.vector();
    std::vector<Vec3> moved;
    for (const Vec3& p : points) moved.push_back(linear * p + shift);
    for (int i = 0; i < 20; ++i, ++checked) {
      const Vec2 st = random.in_chart();
      Dual2 sum;
      for (const Dual2& w : dual_weights(basis, st)) sum = sum + w;
      const double plain = [&] {
        const std::vector<double> W = weights(basis, st);
        return std::accumulate(W.begin(), W.end(), 0.0);
      }();
      ASSERT_NEAR(plain, 1, 1e-13) << told(basis);
      ASSERT_NEAR(sum.f, 1, 1e-13) << told(basis);
      ASSERT_LT(std::max(std::abs(sum.u), std::abs(sum.v)), 1e-12) << told(basis);
      const Vec3 affine = linear * point_at(basis, points, st) + shift;
      ASSERT_LT(glm::length(point_at(basis, moved, st) - affine), 1e-13) << told(basis);
    }
  }
  EXPECT_GT(checked, 2500);
}

TEST(PatchBasis, AtACornerOnlyItsOwnPointCounts) {
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const int own = points_of_side(basis, 0).back();
    ASSERT_EQ(points_of_side(basis, 1).front(), own);
    const std::vector<double> W = weights(basis, Vec2(0.0));
    const std::vector<Dual2> dual = dual_weights(basis, Vec2(0.0));
    for (int m = 0; m < point_count(basis); ++m, ++checked) {
      ASSERT_NEAR(W[m], m == own ? 1 : 0, 1e-14) << told(basis);
      ASSERT_NEAR(dual[m].f, m == own ? 1 : 0, 1e-14) << told(basis);
      for (double part : {dual[m].u, dual[m].v, dual[m].uu, dual[m].uv, dual[m].vv}) ASSERT_TRUE(std::isfinite(part)) << told(basis);
    }
  }
  EXPECT_GT(checked, 5000);
}

// Turning: a permutation whose n-th power is none, which takes sides to sides.
TEST(PatchBasis, TurningTakesEachSideToTheNext) {
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const std::vector<int> to = points_from_next_corner(basis);
    ASSERT_EQ(static_cast<int>(to.size()), point_count(basis));
    for (int m = 0; m < point_count(basis); ++m) {
      int place = m;
      for (int k = 0; k < basis.sides; ++k) place = to[place];
      ASSERT_EQ(place, m) << told(basis);
    }
    for (int side = 0; side < basis.sides; ++side, ++checked) {
      const std::vector<int> own = points_of_side(basis, side), next = points_of_side(basis, (side + 1) % basis.sides);
      ASSERT_EQ(static_cast<int>(own.size()), basis.degree + 1);
      for (std::size_t i = 0; i < own.size(); ++i) ASSERT_EQ(to[own[i]], next[i]) << told(basis);
      ASSERT_EQ(own.back(), next.front());
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST(PatchBasis, SidesAreTheirBezierCurves) {
  Numbers random(2);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const std::vector<Vec3> whole = random.points(basis);
    std::vector<Vec3> points = whole;
    for (int corner = 0; corner < basis.sides; ++corner, points = turned(basis, points)) {
      const std::vector<Vec3> after = chosen(whole, points_of_side(basis, (corner + 1) % basis.sides));
      const std::vector<Vec3> before = chosen(whole, points_of_side(basis, corner));
      for (double along : {0.0, 1e-15, 1e-9, 1e-5, 1e-3, 0.1, 0.35, 0.8, 1.0}) {
        ASSERT_LT(glm::length(point_at(basis, points, {along, 0}) - curve_at(after, along / 2)), 1e-12) << told(basis);
        ASSERT_LT(glm::length(point_at(basis, points, {0, along}) - curve_at(before, 1 - along / 2)), 1e-12) << told(basis);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 7500);
}

// ---- Derivatives, seams, corners ---------------------------------------------------------------------------------------------

double distance_of(const Jet2& a, const Jet2& b) {
  return glm::length(a.Su - b.Su) + glm::length(a.Sv - b.Sv) + glm::length(a.Suu - b.Suu) + glm::length(a.Suv - b.Suv) +
         glm::length(a.Svv - b.Svv);
}
// Central differences of points (first derivatives) and of first derivatives (second ones).
Jet2 differences(const PatchBasis& basis, const std::vector<Vec3>& points, const Vec2& st, double h) {
  const auto at = [&](double s, double t) { return jet_at(basis, points, st + h * Vec2(s, t)); };
  const Jet2 right = at(1, 0), left = at(-1, 0), up = at(0, 1), down = at(0, -1);
  Jet2 jet;
  jet.Su = (right.S - left.S) / (2 * h);
  jet.Sv = (up.S - down.S) / (2 * h);
  jet.Suu = (right.Su - left.Su) / (2 * h);
  jet.Suv = (up.Su - down.Su) / (2 * h);
  jet.Svv = (up.Sv - down.Sv) / (2 * h);
  return jet;
}

TEST(PatchBasis, DerivativesAreTheLimitOfDifferencesOfSecondOrder) {
  Numbers random(5);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const std::vector<Vec3> points = random.points(basis);
    double coarse = 0, fine = 0;
    for (int i = 0; i < 6; ++i, ++checked) {
      const Vec2 st(random(0.2, 0.95), random(0.2, 0.95));
      const Jet2 jet = jet_at(basis, points, st);
      coarse += distance_of(differences(basis, points, st, 2e-3), jet);
      fine += distance_of(differences(basis, points, st, 1e-3), jet);
    }
    ASSERT_LT(fine, 0.1) << told(basis);
    // Of polynomials of degree two and less the differences have no error.
    if (coarse > 1e-8) {
      ASSERT_NEAR(coarse / fine, 4, 0.2) << told(basis);
    }
  }
  EXPECT_GT(checked, 800);
}

// Beyond s = 1 of a chart lies the next corner's: the same points, and the same derivatives in the domain.
TEST(PatchBasis, ChartsOfNeighbouringCornersMeetSmoothly) {
  Numbers random(6);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const std::vector<Vec3> points = random.points(basis), next = turned(basis, points);
    const double angle = kTwoPi / basis.sides;
    const glm::dmat2 turn(Vec2(std::cos(angle), std::sin(angle)), Vec2(-std::sin(angle), std::cos(angle)));
    for (double t : {0.0, 0.2, 0.6, 1.0}) {
      const Jet2 here = jet_at(basis, points, {1, t}), there = jet_at(basis, next, {t, 1});
      ASSERT_LT(glm::length(here.S - there.S), 1e-13) << told(basis);
      const DomainFrame own = domain_frame(basis.sides, {1, t}), other = domain_frame(basis.sides, {t, 1});
      const glm::dmat2 map = glm::inverse(glm::dmat2(own.by_s, own.by_t)) * (turn * glm::dmat2(other.by_s, other.by_t));
      ASSERT_LT(glm::length(map[0].x * here.Su + map[0].y * here.Sv - there.Su), 1e-12) << told(basis);
      ASSERT_LT(glm::length(map[1].x * here.Su + map[1].y * here.Sv - there.Sv), 1e-12) << told(basis);
      ++checked;
    }
  }
  EXPECT_GT(checked, 500);
}

// From all directions value and first derivatives go to those of the corner, with the first power of the distance.
TEST(PatchBasis, CornersAreLimitsFromAllDirections) {
  Numbers random(7);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.parameters == SideParameters::mean_value) continue;
    const std::vector<Vec3> points = random.points(basis);
    const Jet2 corner = jet_at(basis, points, Vec2(0.0));
    double error[3] = {0, 0, 0};
    for (int way = 0; way <= 24; ++way)
      for (int step = 0; step < 3; ++step, ++checked) {
        const double angle = kPi / 2 * way / 24, r = step == 0 ? 1e-4 : step == 1 ? 1e-5 : 1e-12;
        const Jet2 jet = jet_at(basis, points, r * Vec2(std::cos(angle), std::sin(angle)));
        ASSERT_LT(glm::length(jet.S - corner.S), 50 * r) << told(basis);
        error[step] = std::max({error[step], glm::length(jet.Su - corner.Su), glm::length(jet.Sv - corner.Sv)});
      }
    if (basis.degree > 1) {
      ASSERT_NEAR(error[0] / error[1], 10, 0.5) << told(basis);
    }
    ASSERT_LT(error[2], 2e-7 * error[1] + 1e-13) << told(basis);  // and rounding does not grow towards the corner
  }
  EXPECT_GT(checked, 2000);
}
// With mean value coordinates the points go to the corner, the derivatives are bounded.
TEST(PatchBasis, MeanValueCornersAreLimitsOfPoints) {
  Numbers random(8);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.parameters != SideParameters::mean_value) continue;
    const std::vector<Vec3> points = random.points(basis);
    const Vec3 corner = point_at(basis, points, Vec2(0.0));
    for (double r : {1e-2, 1e-4, 1e-8, 1e-12})
      for (int way = 0; way <= 24; ++way, ++checked) {
        const double angle = kPi / 2 * way / 24;
        const Jet2 jet = jet_at(basis, points, r * Vec2(std::cos(angle), std::sin(angle)));
        ASSERT_LT(glm::length(jet.S - corner), 50 * r) << told(basis);
        ASSERT_LT(std::max(glm::length(jet.Su), glm::length(jet.Sv)), 50) << told(basis);
      }
  }
  EXPECT_GT(checked, 2000);
}

// With mean value coordinates there are no limits: the first derivatives at the corner are those of the boundary curves.
TEST(PatchBasis, MeanValueDerivativesAtTheCornerAreThoseAlongTheBorders) {
  Numbers random(17);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.parameters != SideParameters::mean_value) continue;
    const std::vector<Vec3> points = random.points(basis);
    const Jet2 corner = jet_at(basis, points, Vec2(0.0));
    for (const double r : {1e-5, 1e-8}) {
      ASSERT_LT(glm::length(jet_at(basis, points, {r, 0}).Su - corner.Su), 200 * r) << told(basis);
      ASSERT_LT(glm::length(jet_at(basis, points, {0, r}).Sv - corner.Sv), 200 * r) << told(basis);
    }
    for (const Vec2& next : {Vec2(1e-60, 0.0), Vec2(1e-100, 1e-90), Vec2(0.0, 1e-300)}) {
      const Jet2 jet = jet_at(basis, points, next);
      ASSERT_TRUE(finite(jet.S) && finite(jet.Su) && finite(jet.Sv)) << told(basis);
      ASSERT_EQ(point_at(basis, points, next), corner.S) << told(basis);
    }
    ++checked;
  }
  EXPECT_GT(checked, 40);
}

// Along s = t the second derivatives at the corner, too, are limits.
TEST(PatchBasis, DerivativesAtTheCornerAreThoseAlongTheDiagonal) {
  Numbers random(15);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.parameters == SideParameters::mean_value) continue;
    const std::vector<Vec3> points = random.points(basis);
    const Jet2 corner = jet_at(basis, points, Vec2(0.0));
    ++checked;
    const Jet2 near = jet_at(basis, points, Vec2(1e-4)), nearer = jet_at(basis, points, Vec2(5e-5));
    const auto error = [&](const Jet2& jet) { return distance_of(jet, corner); };
    ASSERT_LT(error(near), 1) << told(basis);
    if (basis.degree > 2) {
      ASSERT_NEAR(error(near) / error(nearer), 2, 0.1) << told(basis);
    }
  }
  EXPECT_GT(checked, 80);
}

// ---- Hulls and mirrors -------------------------------------------------------------------------------------------------------

// Gregory patches and Bezier triangles are in the convex hull of their points, and so are, measured on a grid, generalised Bezier and
// Gregory patches with 4 to 13 sides (with more their central point goes down to -2e-4 with Wachspress's coordinates). With three sides
// their central point weighs -1/9 at the centre for degree three, and less than nothing for all; and Charrot-Gregory patches extrapolate.
TEST(PatchBasis, WeightsAreNotNegativeWhereTheHullIsPromised) {
  std::map<PatchKind, int> checked;
  for (const PatchBasis& basis : every_basis()) {
    double least = 0;
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; j <= 20; ++j)
        for (double w : weights(basis, {i / 20.0, j / 20.0})) least = std::min(least, w);
    const bool ribbons = basis.kind == PatchKind::generalised_bezier || basis.kind == PatchKind::generalised_gregory;
    const bool extrapolates = basis.kind == PatchKind::charrot_gregory || (ribbons && basis.sides == 3);
    if (extrapolates) {
      EXPECT_LT(least, -0.05) << told(basis);
    } else {
      EXPECT_GT(least, basis.sides > 13 ? -2e-4 : -1e-14) << told(basis);
    }
    ++checked[basis.kind];
  }
  EXPECT_EQ(checked.size(), static_cast<std::size_t>(kPatchKinds));
  const double central = weights({PatchKind::generalised_bezier, 3, 3}, Vec2(1.0))[0];
  EXPECT_NEAR(central, -1.0 / 9, 1e-15);
}

// Which point stands in the place of m when corner 1 and corner n - 1 are swapped.
int mirrored(const PatchBasis& basis, int m) {
  const int n = basis.sides, d = basis.degree;
  if (basis.kind == PatchKind::bezier_triangle) {
    int at = 0;
    for (int i = 0; i <= d; ++i)
      for (int j = 0; i + j <= d; ++j, ++at)
        if (at == m) return j * (d + 1) - j * (j - 1) / 2 + i;
  }
  if (basis.kind != PatchKind::generalised_bezier) {
    if (m == 5 * n) return m;
    constexpr int kSwapped[5] = {0, 2, 1, 4, 3};
    return 5 * ((n - m / 5) % n) + kSwapped[m % 5];
  }
  // The file's order, point j of row r from corner c on: mirrored it is seen from the other end of a side that ends in corner -c.
  if (m == 0) return 0;
  int first = 1, r = 0;
  for (; m >= first + n * (d - 2 * r); ++r) first += n * (d - 2 * r);
  const int length = d - 2 * r, c = (m - first) / length, j = (m - first) % length;
  return first + (j == 0 ? (n - c) % n : (2 * n - c - 1) % n) * length + (j == 0 ? 0 : length - j);
}

TEST(PatchBasis, MirroredPointsGiveTheMirroredPatch) {
  Numbers random(9);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    for (int i = 0; i < 5; ++i) {
      const Vec2 st = random.in_chart();
      const std::vector<double> W = weights(basis, st), other = weights(basis, {st.y, st.x});
      for (int m = 0; m < point_count(basis); ++m, ++checked)
        ASSERT_NEAR(W[m], other[mirrored(basis, m)], 1e-13) << told(basis) << " point " << m;
    }
  }
  EXPECT_GT(checked, 20000);
}

// ---- Number types ------------------------------------------------------------------------------------------------------------

// A number with nothing but what the weights may use: no comparisons, no sign, no sums with plain doubles.
struct Bare {
  Bare() = default;
  explicit Bare(double value_) : value(value_) {}
  double value = 0;
};
Bare operator+(const Bare& a, const Bare& b) { return Bare(a.value + b.value); }
Bare operator-(const Bare& a, const Bare& b) { return Bare(a.value - b.value); }
Bare operator*(const Bare& a, const Bare& b) { return Bare(a.value * b.value); }
Bare operator/(const Bare& a, const Bare& b) { return Bare(a.value / b.value); }
Bare operator+(const Bare& a, double b) { return Bare(a.value + b); }
Bare operator*(const Bare& a, double b) { return Bare(a.value * b); }
Bare operator*(double a, const Bare& b) { return Bare(a * b.value); }
Bare sqrt(const Bare& a) { return Bare(std::sqrt(a.value)); }
Bare blend(const Bare& a, const Bare& b, const Bare& X, const Bare& Y) { return Bare(iso::blend(a.value, b.value, X.value, Y.value)); }
Bare share(const Bare& a, const Bare& b) { return Bare(iso::share(a.value, b.value)); }
const Bare& where_positive(const Bare& of, const Bare& then, const Bare& otherwise) { return of.value > 0 ? then : otherwise; }

TEST(PatchBasis, AnyNumberTypeWithArithmeticWillDo) {
  Numbers random(16);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    const Vec2 st = random.in_chart();
    std::vector<Bare> bare(point_count(basis));
    patch_weights(basis, Bare(st.x), Bare(st.y), bare.data());
    const std::vector<double> W = weights(basis, st);
    for (std::size_t m = 0; m < W.size(); ++m, ++checked) ASSERT_EQ(bare[m].value, W[m]) << told(basis);
  }
  EXPECT_GT(checked, 5000);
}

TEST(PatchBasis, WhatAKindDoesNotHaveIsTold) {
  using enum PatchKind;
  const std::vector<PatchBasis> wrong = {{bezier_triangle, 4, 3},
                                         {bezier_triangle, 3, 0},
                                         {bezier_triangle, 3, 16},
                                         {bezier_triangle, 3, 3, SideParameters::mean_value},
                                         {gregory_triangle, 4, 3},
                                         {gregory_triangle, 3, 4},
                                         {gregory_triangle, 3, 3, SideParameters::distance},
                                         {gregory_quad, 3, 3},
                                         {gregory_quad, 4, 4},
                                         {generalised_bezier, 2, 3},
                                         {generalised_bezier, 17, 3},
                                         {generalised_bezier, 5, 2},
                                         {generalised_bezier, 5, 16},
                                         {generalised_bezier, 5, 3, SideParameters::distance},
                                         {generalised_gregory, 2, 3},
                                         {generalised_gregory, 5, 4},
                                         {generalised_gregory, 5, 3, SideParameters::distance},
                                         {charrot_gregory, 2, 3},
                                         {charrot_gregory, 5, 5}};
  for (const PatchBasis& basis : wrong) EXPECT_FALSE(problem_of(basis).empty()) << told(basis);
  EXPECT_TRUE(problem_of(PatchBasis{generalised_bezier, 16, 15}).empty());
  EXPECT_TRUE(problem_of(PatchBasis{charrot_gregory, 3, 3, SideParameters::distance}).empty());
}

}  // namespace
}  // namespace iso::test
