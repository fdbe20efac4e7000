// The regular polygon as the formulas of the patch kinds want it, and the two primitives that a corner needs: `blend` and `share`.
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

}  // namespace iso
