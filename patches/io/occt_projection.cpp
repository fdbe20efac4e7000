#include "patches/io/occt_projection.h"

#include <BRep_Tool.hxx>
#include <Geom_Curve.hxx>
#include <Standard_Failure.hxx>
#include <array>

#include "patches/io/occt_surface.h"

namespace iso::occt {
namespace {

// A trim curve is doubted where it leaves its edge by more than the edge's tolerance and this share of the edge's length.
constexpr double kNearEdge = 1e-4;
// Open CASCADE widens tolerances until they cover what it made. One that is a larger share of the edge's length than this excuses nothing.
constexpr double kWidestTolerance = 1e-2;
// A new curve is taken only if it is nearer to the edge by this factor.
constexpr double kGain = 0.1;
// A line of constant u or v is taken instead of a spline unless it is farther from the edge by this factor, or at all above rounding.
constexpr double kLinePreferred = 2;
constexpr double kRounding = 1e-12;  // of the edge's length
// A line so near to the border of the surface, as a share of the surface's domain, is put on it.
constexpr double kOnBorder = 1e-3;
// Splines are made finer while that brings them nearer by the first factor, until they are within the second, a share of the length.
constexpr double kFiner = 0.5, kFineEnough = 1e-6;
constexpr int kQuickSamples = 20, kSamples = 64;  // along an edge
constexpr int kMostSpans = 512;                   // of a new spline

Vec3 to_vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
Vec3 to_vec(const gp_Vec& v) { return {v.X(), v.Y(), v.Z()}; }

// A curve in space over the shares 0 to 1 of its range: the edge's own, or the trace of a trim curve on the surface.
struct EdgeCurve {
  Handle(Geom_Curve) curve;
  double lo = 0, hi = 1;
  Point3 operator()(double share) const { return to_vec(curve->Value(lo + share * (hi - lo))); }
};
struct Trace {
  const Geom_Surface& surface;
  const TrimCurve& trim;
  UV uv(double share) const { return jet(trim.curve, trim.t0 + share * (trim.t1 - trim.t0)).C; }
  Point3 operator()(double share) const {
    const UV p = uv(share);
    return to_vec(surface.Value(p.x, p.y));
  }
};

template <class Curve>
std::vector<Point3> sampled(const Curve& curve, int count) {
  std::vector<Point3> points;
  for (int i = 0; i <= count; ++i) points.push_back(curve(double(i) / count));
  return points;
}

double length_of(const std::vector<Point3>& points) {
  double length = 0;
  for (size_t i = 1; i < points.size(); ++i) length += glm::length(points[i] - points[i - 1]);
  return length;
}

// Distance of p from the curve. It is refined, from the nearest sample in ever smaller steps, only if p is not within `near` of a chord.
template <class Curve>
double distance_to(const Curve& curve, const std::vector<Point3>& samples, const Point3& p, double near) {
  size_t nearest = 0;
  double least = kInf, chord = kInf;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (const double d = glm::length(samples[i] - p); d < least) least = d, nearest = i;
    if (i == 0) continue;
    const Vec3 along = samples[i] - samples[i - 1];
    const double squared = glm::dot(along, along);
    const double t = squared > 0 ? std::clamp(glm::dot(along, p - samples[i - 1]) / squared, 0.0, 1.0) : 0.0;
    chord = std::min(chord, glm::length(samples[i - 1] + t * along - p));
  }
  if (chord <= near) return chord;
  const double last = static_cast<double>(samples.size()) - 1;
  double share = static_cast<double>(nearest) / last, step = 0.5 / last;
  for (int i = 0; i < 24; ++i, step *= 0.5)
    for (const double s : {share - step, share + step}) {
      if (s < 0 || s > 1) continue;
      if (const double d = glm::length(curve(s) - p); d < least) {
        least = d;
        share = s;
        break;
      }
    }
  return least;
}

// The largest distance of a point of either curve from the other curve, whatever their parameters; infinite if it is above `most`.
double apart(const Trace& trace, const EdgeCurve& edge, double near, double most = kInf) {
  const std::vector<Point3> a = sampled(trace, kSamples), b = sampled(edge, kSamples);
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    largest = std::max({largest, distance_to(edge, b, a[i], near), distance_to(trace, a, b[i], near)});
    if (!(largest <= most)) return kInf;
  }
  return largest;
}

// The domain of the surface, endless where the surface goes on, and what steps in u and in v are measured by.
struct Domain {
  Box2 box;
  Vec2 size{1.0};
};
Domain domain_of(const Handle(Geom_Surface) & surface) {
  Domain d{bounds_of(untrimmed(surface))};
  for (int c = 0; c < 2; ++c)
    if (const double width = d.box.size()[c]; finite(width) && width > 0) d.size[c] = width;
  if (untrimmed(surface)->IsUPeriodic()) d.box.lo.x = -kInf, d.box.hi.x = kInf;
  if (untrimmed(surface)->IsVPeriodic()) d.box.lo.y = -kInf, d.box.hi.y = kInf;
  return d;
}

// The point of the surface nearest to p, near `uv`: damped Gauss-Newton steps that stay in the domain. Where the surface is singular the
// damping picks the shortest step, so that the parameter that does not matter stays as it is.
UV nearest_on(const Geom_Surface& surface, const Domain& domain, const Point3& p, UV uv) {
  constexpr double kLeastDamping = 1e-12, kMostDamping = 1e3, kStill = 1e-14;
  constexpr int kMostSteps = 40;
  double damping = kLeastDamping;
  for (int step = 0; step < kMostSteps && damping <= kMostDamping; ++step) {
    gp_Pnt S;
    gp_Vec Su, Sv;
    surface.D1(uv.x, uv.y, S, Su, Sv);
    const Vec3 rest = p - to_vec(S);
    std::array<Vec3, 2> J{to_vec(Su) * domain.size.x, to_vec(Sv) * domain.size.y};
    for (int i = 0; i < 2; ++i) {  // a step out of the domain is none
      const auto k = static_cast<size_t>(i);
      const double slope = glm::dot(J[k], rest);
      if ((uv[i] <= domain.box.lo[i] && slope < 0) || (uv[i] >= domain.box.hi[i] && slope > 0)) J[k] = Vec3(0.0);
    }
    const double a = glm::dot(J[0], J[0]), b = glm::dot(J[0], J[1]), c = glm::dot(J[1], J[1]);
    if (!(a + c > 0)) return uv;
    for (; damping <= kMostDamping; damping *= 10) {
      const double more = damping * (a + c), f = glm::dot(J[0], rest), g = glm::dot(J[1], rest);
      const double det = (a + more) * (c + more) - b * b;
      const Vec2 delta = Vec2((c + more) * f - b * g, (a + more) * g - b * f) / det;
      const UV next = glm::clamp(uv + delta * domain.size, domain.box.lo, domain.box.hi);
      const double moved = glm::length((next - uv) / domain.size);
      if (glm::length(p - to_vec(surface.Value(next.x, next.y))) < glm::length(rest)) {
        uv = next;
        damping = std::max(kLeastDamping, damping / 100);
        if (moved < kStill) return uv;
        break;
      }
      if (!(moved >= kStill)) return uv;
    }
  }
  return uv;
}

// The edge's points on the surface, found from one to the next; the first is the one that the old curve has nearest to the edge.
std::vector<UV> projected(const Trace& old, const EdgeCurve& edge, const Domain& domain, int spans) {
  const std::vector<Point3> points = sampled(edge, spans);
  size_t start = 0;
  double least = kInf;
  for (size_t i = 0; i < points.size(); ++i)
    if (const double d = glm::length(old(double(i) / spans) - points[i]); d < least) least = d, start = i;
  std::vector<UV> uv(points.size());
  uv[start] = nearest_on(old.surface, domain, points[start], old.uv(double(start) / spans));
  for (size_t i = start + 1; i < points.size(); ++i) uv[i] = nearest_on(old.surface, domain, points[i], uv[i - 1]);
  for (size_t i = start; i-- > 0;) uv[i] = nearest_on(old.surface, domain, points[i], uv[i + 1]);
  return uv;
}

// The line of constant u (c = 0) or v (c = 1) along the points, over the parameters of `like`.
TrimCurve line_along(const std::vector<UV>& points, int c, const Domain& domain, const TrimCurve& like) {
  std::vector<double> values;
  for (const UV& p : points) values.push_back(p[c]);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  double value = values[values.size() / 2];
  for (const double border : {domain.box.lo[c], domain.box.hi[c]})
    if (std::abs(value - border) <= kOnBorder * domain.size[c]) value = border;
  UV from = points.front(), to = points.back();
  from[c] = to[c] = value;
  const Vec2 direction = (to - from) / (like.t1 - like.t0);
  return {Line<Vec2>{from - like.t0 * direction, direction}, like.t0, like.t1, like.edge};
}

// A cubic spline through the points at equal steps of the parameters of `like`, without overshoot: slopes by [Fritsch and Butland 1984].
TrimCurve spline_through(const std::vector<UV>& points, const TrimCurve& like) {
  const size_t last = points.size() - 1;
  const auto slope = [&](size_t i) {
    Vec2 m(0.0);
    if (i == 0 || i == last) return i == 0 ? points[1] - points[0] : points[last] - points[last - 1];
    const Vec2 a = points[i] - points[i - 1], b = points[i + 1] - points[i];
    for (int c = 0; c < 2; ++c)
      if (a[c] * b[c] > 0) m[c] = 2 * a[c] * b[c] / (a[c] + b[c]);
    return m;
  };
  NurbsCurve<Vec2> n;
  n.degree = 3;
  n.knots.assign(4, like.t0);
  n.poles.push_back(homogeneous(points[0], 1.0));
  for (size_t i = 1; i <= last; ++i) {
    n.poles.push_back(homogeneous(points[i - 1] + slope(i - 1) / 3.0, 1.0));
    n.poles.push_back(homogeneous(points[i] - slope(i) / 3.0, 1.0));
    n.poles.push_back(homogeneous(points[i], 1.0));
    n.knots.insert(n.knots.end(), i == last ? 4 : 3, i == last ? like.t1 : like.t0 + (like.t1 - like.t0) * double(i) / double(last));
  }
  return {std::move(n), like.t0, like.t1, like.edge};
}

// How far the edge itself is from the surface: no trim curve can be nearer.
double edge_off_surface(const Trace& old, const EdgeCurve& edge, const std::vector<UV>& uv) {
  const std::vector<Point3> points = sampled(edge, static_cast<int>(uv.size()) - 1);
  double most = 0;
  for (size_t i = 0; i < uv.size(); ++i) most = std::max(most, glm::length(to_vec(old.surface.Value(uv[i].x, uv[i].y)) - points[i]));
  return most;
}

// The candidate nearest to the edge, if one gains enough: lines first, then splines that get finer while that helps.
std::optional<Reprojected> best_of_candidates(const Trace& old, const EdgeCurve& edge, const Domain& domain, double before, double length) {
  const double most = kGain * before;
  const auto off = [&](const TrimCurve& trim, double least) { return apart(Trace{old.surface, trim}, edge, 0, std::min(most, least)); };
  std::vector<UV> points = projected(old, edge, domain, kSamples);
  if (edge_off_surface(old, edge, points) > most) return std::nullopt;
  Reprojected line{old.trim, before, kInf}, spline{old.trim, before, kInf};
  for (const int c : {0, 1}) {
    TrimCurve trim = line_along(points, c, domain, old.trim);
    const double after = off(trim, line.after);
    if (after < line.after) line = {std::move(trim), before, after};
  }
  if (line.after <= kRounding * length) return line;
  for (int spans = kSamples; spans <= kMostSpans; spans *= 2) {
    if (spans > kSamples) points = projected(old, edge, domain, spans);
    TrimCurve trim = spline_through(points, old.trim);
    const double after = off(trim, kFiner * spline.after);
    if (after < kInf) spline = {std::move(trim), before, after};
    // A spline that is too coarse to count at all may still do when it is finer.
    if (spline.after <= kFineEnough * length || (!(after < kInf) && spline.after < kInf)) break;
  }
  Reprojected& best = line.after <= kLinePreferred * spline.after ? line : spline;
  if (!(best.after < kInf)) return std::nullopt;
  return std::move(best);
}

std::optional<Reprojected> doubted_and_projected(const TrimCurve& trim, const EdgeCurve& edge, double tolerance,
                                                 const Handle(Geom_Surface) & surface) {
  const Trace trace{*surface, trim};
  const std::vector<Point3> points = sampled(edge, kQuickSamples);
  const double length = length_of(points);
  if (length <= tolerance) return std::nullopt;  // a point, as far as the file knows

  // Most curves run with their edge: point by point at equal parameters.
  const double allowed = std::max(kNearEdge * length, std::min(tolerance, kWidestTolerance * length));
  double same = 0;
  for (int i = 0; i <= kQuickSamples; ++i)
    same = std::max(same, glm::length(trace(double(i) / kQuickSamples) - points[static_cast<size_t>(i)]));
  if (same <= allowed || !finite(same)) return std::nullopt;

  const double before = apart(trace, edge, allowed);
  if (before <= allowed || !finite(before)) return std::nullopt;
  return best_of_candidates(trace, edge, domain_of(surface), before, length);
}

}  // namespace

std::optional<Reprojected> reprojected(const TrimCurve& trim, const TopoDS_Edge& edge, const Handle(Geom_Surface) & surface) {
  EdgeCurve curve;
  curve.curve = BRep_Tool::Curve(edge, curve.lo, curve.hi);
  if (curve.curve.IsNull() || !finite(curve.lo) || !finite(curve.hi) || !(curve.lo < curve.hi)) return std::nullopt;
  try {
    return doubted_and_projected(trim, curve, BRep_Tool::Tolerance(edge), surface);
  } catch (const Standard_Failure&) {  // the surface has no derivative somewhere: the curve stays as the file has it
    return std::nullopt;
  }
}

}  // namespace iso::occt
