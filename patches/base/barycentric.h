// Generalised barycentric coordinates of polygons in the plane: phi_i with sum phi_i = 1 and sum phi_i v_i = x, 1 at their own corner, and
// linear along the sides [Hettinga 2021, 2.5].
#pragma once

#include <vector>

#include "patches/base/jet.h"
#include "patches/base/result.h"

namespace iso {

enum class BarycentricKind : std::uint8_t {
  wachspress,  // rational; strictly convex polygons only, positive inside [Wachspress 1975; Hettinga 2021, eq. 2.8]
  mean_value,  // all simple polygons; negative in places where they are concave [Floater 2003; Hormann, Floater 2006]
};

// A polygon that its kind of coordinates exists for; `barycentric_polygon` makes it.
struct BarycentricPolygon {
  BarycentricKind kind = BarycentricKind::wachspress;
  std::vector<Vec2> corners;   // counter-clockwise or clockwise
  std::vector<double> scales;  // of side k, from corner k - 1 to k: one over twice the area it spans with the corner farthest from it
};

// Errors: fewer than three corners, corners that are not finite, sides of no length, an area of zero, sides that meet outside their common
// corners; for Wachspress: a corner where the polygon is straight or turns the other way.
Result<BarycentricPolygon> barycentric_polygon(BarycentricKind kind, std::vector<Vec2> corners);

// phi_i at x with derivatives in x.x and x.y, one for each corner; lengths in the polygon's units. On sides and at corners they are what
// they must be, up to rounding. Wachspress: x inside or on the border, derivatives everywhere. Mean value: any x; at a corner they have no
// derivatives, and 0 stands for them.
std::vector<Dual2> coordinates_at(const BarycentricPolygon& polygon, const Vec2& x);

}  // namespace iso
