// Trim curves that leave their edge in space, and new ones: the edge projected on the surface.
//
// Open CASCADE makes trim curves where a file has none, from a handful of projected points. Near a collapsed or almost collapsed side one
// such point may land far off in (u, v), and the curve through all of them swings.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Edge.hxx>
#include <optional>

#include "patches/brep.h"

namespace iso::occt {

struct Reprojected {
  TrimCurve trim;        // over the same parameters
  double before, after;  // largest distance between the edge and the old, the new curve on the surface
};

// A new trim curve, if the old one is farther from the edge's curve in space than the file allows and the new one is far nearer. `trim`
// runs in the direction of the edge's curve and is in the parameters of `surface`, which has the face's location in it.
std::optional<Reprojected> reprojected(const TrimCurve& trim, const TopoDS_Edge& edge, const Handle(Geom_Surface) & surface);

}  // namespace iso::occt
