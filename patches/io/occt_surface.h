// Surfaces of Open CASCADE as ours, in the same parametrisation: exact for all elementary, swept, Bezier and B-spline surfaces; others
// (offsets, plates) become B-splines with their measured error.
#pragma once

#include <Geom_Surface.hxx>
#include <optional>
#include <string>

#include "patches/surface/surface.h"

namespace iso::occt {

struct ConvertedSurface {
  AnySurface surface;
  double error = 0;      // largest measured distance from the file's surface, world units; 0 where exact
  std::string original;  // the kind in the file, where the surface was approximated
};

// `needed` is the box of (u, v) that the face uses; periodic B-splines are cut open outside it, approximations cover it.
// Nothing if the surface cannot be used.
std::optional<ConvertedSurface> convert_surface(const Handle(Geom_Surface) & surface, const Box2& needed);

// Without rectangular trimming; the parameters stay.
Handle(Geom_Surface) untrimmed(Handle(Geom_Surface) surface);

// The period of the file's surface in u and in v: closed B-splines count, 0 where the surface does not close.
Vec2 periods_of(const Handle(Geom_Surface) & surface);

// Natural bounds, infinite where Open CASCADE says so.
Box2 bounds_of(const Handle(Geom_Surface) & surface);

}  // namespace iso::occt
