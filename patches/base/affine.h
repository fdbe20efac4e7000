// Affine maps of space in double: the placement of a part.
#pragma once

#include <glm/matrix.hpp>

#include "patches/base/vec.h"

namespace iso {

// p -> linear * p + translation.
struct Affine3 {
  Mat3 linear{1.0};
  Vec3 translation{0.0};

  Vec3 point(const Vec3& p) const { return linear * p + translation; }
  Vec3 vector(const Vec3& v) const { return linear * v; }
  bool is_identity() const { return linear == Mat3(1.0) && translation == Vec3(0.0); }
};

// (a * b)(p) = a(b(p)).
inline Affine3 operator*(const Affine3& a, const Affine3& b) { return {a.linear * b.linear, a.linear * b.translation + a.translation}; }

// Undefined (non-finite) for a singular map; callers reject those with `glm::determinant` first.
inline Affine3 inverse(const Affine3& a) {
  const Mat3 inv = glm::inverse(a.linear);
  return {inv, -(inv * a.translation)};
}

// The box of the image of a box.
inline Box3 transformed(const Affine3& a, const Box3& box) {
  if (box.empty()) return {};
  const Vec3 centre = a.point(box.middle());
  const Vec3 half = 0.5 * box.size();
  Vec3 reach{0.0};
  for (int c = 0; c < 3; ++c) reach += glm::abs(a.linear[c]) * half[c];
  return {centre - reach, centre + reach};
}

// Normals go by the inverse transpose: an outward normal stays outward, also under mirroring.
inline Vec3 transform_normal(const Affine3& a_inverse, const Vec3& n) { return glm::normalize(glm::transpose(a_inverse.linear) * n); }

// How far a map lengthens at most: its largest singular value, 1 for rotations in spite of their rounding.
inline double stretch_of(const Affine3& map) {
  constexpr double kRotationRounding = 1e-12;  // rotations in files are orthogonal to about this
  // The largest eigenvalue of a symmetric matrix in closed form [Smith 1961, Eigenvalues of a symmetric 3 x 3 matrix].
  const Mat3 a = glm::transpose(map.linear) * map.linear;
  const double q = (a[0][0] + a[1][1] + a[2][2]) / 3;
  const Mat3 b = a - Mat3(q);
  const double p = std::sqrt((glm::dot(b[0], b[0]) + glm::dot(b[1], b[1]) + glm::dot(b[2], b[2])) / 6);
  const double r = p > 0 ? std::clamp(glm::determinant(b) / (2 * p * p * p), -1.0, 1.0) : 1.0;
  const double stretch = std::sqrt(std::max(0.0, q + 2 * p * std::cos(std::acos(r) / 3)));
  return std::abs(stretch - 1) <= kRotationRounding ? 1.0 : stretch;
}

}  // namespace iso
