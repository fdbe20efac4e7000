#include "patches/curve/curve.h"

#include "patches/base/bernstein.h"
#include "patches/base/bspline_basis.h"
#include "patches/curve/bspline_tools.h"

namespace iso {

double ParamMap::to_native(double s) const {
  if (kind == Kind::affine) return s <= 0.5 ? a + s * (b - a) : b - (1 - s) * (b - a);
  if (s == 0) return a;
  if (s == 1) return b;
  const double middle = 0.5 * (a + b), quarter = 0.25 * (b - a);
  if (kind == Kind::arc) return middle + 2 * std::atan((2 * s - 1) * std::tan(quarter));
  return middle + 2 * std::atanh((2 * s - 1) * std::tanh(quarter));
}

double ParamMap::to_unit(double native) const {
  if (kind == Kind::affine) return (native - a) / (b - a);
  const double middle = 0.5 * (a + b), quarter = 0.25 * (b - a), half = 0.5 * (native - middle);
  if (kind == Kind::arc) return 0.5 + 0.5 * std::tan(half) / std::tan(quarter);
  return 0.5 + 0.5 * std::tanh(half) / std::tanh(quarter);
}

std::vector<double> breakpoints(const std::vector<double>& knots, int degree) {
  std::vector<double> out;
  const std::size_t last = knots.size() - 1 - static_cast<std::size_t>(degree);
  for (std::size_t i = static_cast<std::size_t>(degree); i <= last; ++i)
    if (out.empty() || knots[i] > out.back()) out.push_back(knots[i]);
  return out;
}

namespace {

std::string knots_problem(const std::vector<double>& knots, int degree, std::size_t poles) {
  if (degree < 1 || degree > kMaxDegree) return "degree " + std::to_string(degree) + " is not in 1.." + std::to_string(kMaxDegree);
  if (poles < static_cast<std::size_t>(degree) + 1)
    return std::to_string(poles) + " poles are too few for degree " + std::to_string(degree);
  if (knots.size() != poles + static_cast<std::size_t>(degree) + 1)
    return std::to_string(knots.size()) +
           " knots, expected poles + degree + 1 = " + std::to_string(poles + static_cast<std::size_t>(degree) + 1);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!finite(knots[i])) return "knot " + std::to_string(i) + " is not a finite number";
    if (i > 0 && knots[i] < knots[i - 1])
      return "knot " + std::to_string(i) + " is smaller than the one before it; knots must not decrease";
  }
  if (!(knots[poles] > knots[static_cast<std::size_t>(degree)])) return "the knots span an empty domain";
  return {};
}

template <class H>
std::string poles_problem(const std::vector<H>& poles) {
  for (std::size_t i = 0; i < poles.size(); ++i) {
    for (int c = 0; c < H::length(); ++c)
      if (!finite(poles[i][c]) || std::abs(poles[i][c]) > 1e15) return "pole " + std::to_string(i) + " is not finite or larger than 1e15";
    if (!(weight(poles[i]) > 0)) return "pole " + std::to_string(i) + " has a weight that is not positive";
  }
  return {};
}

}  // namespace

std::string nurbs_problem(const std::vector<double>& knots, int degree, std::size_t poles) { return knots_problem(knots, degree, poles); }
std::string poles_problem4(const std::vector<Vec4>& poles) { return poles_problem(poles); }

template <class V>
std::string problem_of(const NurbsCurve<V>& c) {
  std::string p = knots_problem(c.knots, c.degree, c.poles.size());
  return p.empty() ? poles_problem(c.poles) : p;
}

// ---- derivatives -------------------------------------------------------------------------------------------------------

namespace {

template <class V>
CurveJet<V> jet_of(const Line<V>& c, double t) {
  return {c.origin + t * c.direction, c.direction, V(0.0)};
}
template <class V>
CurveJet<V> jet_of(const Ellipse<V>& c, double t) {
  const V radial = std::cos(t) * c.X + std::sin(t) * c.Y;
  return {c.centre + radial, std::cos(t) * c.Y - std::sin(t) * c.X, -radial};
}
template <class V>
CurveJet<V> jet_of(const Parabola<V>& c, double t) {
  return {c.vertex + t * t * c.A + t * c.B, 2 * t * c.A + c.B, 2.0 * c.A};
}
template <class V>
CurveJet<V> jet_of(const Hyperbola<V>& c, double t) {
  const V out = std::cosh(t) * c.X + std::sinh(t) * c.Y;
  return {c.centre + out, std::sinh(t) * c.X + std::cosh(t) * c.Y, out};
}

// Quotient rule from homogeneous derivatives.  [Piegl & Tiller, eq. 4.8]
template <class V>
CurveJet<V> jet_of(const NurbsCurve<V>& c, double t) {
  const int span = knot_span(c.knots, c.degree, t);
  const BasisDerivatives b = basis_derivatives(c.knots, c.degree, span, t);
  std::array<Homogeneous<V>, 3> h{};
  for (int d = 0; d < 3; ++d)
    for (int j = 0; j <= c.degree; ++j) h[d] += b.N[d][j] * c.poles[span - c.degree + j];
  const double w = weight(h[0]), w1 = weight(h[1]), w2 = weight(h[2]);
  const V C = V(h[0]) / w;
  const V C1 = (V(h[1]) - w1 * C) / w;
  return {C, C1, (V(h[2]) - 2 * w1 * C1 - w2 * C) / w};
}

}  // namespace

template <class V>
CurveJet<V> jet(const Curve<V>& curve, double t) {
  return std::visit([t](const auto& c) { return jet_of(c, t); }, curve);
}

// ---- Bezier spans ------------------------------------------------------------------------------------------------------

namespace {

template <class V>
std::vector<BezierSpan<V>> spans_of(const Line<V>& c, double t0, double t1) {
  if (!finite(t0) || !finite(t1)) return {};
  return {
      {{homogeneous(c.origin + t0 * c.direction, 1.0), homogeneous(c.origin + t1 * c.direction, 1.0)}, {ParamMap::Kind::affine, t0, t1}}};
}

template <class V>
std::vector<BezierSpan<V>> spans_of(const Parabola<V>& c, double t0, double t1) {
  if (!finite(t0) || !finite(t1)) return {};
  const auto p0 = jet_of(c, t0), p1 = jet_of(c, t1);
  const V middle = p0.C + 0.5 * (t1 - t0) * p0.Ct;
  return {{{homogeneous(p0.C, 1.0), homogeneous(middle, 1.0), homogeneous(p1.C, 1.0)}, {ParamMap::Kind::affine, t0, t1}}};
}

// Arcs of at most a quarter turn: weights (1, cos(width / 2), 1), the middle point where the end tangents meet.
template <class V>
std::vector<BezierSpan<V>> spans_of(const Ellipse<V>& c, double t0, double t1) {
  if (!finite(t0) || !finite(t1)) return {};
  const int n = std::max(1, static_cast<int>(std::ceil((t1 - t0) / (kPi / 2) - 1e-9)));
  std::vector<BezierSpan<V>> spans;
  V start = jet_of(c, t0).C;
  for (int i = 0; i < n; ++i) {
    const double a = i == 0 ? t0 : t0 + (t1 - t0) * i / n, b = i + 1 == n ? t1 : t0 + (t1 - t0) * (i + 1) / n;
    const double w = std::cos(0.5 * (b - a)), m = 0.5 * (a + b);
    const V end = jet_of(c, b).C;
    const V middle = c.centre + (std::cos(m) * c.X + std::sin(m) * c.Y) / w;
    spans.push_back({{homogeneous(start, 1.0), homogeneous(middle, w), homogeneous(end, 1.0)}, {ParamMap::Kind::arc, a, b}});
    start = end;
  }
  return spans;
}

// With T = tanh(width / 4): end weights 1, middle weight (1 + T^2) / (1 - T^2) = cosh(width / 2).
template <class V>
std::vector<BezierSpan<V>> spans_of(const Hyperbola<V>& c, double t0, double t1) {
  if (!finite(t0) || !finite(t1)) return {};
  const int n = std::max(1, static_cast<int>(std::ceil((t1 - t0) / 1.0)));
  std::vector<BezierSpan<V>> spans;
  V start = jet_of(c, t0).C;
  for (int i = 0; i < n; ++i) {
    const double a = i == 0 ? t0 : t0 + (t1 - t0) * i / n, b = i + 1 == n ? t1 : t0 + (t1 - t0) * (i + 1) / n;
    const double w = std::cosh(0.5 * (b - a)), m = 0.5 * (a + b);
    const V end = jet_of(c, b).C;
    const V middle = c.centre + (std::cosh(m) * c.X + std::sinh(m) * c.Y) / w;
    spans.push_back({{homogeneous(start, 1.0), homogeneous(middle, w), homogeneous(end, 1.0)}, {ParamMap::Kind::hyperbolic, a, b}});
    start = end;
  }
  return spans;
}

template <class H>
std::vector<H> bezier_points(const std::vector<double>& knots, int degree, const std::vector<H>& poles, int span, double a, double b) {
  const SpanBlossom blossom(knots, degree, span, a, b);
  std::vector<H> out(static_cast<std::size_t>(degree) + 1);
  blossom.points(&poles[static_cast<std::size_t>(blossom.first_pole())], 1, out.data(), 1);
  return out;
}

template <class V>
std::vector<BezierSpan<V>> spans_of(const NurbsCurve<V>& c, double t0, double t1) {
  std::vector<BezierSpan<V>> spans;
  std::vector<double> cuts = breakpoints(c.knots, c.degree);
  cuts.front() = std::min(cuts.front(), t0);
  cuts.back() = std::max(cuts.back(), t1);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double a = std::max(cuts[i], t0), b = std::min(cuts[i + 1], t1);
    if (!(b > a)) continue;
    const int span = knot_span(c.knots, c.degree, 0.5 * (a + b));
    spans.push_back({bezier_points(c.knots, c.degree, c.poles, span, a, b), {ParamMap::Kind::affine, a, b}});
    if (spans.size() > 1 && spans[spans.size() - 2].map.b == a) {
      // Neighbours in a chain share their end point bit for bit (they agree to rounding by continuity).
      auto& before = spans[spans.size() - 2].points.back();
      const V shared = project(before);
      if (glm::length(shared - project(spans.back().points.front())) <= 1e-12 * (1 + glm::length(shared)))
        spans.back().points.front() = before;
    }
  }
  return spans;
}

}  // namespace

template <class V>
std::vector<BezierSpan<V>> bezier_spans(const Curve<V>& curve, double t0, double t1) {
  return std::visit([=](const auto& c) { return spans_of(c, t0, t1); }, curve);
}

SpanBlossom::SpanBlossom(const std::vector<double>& knots, int degree, int span, double a, double b)
    : degree_(degree), first_pole_(span - degree) {
  for (int j = 0; j <= degree; ++j)
    for (int level = 1; level <= degree; ++level) {
      const double t = level <= j ? b : a;
      for (int i = degree; i >= level; --i) {
        const int k = span - degree + i;
        ratios_.push_back((t - knots[k]) / (knots[k + degree + 1 - level] - knots[k]));
      }
    }
}

template std::string problem_of(const NurbsCurve<Vec2>&);
template std::string problem_of(const NurbsCurve<Vec3>&);
template CurveJet<Vec2> jet(const Curve<Vec2>&, double);
template CurveJet<Vec3> jet(const Curve<Vec3>&, double);
template std::vector<BezierSpan<Vec2>> bezier_spans(const Curve<Vec2>&, double, double);
template std::vector<BezierSpan<Vec3>> bezier_spans(const Curve<Vec3>&, double, double);

}  // namespace iso
