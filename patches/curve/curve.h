// Curves of a CAD model in the plane (trim curves, V = Vec2) and in space (profiles, V = Vec3), in the parametrisation of their file.
//   line       C(t) = origin + t direction
//   ellipse    C(t) = centre + cos t X + sin t Y          (X, Y: half axes as vectors; a circle has |X| = |Y|)
//   parabola   C(t) = vertex + t^2 A + t B
//   hyperbola  C(t) = centre + cosh t X + sinh t Y
//   NURBS      rational B-spline, clamped or not, knots with repetition
// Every curve is also a chain of rational Bezier spans, exactly, with a closed-form map between the two parameters.
#pragma once

#include <variant>
#include <vector>

#include "patches/base/jet.h"
#include "patches/base/result.h"
#include "patches/base/vec.h"

namespace iso {

template <class V>
struct Line {
  V origin{0.0}, direction{0.0};
};
template <class V>
struct Ellipse {
  V centre{0.0}, X{0.0}, Y{0.0};
};
template <class V>
struct Parabola {
  V vertex{0.0}, A{0.0}, B{0.0};
};
template <class V>
struct Hyperbola {
  V centre{0.0}, X{0.0}, Y{0.0};
};

// Homogeneous companion of V: (w x, w y, w) or (w x, w y, w z, w).
template <class V>
struct HomogeneousOf;
template <>
struct HomogeneousOf<Vec2> {
  using type = Vec3;
};
template <>
struct HomogeneousOf<Vec3> {
  using type = Vec4;
};
template <class V>
using Homogeneous = typename HomogeneousOf<V>::type;

inline Vec3 homogeneous(const Vec2& p, double w) { return {w * p.x, w * p.y, w}; }
inline Vec4 homogeneous(const Vec3& p, double w) { return {w * p.x, w * p.y, w * p.z, w}; }
inline Vec2 project(const Vec3& h) { return {h.x / h.z, h.y / h.z}; }
inline Vec3 project(const Vec4& h) { return {h.x / h.w, h.y / h.w, h.z / h.w}; }
inline double weight(const Vec3& h) { return h.z; }
inline double weight(const Vec4& h) { return h.w; }

// Domain [knots[degree], knots[poles.size()]]; knots.size() == poles.size() + degree + 1, not decreasing; weights positive.
template <class V>
struct NurbsCurve {
  int degree = 0;
  std::vector<double> knots;
  std::vector<Homogeneous<V>> poles;
};

template <class V>
using Curve = std::variant<Line<V>, Ellipse<V>, Parabola<V>, Hyperbola<V>, NurbsCurve<V>>;
using Curve2 = Curve<Vec2>;
using Curve3 = Curve<Vec3>;

// Says what is wrong with the data of a NURBS curve, or nothing (empty) if it can be used.
template <class V>
std::string problem_of(const NurbsCurve<V>& curve);

// Point and derivatives at t; a NURBS is continued beyond its domain by its end spans. At a C0 knot: from the right.
template <class V>
CurveJet<V> jet(const Curve<V>& curve, double t);

// The map between the unit parameter of a Bezier span and the native parameter of its curve (strictly increasing on [0, 1]).
//   affine      a + s (b - a)
//   arc         middle + 2 atan((2s - 1) tan(width / 4))       rational quadratic arc of angle < 2 pi, in standard form
//   hyperbolic  middle + 2 atanh((2s - 1) tanh(width / 4))
struct ParamMap {
  enum class Kind : unsigned char { affine, arc, hyperbolic };
  Kind kind = Kind::affine;
  double a = 0, b = 1;

  double to_native(double s) const;
  double to_unit(double native) const;
};

// A Bezier span [0, 1] of a curve. The spans of a curve touch end to end, bit for bit.
template <class V>
struct BezierSpan {
  std::vector<Homogeneous<V>> points;
  ParamMap map;
};

// The part [t0, t1] (t0 < t1) of a curve as Bezier spans in increasing t. A line over an unbounded range has none.
template <class V>
std::vector<BezierSpan<V>> bezier_spans(const Curve<V>& curve, double t0, double t1);

// Distinct knots of a NURBS inside its domain, ends included.
std::vector<double> breakpoints(const std::vector<double>& knots, int degree);

}  // namespace iso
