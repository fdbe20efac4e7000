// Bezier triangles, polynomial and rational, as control nets: raised in degree, cut into parts, and the octant of a sphere.
//
// Patches of kind bezier_triangle, points in the order of kinds/bezier_triangle-inl.h. The parts and the raised one are the same surface.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "patches/surface/patch_chart.h"

namespace iso {

// One degree higher [Farin 2002, 17.5; Hettinga 2021, 2.3.2]. The degree must be below 15.
NSidedPatch raised_triangle(const NSidedPatch& triangle);

// Cut at the point with the given barycentric coordinates, whose sum is 1 and none of which is negative: entry k has the point as its
// corner k, and the triangle's own other two. Where coordinate k is 0 there is no such part: two parts for a point on a side, one at a
// corner. Blossoming [Farin 2002, 17.4].
std::vector<NSidedPatch> cut_triangle(const NSidedPatch& triangle, const Vec3& at);

// The octant x, y, z >= 0 of the unit sphere about the origin, corners on the axes: rational of degree four, exact [Farin, Piper, Worsey
// 1987].
NSidedPatch sphere_octant();

// The Gregory quadrilateral of a bicubic Bezier patch, both points of each pair its inner point. net[4 j + i], i along side 1 from corner 0
// to corner 1, j along side 0 from corner 0 back to corner 3. The same surface.
NSidedPatch gregory_of_bezier(std::span<const Vec3, 16> net);

}  // namespace iso
