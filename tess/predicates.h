// Signs of determinants of points in the plane: a floating-point value with a proven error bound where that decides, expansions where it
// does not [Shewchuk 1997, section 4]. Exact where no product loses bits below 2^-1074 or overflows: all coordinates 0 or of magnitudes
// 1e-140 to 1e150 (orientation), 1e-60 to 1e70 (circles).
#pragma once

#include "patches/base/vec.h"

namespace iso {

// The sign (-1, 0, 1) of twice the signed area of the triangle a, b, c: 1 if it runs counter-clockwise. Exact.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

// Whether d lies inside the circle through the counter-clockwise a, b, c; on the circle is not inside. Exact.
bool in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

// Floating point's verdict: 1 certainly inside, -1 certainly outside, 0 on the circle or in doubt.
int circle_side_or_doubt(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

// in_circle, but false where rounding leaves doubt: enough for a swap that may as well not be made, and never slow on grids, whose points
// lie on common circles.
inline bool certainly_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) { return circle_side_or_doubt(a, b, c, d) > 0; }

}  // namespace iso
