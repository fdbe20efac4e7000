// Trim loops at singular points: sides of a surface's domain that the surface maps to one point.
#pragma once

#include <optional>
#include <vector>

#include "patches/surface/surface.h"

namespace iso {

// A way in (u, v) between two points with one image, such as the two ends of a collapsed side. `strays` is the largest distance of its
// image from those of its ends, `straight` that of the straight line between them.
struct BorderWay {
  std::vector<UV> points;  // `from`, corners of the domain, `to`
  double strays = 0, straight = 0;
};

// The way along the border of the surface's natural domain, around one or more of its corners; only if both points lie on the border, and
// only if the straight line strays by more than `allowed` and far more than it: where two collapsed sides meet in a corner, the line cuts
// across the surface.
std::optional<BorderWay> border_way(const AnySurface& surface, const UV& from, const UV& to, double allowed);

}  // namespace iso
