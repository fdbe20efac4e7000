#include "patches/surface/patch_basis.h"

#include <cmath>

#include "patches/base/check.h"
#include "patches/surface/patch_basis-inl.h"

namespace iso {

namespace {

constexpr int kMostTriangleDegree = 15;

// What is particular to one kind.
struct KindEntry {
  const char* name;
  std::string (*problem)(const PatchBasis&);
  int (*count)(const PatchBasis&);
  std::vector<int> (*from_next_corner)(const PatchBasis&);
  std::vector<int> (*of_side)(const PatchBasis&, int side);
};

std::string sides_must_be(const PatchBasis& basis, int sides) {
  return basis.sides == sides ? std::string{} : std::to_string(basis.sides) + " sides, expected " + std::to_string(sides);
}

// ---- Gregory quadrilaterals ----------------------------------------------------------------------------------------------

std::string quad_problem(const PatchBasis& basis) {
  if (basis.degree != 3) return "degree " + std::to_string(basis.degree) + ", expected 3";
  return sides_must_be(basis, 4);
}
int quad_count(const PatchBasis&) { return 20; }
// Five points a corner, the corners in a ring.
std::vector<int> quad_turned(const PatchBasis&) {
  std::vector<int> to;
  for (int m = 0; m < 20; ++m) to.push_back((m + 5) % 20);
  return to;
}
std::vector<int> quad_side(const PatchBasis&, int side) {
  const int from = 5 * ((side + 3) % 4), to = 5 * side;
  return {from, from + 1, to + 2, to};
}

// ---- Bezier triangles ----------------------------------------------------------------------------------------------------

std::string triangle_problem(const PatchBasis& basis) {
  if (basis.degree < 1 || basis.degree > kMostTriangleDegree)
    return "degree " + std::to_string(basis.degree) + ", expected 1 to " + std::to_string(kMostTriangleDegree);
  return sides_must_be(basis, 3);
}
int triangle_count(const PatchBasis& basis) { return (basis.degree + 1) * (basis.degree + 2) / 2; }
// Coordinates (a, b, c) of the turned patch belong to corners 1, 2 and 0.
std::vector<int> triangle_turned(const PatchBasis& basis) {
  std::vector<int> to;
  const int d = basis.degree;
  for (int i = 0; i <= d; ++i)
    for (int j = 0; i + j <= d; ++j) to.push_back(triangle_index(d, d - i - j, j));
  return to;
}
std::vector<int> triangle_side(const PatchBasis& basis, int side) {
  std::vector<int> points;
  const int d = basis.degree;
  for (int k = 0; k <= d; ++k)
    points.push_back(side == 1 ? triangle_index(d, k, 0) : side == 2 ? triangle_index(d, d - k, k) : triangle_index(d, 0, d - k));
  return points;
}

// In the order of PatchKind.
constexpr KindEntry kKinds[kPatchKinds] = {
    {"Bezier triangle", triangle_problem, triangle_count, triangle_turned, triangle_side},
    {"Gregory triangle", nullptr, nullptr, nullptr, nullptr},
    {"Gregory quad", quad_problem, quad_count, quad_turned, quad_side},
    {"generalised Bezier", nullptr, nullptr, nullptr, nullptr},
    {"generalised Gregory", nullptr, nullptr, nullptr, nullptr},
    {"Charrot-Gregory", nullptr, nullptr, nullptr, nullptr},
};
const KindEntry& entry(const PatchBasis& basis) { return kKinds[static_cast<std::size_t>(basis.kind)]; }

}  // namespace

const char* name_of(PatchKind kind) { return kKinds[static_cast<std::size_t>(kind)].name; }

std::string problem_of(const PatchBasis& basis) {
  if (basis.sides < 3 || basis.sides > kMostSides)
    return std::to_string(basis.sides) + " sides, expected 3 to " + std::to_string(kMostSides);
  return entry(basis).problem(basis);
}
int point_count(const PatchBasis& basis) { return entry(basis).count(basis); }
std::vector<int> points_from_next_corner(const PatchBasis& basis) { return entry(basis).from_next_corner(basis); }
std::vector<int> points_of_side(const PatchBasis& basis, int side) { return entry(basis).of_side(basis, side); }

std::vector<std::pair<int, int>> pairs_of(const PatchBasis& basis) {
  std::vector<std::pair<int, int>> pairs;
  if (basis.kind == PatchKind::gregory_quad)
    for (int k = 0; k < 4; ++k) pairs.push_back({5 * k + 3, 5 * k + 4});
  return pairs;
}

void weights_at(const PatchBasis& basis, const Vec2& st, std::span<double> W) { patch_weights<double>(basis, st.x, st.y, W.data()); }

void weights_at(const PatchBasis& basis, const Vec2& st, std::span<Dual2> W) {
  patch_weights<Dual2>(basis, Dual2::variable_u(st.x), Dual2::variable_v(st.y), W.data());
  if (st != Vec2(0.0)) return;
  // The limit along s = t of what has none at the corner: from a point so near that its derivatives differ by next to nothing.
  constexpr double kBeside = 1e-6;
  std::vector<Dual2> beside(W.size());
  patch_weights<Dual2>(basis, Dual2::variable_u(kBeside), Dual2::variable_v(kBeside), beside.data());
  for (std::size_t m = 0; m < W.size(); ++m) {
    W[m].uu = beside[m].uu;
    W[m].uv = beside[m].uv;
    W[m].vv = beside[m].vv;
  }
}

Vec2 domain_corner(int sides, int k) {
  const double angle = kTwoPi * k / sides;
  return {std::cos(angle), std::sin(angle)};
}

Vec2 domain_point(int sides, const Vec2& st) {
  const Vec2 v0 = domain_corner(sides, 0);
  const Vec2 next = 0.5 * (v0 + domain_corner(sides, 1)), back = 0.5 * (v0 + domain_corner(sides, -1));
  return (1 - st.x) * (1 - st.y) * v0 + st.x * (1 - st.y) * next + (1 - st.x) * st.y * back;
}

}  // namespace iso
