// Division of a face into cells: pieces of its Bezier patches small enough that a ray meets each at most once unless it grazes it, with a
// tight box, a linear model and a proven bound on how far the derivatives stray from it, and classified against the trim loops.
// The ray tracer makes its leaves of them.
#pragma once

#include <vector>

#include "patches/surface/bezier_patch.h"
#include "patches/trim.h"

namespace iso {

// A parallelepiped around a cell, square to its tangents: row . (p - centre) lies in `reach`. The first two rows give the cell's own
// parameters of p in its linear model, the third is the unit normal.
struct Slab {
  Vec3 row[3];
  Range reach[3];
};

// Over |a|, |b| <= kCellMargin, with (a, b) in [-1, 1]^2 the cell's own parameters: |dS/da - A| <= stray_a, |dS/db - B| <= stray_b
// (3-vectors).
struct FaceCell {
  int piece = 0;          // index into the face's Bezier pieces
  Vec2 lo{0.0}, hi{1.0};  // dyadic box in the piece's unit square
  Point3 centre{0.0};
  Vec3 A{0.0}, B{0.0};
  double stray_a = 0, stray_b = 0;
  // A ray has at most one root in that square if the tangent of its angle to the slab's normal is below 1 / tilt.
  double tilt = kInf;
  // Bounds on the second derivatives of a ray's plane equations f = n . P - d w, |n| = 1, for planes that come within the slab:
  // |f_aa|, |f_ab| and |f_bb| over the same square.
  Vec3 curls{kInf};
  Box3 box;   // of the hull of the control points
  Slab slab;  // of the same hull
  TrimRegion::Kind kind = TrimRegion::Kind::inside;
};

// What is proven of a cell holds a quarter of its half width beyond its borders: a root found there rules out another one inside.
inline constexpr double kCellMargin = 1.25;

// How fine to divide.
struct CellPolicy {
  double bend = 0.25;    // split until FaceCell::tilt is below this
  double small = 1e-3;   // a cell smaller than this (world units) that still bends is degenerate: left to the solver's fallback
  int most_levels = 18;  // binary splits in all
};

// Appends the cells of one piece that are not outside the trim loops.
void divide(const BezierPiece& piece, int piece_index, const TrimRegion& trim, const CellPolicy& policy, std::vector<FaceCell>& cells);

// A guaranteed box of what the trim loops leave of a face: tight for planes, to a cell of the trim grid for the other closed forms, to the
// hulls of coarse cells for the rest. Without what tolerances add (TrimRegion::largest_reach).
Box3 trimmed_box(const Face& face, const TrimRegion& trim);

}  // namespace iso
