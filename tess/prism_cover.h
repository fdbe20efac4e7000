// An upper bound of how far the points of a triangle are from many others: it is cut into pieces, each before one of those, from which the
// distance is convex, so that a piece's largest distance is at a corner.
#pragma once

#include <array>

#include "tess/triangle_tree.h"

namespace iso {

struct CoverBound {
  double bound = kInf;  // no point of the triangle is farther from the triangles of the tree
  int pieces = 0;       // it took
};

// `near`: a distance that is usual for the triangle's points, about that of its corners and its middle. Where the others lie before the
// triangle as one sheet within it the bound is tight to second order; at their borders, and between sheets, it is loose, but holds.
// `enough`: a bound up to this need not be made tighter.
CoverBound cover_bound(const TriangleTree& tree, std::span<const Point3> points, std::span<const PointTriangle> triangles,
                       const std::array<Point3, 3>& corners, double near, double enough);

}  // namespace iso
