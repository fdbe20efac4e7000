// Bernstein polynomials on [0, 1]: values, derivatives, splitting, products and roots. Coefficients in rising order.
#pragma once

#include <array>
#include <vector>

#include "patches/base/bspline_basis.h"
#include "patches/base/vec.h"

namespace iso {

// Value by de Casteljau; `work` is overwritten. Stable for every degree.
template <class T>
T bernstein_value(std::vector<T> work, double s) {
  for (std::size_t n = work.size(); n > 1; --n)
    for (std::size_t i = 0; i + 1 < n; ++i) work[i] = (1 - s) * work[i] + s * work[i + 1];
  return work.front();
}

// The parts on [0, s] and [s, 1]; they share the middle coefficient bit for bit.
template <class T>
void bernstein_split(const std::vector<T>& c, double s, std::vector<T>& left, std::vector<T>& right) {
  std::vector<T> work = c;
  const std::size_t n = c.size();
  left.resize(n);
  right.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    left[k] = work.front();
    right[n - 1 - k] = work[n - 1 - k];
    for (std::size_t i = 0; i + 1 + k < n; ++i) work[i] = (1 - s) * work[i] + s * work[i + 1];
  }
}

// The part on [s0, s1], s0 < s1, s1 > 0; beyond [0, 1] the polynomial continues.
template <class T>
std::vector<T> bernstein_part(const std::vector<T>& c, double s0, double s1) {
  std::vector<T> left, right, rest = c;
  if (s1 != 1) {
    bernstein_split(c, s1, left, right);
    rest = left;
  }
  if (s0 != 0) {
    bernstein_split(rest, s0 / s1, left, right);
    rest = right;
  }
  return rest;
}

// The same in place, of the n + 1 coefficients row[0], row[step], ...
template <class T>
void bernstein_restrict(T* row, std::size_t step, int n, double lo, double hi) {
  if (hi != 1)
    for (int level = 1; level <= n; ++level)
      for (int i = n; i >= level; --i) row[i * step] = (1 - hi) * row[(i - 1) * step] + hi * row[i * step];
  if (lo == 0) return;
  const double at = lo / hi;
  for (int level = 1; level <= n; ++level)
    for (int i = 0; i <= n - level; ++i) row[i * step] = (1 - at) * row[i * step] + at * row[(i + 1) * step];
}

// Coefficients of the derivative with respect to s.
template <class T>
std::vector<T> bernstein_derivative(const std::vector<T>& c) {
  std::vector<T> d;
  const double n = static_cast<double>(c.size()) - 1;
  for (std::size_t i = 0; i + 1 < c.size(); ++i) d.push_back(n * (c[i + 1] - c[i]));
  if (d.empty()) d.push_back(T{});
  return d;
}

// The basis of one degree and its derivatives at s.
struct BernsteinBasis {
  std::array<double, kMaxDegree + 1> B, D;
};
void bernstein_basis(int degree, double s, BernsteinBasis& b);

// Coefficients of the product, degree m + n.
std::vector<double> bernstein_product(const std::vector<double>& a, const std::vector<double>& b);

// All roots in (0, 1) where the sign changes, rising, each to rounding. A polynomial that is zero everywhere has none.
std::vector<double> bernstein_roots(const std::vector<double>& c);

}  // namespace iso
