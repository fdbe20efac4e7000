// What first derivatives do across the knots between Bezier pieces.
#include <array>

#include "patches/base/bernstein.h"
#include "patches/bend_cell.h"

namespace iso {

namespace {

// Derivatives agree if they do but for rounding: as a share of the coordinates, over the spans' widths.
constexpr double kJump = 1e-12;
// Unit normals that differ by less are one: it moves a triangle by less than a millionth of its size.
constexpr double kSameNormal = 1e-6;

// The pieces on both sides of a part of a knot, seen in the direction that crosses it.
struct Border {
  const BezierPiece& low;
  const BezierPiece& high;
  int direction;

  int along() const { return direction == 0 ? low.patch.pv : low.patch.pu; }
  int across() const { return direction == 0 ? low.patch.pu : low.patch.pv; }
  double width(const BezierPiece& p) const { return direction == 0 ? p.u.b - p.u.a : p.v.b - p.v.a; }
  const Vec4& at(const BezierPiece& p, int i, int j) const { return direction == 0 ? p.patch.at(i, j) : p.patch.at(j, i); }
};

// The supremum of the jump |S+ - S-| = |(D w - Dw P) / w^2|, where D is the jump of the homogeneous derivative, by coefficients.
double jump_across(const Border& b) {
  const int p = b.across(), q = b.along();
  std::array<std::vector<double>, 4> H, D;
  bool weights_jump = false;
  for (int j = 0; j <= q; ++j) {
    const Vec4 border = b.at(b.high, 0, j);
    const Vec4 jump = static_cast<double>(p) *
                      ((b.at(b.high, 1, j) - border) / b.width(b.high) - (b.at(b.low, p, j) - b.at(b.low, p - 1, j)) / b.width(b.low));
    weights_jump = weights_jump || jump.w != 0;
    for (int c = 0; c < 4; ++c) {
      H[static_cast<std::size_t>(c)].push_back(border[c]);
      D[static_cast<std::size_t>(c)].push_back(jump[c]);
    }
  }
  double most = 0;
  if (!weights_jump) {
    for (std::size_t j = 0; j < D[0].size(); ++j) most = std::max(most, glm::length(Vec3(D[0][j], D[1][j], D[2][j])) / H[3][j]);
    return most;
  }
  const std::vector<double> square = bernstein_product(H[3], H[3]);
  std::vector<Vec3> sum(square.size(), Vec3(0.0));
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const std::vector<double> Dw = bernstein_product(D[k], H[3]), wD = bernstein_product(D[3], H[k]);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i][c] = Dw[i] - wD[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) most = std::max(most, glm::length(sum[i]) / square[i]);
  return most;
}

// Whether the tangent planes are one along the border. The determinant that decides has the degree 3q, so as many samples and one more
// cannot all be zero by chance.
bool same_planes(const Border& b) {
  const int samples = 3 * b.along() + 1;
  const bool first = b.direction == 0;
  for (int k = 0; k <= samples; ++k) {
    const double t = static_cast<double>(k) / samples;
    const HomogeneousJet l = homogeneous_jet(b.low.patch, first ? Vec2(1, t) : Vec2(t, 1));
    const HomogeneousJet h = homogeneous_jet(b.high.patch, first ? Vec2(0, t) : Vec2(t, 0));
    const auto tangent = [](const HomogeneousJet& j, const Vec4& d) { return Vec3(d) - d.w * project(j.H); };
    const Vec3 along = tangent(l, first ? l.Ht : l.Hs);
    const Vec3 n = glm::cross(tangent(l, first ? l.Hs : l.Ht), along), m = glm::cross(tangent(h, first ? h.Hs : h.Ht), along);
    const double size = glm::length(n) * glm::length(m);
    if (glm::length(glm::cross(n, m)) > kSameNormal * size || glm::dot(n, m) < 0) return false;
  }
  return true;
}

}  // namespace

std::vector<KnotJump> knot_jumps(const std::vector<BezierPiece>& pieces, int count_u, int count_v, int direction, double size) {
  const int knots = direction == 0 ? count_u : count_v, parts = direction == 0 ? count_v : count_u;
  const auto piece = [&](int k, int l) -> const BezierPiece& {
    return pieces[static_cast<std::size_t>(direction == 0 ? k * count_v + l : l * count_v + k)];
  };
  std::vector<KnotJump> jumps;
  for (int k = 1; k < knots; ++k) {
    KnotJump jump{direction == 0 ? piece(k, 0).u.a : piece(k, 0).v.a, 0, false};
    double rounding = 0;
    for (int l = 0; l < parts; ++l) {
      const Border b{piece(k - 1, l), piece(k, l), direction};
      jump.size = std::max(jump.size, jump_across(b));
      rounding = kJump * size * b.across() * (1 / b.width(b.low) + 1 / b.width(b.high));
    }
    if (jump.size <= rounding) continue;
    for (int l = 0; l < parts && !jump.crease; ++l) jump.crease = !same_planes({piece(k - 1, l), piece(k, l), direction});
    jumps.push_back(jump);
  }
  return jumps;
}

std::vector<KnotJump> knot_jumps(const std::vector<BezierSpan<Vec3>>& spans, double size) {
  std::vector<KnotJump> jumps;
  for (std::size_t k = 1; k < spans.size(); ++k) {
    const auto &low = spans[k - 1], &high = spans[k];
    const double width_low = low.map.b - low.map.a, width_high = high.map.b - high.map.a;
    const auto p = static_cast<double>(low.points.size() - 1);
    const Vec4 &end = low.points.back(), &start = high.points.front(), &before = *(low.points.end() - 2), &after = high.points[1];
    const Vec3 rise = p * before.w / end.w * (project(end) - project(before)) / width_low;
    const Vec3 next = p * after.w / start.w * (project(after) - project(start)) / width_high;
    const double jump = glm::length(next - rise), product = glm::length(next) * glm::length(rise);
    if (jump <= kJump * size * p * (1 / width_low + 1 / width_high)) continue;
    const bool crease = glm::length(glm::cross(rise, next)) > kSameNormal * product || !(glm::dot(rise, next) > 0);
    jumps.push_back({high.map.a, jump, crease});
  }
  return jumps;
}

}  // namespace iso
