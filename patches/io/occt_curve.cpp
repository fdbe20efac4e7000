#include "patches/io/occt_curve.h"

#include <Geom2dConvert_ApproxCurve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Hyperbola.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_Parabola.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert_ApproxCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <gp_Elips.hxx>
#include <gp_Hypr.hxx>
#include <gp_Parab.hxx>

namespace iso::occt {
namespace {

// Samples per approximated curve when its error is measured.
constexpr int kErrorSamples = 400;
// Limits handed to Open CASCADE's approximation; the reached error is measured afterwards.
constexpr double kApproxTolerance = 1e-9;
constexpr int kApproxSpans = 500, kApproxDegree = 9;

// The names of both worlds of Open CASCADE, so that each conversion is written once.
struct Plane2d {
  using V = Vec2;
  using Curve = Geom2d_Curve;
  using Line = Geom2d_Line;
  using Circle = Geom2d_Circle;
  using Ellipse = Geom2d_Ellipse;
  using Parabola = Geom2d_Parabola;
  using Hyperbola = Geom2d_Hyperbola;
  using Bezier = Geom2d_BezierCurve;
  using BSpline = Geom2d_BSplineCurve;
  using Trimmed = Geom2d_TrimmedCurve;
  using Approx = Geom2dConvert_ApproxCurve;
};
struct Space3d {
  using V = Vec3;
  using Curve = Geom_Curve;
  using Line = Geom_Line;
  using Circle = Geom_Circle;
  using Ellipse = Geom_Ellipse;
  using Parabola = Geom_Parabola;
  using Hyperbola = Geom_Hyperbola;
  using Bezier = Geom_BezierCurve;
  using BSpline = Geom_BSplineCurve;
  using Trimmed = Geom_TrimmedCurve;
  using Approx = GeomConvert_ApproxCurve;
};

Vec2 to_vec(const gp_Pnt2d& p) { return {p.X(), p.Y()}; }
Vec2 to_vec(const gp_Dir2d& d) { return {d.X(), d.Y()}; }
Vec3 to_vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
Vec3 to_vec(const gp_Dir& d) { return {d.X(), d.Y(), d.Z()}; }

// The two axes of a conic; the third one of a conic in space is its normal.
template <class Conic>
auto x_axis(const Conic& conic) {
  return to_vec(conic->XAxis().Direction());
}
template <class Conic>
auto y_axis(const Conic& conic) {
  return to_vec(conic->YAxis().Direction());
}

// Poles with weights, and knots written out with their multiplicities.
template <class V, class BSpline>
NurbsCurve<V> nurbs_of(const BSpline& s) {
  const bool weighted = s->IsRational();
  NurbsCurve<V> n;
  n.degree = s->Degree();
  for (int i = 1; i <= s->NbKnots(); ++i) n.knots.insert(n.knots.end(), static_cast<size_t>(s->Multiplicity(i)), s->Knot(i));
  for (int i = 1; i <= s->NbPoles(); ++i) n.poles.push_back(homogeneous(to_vec(s->Pole(i)), weighted ? s->Weight(i) : 1.0));
  return n;
}

template <class V, class Bezier>
NurbsCurve<V> nurbs_of_bezier(const Bezier& b) {
  NurbsCurve<V> n;
  n.degree = b->Degree();
  n.knots.assign(static_cast<size_t>(n.degree + 1), 0.0);
  n.knots.insert(n.knots.end(), static_cast<size_t>(n.degree + 1), 1.0);
  for (int i = 1; i <= b->NbPoles(); ++i) n.poles.push_back(homogeneous(to_vec(b->Pole(i)), b->Weight(i)));
  return n;
}

// The knot of a periodic B-spline nearest to t.
template <class BSpline>
int nearest_knot(const BSpline& s, double t) {
  int best = 1;
  for (int i = 2; i <= s->NbKnots(); ++i)
    if (std::abs(s->Knot(i) - t) < std::abs(s->Knot(best) - t)) best = i;
  return best;
}

// A periodic B-spline is cut open where the needed range begins, by inserting a knot there: the shape stays exactly the same.
template <class T>
NurbsCurve<typename T::V> unrolled(const opencascade::handle<typename T::BSpline>& spline, const Range& needed) {
  const auto s = opencascade::handle<typename T::BSpline>::DownCast(spline->Copy());
  const double lo = s->FirstParameter(), period = s->Period();
  const Window window = window_of(lo, period, needed);
  if (window.cut != lo) {
    const double slack = kWindowSlack * period;
    if (std::abs(s->Knot(nearest_knot(s, window.cut)) - window.cut) > slack) s->InsertKnot(window.cut, 1, slack);
    const int at = nearest_knot(s, window.cut);
    if (at > 1 && at < s->NbKnots()) s->SetOrigin(at);
  }
  s->SetNotPeriodic();
  auto n = nurbs_of<typename T::V>(s);
  for (double& k : n.knots) k += window.shift;
  return n;
}

template <class T>
std::optional<Curve<typename T::V>> convert_exactly(const opencascade::handle<typename T::Curve>& c, const Range& needed) {
  using V = typename T::V;
  if (const auto line = opencascade::handle<typename T::Line>::DownCast(c))
    return Line<V>{to_vec(line->Position().Location()), to_vec(line->Position().Direction())};
  if (const auto k = opencascade::handle<typename T::Circle>::DownCast(c))
    return Ellipse<V>{to_vec(k->Location()), k->Radius() * x_axis(k), k->Radius() * y_axis(k)};
  if (const auto e = opencascade::handle<typename T::Ellipse>::DownCast(c))
    return Ellipse<V>{to_vec(e->Location()), e->MajorRadius() * x_axis(e), e->MinorRadius() * y_axis(e)};
  if (const auto p = opencascade::handle<typename T::Parabola>::DownCast(c)) {
    if (!(p->Focal() > 0)) return std::nullopt;
    return Parabola<V>{to_vec(p->Location()), x_axis(p) / (4 * p->Focal()), y_axis(p)};
  }
  if (const auto h = opencascade::handle<typename T::Hyperbola>::DownCast(c))
    return Hyperbola<V>{to_vec(h->Location()), h->MajorRadius() * x_axis(h), h->MinorRadius() * y_axis(h)};
  if (const auto b = opencascade::handle<typename T::Bezier>::DownCast(c)) return nurbs_of_bezier<V>(b);
  if (const auto s = opencascade::handle<typename T::BSpline>::DownCast(c)) {
    if (s->IsPeriodic()) return unrolled<T>(s, needed);
    return nurbs_of<V>(s);
  }
  return std::nullopt;
}

// The largest distance at equal parameters, which bounds the distance of the two curves.
template <class T>
double measured_error(const Curve<typename T::V>& ours, const opencascade::handle<typename T::Curve>& theirs, const Range& r) {
  double worst = 0;
  for (int i = 0; i <= kErrorSamples; ++i) {
    const double t = r.lo + r.width() * i / kErrorSamples;
    worst = std::max(worst, glm::length(jet(ours, t).C - to_vec(theirs->Value(t))));
  }
  return worst;
}

template <class T>
std::optional<ConvertedCurve<typename T::V>> approximate(const opencascade::handle<typename T::Curve>& c, Range r) {
  if (!(r.width() > 0) || !finite(r.lo) || !finite(r.hi)) return std::nullopt;
  const opencascade::handle<typename T::Curve> piece = new typename T::Trimmed(c, r.lo, r.hi);
  const typename T::Approx fit(piece, kApproxTolerance, GeomAbs_C1, kApproxSpans, kApproxDegree);
  if (!fit.HasResult()) return std::nullopt;
  ConvertedCurve<typename T::V> result{nurbs_of<typename T::V>(fit.Curve()), r, 0};
  result.error = measured_error<T>(result.curve, c, r);
  return result;
}

template <class T>
std::optional<ConvertedCurve<typename T::V>> convert(opencascade::handle<typename T::Curve> c, const Range& needed) {
  // Trimmed curves keep the parameter of what they trim.
  while (!c.IsNull()) {
    const auto trimmed = opencascade::handle<typename T::Trimmed>::DownCast(c);
    if (trimmed.IsNull()) break;
    c = trimmed->BasisCurve();
  }
  if (c.IsNull()) return std::nullopt;
  const Range own{finite_or_infinite(c->FirstParameter()), finite_or_infinite(c->LastParameter())};
  if (auto exact = convert_exactly<T>(c, needed)) {
    ConvertedCurve<typename T::V> result{std::move(*exact), own, 0};
    if (const auto* n = std::get_if<NurbsCurve<typename T::V>>(&result.curve)) {
      if (!problem_of(*n).empty()) return std::nullopt;
      result.domain = {n->knots[static_cast<size_t>(n->degree)], n->knots[n->poles.size()]};
    }
    return result;
  }
  return approximate<T>(c, needed.empty() ? own : needed);
}

}  // namespace

double finite_or_infinite(double parameter) {
  if (Precision::IsPositiveInfinite(parameter)) return kInf;
  if (Precision::IsNegativeInfinite(parameter)) return -kInf;
  return parameter;
}

Window window_of(double lo, double period, const Range& needed) {
  const double slack = kWindowSlack * period;
  if (needed.empty() || (needed.lo >= lo - slack && needed.hi <= lo + period + slack)) return {lo, 0};
  // Where whole periods are enough, no knot is inserted.
  const double shift = std::floor((needed.lo - lo) / period + kWindowSlack) * period;
  if (needed.hi <= lo + shift + period + slack) return {lo, shift};
  return {needed.lo - shift, shift};
}

std::optional<ConvertedCurve<Vec2>> convert_curve(const Handle(Geom2d_Curve) & curve, const Range& needed) {
  return convert<Plane2d>(curve, needed);
}
std::optional<ConvertedCurve<Vec3>> convert_curve(const Handle(Geom_Curve) & curve, const Range& needed) {
  return convert<Space3d>(curve, needed);
}

Curve2 moved(const Curve2& curve, const Vec2& scale, const Vec2& shift) {
  struct Mover {
    Vec2 s, d;
    Curve2 operator()(const Line<Vec2>& c) const { return Line<Vec2>{c.origin * s + d, c.direction * s}; }
    Curve2 operator()(const Ellipse<Vec2>& c) const { return Ellipse<Vec2>{c.centre * s + d, c.X * s, c.Y * s}; }
    Curve2 operator()(const Parabola<Vec2>& c) const { return Parabola<Vec2>{c.vertex * s + d, c.A * s, c.B * s}; }
    Curve2 operator()(const Hyperbola<Vec2>& c) const { return Hyperbola<Vec2>{c.centre * s + d, c.X * s, c.Y * s}; }
    Curve2 operator()(const NurbsCurve<Vec2>& c) const {
      NurbsCurve<Vec2> n = c;
      for (Vec3& p : n.poles) p = {p.x * s.x + p.z * d.x, p.y * s.y + p.z * d.y, p.z};
      return n;
    }
  };
  return std::visit(Mover{scale, shift}, curve);
}

}  // namespace iso::occt
