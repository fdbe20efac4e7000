// A second opinion on plane geometry: CGAL's exact predicates and its constrained Delaunay triangulation. For tests only (GPL).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tess/triangulation.h"

namespace iso::test {

// Both from exact sums of products; 1 is counter-clockwise, and inside the circle through the counter-clockwise a, b, c.
int cgal_orientation(const Vec2& a, const Vec2& b, const Vec2& c);
int cgal_circle_side(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

// An edge by its two vertices, the smaller first.
struct PlaneEdge {
  std::uint32_t a, b;
  bool constrained;
  auto operator<=>(const PlaneEdge&) const = default;
};

// The sorted edges of the constrained Delaunay triangulation of distinct points; the segments must not cross.
std::vector<PlaneEdge> cgal_triangulation(std::span<const Vec2> points, std::span<const std::array<std::uint32_t, 2>> segments);

// Those of ours.
std::vector<PlaneEdge> edges_of(const Triangulation& all);

}  // namespace iso::test
