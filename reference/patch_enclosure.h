// A function over a box of (s, t) with its first derivatives, each as a Taylor model: the number type with which a formula of weights
// (patch_basis-inl.h) bounds a patch and its tangents over the box.
#pragma once

#include "patches/base/taylor.h"

namespace iso::reference {

using Model = PowerSeries<2, true>;

struct Enclosure {
  Model f, s, t;  // over the box as |a|, |b| <= 1; s and t are derivatives in (s, t), not in (a, b)

  Enclosure() = default;
  Enclosure(double constant) : f(constant) {}
  Enclosure(const Model& value, const Model& by_s, const Model& by_t) : f(value), s(by_s), t(by_t) {}

  friend Enclosure operator+(const Enclosure& x, const Enclosure& y) { return {x.f + y.f, x.s + y.s, x.t + y.t}; }
  friend Enclosure operator-(const Enclosure& x, const Enclosure& y) { return {x.f - y.f, x.s - y.s, x.t - y.t}; }
  friend Enclosure operator*(const Enclosure& x, const Enclosure& y) { return {x.f * y.f, x.s * y.f + x.f * y.s, x.t * y.f + x.f * y.t}; }
  friend Enclosure operator/(const Enclosure& x, const Enclosure& y) {
    const Model one_over = inverse(y.f), quotient = x.f * one_over;
    return {quotient, (x.s - quotient * y.s) * one_over, (x.t - quotient * y.t) * one_over};
  }
  friend Enclosure operator*(const Enclosure& x, double by) { return {x.f * by, x.s * by, x.t * by}; }
  friend Enclosure operator*(double by, const Enclosure& x) { return x * by; }
  friend Enclosure operator+(const Enclosure& x, double by) { return {x.f + by, x.s, x.t}; }
  friend Enclosure operator-(const Enclosure& x, double by) { return x + -by; }
  friend Enclosure operator-(double by, const Enclosure& x) { return x * -1.0 + by; }
};

// Something of which nothing is known.
inline Model unknown() {
  Model any;
  any.radius = kInf;
  return any;
}

inline Enclosure sqrt(const Enclosure& x) {
  const Model root = sqrt(x.f);
  if (!x.f.bounded_away()) return {root, unknown(), unknown()};
  const Model half = 0.5 * inverse(root);
  return {root, x.s * half, x.t * half};
}
// Near the corner the values have a range; their derivatives, which depend on the direction, are given up.
inline Enclosure blend(const Enclosure& a, const Enclosure& b, const Enclosure& X, const Enclosure& Y) {
  const Enclosure sum = a + b, mean = 0.5 * (X + Y);
  if (sum.f.bounded_away()) return mean + 0.5 * (a - b) / sum * (X - Y);
  return {blend(a.f, b.f, X.f, Y.f), unknown(), unknown()};
}
inline Enclosure share(const Enclosure& a, const Enclosure& b) {
  const Enclosure sum = a + b;
  if (sum.f.bounded_away()) return a / sum;
  return {share(a.f, b.f), unknown(), unknown()};
}

}  // namespace iso::reference
