#include "patches/surface/patch_basis.h"

#include <algorithm>
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
std::string degree_must_be(const PatchBasis& basis, int lowest, int highest) {
  if (lowest <= basis.degree && basis.degree <= highest) return {};
  const std::string range = lowest == highest ? std::to_string(lowest) : std::to_string(lowest) + " to " + std::to_string(highest);
  return "degree " + std::to_string(basis.degree) + ", expected " + range;
}
// For polynomials there is nothing to choose; ribbons have a parameter along the side, which lengths do not give.
std::string no_choice(const PatchBasis& basis) {
  return basis.parameters == SideParameters::wachspress ? std::string{} : "a choice of side parameters, expected none";
}
std::string coordinates_only(const PatchBasis& basis) {
  return basis.parameters != SideParameters::distance ? std::string{} : "side parameters by distance, expected barycentric coordinates";
}
std::string first_of(std::string a, std::string b) { return a.empty() ? std::move(b) : std::move(a); }

// ---- Five points a corner: Gregory, generalised Gregory, Charrot-Gregory ---------------------------------------------------

std::string gregory_triangle_problem(const PatchBasis& basis) {
  return first_of(sides_must_be(basis, 3), first_of(degree_must_be(basis, 3, 3), no_choice(basis)));
}
std::string quad_problem(const PatchBasis& basis) {
  return first_of(sides_must_be(basis, 4), first_of(degree_must_be(basis, 3, 3), no_choice(basis)));
}
std::string generalised_gregory_problem(const PatchBasis& basis) { return first_of(degree_must_be(basis, 3, 3), coordinates_only(basis)); }
std::string charrot_gregory_problem(const PatchBasis& basis) { return degree_must_be(basis, 3, 3); }

int five_a_corner(const PatchBasis& basis) { return 5 * basis.sides; }
int five_and_centre(const PatchBasis& basis) { return 5 * basis.sides + 1; }
std::vector<int> fives_turned(const PatchBasis& basis) {
  std::vector<int> to;
  const int count = 5 * basis.sides;
  for (int m = 0; m < count; ++m) to.push_back((m + 5) % count);
  if (basis.kind == PatchKind::generalised_gregory) to.push_back(count);
  return to;
}
std::vector<int> fives_side(const PatchBasis& basis, int side) {
  const int from = 5 * ((side + basis.sides - 1) % basis.sides), to = 5 * (side % basis.sides);
  return {from, from + 1, to + 2, to};
}

// ---- Generalised Bezier --------------------------------------------------------------------------------------------------

std::string generalised_bezier_problem(const PatchBasis& basis) {
  return first_of(degree_must_be(basis, 3, kMostRibbonDegree), coordinates_only(basis));
}
int generalised_bezier_count(const PatchBasis& basis) {
  const int rows = ribbon_rows(basis.degree);
  return 1 + basis.sides * rows * (basis.degree + 1 - rows);
}
std::vector<int> generalised_bezier_turned(const PatchBasis& basis) {
  std::vector<int> to{0};
  const int n = basis.sides, d = basis.degree;
  for (int r = 0; r < ribbon_rows(d); ++r)
    for (int side = 1; side <= n; ++side)
      for (int j = r; j < d - r; ++j) to.push_back(ribbon_index(n, d, side + 1, j, r));
  return to;
}
std::vector<int> generalised_bezier_side(const PatchBasis& basis, int side) {
  std::vector<int> points;
  const int n = basis.sides, d = basis.degree;
  for (int j = 0; j < d; ++j) points.push_back(ribbon_index(n, d, side, j, 0));
  points.push_back(ribbon_index(n, d, side + 1, 0, 0));
  return points;
}

// ---- Bezier triangles ----------------------------------------------------------------------------------------------------

std::string triangle_problem(const PatchBasis& basis) {
  return first_of(sides_must_be(basis, 3), first_of(degree_must_be(basis, 1, kMostTriangleDegree), no_choice(basis)));
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
    {"Gregory triangle", gregory_triangle_problem, five_a_corner, fives_turned, fives_side},
    {"Gregory quad", quad_problem, five_a_corner, fives_turned, fives_side},
    {"generalised Bezier", generalised_bezier_problem, generalised_bezier_count, generalised_bezier_turned, generalised_bezier_side},
    {"generalised Gregory", generalised_gregory_problem, five_and_centre, fives_turned, fives_side},
    {"Charrot-Gregory", charrot_gregory_problem, five_a_corner, fives_turned, fives_side},
};
const KindEntry& entry(const PatchBasis& basis) { return kKinds[static_cast<std::size_t>(basis.kind)]; }

// At the corner of the chart: all of its control point, the last of side 0.
void corner_weights(const PatchBasis& basis, std::span<double> W) {
  std::fill(W.begin(), W.end(), 0.0);
  W[points_of_side(basis, 0).back()] = 1;
}

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
  if (basis.kind == PatchKind::bezier_triangle || basis.kind == PatchKind::generalised_bezier) return pairs;
  for (int k = 0; k < basis.sides; ++k) pairs.push_back({5 * k + 3, 5 * k + 4});
  return pairs;
}

void weights_at(const PatchBasis& basis, const Vec2& st, std::span<double> W) {
  if (is_corner_by_mean_value(basis, st)) return corner_weights(basis, W);
  patch_weights<double>(basis, st.x, st.y, W.data());
}

void weights_at(const PatchBasis& basis, const Vec2& st, std::span<Dual2> W) {
  const bool by_mean_value = is_corner_by_mean_value(basis, st);
  if (st != Vec2(0.0) && !by_mean_value) return patch_weights<Dual2>(basis, Dual2::variable_u(st.x), Dual2::variable_v(st.y), W.data());
  if (by_mean_value) {
    std::fill(W.begin(), W.end(), Dual2(0.0));
    const std::vector<int> next = points_of_side(basis, 1), back = points_of_side(basis, 0);
    const double leg = 0.5 * basis.degree;  // of Bernstein polynomials of s / 2, and of t / 2
    W[next[0]] = Dual2(1, -leg, -leg, 0, 0, 0);
    W[next[1]].u = W[back[back.size() - 2]].v = leg;
    return;
  }
  // What has no limit at the corner: along s = t, extrapolated from two places so near that what is left out is next to nothing, and far
  // enough for the differences that blends are made of.
  constexpr double kBeside = 1e-4;
  std::vector<Dual2> near(W.size()), far(W.size());
  patch_weights<Dual2>(basis, Dual2::variable_u(kBeside), Dual2::variable_v(kBeside), near.data());
  patch_weights<Dual2>(basis, Dual2::variable_u(2 * kBeside), Dual2::variable_v(2 * kBeside), far.data());
  const auto limit = [&](std::size_t m, double Dual2::*part) { return 2 * near[m].*part - far[m].*part; };
  patch_weights<Dual2>(basis, Dual2::variable_u(0), Dual2::variable_v(0), W.data());
  for (std::size_t m = 0; m < W.size(); ++m)
    for (double Dual2::*part : {&Dual2::uu, &Dual2::uv, &Dual2::vv}) W[m].*part = limit(m, part);
}

Vec2 domain_corner(int sides, int k) {
  const double angle = kTwoPi * k / sides;
  return {std::cos(angle), std::sin(angle)};
}

namespace {

DomainRates make_rates(int sides) {
  const auto middle = [&](int side) { return 0.5 * (domain_corner(sides, side - 1) + domain_corner(sides, side)); };
  const Vec2 v0 = domain_corner(sides, 0);
  DomainRates rates;
  rates.along_s = middle(1) - v0;
  rates.along_t = middle(0) - v0;
  rates.across = -v0 - rates.along_s - rates.along_t;
  for (int k = 0; k < sides; ++k) {
    const Vec2 a = domain_corner(sides, k - 1), b = domain_corner(sides, k), u = (b - a) / glm::length(b - a);
    const auto inward = [&](const Vec2& d) { return u.x * d.y - u.y * d.x; };
    rates.side[k] = {k < 2 ? 0.0 : inward(v0 - a), k == 1 ? 0.0 : inward(rates.along_s), k == 0 ? 0.0 : inward(rates.along_t),
                     inward(rates.across)};
    rates.corner[k] = b - v0;
  }
  return rates;
}

}  // namespace

const DomainRates& domain_rates(int sides) {
  static const std::array<DomainRates, kMostSides + 1> kRates = [] {
    std::array<DomainRates, kMostSides + 1> all;
    for (int n = 3; n <= kMostSides; ++n) all[n] = make_rates(n);
    return all;
  }();
  return kRates[sides];
}

Vec2 domain_point(int sides, const Vec2& st) {
  const Vec2 v0 = domain_corner(sides, 0);
  const Vec2 next = 0.5 * (v0 + domain_corner(sides, 1)), back = 0.5 * (v0 + domain_corner(sides, -1));
  return (1 - st.x) * (1 - st.y) * v0 + st.x * (1 - st.y) * next + (1 - st.x) * st.y * back;
}

}  // namespace iso
