// B-spline basis functions with derivatives, and knot spans.  [Piegl & Tiller, The NURBS Book, A2.1 to A2.3]
#pragma once

#include <array>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

inline constexpr int kMaxDegree = 30;

// The non-empty knot span [knots[i], knots[i+1]) that holds t; end spans also serve what lies beyond the domain.
inline int knot_span(const std::vector<double>& knots, int degree, double t) {
  const int last = static_cast<int>(knots.size()) - degree - 2;
  const auto begin = knots.begin() + degree, end = knots.begin() + last + 1;
  int i = static_cast<int>(std::upper_bound(begin, end, t) - knots.begin()) - 1;
  i = std::clamp(i, degree, last);
  while (i > degree && knots[i] == knots[i + 1]) --i;
  while (i < last && knots[i] == knots[i + 1]) ++i;
  return i;
}

// N[d][j]: d-th derivative of basis function number span - degree + j at t, for d = 0, 1, 2.
struct BasisDerivatives {
  std::array<std::array<double, kMaxDegree + 1>, 3> N;
};

// Raises the functions N of degree j - 1 to degree j, for j = 1 .. degree in turn; `left` and `right` keep the distances to the knots.
struct BasisRecursion {
  std::array<double, kMaxDegree + 1> left, right;

  void raise(const std::vector<double>& knots, int span, double t, int j, double* N) {
    left[j] = t - knots[span + 1 - j];
    right[j] = knots[span + j] - t;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double part = N[r] / (right[r + 1] + left[j - r]);
      N[r] = saved + right[r + 1] * part;
      saved = left[j - r] * part;
    }
    N[j] = saved;
  }
};

// Derivatives from the functions of one and two degrees less: N_p' = p (N_{p-1,i} / d_i - N_{p-1,i+1} / d_{i+1}).
inline void raise_derivative(const std::vector<double>& knots, int degree, int span, const double* lower, double* out) {
  for (int j = 0; j <= degree; ++j) {
    const int i = span - degree + j;
    double sum = 0;
    if (j > 0) sum += lower[j - 1] / (knots[i + degree] - knots[i]);
    if (j < degree) sum -= lower[j] / (knots[i + degree + 1] - knots[i + 1]);
    out[j] = degree * sum;
  }
}

inline BasisDerivatives basis_derivatives(const std::vector<double>& knots, int degree, int span, double t) {
  BasisDerivatives b;
  BasisRecursion recursion;
  std::array<double, kMaxDegree + 1> lower, lowest, lower_d;
  double* N = b.N[0].data();
  N[0] = 1;
  for (int j = 0; j <= degree; ++j) {
    if (j > 0) recursion.raise(knots, span, t, j, N);
    if (j == degree - 2) std::copy(N, N + j + 1, lowest.begin());
    if (j == degree - 1) std::copy(N, N + j + 1, lower.begin());
  }
  std::fill_n(b.N[1].begin(), degree + 1, 0.0);
  std::fill_n(b.N[2].begin(), degree + 1, 0.0);
  if (degree >= 1) raise_derivative(knots, degree, span, lower.data(), b.N[1].data());
  if (degree >= 2) {
    raise_derivative(knots, degree - 1, span, lowest.data(), lower_d.data());
    raise_derivative(knots, degree, span, lower_d.data(), b.N[2].data());
  }
  return b;
}

}  // namespace iso
