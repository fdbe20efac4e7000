// Signs of determinants of points in the plane.
#pragma once

#include "patches/base/vec.h"

namespace iso {

// The sign (-1, 0, 1) of twice the signed area of the triangle a, b, c: 1 if it runs counter-clockwise. Exact for all finite doubles whose
// products neither overflow nor underflow [Shewchuk 1997].
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

// Whether d lies inside the circle through the counter-clockwise a, b, c. Exact.
bool in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

// The same, but false where rounding leaves doubt: enough for a swap that may as well not be made, and never slow on grids, whose points
// lie on common circles.
bool certainly_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

}  // namespace iso
