#include "patches/io/occt_surface.h"

#include <GeomConvert_ApproxSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>

#include "patches/io/occt_curve.h"

namespace iso::occt {
namespace {

// An offset surface counts as one of the exact kinds if no sample is further off than this share of its size.
constexpr double kSameSurface = 1e-12;
// Samples per direction when the error of an approximated surface is measured.
constexpr int kErrorSamples = 97;
// The tolerance asked of an approximation, as a share of the face's size, and the limits of its B-spline.
constexpr double kApproxTolerance = 1e-7;
constexpr int kApproxDegree = 8, kApproxPatches = 200;

Vec3 to_vec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
Vec3 to_vec(const gp_Dir& d) { return {d.X(), d.Y(), d.Z()}; }

Frame frame_of(const gp_Ax3& axes) {
  return {to_vec(axes.Location()), to_vec(axes.XDirection()), to_vec(axes.YDirection()), to_vec(axes.Direction())};
}

std::vector<double> knots_with_multiplicity(const TColStd_Array1OfReal& knots, const TColStd_Array1OfInteger& multiplicities) {
  std::vector<double> out;
  for (int i = knots.Lower(); i <= knots.Upper(); ++i) out.insert(out.end(), static_cast<size_t>(multiplicities(i)), knots(i));
  return out;
}

int nearest_knot(const TColStd_Array1OfReal& knots, double t) {
  int best = knots.Lower();
  for (int i = knots.Lower(); i <= knots.Upper(); ++i)
    if (std::abs(knots(i) - t) < std::abs(knots(best) - t)) best = i;
  return best;
}

// Cuts a periodic surface open where the face begins, by knot insertion (exact), and returns the shift of the knots in whole periods.
double unroll_u(const Handle(Geom_BSplineSurface) & s, const Range& needed) {
  if (!s->IsUPeriodic()) return 0;
  double u0, u1, v0, v1;
  s->Bounds(u0, u1, v0, v1);
  const Window window = window_of(u0, u1 - u0, needed);
  const double slack = kWindowSlack * (u1 - u0);
  if (window.cut != u0) {
    if (std::abs(s->UKnot(nearest_knot(s->UKnots(), window.cut)) - window.cut) > slack)
      s->InsertUKnot(window.cut, 1, slack, Standard_False);
    const int at = nearest_knot(s->UKnots(), window.cut);
    if (at > 1 && at < s->NbUKnots()) s->SetUOrigin(at);
  }
  s->SetUNotPeriodic();
  return window.shift;
}
double unroll_v(const Handle(Geom_BSplineSurface) & s, const Range& needed) {
  if (!s->IsVPeriodic()) return 0;
  double u0, u1, v0, v1;
  s->Bounds(u0, u1, v0, v1);
  const Window window = window_of(v0, v1 - v0, needed);
  const double slack = kWindowSlack * (v1 - v0);
  if (window.cut != v0) {
    if (std::abs(s->VKnot(nearest_knot(s->VKnots(), window.cut)) - window.cut) > slack)
      s->InsertVKnot(window.cut, 1, slack, Standard_False);
    const int at = nearest_knot(s->VKnots(), window.cut);
    if (at > 1 && at < s->NbVKnots()) s->SetVOrigin(at);
  }
  s->SetVNotPeriodic();
  return window.shift;
}

Range range_u(const Box2& box) { return box.empty() ? Range{} : Range{box.lo.x, box.hi.x}; }
Range range_v(const Box2& box) { return box.empty() ? Range{} : Range{box.lo.y, box.hi.y}; }

// Leaves [lo, hi] by more than what pcurves do everywhere; the share was seen to be below 1e-6 in faces that end at the closing line.
constexpr double kCrossesClosing = 1e-4;
bool leaves(const Range& needed, double lo, double hi) {
  const double slack = kCrossesClosing * (hi - lo);
  return !needed.empty() && (needed.lo < lo - slack || needed.hi > hi + slack);
}

NurbsSurface nurbs_of(const Handle(Geom_BSplineSurface) & original, const Box2& needed) {
  const Handle(Geom_BSplineSurface) s = Handle(Geom_BSplineSurface)::DownCast(original->Copy());
  // After SetUOrigin of a surface without weights, Open CASCADE 7.6 hands out uninitialised ones.
  const bool weighted = s->IsURational() || s->IsVRational();
  NurbsSurface n;
  n.closed_u = s->IsUPeriodic() || s->IsUClosed();
  n.closed_v = s->IsVPeriodic() || s->IsVClosed();
  // A closed surface whose face runs across the closing line is written as a periodic one first.
  const Box2 own = bounds_of(s);
  if (!s->IsUPeriodic() && s->IsUClosed() && leaves(range_u(needed), own.lo.x, own.hi.x)) s->SetUPeriodic();
  if (!s->IsVPeriodic() && s->IsVClosed() && leaves(range_v(needed), own.lo.y, own.hi.y)) s->SetVPeriodic();
  const double shift_u = unroll_u(s, range_u(needed)), shift_v = unroll_v(s, range_v(needed));
  n.degree_u = s->UDegree();
  n.degree_v = s->VDegree();
  n.count_u = s->NbUPoles();
  n.count_v = s->NbVPoles();
  n.knots_u = knots_with_multiplicity(s->UKnots(), s->UMultiplicities());
  n.knots_v = knots_with_multiplicity(s->VKnots(), s->VMultiplicities());
  for (double& k : n.knots_u) k += shift_u;
  for (double& k : n.knots_v) k += shift_v;
  for (int i = 1; i <= n.count_u; ++i)
    for (int j = 1; j <= n.count_v; ++j) n.poles.push_back(homogeneous(to_vec(s->Pole(i, j)), weighted ? s->Weight(i, j) : 1.0));
  return n;
}

NurbsSurface nurbs_of_bezier(const Handle(Geom_BezierSurface) & s) {
  NurbsSurface n;
  n.degree_u = s->UDegree();
  n.degree_v = s->VDegree();
  n.count_u = s->NbUPoles();
  n.count_v = s->NbVPoles();
  const auto unit_knots = [](int degree) {
    std::vector<double> k(static_cast<size_t>(degree + 1), 0.0);
    k.insert(k.end(), static_cast<size_t>(degree + 1), 1.0);
    return k;
  };
  n.knots_u = unit_knots(n.degree_u);
  n.knots_v = unit_knots(n.degree_v);
  n.closed_u = s->IsUClosed();
  n.closed_v = s->IsVClosed();
  for (int i = 1; i <= n.count_u; ++i)
    for (int j = 1; j <= n.count_v; ++j) n.poles.push_back(homogeneous(to_vec(s->Pole(i, j)), s->Weight(i, j)));
  return n;
}

std::optional<ConvertedSurface> swept(const Handle(Geom_Surface) & s, const Box2& needed) {
  if (const auto e = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(s)) {
    auto profile = convert_curve(e->BasisCurve(), range_u(needed));
    if (!profile) return std::nullopt;
    const char* original = profile->error > 0 ? "extrusion of a special curve" : "";
    return ConvertedSurface{Extrusion{std::move(profile->curve), to_vec(e->Direction()), profile->domain}, profile->error, original};
  }
  const auto r = Handle(Geom_SurfaceOfRevolution)::DownCast(s);
  auto profile = convert_curve(r->BasisCurve(), range_v(needed));
  if (!profile) return std::nullopt;
  const char* original = profile->error > 0 ? "revolution of a special curve" : "";
  return ConvertedSurface{Revolution{std::move(profile->curve), to_vec(r->Location()), to_vec(r->Direction()), profile->domain},
                          profile->error, original};
}

std::optional<ConvertedSurface> convert_exactly(const Handle(Geom_Surface) & s, const Box2& needed) {
  const auto exact = [](AnySurface a) { return ConvertedSurface{std::move(a), 0, {}}; };
  if (const auto p = Handle(Geom_Plane)::DownCast(s)) return exact(Plane{frame_of(p->Position())});
  if (const auto c = Handle(Geom_CylindricalSurface)::DownCast(s)) return exact(Cylinder{frame_of(c->Position()), c->Radius()});
  if (const auto c = Handle(Geom_ConicalSurface)::DownCast(s)) return exact(Cone{frame_of(c->Position()), c->RefRadius(), c->SemiAngle()});
  if (const auto b = Handle(Geom_SphericalSurface)::DownCast(s)) return exact(Sphere{frame_of(b->Position()), b->Radius()});
  if (const auto t = Handle(Geom_ToroidalSurface)::DownCast(s))
    return exact(Torus{frame_of(t->Position()), t->MajorRadius(), t->MinorRadius()});
  if (const auto b = Handle(Geom_BezierSurface)::DownCast(s)) return exact(nurbs_of_bezier(b));
  if (const auto b = Handle(Geom_BSplineSurface)::DownCast(s)) return exact(nurbs_of(b, needed));
  if (s->IsKind(STANDARD_TYPE(Geom_SweptSurface))) return swept(s, needed);
  return std::nullopt;
}

// The largest distance at equal parameters over a grid, which bounds the distance of the two surfaces there; and the size of the face.
struct Measured {
  double error = 0, size = 0;
};
Measured measure(const AnySurface& ours, const Handle(Geom_Surface) & theirs, const Box2& box) {
  Measured m;
  Box3 extent;
  for (int i = 0; i <= kErrorSamples; ++i)
    for (int j = 0; j <= kErrorSamples; ++j) {
      const UV uv = box.lo + box.size() * Vec2(i, j) / double(kErrorSamples);
      const Vec3 p = to_vec(theirs->Value(uv.x, uv.y));
      m.error = std::max(m.error, glm::length(point(ours, uv) - p));
      extent.include(p);
    }
  m.size = extent.diagonal();
  return m;
}

// The offset of an elementary surface is elementary again; believed only if the points agree.
std::optional<ConvertedSurface> offset_as_elementary(const Handle(Geom_Surface) & s, const Box2& needed) {
  const auto offset = Handle(Geom_OffsetSurface)::DownCast(s);
  if (offset.IsNull()) return std::nullopt;
  const Handle(Geom_Surface) equal = offset->Surface();
  if (equal.IsNull()) return std::nullopt;
  auto result = convert_exactly(untrimmed(equal), needed);
  if (!result || !problem_of(result->surface).empty()) return std::nullopt;
  const Measured m = measure(result->surface, s, needed);
  if (!(m.error <= kSameSurface * m.size)) return std::nullopt;
  return result;
}

std::optional<ConvertedSurface> approximate(const Handle(Geom_Surface) & s, const Box2& needed) {
  double size = 0;
  for (const UV corner : {needed.lo, needed.hi, UV{needed.lo.x, needed.hi.y}, UV{needed.hi.x, needed.lo.y}, needed.middle()})
    size = std::max(size, glm::length(to_vec(s->Value(corner.x, corner.y)) - to_vec(s->Value(needed.middle().x, needed.middle().y))));
  const Handle(Geom_Surface) piece =
      new Geom_RectangularTrimmedSurface(s, needed.lo.x, needed.hi.x, needed.lo.y, needed.hi.y, Standard_True, Standard_True);
  const GeomConvert_ApproxSurface fit(piece, kApproxTolerance * size, GeomAbs_C1, GeomAbs_C1, kApproxDegree, kApproxDegree, kApproxPatches,
                                      0);
  if (!fit.HasResult() || fit.Surface().IsNull()) return std::nullopt;
  ConvertedSurface result{nurbs_of(fit.Surface(), needed), 0,
                          s->IsKind(STANDARD_TYPE(Geom_OffsetSurface)) ? "offset surface" : "special surface"};
  if (!problem_of(result.surface).empty()) return std::nullopt;
  result.error = measure(result.surface, s, needed).error;
  return result;
}

}  // namespace

Handle(Geom_Surface) untrimmed(Handle(Geom_Surface) surface) {
  for (;;) {
    const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    if (trimmed.IsNull()) return surface;
    surface = trimmed->BasisSurface();
  }
}

Box2 bounds_of(const Handle(Geom_Surface) & surface) {
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  return {{finite_or_infinite(u0), finite_or_infinite(v0)}, {finite_or_infinite(u1), finite_or_infinite(v1)}};
}

Vec2 periods_of(const Handle(Geom_Surface) & surface) {
  const Box2 box = bounds_of(surface);
  Vec2 period{0.0};
  if (surface->IsUPeriodic())
    period.x = surface->UPeriod();
  else if (finite(box.size().x) && surface->IsUClosed())
    period.x = box.size().x;
  if (surface->IsVPeriodic())
    period.y = surface->VPeriod();
  else if (finite(box.size().y) && surface->IsVClosed())
    period.y = box.size().y;
  return period;
}

std::optional<ConvertedSurface> convert_surface(const Handle(Geom_Surface) & surface, const Box2& needed) {
  const Handle(Geom_Surface) s = untrimmed(surface);
  if (s.IsNull()) return std::nullopt;
  if (auto exact = convert_exactly(s, needed)) return exact;
  if (needed.empty() || !finite(needed.lo) || !finite(needed.hi)) return std::nullopt;
  if (auto elementary = offset_as_elementary(s, needed)) return elementary;
  return approximate(s, needed);
}

}  // namespace iso::occt
