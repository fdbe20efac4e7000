#include "patches/io/occt_trim_curve.h"

#include <fmt/format.h>

#include <BRep_Tool.hxx>
#include <ShapeFix_Edge.hxx>
#include <gp_GTrsf2d.hxx>

#include "patches/io/occt_curve.h"
#include "patches/io/occt_projection.h"

namespace iso::occt {
namespace {

using Tell = std::function<void(Problem::Kind, const std::string&)>;

// Projects the edge's curve on the surface where the file has no curve in (u, v), and tells the distance.
bool add_missing_pcurve(const TopoDS_Edge& edge, const TopoDS_Face& face, const Tell& tell) {
  ShapeFix_Edge fix;
  fix.FixAddPCurve(edge, face, Standard_False, BRep_Tool::Tolerance(edge));
  double first, last, lo, hi;
  const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (pcurve.IsNull()) return false;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, lo, hi);
  double worst = 0;
  constexpr int kSamples = 100;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  for (int i = 0; i <= kSamples && !curve.IsNull(); ++i) {
    const gp_Pnt2d uv = pcurve->Value(first + (last - first) * i / kSamples);
    worst = std::max(worst, surface->Value(uv.X(), uv.Y()).Distance(curve->Value(lo + (hi - lo) * i / kSamples)));
  }
  tell(Problem::Kind::repaired, fmt::format("an edge had no trim curve: its curve in space was projected, {:.2g} off", worst));
  return true;
}

// Distances that no one can see are not told apart, so that equal repairs are counted as one.
std::string distance_text(double distance) {
  return distance < kConfusion ? fmt::format("less than {:.0g} off", kConfusion) : fmt::format("{:.1g} off", distance);
}

}  // namespace

PlacedSurface placed_surface(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Geom_Surface) own = BRep_Tool::Surface(face, location);
  if (own.IsNull() || location.IsIdentity()) return {own, Vec2(1.0), false};
  const gp_Trsf& t = location.Transformation();
  PlacedSurface placed{Handle(Geom_Surface)::DownCast(own->Transformed(t)), Vec2(1.0), t.IsNegative()};
  if (std::abs(std::abs(t.ScaleFactor()) - 1) > kEps) {
    const gp_GTrsf2d map = own->ParametricTransformation(t);
    placed.parameter_scale = {map.Value(1, 1), map.Value(2, 2)};
  }
  return placed;
}

std::optional<EdgeUse> trim_curve(const TopoDS_Edge& edge, const TopoDS_Face& face, const PlacedSurface& placed, const Tell& tell) {
  double first = 0, last = 0;
  Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (pcurve.IsNull() && !BRep_Tool::Degenerated(edge) && add_missing_pcurve(edge, face, tell))
    pcurve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (pcurve.IsNull()) {
    if (!BRep_Tool::Degenerated(edge)) tell(Problem::Kind::repaired, "an edge has no trim curve and none could be found: closed by a line");
    return std::nullopt;
  }
  if (!finite(first) || !finite(last) || !(first < last)) {
    tell(Problem::Kind::repaired, "a trim curve has an empty range of parameters: left out");
    return std::nullopt;
  }
  auto converted = convert_curve(pcurve, {first, last});
  if (!converted) {
    tell(Problem::Kind::repaired, fmt::format("a trim curve of type {} cannot be used: closed by a line", pcurve->DynamicType()->Name()));
    return std::nullopt;
  }
  if (converted->error > 0)
    tell(Problem::Kind::approximated,
         fmt::format("trim curve of type {} as B-spline, {:.2g} off in (u, v)", pcurve->DynamicType()->Name(), converted->error));
  EdgeUse use{{std::move(converted->curve), first, last, -1}};
  if (placed.parameter_scale != Vec2(1.0)) use.trim.curve = moved(use.trim.curve, placed.parameter_scale, Vec2(0.0));
  if (auto better = reprojected(use.trim, edge, placed.surface)) {
    tell(Problem::Kind::repaired,
         fmt::format("trim curve up to {:.2g} off its edge: the edge projected anew, {}", better->before, distance_text(better->after)));
    use = {std::move(better->trim), true};
  }
  if (edge.Orientation() == TopAbs_REVERSED) std::swap(use.trim.t0, use.trim.t1);
  return use;
}

}  // namespace iso::occt
