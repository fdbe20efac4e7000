// The B-spline steps that curves and surfaces share.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "patches/base/bspline_basis.h"

namespace iso {

// What is wrong with a knot vector for this degree and number of poles, or nothing (empty).
std::string nurbs_problem(const std::vector<double>& knots, int degree, std::size_t poles);

// What is wrong with homogeneous poles (not finite, huge, weight not positive), or nothing.
std::string poles_problem4(const std::vector<Vec4>& poles);

// Bezier points over [a, b] inside one knot span, by blossoming: point j is the blossom at (a, .. a, b, .. b), b taken j times. The knots'
// share of the work is done once for all rows of poles.
class SpanBlossom {
 public:
  SpanBlossom(const std::vector<double>& knots, int degree, int span, double a, double b);

  // The pole that row[0] must be.
  int first_pole() const { return first_pole_; }

  // From poles row[0], row[step], ... to points out[0], out[out_step], ..., degree + 1 of both.
  template <class H>
  void points(const H* row, std::size_t step, H* out, std::size_t out_step) const {
    std::array<H, kMaxDegree + 1> work;
    const double* at = ratios_.data();
    for (int j = 0; j <= degree_; ++j) {
      for (int i = 0; i <= degree_; ++i) work[i] = row[static_cast<std::size_t>(i) * step];
      for (int level = 1; level <= degree_; ++level)
        for (int i = degree_; i >= level; --i, ++at) work[i] = (1 - *at) * work[i - 1] + *at * work[i];
      out[static_cast<std::size_t>(j) * out_step] = work[degree_];
    }
  }

 private:
  int degree_, first_pole_;
  std::vector<double> ratios_;  // in the order of their use
};

}  // namespace iso
