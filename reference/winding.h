// Is a point inside polygons? Slow and obviously right: crossings of a ray to the right, counted segment by segment in long double, by the
// sign of an area. Even-odd over all polygons. Says nothing reliable within rounding of a segment; `distance` tells how near that is.
#pragma once

#include <cmath>
#include <vector>

#include "patches/base/vec.h"

namespace iso::reference {

using Polygon = std::vector<Vec2>;

inline bool inside_even_odd(const std::vector<Polygon>& polygons, const Vec2& p) {
  bool inside = false;
  for (const Polygon& polygon : polygons)
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      const long double ax = a.x, ay = a.y, bx = b.x, by = b.y, px = p.x, py = p.y;
      const long double area = (bx - ax) * (py - ay) - (px - ax) * (by - ay);  // > 0: p lies left of a -> b
      if ((area > 0) == (b.y > a.y)) inside = !inside;
    }
  return inside;
}

inline long double distance(const std::vector<Polygon>& polygons, const Vec2& p) {
  long double least = INFINITY;
  for (const Polygon& polygon : polygons)
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const long double ux = static_cast<long double>(b.x) - a.x, uy = static_cast<long double>(b.y) - a.y;
      const long double qx = static_cast<long double>(p.x) - a.x, qy = static_cast<long double>(p.y) - a.y;
      const long double length2 = ux * ux + uy * uy;
      const long double s = length2 > 0 ? std::fmin(1.0L, std::fmax(0.0L, (ux * qx + uy * qy) / length2)) : 0.0L;
      least = std::fmin(least, std::hypot(qx - s * ux, qy - s * uy));
    }
  return least;
}

}  // namespace iso::reference
