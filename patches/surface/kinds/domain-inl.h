// The regular polygon as the formulas of the patch kinds want it, and the two primitives that a corner needs: `blend` and `share`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "patches/surface/patch_basis.h"

namespace iso {

// a + b, where both vanish together at a corner only. Inside the patch neither is negative; beyond its borders, where one of them is, the
// sum stops at half of their difference: so the formulas continue through a border smoothly, and no line on which a + b vanishes leaves
// the corner. Behind it, mean value coordinates do not go on.
inline double corner_sum(double a, double b) { return std::max(a + b, 0.5 * (std::abs(a) + std::abs(b))); }
inline Dual2 corner_sum(const Dual2& a, const Dual2& b) {
  if (a.f + b.f >= 0.5 * (std::abs(a.f) + std::abs(b.f))) return a + b;
  return 0.5 * ((a.f < 0 ? -a : a) + (b.f < 0 ? -b : b));
}

// (a X + b Y) / (a + b), where a and b vanish together at a corner only, and X - Y vanishes there to second order: so the value has a
// tangent plane at the corner. At the corner itself the mean. Number types that hold ranges have a `blend` of their own.
inline double blend(double a, double b, double X, double Y) {
  const double sum = corner_sum(a, b), mean = 0.5 * (X + Y);
  if (sum != a + b) return mean + 0.5 * (a - b) / sum * (X - Y);
  return sum != 0 ? (a * X + b * Y) / sum : mean;
}
inline Dual2 blend(const Dual2& a, const Dual2& b, const Dual2& X, const Dual2& Y) {
  const Dual2 sum = corner_sum(a, b), mean = 0.5 * (X + Y);
  return sum.f != 0 ? mean + 0.5 * (a - b) / sum * (X - Y) : mean;
}

// a / (a + b), likewise. Where both vanish it has no limit, and 1/2 with no derivatives stands for it: only for what is multiplied by
// something that vanishes there to second order. Number types that hold ranges have a `share` of their own.
inline double share(double a, double b) {
  const double sum = corner_sum(a, b);
  if (sum != a + b) return 0.5 + 0.5 * (a - b) / sum;
  return sum != 0 ? a / sum : 0.5;
}
inline Dual2 share(const Dual2& a, const Dual2& b) {
  const Dual2 sum = corner_sum(a, b);
  if (sum.f != a.f + b.f) return 0.5 + 0.5 * (a - b) / sum;
  return sum.f != 0 ? a / sum : Dual2(0.5);
}

// Both shares, a / (a + b) and b / (a + b). Number types for which it pays have a `shares` of their own that divides once.
template <class T>
void shares(const T& a, const T& b, T& of_a, T& of_b) {
  of_a = share(a, b);
  of_b = share(b, a);
}

// One or the other, of two that are the same number: where the first is better told. Number types that hold ranges take the second, which
// is told everywhere inside.
template <class T>
const T& where_positive(const T&, const T&, const T& otherwise) {
  return otherwise;
}
inline double where_positive(double of, double then, double otherwise) { return of > 0 ? then : otherwise; }
inline const Dual2& where_positive(const Dual2& of, const Dual2& then, const Dual2& otherwise) { return of.f > 0 ? then : otherwise; }
template <class R>
Dual1<R> where_positive(const Dual1<R>& of, const Dual1<R>& then, const Dual1<R>& otherwise) {
  return {where_positive(of.f, then.f, otherwise.f), where_positive(of.f, then.u, otherwise.u), where_positive(of.f, then.v, otherwise.v)};
}

// Of first derivatives: `inverse_or_zero` takes zero to zero, so that nothing is left of what has no limit.
inline double inverse_or_zero(double x) { return x != 0 ? 1 / x : 0.0; }
template <class R>
Dual1<R> blend(const Dual1<R>& a, const Dual1<R>& b, const Dual1<R>& X, const Dual1<R>& Y) {
  const Dual1<R> sum = a + b;
  return 0.5 * (X + Y) + (0.5 * (a - b)).over(sum, inverse_or_zero(sum.f)) * (X - Y);
}
template <class R>
Dual1<R> share(const Dual1<R>& a, const Dual1<R>& b) {
  const Dual1<R> sum = a + b;
  return (0.5 * (a - b)).over(sum, inverse_or_zero(sum.f)) + 0.5;
}
// In doubles beyond the borders, too. Packs of lanes leave what does not converge there to these.
inline Dual1<double> corner_sum(const Dual1<double>& a, const Dual1<double>& b) {
  if (a.f + b.f >= 0.5 * (std::abs(a.f) + std::abs(b.f))) return a + b;
  return a * (a.f < 0 ? -0.5 : 0.5) + b * (b.f < 0 ? -0.5 : 0.5);
}
inline Dual1<double> blend(const Dual1<double>& a, const Dual1<double>& b, const Dual1<double>& X, const Dual1<double>& Y) {
  const Dual1<double> sum = corner_sum(a, b);
  return 0.5 * (X + Y) + (0.5 * (a - b)).over(sum, inverse_or_zero(sum.f)) * (X - Y);
}
inline Dual1<double> share(const Dual1<double>& a, const Dual1<double>& b) {
  const Dual1<double> sum = corner_sum(a, b);
  if (sum.f == a.f + b.f && sum.f != 0) return a.over(sum, 1 / sum.f);
  return (0.5 * (a - b)).over(sum, inverse_or_zero(sum.f)) + 0.5;
}
template <class R>
Dual1<R> sqrt(const Dual1<R>& a) {
  using std::sqrt;
  const R root = sqrt(a.f), half = R(0.5) / root;
  return {root, half * a.u, half * a.v};
}

// A point of the domain as formulas want it, from the chart of corner 0. What vanishes at the corner has no constant term, bit for bit.
template <class T>
struct DomainPoint {
  int sides;
  std::array<T, kMostSides> distance;  // from side k, inward; [0] and [1] vanish at the corner
  std::array<T, 2> from_corner;        // x - v_0

  // Coordinate c of v_k - x.
  T to_corner(int k, int c) const { return k == 0 ? from_corner[c] * -1.0 : from_corner[c] * -1.0 + domain_rates(sides).corner[k][c]; }
};

template <class T>
DomainPoint<T> domain_point_in(int sides, const T& s, const T& t) {
  const DomainRates& rates = domain_rates(sides);
  const T st = s * t;
  DomainPoint<T> x;
  x.sides = sides;
  for (int c = 0; c < 2; ++c) x.from_corner[c] = s * rates.along_s[c] + t * rates.along_t[c] + st * rates.across[c];
  for (int k = 0; k < sides; ++k) {
    const DomainRates::Side& side = rates.side[k];
    x.distance[k] = s * side.by_s + t * side.by_t + st * side.by_st;
    if (k > 1) x.distance[k] = x.distance[k] + side.at_corner;
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
