// What n-sided patches promise across their sides, kind by kind, in closed form.
#include <gtest/gtest.h>

#include "patches/base/barycentric.h"
#include "patches/surface/patch_basis.h"
#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

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

}  // namespace
}  // namespace iso::test
