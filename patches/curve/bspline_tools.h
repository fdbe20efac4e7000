// The B-spline steps that curves and surfaces share.
#pragma once

#include <string>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

// What is wrong with a knot vector for this degree and number of poles, or nothing (empty).
std::string nurbs_problem(const std::vector<double>& knots, int degree, std::size_t poles);

// What is wrong with homogeneous poles (not finite, huge, weight not positive), or nothing.
std::string poles_problem4(const std::vector<Vec4>& poles);

// Bezier points over [a, b] inside one knot span, by blossoming. The degree + 1 poles of the span are `step` apart, so are the points by
// `out_step`.
void bezier_points_of_row(const std::vector<double>& knots, int degree, const Vec4* poles, std::size_t step, int span, double a, double b,
                          Vec4* out, std::size_t out_step);

}  // namespace iso
