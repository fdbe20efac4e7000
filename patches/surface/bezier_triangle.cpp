#include "patches/surface/bezier_triangle.h"

#include <cmath>

#include "patches/base/check.h"
#include "patches/surface/kinds/bezier_triangle-inl.h"

namespace iso {

namespace {

// Homogeneous control points.
std::vector<Vec4> homogeneous(const NSidedPatch& patch) {
  ISO_CHECK(patch.basis.kind == PatchKind::bezier_triangle);
  std::vector<Vec4> net;
  for (std::size_t m = 0; m < patch.points.size(); ++m) {
    const double w = patch.weights.empty() ? 1 : patch.weights[m];
    net.emplace_back(w * patch.points[m], w);
  }
  return net;
}
NSidedPatch from_homogeneous(int degree, const std::vector<Vec4>& net, bool rational) {
  NSidedPatch patch{.basis = {.kind = PatchKind::bezier_triangle, .sides = 3, .degree = degree}, .points = {}, .weights = {}};
  for (const Vec4& p : net) {
    patch.points.push_back(rational ? Vec3(p) / p.w : Vec3(p));
    if (rational) patch.weights.push_back(p.w);
  }
  return patch;
}

// Of a net of degree d, at the powers (d - i - j, j, i).
const Vec4& at_powers(const std::vector<Vec4>& net, int degree, int j, int i) { return net[triangle_index(degree, j, i)]; }

}  // namespace

NSidedPatch raised_triangle(const NSidedPatch& triangle) {
  const std::vector<Vec4> net = homogeneous(triangle);
  const int d = triangle.basis.degree, up = d + 1;
  std::vector<Vec4> raised;
  for (int i = 0; i <= up; ++i) {
    for (int j = 0; i + j <= up; ++j) {
      const int k = up - i - j;
      Vec4 sum(0.0);
      if (k > 0) sum += double(k) * at_powers(net, d, j, i);
      if (j > 0) sum += double(j) * at_powers(net, d, j - 1, i);
      if (i > 0) sum += double(i) * at_powers(net, d, j, i - 1);
      raised.push_back(sum / double(up));
    }
  }
  return from_homogeneous(up, raised, !triangle.weights.empty());
}

std::vector<NSidedPatch> cut_triangle(const NSidedPatch& triangle, const Vec3& at) {
  const int d = triangle.basis.degree;
  // levels[r]: the net of degree d - r after r steps of de Casteljau.
  std::vector<std::vector<Vec4>> levels{homogeneous(triangle)};
  for (int r = 1; r <= d; ++r) {
    std::vector<Vec4> next;
    const std::vector<Vec4>& last = levels.back();
    const int of_last = d - r + 1;
    for (int i = 0; i <= d - r; ++i)
      for (int j = 0; i + j <= d - r; ++j)
        next.push_back(at[0] * at_powers(last, of_last, j, i) + at[1] * at_powers(last, of_last, j + 1, i) +
                       at[2] * at_powers(last, of_last, j, i + 1));
    levels.push_back(std::move(next));
  }
  std::vector<NSidedPatch> parts;
  for (int k = 0; k < 3; ++k) {
    if (at[k] == 0) continue;
    // Of powers with r at corner k: from level r, where that corner has none.
    std::vector<Vec4> net;
    for (int i = 0; i <= d; ++i) {
      for (int j = 0; i + j <= d; ++j) {
        const int r = k == 0 ? d - i - j : k == 1 ? j : i;
        net.push_back(at_powers(levels[r], d - r, k == 1 ? 0 : j, k == 2 ? 0 : i));
      }
    }
    parts.push_back(from_homogeneous(d, net, !triangle.weights.empty()));
  }
  return parts;
}

NSidedPatch sphere_octant() {
  const double root2 = std::sqrt(2.0), root3 = std::sqrt(3.0);
  const double a = (root3 - 1) / root3, b = (root3 + 1) / (2 * root3), c = 1 - (5 - root2) * (7 - root3) / 46;
  const double corner = 4 * root3 * (root3 - 1), beside = 3 * root2, middle = 4, inner = root2 / root3 * (3 + 2 * root2 - root3);
  NSidedPatch octant{.basis = {.kind = PatchKind::bezier_triangle, .sides = 3, .degree = 4}, .points = {}, .weights = {}};
  for (int i = 0; i <= 4; ++i) {
    for (int j = 0; i + j <= 4; ++j) {
      const int power[3] = {4 - i - j, j, i};
      Vec3 point(0.0);
      int highest = 0;
      bool all = true;
      for (int k = 0; k < 3; ++k) {
        highest = std::max(highest, power[k]);
        all = all && power[k] > 0;
      }
      for (int k = 0; k < 3; ++k) {
        const double two = all ? 1 : b;  // (2, 1, 1) or (2, 2, 0)
        point[k] = power[k] >= 3 ? 1 : power[k] == 2 ? two : power[k] == 0 ? 0 : all ? c : a;
      }
      octant.points.push_back(point);
      octant.weights.push_back(all ? inner : highest == 4 ? corner : highest == 3 ? beside : middle);
    }
  }
  return octant;
}

NSidedPatch gregory_of_bezier(std::span<const Vec3, 16> net) {
  NSidedPatch patch{.basis = {.kind = PatchKind::gregory_quad, .sides = 4, .degree = 3}, .points = {}, .weights = {}};
  constexpr int kCorner[4][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  for (int k = 0; k < 4; ++k) {
    const int *here = kCorner[k], *next = kCorner[(k + 1) % 4], *before = kCorner[(k + 3) % 4];
    // A third of the way along side k + 1, along side k, and both.
    const int next_i = (next[0] - here[0]) / 3, next_j = (next[1] - here[1]) / 3;
    const int back_i = (before[0] - here[0]) / 3, back_j = (before[1] - here[1]) / 3;
    const auto at = [&](int i, int j) { return net[4 * j + i]; };
    patch.points.push_back(at(here[0], here[1]));
    patch.points.push_back(at(here[0] + next_i, here[1] + next_j));
    patch.points.push_back(at(here[0] + back_i, here[1] + back_j));
    for (int twice = 0; twice < 2; ++twice) patch.points.push_back(at(here[0] + next_i + back_i, here[1] + next_j + back_j));
  }
  return patch;
}

}  // namespace iso
