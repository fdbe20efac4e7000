// Properties that every kind of n-sided patch has, and truths in closed form for some.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "patches/base/barycentric.h"
#include "patches/surface/bezier_triangle.h"
#include "patches/surface/patch_basis.h"
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
      ASSERT_LT(std::max(std::abs(sum.u), std::abs(sum.v)), 1e-11) << told(basis);
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
      for (double along : {0.0, 1e-9, 0.1, 0.35, 0.8, 1.0}) {
        ASSERT_LT(glm::length(point_at(basis, points, {along, 0}) - curve_at(after, along / 2)), 1e-12) << told(basis);
        ASSERT_LT(glm::length(point_at(basis, points, {0, along}) - curve_at(before, 1 - along / 2)), 1e-12) << told(basis);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 5000);
}

// ---- Across the sides --------------------------------------------------------------------------------------------------------

// The second row of side 1: across = sum_j B_j r_j is promised as the derivative in the parameter across.
std::vector<Vec3> row_of_side_1(const PatchBasis& basis, const std::vector<Vec3>& p) {
  const int d = basis.degree;
  std::vector<int> side = points_of_side(basis, 1), row;
  if (basis.kind == PatchKind::generalised_bezier) {
    // The file's order: row 1 stands after the n d points of row 0, the points next to the corners are the neighbours'.
    const std::vector<int> before = points_of_side(basis, 0), after = points_of_side(basis, 2 % basis.sides);
    row.push_back(before[d - 1]);
    for (int j = 0; j < d - 2; ++j) row.push_back(1 + basis.sides * d + j);
    row.push_back(1 + basis.sides * d + d - 2);
    row.push_back(after[1]);
  } else {
    row = {2, 3, 5 + 4, 5 + 1};
  }
  std::vector<Vec3> field;
  for (int j = 0; j <= d; ++j) field.push_back(double(d) * (p[row[j]] - p[side[j]]));
  return field;
}

// f and its derivative into the patch, that in t at t = 0.
struct Across {
  double f = 0, by_t = 0;
};
// The coordinates that the parameters are made of, by another route: phi_j at a place of side 1.
std::vector<Across> coordinates(const PatchBasis& basis, double s) {
  std::vector<Vec2> corners;
  for (int k = 0; k < basis.sides; ++k) corners.push_back(domain_corner(basis.sides, k));
  const auto kind = basis.parameters == SideParameters::mean_value ? BarycentricKind::mean_value : BarycentricKind::wachspress;
  const BarycentricPolygon polygon = *barycentric_polygon(kind, corners);
  const Vec2 st(s, 0), by_t = domain_frame(basis.sides, st).by_t;
  std::vector<Across> phi;
  for (const Dual2& c : coordinates_at(polygon, domain_point(basis.sides, st))) phi.push_back({c.f, c.u * by_t.x + c.v * by_t.y});
  return phi;
}
// h_k, or the distance from side k.
Across distance(const PatchBasis& basis, const std::vector<Across>& phi, double s, int k) {
  const int n = basis.sides, from = (k + n - 1) % n;
  if (basis.parameters != SideParameters::distance) return {1 - phi[from % n].f - phi[k % n].f, -phi[from % n].by_t - phi[k % n].by_t};
  const Vec2 a = domain_corner(n, k - 1), b = domain_corner(n, k), normal = Vec2(a.y - b.y, b.x - a.x) / glm::length(b - a);
  const Vec2 st(s, 0);
  return {glm::dot(domain_point(n, st) - a, normal), glm::dot(domain_frame(n, st).by_t, normal)};
}
Across share_of(const Across& a, const Across& b) {
  const double sum = a.f + b.f;
  return {a.f / sum, (a.by_t * b.f - a.f * b.by_t) / (sum * sum)};
}

// The derivative in t at (s, 0) as the kind promises it, in terms of the side's own two rows.
Vec3 promised(const PatchBasis& basis, const std::vector<Vec3>& points, double s) {
  const std::vector<Vec3> curve = chosen(points, points_of_side(basis, 1));
  const double along = s / 2;
  const Vec3 tangent = curve_at(legs(curve), along), across = curve_at(row_of_side_1(basis, points), along);
  const std::vector<Across> phi = coordinates(basis, s);
  const int n = basis.sides;
  if (basis.kind != PatchKind::charrot_gregory) {
    const Across h = distance(basis, phi, s, 1), u = share_of(phi[1], phi[0]);
    return u.by_t * tangent + h.by_t * across;
  }
  // Corners 0 and 1 weigh with their squared distances from the sides 2 and 0; in corner 1 the side runs backwards.
  const auto d = [&](int k) { return distance(basis, phi, s, (k + n) % n); };
  Across product[2] = {{1, 0}, {1, 0}};
  for (int k = 2; k < n; ++k) product[0].f *= d(k).f * d(k).f;
  for (int k = 3; k <= n; ++k) product[1].f *= d(k).f * d(k).f;
  const double w = product[0].f / (product[0].f + product[1].f);
  const Across u0 = share_of(d(0), d(2)), v0 = share_of(d(1), d(-1)), u1 = share_of(d(1), d(3)), v1 = share_of(d(2), d(0));
  return (w * u0.by_t - (1 - w) * v1.by_t) * tangent + (w * v0.by_t + (1 - w) * u1.by_t) * across;
}

// Bezier quads, generalised Bezier and Gregory, Charrot-Gregory: d S = C' du + R dh with the kind's own parameters.
TEST(PatchBasis, DerivativesAcrossSidesAreThoseOfTheRibbon) {
  Numbers random(3);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.kind == PatchKind::bezier_triangle || basis.kind == PatchKind::gregory_triangle) continue;
    std::vector<Vec3> points = random.points(basis);
    for (int corner = 0; corner < 2; ++corner, points = turned(basis, points))
      for (double s : {0.05, 0.3, 0.5, 0.77, 1.0}) {
        const Jet2 jet = jet_at(basis, points, {s, 0});
        ASSERT_LT(glm::length(jet.Sv - promised(basis, points, s)), 1e-11) << told(basis) << " at " << s;
        ++checked;
      }
  }
  EXPECT_GT(checked, 1000);
}

// Triangles: with coordinates (a, b, c) the derivative with c growing and a falling is 4 sum_j B_j (row_j - side_j), row and side quartic.
TEST(PatchBasis, DerivativesAcrossSidesOfGregoryTrianglesAreThoseOfTheRows) {
  Numbers random(4);
  const PatchBasis basis{PatchKind::gregory_triangle, 3, 3};
  int checked = 0;
  std::vector<Vec3> p = random.points(basis);
  for (int corner = 0; corner < 3; ++corner, p = turned(basis, p)) {
    const std::vector<Vec3> side = {p[0], 0.25 * p[0] + 0.75 * p[1], 0.5 * (p[1] + p[7]), 0.75 * p[7] + 0.25 * p[5], p[5]};
    const std::vector<Vec3> row = {0.25 * p[0] + 0.75 * p[2], p[3], p[9], 0.25 * p[5] + 0.75 * p[6]};
    std::vector<Vec3> field;
    for (int j = 0; j < 4; ++j) field.push_back(4.0 * (row[j] - side[j]));
    const Vec2 from = domain_corner(3, 0), to = domain_corner(3, 2);  // the direction from a = 1 to c = 1
    for (double s : {0.0, 0.1, 0.4, 0.9, 1.0}) {
      const DomainFrame frame = domain_frame(3, {s, 0});
      const Vec2 way = glm::inverse(glm::dmat2(frame.by_s, frame.by_t)) * (to - from);
      const Jet2 jet = jet_at(basis, p, {s, 0});
      EXPECT_LT(glm::length(way.x * jet.Su + way.y * jet.Sv - curve_at(field, s / 2)), 1e-12);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 15);
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
      ASSERT_LT(glm::length(map[0].x * here.Su + map[0].y * here.Sv - there.Su), 1e-11) << told(basis);
      ASSERT_LT(glm::length(map[1].x * here.Su + map[1].y * here.Sv - there.Sv), 1e-11) << told(basis);
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
    double error[2] = {0, 0};
    for (int way = 0; way <= 24; ++way)
      for (int step = 0; step < 2; ++step, ++checked) {
        const double angle = kPi / 2 * way / 24, r = step == 0 ? 1e-4 : 1e-5;
        const Jet2 jet = jet_at(basis, points, r * Vec2(std::cos(angle), std::sin(angle)));
        ASSERT_LT(glm::length(jet.S - corner.S), 50 * r) << told(basis);
        error[step] = std::max({error[step], glm::length(jet.Su - corner.Su), glm::length(jet.Sv - corner.Sv)});
      }
    if (basis.degree > 1) {
      ASSERT_NEAR(error[0] / error[1], 10, 0.5) << told(basis);
    }
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

// ---- Truths ------------------------------------------------------------------------------------------------------------------

double bernstein(int d, int j, double u) {
  double c = 1;
  for (int i = 1; i <= j; ++i) c = c * (d - j + i) / i;
  return c * std::pow(u, j) * std::pow(1 - u, d - j);
}

TEST(PatchTruth, GregoryQuadWithEqualTwistsIsItsBezierPatch) {
  Numbers random(10);
  std::array<Vec3, 16> net;
  for (Vec3& p : net) p = random.vector();
  const NSidedPatch patch = gregory_of_bezier(net);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec2 st = random.in_chart();
    Vec3 truth(0.0);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) truth += bernstein(3, k, st.x / 2) * bernstein(3, j, st.y / 2) * net[4 * j + k];
    worst = std::max(worst, glm::length(point_at(patch.basis, patch.points, st) - truth));
  }
  EXPECT_LT(worst, 1e-14);
}

// With four sides of any degree the generalised Bezier patch is the tensor product: even degrees have the central point in the middle.
TEST(PatchTruth, FourSidedGeneralisedBezierIsTheTensorProduct) {
  Numbers random(11);
  for (int d = 3; d <= 8; ++d)
    for (SideParameters parameters : {SideParameters::wachspress}) {
      const PatchBasis basis{PatchKind::generalised_bezier, 4, d, parameters};
      // Point (j, r) of the side from corner c, in the net whose first index runs from corner 0 to 1.
      std::vector<std::array<int, 2>> place{{d / 2, d / 2}};
      for (int r = 0; r < (d + 1) / 2; ++r)
        for (int c = 0; c < 4; ++c)
          for (int j = r; j < d - r; ++j)
            place.push_back(c == 0   ? std::array<int, 2>{j, r}
                            : c == 1 ? std::array<int, 2>{d - r, j}
                            : c == 2 ? std::array<int, 2>{d - j, d - r}
                                     : std::array<int, 2>{r, d - j});
      ASSERT_EQ(static_cast<int>(place.size()), point_count(basis));
      for (int i = 0; i < 50; ++i) {
        const Vec2 st = random.in_chart();
        const std::vector<double> W = weights(basis, st);
        for (std::size_t m = 0; m < W.size(); ++m) {
          const double truth = bernstein(d, place[m][0], st.x / 2) * bernstein(d, place[m][1], st.y / 2);
          ASSERT_NEAR(W[m], m == 0 && d % 2 == 1 ? 0 : truth, 1e-14) << "degree " << d << " point " << m;
        }
      }
    }
}
TEST(PatchTruth, FourSidedGeneralisedGregoryIsTheGregoryQuad) {
  Numbers random(12);
  for (int i = 0; i < 200; ++i) {
    const Vec2 st = random.in_chart();
    const std::vector<double> W = weights({PatchKind::generalised_gregory, 4, 3}, st), quad = weights({PatchKind::gregory_quad, 4, 3}, st);
    for (int m = 0; m < 20; ++m) ASSERT_NEAR(W[m], quad[m], 1e-14);
    ASSERT_NEAR(W[20], 0, 1e-14);
  }
}

// With three sides phi are the barycentric coordinates (a, b, c), s = b / (a + b) and h = c on side 1: its row 0 has the Bernstein
// polynomials of the triangle's border, its row 1 those times d c / (a + b).
TEST(PatchTruth, ThreeSidedGeneralisedBezierInBarycentricCoordinates) {
  Numbers random(13);
  for (int d = 3; d <= 8; ++d) {
    const PatchBasis basis{PatchKind::generalised_bezier, 3, d};
    for (int i = 0; i < 100; ++i) {
      const Vec2 st = random.in_chart(), x = domain_point(3, st);
      const double b = (1 - x.x) / 3 + x.y / std::sqrt(3.0), c = (1 - x.x) / 3 - x.y / std::sqrt(3.0), a = 1 - b - c;
      const std::vector<double> W = weights(basis, st);
      const auto border = [&](int j, double p, double q) {
        return bernstein(d, j, 0.5) * std::pow(2, d) * std::pow(p, d - j) * std::pow(q, j);
      };
      ASSERT_NEAR(W[1], border(0, a, b), 1e-13);
      ASSERT_NEAR(W[2], (b * border(1, a, b) + c * d * b * std::pow(a, d) / (a + c)) / (b + c), 1e-13);
      if (d > 3) {
        ASSERT_NEAR(W[3], border(2, a, b), 1e-13);
      }
      const double twist = (b * border(1, a, b) * d * c / (a + b) + c * border(d - 1, c, a) * d * b / (a + c)) / (b + c);
      ASSERT_NEAR(W[1 + 3 * d], twist, 1e-13) << d;
    }
  }
}

TEST(PatchTruth, GregoryTriangleWithEqualPairsIsItsQuarticBezierTriangle) {
  Numbers random(14);
  const PatchBasis basis{PatchKind::gregory_triangle, 3, 3}, quartic{PatchKind::bezier_triangle, 3, 4};
  std::vector<Vec3> p = random.points(basis);
  for (int k = 0; k < 3; ++k) p[5 * k + 4] = p[5 * k + 3];
  // The cubic triangle with this border raised to degree four: its border is right whatever its middle is.
  NSidedPatch cubic{.basis = {PatchKind::bezier_triangle, 3, 3}, .points = std::vector<Vec3>(10), .weights = {}};
  for (int side = 0; side < 3; ++side)
    for (int j = 0; j < 4; ++j) cubic.points[points_of_side(cubic.basis, side)[j]] = p[points_of_side(basis, side)[j]];
  NSidedPatch raised = raised_triangle(cubic);
  raised.points[6] = p[3];    // powers (2, 1, 1)
  raised.points[7] = p[8];    // powers (1, 2, 1)
  raised.points[10] = p[13];  // powers (1, 1, 2)
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec2 st = random.in_chart();
    worst = std::max(worst, glm::length(point_at(basis, p, st) - point_at(quartic, raised.points, st)));
  }
  EXPECT_LT(worst, 1e-14);
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
