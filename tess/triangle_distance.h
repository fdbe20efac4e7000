// The point of a triangle that is nearest to a given one.
#pragma once

#include <array>

#include "patches/base/vec.h"

namespace iso {

// Of a triangle that is nearly or quite a line or a point: the sides, each for itself; and the inside by a height over the longest side, so
// that rounding moves the point across the triangle, not along it.
inline Vec3 nearest_in_needle(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const std::array<Point3, 3> t{a, b, c};
  Vec3 best{1, 0, 0};
  double least = kInf, longest = -1;
  int at = 0;
  const auto consider = [&](const Vec3& l) {
    const Vec3 d = l.x * a + l.y * b + l.z * c - p;
    if (const double squared = glm::dot(d, d); squared < least) least = squared, best = l;
  };
  for (int k = 0; k < 3; ++k) {
    const Point3& from = t[static_cast<std::size_t>(k)];
    const Vec3 side = t[static_cast<std::size_t>((k + 1) % 3)] - from;
    const double length2 = glm::dot(side, side);
    if (length2 > longest) longest = length2, at = k;
    Vec3 l(0.0);
    l[(k + 1) % 3] = length2 > 0 ? std::clamp(glm::dot(p - from, side) / length2, 0.0, 1.0) : 0.0;
    l[k] = 1 - l[(k + 1) % 3];
    consider(l);
  }
  const Point3& from = t[static_cast<std::size_t>(at)];
  const Vec3 e = t[static_cast<std::size_t>((at + 1) % 3)] - from, f = t[static_cast<std::size_t>((at + 2) % 3)] - from, d = p - from;
  const Vec3 across = glm::cross(glm::cross(e, f), e);
  const double height = glm::dot(across, f);
  if (!(height > 0)) return best;
  Vec3 l(0.0);
  l[(at + 2) % 3] = std::clamp(glm::dot(across, d) / height, 0.0, 1.0);
  l[(at + 1) % 3] = std::clamp((glm::dot(d, e) - l[(at + 2) % 3] * glm::dot(f, e)) / longest, 0.0, 1 - l[(at + 2) % 3]);
  l[at] = 1 - l[(at + 1) % 3] - l[(at + 2) % 3];
  consider(l);
  return best;
}

// As barycentric coordinates; those of a side or a corner have zeros. Triangles may have no area.  [Ericson 2005, 5.1.5]
inline Vec3 nearest_in_triangle(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  // Below this squared sine of an angle the weights would have lost half of their digits.
  constexpr double kNeedle = 1e-6;
  if (!(va + vb + vc > kNeedle * glm::dot(ab, ab) * glm::dot(ac, ac))) return nearest_in_needle(p, a, b, c);
  const double inverse = 1 / (va + vb + vc);
  return {1 - (vb + vc) * inverse, vb * inverse, vc * inverse};
}

}  // namespace iso
