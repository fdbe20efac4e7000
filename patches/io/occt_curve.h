// Curves of Open CASCADE as ours, in the same parametrisation: exact where the kind is known, else as a B-spline with its measured error.
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <optional>

#include "patches/curve/curve.h"

namespace iso::occt {

template <class V>
struct ConvertedCurve {
  Curve<V> curve;
  Range domain;      // of the curve, ends may be infinite
  double error = 0;  // largest measured distance from the file's curve; 0 where exact
};

// `needed` is the range that will be used: a periodic B-spline is cut open outside it. Nothing if the curve cannot be used.
std::optional<ConvertedCurve<Vec2>> convert_curve(const Handle(Geom2d_Curve) & curve, const Range& needed);
std::optional<ConvertedCurve<Vec3>> convert_curve(const Handle(Geom_Curve) & curve, const Range& needed);

// The image of a parameter curve under (u, v) -> (scale.x u, scale.y v) + shift.
Curve2 moved(const Curve2& curve, const Vec2& scale, const Vec2& shift);

// Open CASCADE writes infinity as +-2e100.
double finite_or_infinite(double parameter);

// Where a periodic B-spline with domain [lo, lo + period) is cut open so that one period holds `needed`: at `cut` inside the domain, all
// knots then moved by `shift` (whole periods). Ranges that leave the domain by less than kWindowSlack periods are not cut anew.
inline constexpr double kWindowSlack = 1e-9;
struct Window {
  double cut, shift;
};
Window window_of(double lo, double period, const Range& needed);

}  // namespace iso::occt
