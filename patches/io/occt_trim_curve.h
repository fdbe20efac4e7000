// The trim curve of one use of an edge on a face: as the file has it, or mended.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <optional>
#include <string>

#include "patches/brep.h"

namespace iso::occt {

// Open CASCADE's own confusion: points nearer than this are one, whatever the file's tolerances.
inline constexpr double kConfusion = 1e-7;

// The face's surface with its location baked in, and what a scaled location does to its parameters.
struct PlacedSurface {
  Handle(Geom_Surface) surface;  // null: the face has none
  Vec2 parameter_scale{1.0};
  bool mirrored = false;
};
PlacedSurface placed_surface(const TopoDS_Face& face);

// A trim curve that runs in the direction of the use; `reprojected` if it is not the file's.
struct EdgeUse {
  TrimCurve trim;
  bool reprojected = false;
};

// Nothing if there is no curve that can be used. What was mended or left out goes to `tell`.
std::optional<EdgeUse> trim_curve(const TopoDS_Edge& edge, const TopoDS_Face& face, const PlacedSurface& placed,
                                  const std::function<void(Problem::Kind, const std::string&)>& tell);

}  // namespace iso::occt
