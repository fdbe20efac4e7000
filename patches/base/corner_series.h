// Numbers near a corner (s, t) = (0, 0) where what vanishes is divided by what vanishes: in coordinates (r, w) with (s, t) = (r, r w), or
// (r w, r), each is a power of r times a function that has a limit. The powers cancel; the functions are power series (taylor.h), and
// models of them bound the quotient up to the corner itself.
#pragma once

#include <algorithm>

#include "patches/base/taylor.h"

namespace iso {

// r^power f(a, b), with r = middle + half a in (0, middle + half], middle >= half; constants need not know r.
template <class Series>
struct CornerSeries {
  Series f;
  int power = 0;
  double middle = 0, half = 0;

  CornerSeries() = default;
  CornerSeries(double constant) : f(constant) {}
  CornerSeries(const Series& f_, int power_, double middle_, double half_) : f(f_), power(power_), middle(middle_), half(half_) {}

  // As a series in a and b; powers below zero have no limit.
  Series value() const {
    if (power >= 0) return times_r(power);
    Series any;
    any.radius = kInf;
    return any;
  }

  friend CornerSeries operator+(const CornerSeries& x, const CornerSeries& y) {
    if (x.none()) return y;
    if (y.none()) return x;
    const int power = std::min(x.power, y.power);
    return joined(x.times_r(x.power - power, y) + y.times_r(y.power - power, x), power, x, y);
  }
  friend CornerSeries operator*(const CornerSeries& x, const CornerSeries& y) { return joined(x.f * y.f, x.power + y.power, x, y); }
  friend CornerSeries operator/(const CornerSeries& x, const CornerSeries& y) {
    return joined(x.f * inverse(y.f), x.power - y.power, x, y);
  }
  friend CornerSeries operator*(CornerSeries x, double by) {
    x.f = x.f * by;
    return x;
  }
  friend CornerSeries operator*(double by, const CornerSeries& x) { return x * by; }
  friend CornerSeries operator-(const CornerSeries& x, const CornerSeries& y) { return x + y * -1.0; }
  friend CornerSeries operator+(const CornerSeries& x, double by) { return x + CornerSeries(by); }
  friend CornerSeries operator-(const CornerSeries& x, double by) { return x + CornerSeries(-by); }
  friend CornerSeries operator-(double by, const CornerSeries& x) { return x * -1.0 + by; }

  // Of even powers.
  friend CornerSeries sqrt(const CornerSeries& x) {
    if (x.power % 2 == 0) return joined(sqrt(x.f), x.power / 2, x, x);
    CornerSeries any = x;
    any.f.radius = kInf;
    return any;
  }
  // Of patches at their corners (patches/surface/kinds/domain-inl.h).
  friend CornerSeries blend(const CornerSeries& a, const CornerSeries& b, const CornerSeries& X, const CornerSeries& Y) {
    return (a * X + b * Y) / (a + b);
  }
  friend CornerSeries share(const CornerSeries& a, const CornerSeries& b) { return a / (a + b); }

 private:
  bool none() const { return f.magnitude() == 0; }
  Series times_r(int count, const CornerSeries& knows) const {
    const CornerSeries& r = middle > 0 ? *this : knows;
    Series product = f;
    for (; count > 0; --count) product = product * Series(r.middle, r.half, 0);
    return product;
  }
  Series times_r(int count) const { return times_r(count, *this); }
  static CornerSeries joined(const Series& f, int power, const CornerSeries& x, const CornerSeries& y) {
    const CornerSeries& r = x.middle > 0 ? x : y;
    return {f, power, r.middle, r.half};
  }
};

}  // namespace iso
