// Boundary curves of patch files (B-splines) as the polynomial Bezier curves that the sides of patches are.
#pragma once

#include <vector>

#include "patches/curve/curve.h"

namespace iso {

struct SideCurve {
  std::vector<Vec3> points;  // degree + 1
  double error = 0;          // no point of the B-spline is farther from the one at the same parameter; 0: they are one
};

// The number of polynomial pieces of a curve whose knots may repeat.
int pieces_of(const NurbsCurve<Vec3>& curve);

// The curve over [0, 1] in this degree, at least that of the curve; all weights one. One piece: the same curve, exactly but for rounding.
// More: the least-squares fit at evenly spread parameters that keeps both ends and the derivatives there; `error` is the proven bound, from
// the control points of the difference, piece by piece [Farin 2002, 6.10].
SideCurve bezier_side(const NurbsCurve<Vec3>& curve, int degree);

// One polynomial Bezier curve in a higher degree [Farin 2002, 5.1].
std::vector<Vec3> elevated_to(int degree, std::vector<Vec3> points);

}  // namespace iso
