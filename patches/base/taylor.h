// Truncated power series in two variables, for formulas that are generic over their number type.
//
// Taylor: a Taylor model: the function differs from the polynomial by at most `radius` for all |a|, |b| <= 1. So a formula evaluated once
// gives a polynomial near it, and the proof. [Makino, Berz 2003]
// Series: the derivatives at a = b = 0 only, through order kOrder; nothing is said of what is cut off.
//
// Rounding of the coefficients is not counted: whoever proves something with Taylor adds what it may come to.
#pragma once

#include <array>
#include <cmath>

#include "patches/base/vec.h"

namespace iso {

template <int kMaxOrder, bool kModel>
struct PowerSeries {
  static constexpr int kOrder = kMaxOrder;
  static constexpr int kCount = (kOrder + 1) * (kOrder + 2) / 2;
  std::array<double, kCount> c{};  // at index(i, j): of a^i b^j, i + j <= kOrder
  double radius = 0;               // of a model; infinite where nothing is known

  static constexpr int index(int i, int j) { return (i + j) * (i + j + 1) / 2 + j; }

  PowerSeries() = default;
  PowerSeries(double constant) { c[0] = constant; }
  // constant + by_a a + by_b b.
  PowerSeries(double constant, double by_a, double by_b) {
    c[0] = constant;
    c[1] = by_a;
    c[2] = by_b;
  }

  // Bounds |f - c[0]| and |f|.
  double spread() const {
    double sum = radius;
    for (int k = 1; k < kCount; ++k) sum += std::abs(c[k]);
    return sum;
  }
  double magnitude() const { return std::abs(c[0]) + spread(); }

  friend PowerSeries operator+(PowerSeries x, const PowerSeries& y) {
    for (int k = 0; k < kCount; ++k) x.c[k] += y.c[k];
    x.radius += y.radius;
    return x;
  }
  friend PowerSeries operator-(PowerSeries x, const PowerSeries& y) {
    for (int k = 0; k < kCount; ++k) x.c[k] -= y.c[k];
    x.radius += y.radius;
    return x;
  }
  friend PowerSeries operator*(PowerSeries x, double by) {
    for (double& k : x.c) k *= by;
    x.radius *= std::abs(by);
    return x;
  }
  friend PowerSeries operator*(double by, const PowerSeries& x) { return x * by; }
  friend PowerSeries operator+(PowerSeries x, double by) {
    x.c[0] += by;
    return x;
  }
  friend PowerSeries operator-(PowerSeries x, double by) { return x + -by; }
  friend PowerSeries operator-(double by, const PowerSeries& x) { return x * -1.0 + by; }

  friend PowerSeries operator*(const PowerSeries& x, const PowerSeries& y) {
    PowerSeries p;
    std::array<double, kOrder + 1> of_x{}, of_y{};  // sums of |coefficients| by order
    for (int n = 0; n <= kOrder; ++n)
      for (int j = 0; j <= n; ++j) {
        of_x[n] += std::abs(x.c[index(n - j, j)]);
        of_y[n] += std::abs(y.c[index(n - j, j)]);
      }
    for (int n = 0; n <= kOrder; ++n) {
      if (of_x[n] == 0) continue;
      for (int m = 0; m + n <= kOrder; ++m) {
        if (of_y[m] == 0) continue;
        for (int j = 0; j <= n; ++j) {
          const double by = x.c[index(n - j, j)];
          const double* from = &y.c[index(m, 0)];
          double* to = &p.c[index(n + m - j, j)];
          for (int l = 0; l <= m; ++l) to[l] += by * from[l];
        }
      }
    }
    if constexpr (kModel) {
      double all_x = 0, all_y = 0, cut = 0, tail = 0;  // tail: of y, orders above kOrder - n
      for (int n = 0; n <= kOrder; ++n) {
        all_x += of_x[n];
        all_y += of_y[n];
        if (n > 0) {
          tail += of_y[kOrder + 1 - n];
          cut += of_x[n] * tail;
        }
      }
      p.radius = cut + x.radius * (all_y + y.radius) + y.radius * all_x;
    }
    return p;
  }

  // 1 / x = 1 / c0 sum (-g / c0)^k with g = x - c0, to the order kept; what is cut off is a geometric series. Nothing is known where x may
  // vanish.
  friend PowerSeries inverse(const PowerSeries& x) {
    PowerSeries g = x, sum(1.0), power(1.0);
    g.c[0] = 0;
    g = g * (-1 / x.c[0]);
    for (int k = 1; k <= kOrder; ++k) {
      power = power * g;
      sum = sum + power;
    }
    if constexpr (kModel) {
      const double ratio = g.spread();
      sum.radius = ratio < 1 ? sum.radius + std::pow(ratio, kOrder + 1) / (1 - ratio) : kInf;
    }
    return sum * (1 / x.c[0]);
  }
  friend PowerSeries operator/(const PowerSeries& x, const PowerSeries& y) { return x * inverse(y); }

  // sqrt(c0) sum binomial(1/2, k) (g / c0)^k; where x may vanish, all that lies between 0 and its largest root.
  friend PowerSeries sqrt(const PowerSeries& x) {
    if (!x.bounded_away()) {
      PowerSeries any(0.5 * std::sqrt(x.magnitude()));
      any.radius = any.c[0];
      return any;
    }
    PowerSeries g = x, sum(1.0), power(1.0);
    g.c[0] = 0;
    g = g * (1 / x.c[0]);
    double binomial = 1;
    for (int k = 1; k <= kOrder; ++k) {
      binomial *= (1.5 - k) / k;
      power = power * g;
      sum = sum + power * binomial;
    }
    if constexpr (kModel) {
      const double ratio = g.spread();
      sum.radius += std::pow(ratio, kOrder + 1) / (1 - ratio);
    }
    return sum * std::sqrt(x.c[0]);
  }

  // Of a sum a + b of what is not negative: whether it may be divided by.
  bool bounded_away() const { return kModel ? c[0] - spread() > 0.02 * c[0] : c[0] > 0; }

  // Of patches at their corners (patches/surface/kinds/domain-inl.h).
  friend PowerSeries blend(const PowerSeries& a, const PowerSeries& b, const PowerSeries& X, const PowerSeries& Y) {
    const PowerSeries sum = a + b, mean = 0.5 * (X + Y);
    if (sum.bounded_away()) return mean + 0.5 * (a - b) * inverse(sum) * (X - Y);
    PowerSeries between = mean;
    between.radius += 0.5 * (X - Y).magnitude();
    return between;
  }
  friend PowerSeries share(const PowerSeries& a, const PowerSeries& b) {
    const PowerSeries sum = a + b;
    if (sum.bounded_away()) return a * inverse(sum);
    PowerSeries any(0.5);
    any.radius = 0.5;
    return any;
  }
};

using Taylor = PowerSeries<10, true>;
using Series = PowerSeries<4, false>;

}  // namespace iso
