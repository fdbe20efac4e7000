// Interval arithmetic for bounds of closed-form surfaces. Results are widened by a few units in the last place instead of
// switching the rounding mode: the bounds stay guaranteed and cost nothing to speak of.
#pragma once

#include <cmath>

#include "patches/base/vec.h"

namespace iso {

struct Interval {
  double lo = 0, hi = 0;

  Interval() = default;
  Interval(double constant) : lo(constant), hi(constant) {}
  Interval(double l, double h) : lo(l), hi(h) {}
};

inline Interval widened(double lo, double hi) {
  const double by = 2 * kEps * std::max(std::abs(lo), std::abs(hi));
  return {lo - by, hi + by};
}
inline Interval operator+(const Interval& a, const Interval& b) { return widened(a.lo + b.lo, a.hi + b.hi); }
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return widened(std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s)));
}
// cos over an interval: the end values, and +-1 where a multiple of pi lies inside.
inline Interval cos(const Interval& a) {
  if (!(a.hi - a.lo < kTwoPi)) return {-1, 1};
  double lo = std::min(std::cos(a.lo), std::cos(a.hi));
  double hi = std::max(std::cos(a.lo), std::cos(a.hi));
  const double slack = 1e-15 * std::max({1.0, std::abs(a.lo), std::abs(a.hi)});
  for (double k = std::floor((a.lo - slack) / kPi); k * kPi <= a.hi + slack; k += 1) {
    if (k * kPi < a.lo - slack) continue;
    if (std::fmod(std::abs(k), 2.0) == 0.0)
      hi = 1;
    else
      lo = -1;
  }
  return {std::max(-1.0, lo - 4 * kEps), std::min(1.0, hi + 4 * kEps)};
}
inline Interval sin(const Interval& a) { return cos(Interval{a.lo - kPi / 2, a.hi - kPi / 2}); }

}  // namespace iso
