#include "patches/surface/patch_construct.h"

#include <cmath>
#include <vector>

namespace iso {

namespace {

// What is left of a chord at right angles to the plane when it is projected, by rounding: a few units in the last place of its length.
constexpr double kNoTangent = 16 * kEps;

Vec3 in_tangent_plane(const Vec3& v, const Vec3& normal) { return v - glm::dot(v, normal) * normal; }

// Across the boundary, in the tangent plane, of length 1; zero if the boundary has no tangent.
Vec3 basis_vector(const Vec3& normal, const Vec3& leg) {
  const Vec3 across = glm::cross(normal, leg);
  const double length = glm::length(across);
  return length > 0 ? across / length : Vec3(0.0);
}

// The second rows of all sides as they come from the join: entry k for side k.
struct Rows {
  std::vector<CubicPoints> curves;
  std::vector<CrossField> fields;
};

Rows rows_of(PatchKind kind, std::span<const PatchCorner> corners, std::span<const CubicPoints> curves) {
  const std::size_t n = corners.size();
  Rows rows{.curves = {curves.begin(), curves.end()}, .fields = {}};
  for (std::size_t k = 0; k < n; ++k) {
    const CubicPoints &own = curves[k], &before = curves[(k + n - 1) % n], &next = curves[(k + 1) % n];
    Vec3 a0 = before[2] - before[3], a3 = next[1] - next[0];
    // A quartic triangle's row goes from its points on the sides before and after; what it starts from is the side's point a step back.
    if (kind == PatchKind::gregory_triangle) {
      a0 = 0.75 * a0;
      a3 = 0.75 * (a3 + own[3] - own[2]);
    }
    rows.fields.push_back(join_field(own, a0, a3, corners[(k + n - 1) % n].normal, corners[k].normal));
  }
  return rows;
}

// The pair of inner points of a corner: of side k + 1, and of side k.
std::array<Vec3, 2> inner_pair(PatchKind kind, const Rows& rows, std::size_t k) {
  const std::size_t next = (k + 1) % rows.curves.size();
  const CubicPoints &on_next = rows.curves[next], &on_own = rows.curves[k];
  // Quartic points of the sides, where the triangle wants them.
  const bool quartic = kind == PatchKind::gregory_triangle;
  const Vec3 from_next = quartic ? 0.25 * on_next[0] + 0.75 * on_next[1] : on_next[1];
  const Vec3 from_own = quartic ? 0.5 * (on_own[1] + on_own[2]) : on_own[2];
  return {from_next + rows.fields[next].a1, from_own + rows.fields[k].a2};
}

// How far beyond the corners' mean the central point lies, in distances from it to the mean of the inner points: so that over a regular
// polygon with the normals of a sphere the centre of the patch is on the sphere, up to fourth order in the polygon's size. Heights below
// are over the plane through the corners of the unit circle, on z = (1 - x^2 - y^2) / 2; weights are those at the centre of a cubic patch.
double central_reach(int sides) {
  if (sides == 4) return 2;  // the central point has no weight
  const double n = sides, c = std::cos(kTwoPi / n), h_rest = 2 / n, near = h_rest * h_rest;
  const double on_side = (1 - c) / 3, inside = (1 - c) * (6 + 4 * c) / 9;
  const double corner = near * h_rest / 8, boundary = near * (3 * h_rest + 3 * (1 - h_rest)) / 8, inner = near * (1 - h_rest) * 9 / 8;
  const double central = 1 - n * (corner + boundary + inner);
  return (0.5 - n * (boundary * on_side + inner * inside)) / (central * inside);
}
Vec3 central_point(const std::vector<Vec3>& inner, std::span<const PatchCorner> corners) {
  Vec3 mean(0.0), inside(0.0);
  for (const PatchCorner& c : corners) mean += c.point / static_cast<double>(corners.size());
  for (const Vec3& p : inner) inside += p / static_cast<double>(inner.size());
  return mean + central_reach(static_cast<int>(corners.size())) * (inside - mean);
}

std::string fault_of(const PatchBasis& basis, std::span<const PatchCorner> corners) {
  if (std::string problem = problem_of(basis); !problem.empty()) return problem;
  if (basis.kind == PatchKind::bezier_triangle) return "Bezier triangle, expected a kind that can join its neighbours";
  if (basis.kind == PatchKind::generalised_bezier && basis.degree != 3) return "degree " + std::to_string(basis.degree) + ", expected 3";
  if (corners.size() != static_cast<std::size_t>(basis.sides))
    return std::to_string(corners.size()) + " corners, expected " + std::to_string(basis.sides);
  return {};
}

}  // namespace

CubicPoints boundary_cubic(const Vec3& p0, const Vec3& n0, const Vec3& p1, const Vec3& n1) {
  const Vec3 chord = p1 - p0;
  const double length = glm::length(chord);
  const auto leg = [&](const Vec3& normal) {
    const Vec3 projected = in_tangent_plane(chord, normal);
    if (!(glm::length(projected) > kNoTangent * length)) return Vec3(0.0);
    const Vec3 tangent = in_tangent_plane(projected, normal);  // again: at right angles when short, too
    const double part = glm::length(tangent);                  // length times the cosine of the angle between them
    return tangent * (2 * length * length / (3 * part * (length + part)));
  };
  return {p0, p0 + leg(n0), p1 - leg(n1), p1};
}

CrossField join_field(const CubicPoints& boundary, const Vec3& a0, const Vec3& a3, const Vec3& n0, const Vec3& n1) {
  const Vec3 c0 = boundary[1] - boundary[0], c1 = boundary[2] - boundary[1], c2 = boundary[3] - boundary[2];
  const Vec3 b0 = basis_vector(n0, c0), b3 = basis_vector(n1, c2);
  if (b0 == Vec3(0.0) || b3 == Vec3(0.0)) return {(2.0 * a0 + a3) / 3.0, (a0 + 2.0 * a3) / 3.0};
  // b_0 and c_0 are at right angles, so the coordinates of a_0 are projections.
  const double k0 = glm::dot(a0, b0), k1 = glm::dot(a3, b3);
  const double h0 = glm::dot(a0, c0) / glm::dot(c0, c0), h1 = glm::dot(a3, c2) / glm::dot(c2, c2);
  return {((k0 + k1) * b0 + k0 * b3 + 2 * h0 * c1 + h1 * c0) / 3.0, (k1 * b0 + (k0 + k1) * b3 + h0 * c2 + 2 * h1 * c1) / 3.0};
}

PatchBasis gregory_basis(int sides) {
  const PatchKind kind = sides == 3 ? PatchKind::gregory_triangle : sides == 4 ? PatchKind::gregory_quad : PatchKind::generalised_gregory;
  return {.kind = kind, .sides = sides, .degree = 3};
}

Result<NSidedPatch> patch_within(const PatchBasis& basis, std::span<const PatchCorner> corners, std::span<const CubicPoints> curves) {
  if (std::string fault = fault_of(basis, corners); !fault.empty()) return bad_input({}, name_of(basis.kind), fault);
  const std::size_t n = corners.size();
  if (curves.size() != n)
    return bad_input({}, name_of(basis.kind), std::to_string(curves.size()) + " curves, expected " + std::to_string(n));
  for (std::size_t k = 0; k < n; ++k) {
    const std::string place = "corner " + std::to_string(k);
    if (!finite(corners[k].point) || !finite(corners[k].normal)) return bad_input({}, place, "not finite");
    if (!(std::abs(glm::length(corners[k].normal) - 1) < 1e-6)) return bad_input({}, place, "a normal that is no unit vector");
    if (curves[k][3] != corners[k].point || curves[(k + 1) % n][0] != corners[k].point)
      return bad_input({}, place, "curves that do not meet in it");
    if (!finite(curves[k][1]) || !finite(curves[k][2])) return bad_input({}, "side " + std::to_string(k), "not finite");
  }

  const Rows rows = rows_of(basis.kind, corners, curves);
  NSidedPatch patch{.basis = basis, .points = std::vector<Vec3>(point_count(basis)), .weights = {}};
  std::vector<Vec3> inner;
  for (std::size_t k = 0; k < n; ++k)
    for (const Vec3& p : inner_pair(basis.kind, rows, k)) inner.push_back(p);
  for (std::size_t k = 0; k < n; ++k) {
    const CubicPoints& next = curves[(k + 1) % n];
    if (basis.kind == PatchKind::generalised_bezier) {
      // Row 0 three points a side, then one twist a corner, after the central point.
      for (int j = 0; j < 3; ++j) patch.points[1 + 3 * k + j] = next[j];
      patch.points[1 + 3 * n + k] = 0.5 * (inner[2 * k] + inner[2 * k + 1]);
    } else {
      const std::array<Vec3, 5> five = {corners[k].point, next[1], curves[k][2], inner[2 * k], inner[2 * k + 1]};
      for (int j = 0; j < 5; ++j) patch.points[5 * k + j] = five[j];
    }
  }
  if (basis.kind == PatchKind::generalised_bezier) patch.points.front() = central_point(inner, corners);
  if (basis.kind == PatchKind::generalised_gregory) patch.points.back() = central_point(inner, corners);
  return patch;
}

Result<NSidedPatch> patch_over(const PatchBasis& basis, std::span<const PatchCorner> corners) {
  std::vector<CubicPoints> curves;
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const PatchCorner &from = corners[(k + n - 1) % n], &to = corners[k];
    if (from.point == to.point) return bad_input({}, "corner " + std::to_string(k), "the place of the corner before it");
    curves.push_back(boundary_cubic(from.point, from.normal, to.point, to.normal));
  }
  return patch_within(basis, corners, curves);
}

}  // namespace iso
