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

  // Coefficients of the same polynomial over a quarter of its square, about (m.x, m.y) = (+-1/2, +-1/2).
  template <class V>
  static void to_quarter(std::array<V, kCount>& of, const Vec2& m) {
    const auto at = [&](int i, int j) -> V& { return of[static_cast<std::size_t>(index(i, j))]; };
    for (int j = 0; j < kOrder; ++j)
      for (int k = 0; k < kOrder - j; ++k)
        for (int i = kOrder - j - 1; i >= k; --i) at(i, j) += m.x * at(i + 1, j);
    for (int i = 0; i < kOrder; ++i)
      for (int k = 0; k < kOrder - i; ++k)
        for (int j = kOrder - i - 1; j >= k; --j) at(i, j) += m.y * at(i, j + 1);
    for (int i = 0; i <= kOrder; ++i)
      for (int j = 0; i + j <= kOrder; ++j) at(i, j) *= std::ldexp(1.0, -i - j);
  }
  PowerSeries quarter(double a, double b) const {
    PowerSeries q = *this;
    to_quarter(q.c, {a, b});
    return q;
  }

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
        if (of_y[m] != 0) p.add_product(x, n, y, m);
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

  // Order by order from x y = 1. Of a model, what x y differs from 1 by: 1 / x = y / (1 + e). Nothing is known where x may vanish.
  friend PowerSeries inverse(const PowerSeries& x) {
    PowerSeries y;
    y.c[0] = 1 / x.c[0];
    for (int n = 1; n <= kOrder; ++n) {
      for (int k = 1; k <= n; ++k) y.add_product(x, k, y, n - k);
      for (int j = 0; j <= n; ++j) y.c[index(n - j, j)] *= -y.c[0];
    }
    if constexpr (kModel) {
      const double apart = (x * y - 1.0).magnitude();
      y.radius = apart < 1 ? y.magnitude() * apart / (1 - apart) : kInf;
    }
    return y;
  }
  friend PowerSeries operator/(const PowerSeries& x, const PowerSeries& y) { return x * inverse(y); }

  // Order by order from y y = x; where x may vanish, all that lies between 0 and its largest root. Of a model, what y y differs from x by:
  // sqrt(x) - y = (x - y y) / (sqrt(x) + y).
  friend PowerSeries sqrt(const PowerSeries& x) {
    if (!x.bounded_away()) {
      PowerSeries any(0.5 * std::sqrt(x.magnitude()));
      any.radius = any.c[0];
      return any;
    }
    PowerSeries y;
    y.c[0] = std::sqrt(x.c[0]);
    for (int n = 1; n <= kOrder; ++n) {
      for (int k = 1; k < n; ++k) y.add_product(y, k, y, n - k);
      for (int j = 0; j <= n; ++j) y.c[index(n - j, j)] = (x.c[index(n - j, j)] - y.c[index(n - j, j)]) / (2 * y.c[0]);
    }
    if constexpr (kModel) {
      const double least = std::sqrt(x.c[0] - x.spread()) + y.c[0] - y.spread();
      y.radius = least > 0 ? (x - y * y).magnitude() / least : kInf;
    }
    return y;
  }

  // Of a sum a + b of what is not negative: whether it may be divided by.
  bool bounded_away() const { return kModel ? c[0] - spread() > 0.02 * c[0] : c[0] > 0; }

  // Adds the product of x's terms of order n and y's of order m.
  void add_product(const PowerSeries& x, int n, const PowerSeries& y, int m) {
    for (int j = 0; j <= n; ++j) {
      const double by = x.c[index(n - j, j)];
      const double* from = &y.c[index(m, 0)];
      double* to = &c[index(n + m - j, j)];
      for (int l = 0; l <= m; ++l) to[l] += by * from[l];
    }
  }

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
