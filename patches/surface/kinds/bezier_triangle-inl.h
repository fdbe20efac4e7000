// Bezier triangles.
#pragma once

#include "patches/surface/kinds/domain-inl.h"

namespace iso {

// Bezier triangle of degree d: points in rows of (d + 1 - i), i = 0 .. d the power of the third barycentric coordinate, within a row by the
// power j of the second; the first, second and third coordinate belong to corners 0, 1 and 2 [Hettinga 2021, 2.3.1].
inline int triangle_index(int degree, int j, int i) { return i * (degree + 1) - i * (i - 1) / 2 + j; }
template <class T>
void bezier_triangle_weights(int degree, const DomainPoint<T>& x, T* W) {
  // The distance from a side over the height of the triangle, 3/2, is the coordinate of the corner opposite: corner 0 is opposite side 2.
  const T a = x.distance[2] * (2.0 / 3), b = x.distance[0] * (2.0 / 3), c = x.distance[1] * (2.0 / 3);
  std::array<T, 3 * 16> powers;  // of a, b, c
  for (int k = 0; k < 3; ++k) {
    const T& base = k == 0 ? a : k == 1 ? b : c;
    powers[16 * k] = T(1.0);
    for (int p = 1; p <= degree; ++p) powers[16 * k + p] = powers[16 * k + p - 1] * base;
  }
  double row = 1;  // degree! / (i! (degree - i)!)
  for (int i = 0; i <= degree; ++i) {
    double factor = row;
    for (int j = 0; i + j <= degree; ++j) {
      W[triangle_index(degree, j, i)] = powers[degree - i - j] * powers[16 + j] * powers[32 + i] * factor;
      factor = factor * (degree - i - j) / (j + 1);
    }
    row = row * (degree - i) / (i + 1);
  }
}

}  // namespace iso
