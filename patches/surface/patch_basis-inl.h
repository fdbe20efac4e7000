// The weights of every patch kind, once, generic over their number type T: arithmetic among T and with doubles, `sqrt`, and `blend`.
// Only for the sources that need another T than double and Dual2 (patch_basis.h).
#pragma once

#include <array>
#include <cmath>

#include "patches/surface/patch_basis.h"

namespace iso {

// (a X + b Y) / (a + b), where a and b are not negative, vanish together at a corner only, and X - Y vanishes there to second order: so the
// value has a tangent plane at the corner. At the corner itself the mean. Number types that hold ranges have a `blend` of their own.
inline double blend(double a, double b, double X, double Y) {
  const double sum = a + b;
  return sum != 0 ? (a * X + b * Y) / sum : 0.5 * (X + Y);
}
inline Dual2 blend(const Dual2& a, const Dual2& b, const Dual2& X, const Dual2& Y) {
  const Dual2 sum = a + b, mean = 0.5 * (X + Y);
  if (sum.f == 0) return mean;
  return mean + 0.5 * (a - b) / sum * (X - Y);
}

// a / (a + b), where neither is negative. Where both vanish it has no limit, and 1/2 with no derivatives stands for it: only for what is
// multiplied by something that vanishes there to second order. Number types that hold ranges have a `share` of their own.
inline double share(double a, double b) {
  const double sum = a + b;
  return sum != 0 ? a / sum : 0.5;
}
inline Dual2 share(const Dual2& a, const Dual2& b) {
  const Dual2 sum = a + b;
  return sum.f != 0 ? a / sum : Dual2(0.5);
}

// A point of the domain as formulas want it, from the chart of corner 0. What vanishes at the corner has no constant term, bit for bit.
template <class T>
struct DomainPoint {
  int sides;
  std::array<T, kMostSides> distance;               // from side k, inward; [0] and [1] vanish at the corner
  std::array<std::array<T, 2>, kMostSides> corner;  // v_k - x; [0] vanishes at the corner
};

template <class T>
DomainPoint<T> domain_point_in(int sides, const T& s, const T& t) {
  const auto middle = [&](int side) { return 0.5 * (domain_corner(sides, side - 1) + domain_corner(sides, side)); };
  const Vec2 v0 = domain_corner(sides, 0), along_s = middle(1) - v0, along_t = middle(0) - v0, across = -v0 - along_s - along_t;
  const T st = s * t;
  DomainPoint<T> x{.sides = sides, .distance = {}, .corner = {}};
  std::array<T, 2> from_corner;
  for (int c = 0; c < 2; ++c) from_corner[c] = s * along_s[c] + t * along_t[c] + st * across[c];
  for (int k = 0; k < sides; ++k) {
    const Vec2 a = domain_corner(sides, k - 1), b = domain_corner(sides, k), u = (b - a) / glm::length(b - a);
    // (p - a) x u is the distance on the right; inward is the left.
    const auto inward = [&](const Vec2& d) { return u.x * d.y - u.y * d.x; };
    const double at_corner = k < 2 ? 0.0 : inward(v0 - a);
    const double rate_s = k == 1 ? 0.0 : inward(along_s), rate_t = k == 0 ? 0.0 : inward(along_t);
    x.distance[k] = s * rate_s + t * rate_t + st * inward(across);
    if (at_corner != 0) x.distance[k] = x.distance[k] + at_corner;
    const Vec2 to = b - v0;
    for (int c = 0; c < 2; ++c) x.corner[k][c] = k == 0 ? from_corner[c] * -1.0 : from_corner[c] * -1.0 + to[c];
  }
  return x;
}

// Bernstein polynomials of one degree at u, with w = 1 - u.
template <class T>
void bernstein_weights(int degree, const T& u, const T& w, T* B) {
  B[0] = T(1.0);
  for (int d = 1; d <= degree; ++d) {
    B[d] = u * B[d - 1];
    for (int i = d - 1; i > 0; --i) B[i] = w * B[i] + u * B[i - 1];
    B[0] = w * B[0];
  }
}

// Gregory quadrilateral. Twenty points, five a corner (k = 0 .. 3, point 5 k + j): the corner; the boundary point next to it on side k + 1;
// the boundary point next to it on side k; and the pair of inner points, the one of side k + 1 first. A bicubic patch whose inner points
// are blended pairs [Hettinga 2021, 2.3.4]: the one of side k + 1 counts there (t = 0), the other on side k.
template <class T>
void gregory_quad_weights(const T& s, const T& t, T* W) {
  const T u = 0.5 * s, v = 0.5 * t;  // from corner 0 along side 1, and along side 0
  const T one(1.0), u1 = one - u, v1 = one - v;
  T U[4], V[4];
  bernstein_weights(3, u, u1, U);
  bernstein_weights(3, v, v1, V);
  // Corner k: its place in the net, the place of its neighbour on side k + 1, and on side k; its distances from sides k + 1 and k.
  struct Corner {
    int i, j, along_i, along_j, back_i, back_j;
    const T *from_next, *from_own;
  };
  const Corner corners[4] = {
      {0, 0, 1, 0, 0, 1, &v, &u}, {3, 0, 3, 1, 2, 0, &u1, &v}, {3, 3, 2, 3, 3, 2, &v1, &u1}, {0, 3, 0, 2, 1, 3, &u, &v1}};
  for (int k = 0; k < 4; ++k) {
    const Corner& c = corners[k];
    const int inner_i = c.i == 0 ? 1 : 2, inner_j = c.j == 0 ? 1 : 2;
    W[5 * k] = U[c.i] * V[c.j];
    W[5 * k + 1] = U[c.along_i] * V[c.along_j];
    W[5 * k + 2] = U[c.back_i] * V[c.back_j];
    // The point of side k + 1 weighs as much as the distance from side k.
    const T inner = U[inner_i] * V[inner_j], none = inner * 0.0;
    W[5 * k + 3] = blend(*c.from_own, *c.from_next, inner, none);
    W[5 * k + 4] = blend(*c.from_own, *c.from_next, none, inner);
  }
}

// Bezier triangle of degree d: points in rows of (d + 1 - i), i = 0 .. d the power of the third barycentric coordinate, within a row by the
// power j of the second; the first, second and third coordinate belong to corners 0, 1 and 2 [Hettinga 2021, 2.3.1].
inline int triangle_index(int degree, int j, int i) { return i * (degree + 1) - i * (i - 1) / 2 + j; }
template <class T>
void bezier_triangle_weights(int degree, const DomainPoint<T>& x, T* W) {
  // The distance from a side over the height of the triangle, 3/2, is the coordinate of the corner opposite: corner k is opposite side k
  // - 1.
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

// All kinds.
template <class T>
void patch_weights(const PatchBasis& basis, const T& s, const T& t, T* W) {
  if (basis.kind == PatchKind::gregory_quad) return gregory_quad_weights(s, t, W);
  const DomainPoint<T> x = domain_point_in(basis.sides, s, t);
  if (basis.kind == PatchKind::bezier_triangle) return bezier_triangle_weights(basis.degree, x, W);
}

}  // namespace iso
