// Patches from polygons with normals: boundary curves, and inner points that join neighbours with a common tangent plane.
//
// World units throughout. Corners go round counter-clockwise as seen from the side the normals point to. Everything along an edge follows
// from the edge's own two points and normals, so patches on both sides of it are made one by one and still meet: same boundary curve, bit
// for bit, and one tangent plane all along it.
#pragma once

#include <array>
#include <span>

#include "patches/base/result.h"
#include "patches/surface/patch_chart.h"

namespace iso {

using CubicPoints = std::array<Vec3, 4>;  // Bezier points of a cubic curve

// A cubic from p0 to p1, at right angles to the unit normals n0 and n1 there: the chord projected into the tangent planes [Vlachos et al.
// 2001, eq. 1], and legs as long as an arc of a circle has that leaves its chord L at the same angle, 2 L / (3 + 3 cos) [Goldapp 1991].
// Swapping the ends gives the same points in reverse, bit for bit. Where the chord is at right angles to a tangent plane, the end has no
// tangent: two of the points coincide.
CubicPoints boundary_cubic(const Vec3& p0, const Vec3& n0, const Vec3& p1, const Vec3& n1);

// The cubic field a(u) = sum_j B_j(u) a_j across a boundary, into the patch, of which both ends are given: its two middle vectors.
struct CrossField {
  Vec3 a1{0.0}, a2{0.0};
};
// The join of Chiyokura and Kimura [1983; Hettinga 2021, 2.3.3]: a = k b + h c, where c is the derivative of the boundary over 3, b(u) the
// linear field between b_0 and b_3, which are unit vectors at right angles to normal and boundary at the ends, and k and h linear.
//
// b depends on the edge alone: seen from the neighbour it is its own negative. So both patches have the tangent plane of b and c at every
// point of the edge, whatever their a_0 and a_3 are. Exact if a_0 and the first leg of the boundary are at right angles to n0, and likewise
// at the other end. Where the boundary has no tangent at an end there is no b: then a is linear, and the join is not smooth.
CrossField join_field(const CubicPoints& boundary, const Vec3& a0, const Vec3& a3, const Vec3& n0, const Vec3& n1);

// A corner of a polygon: its point, and the unit normal of the surface there.
struct PatchCorner {
  Vec3 point{0.0}, normal{0.0, 0.0, 1.0};
};

// The Gregory patch of so many sides: triangle, quadrilateral, or the generalised one from 5 on.
PatchBasis gregory_basis(int sides);

// The patch over a polygon with given boundary curves, entry k from corner k - 1 to corner k. Kinds: both Gregory ones, generalised
// Gregory, Charrot-Gregory with any parameters, generalised Bezier of degree 3. The latter has one twist point where the others have a
// pair, and takes the middle of both: its tangent planes meet the neighbour's at the corners and only about elsewhere. Errors: a kind or a
// number of corners that does not fit, places or normals that are not finite, normals of no length, curves that do not begin and end in the
// corners.
Result<NSidedPatch> patch_within(const PatchBasis& basis, std::span<const PatchCorner> corners, std::span<const CubicPoints> curves);
// With the curves of `boundary_cubic`. An error, too: neighbouring corners at one place.
Result<NSidedPatch> patch_over(const PatchBasis& basis, std::span<const PatchCorner> corners);

}  // namespace iso
