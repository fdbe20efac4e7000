// How far the triangles of one patch's pattern are from it, proven.
//
// A triangle T may reach over several charts. It is cut in the domain, every piece in one chart (pattern_cuts.h). The surface over a piece
// with the corners q is proven to be within FaceShape::triangle_bound of the flat triangle P over the points S(q). Each S(q) has a partner
// on T: the corner itself, the nearest point of the edge if q is on one, else the nearest of T. The linear map of P that takes its corners
// to their partners moves no point farther than it moves the corners. So the sum of both holds for the surface from T; and for T from the
// surface, since the maps of all pieces together take the border of T to itself and so cover T. The charts' map is bilinear: what is
// straight in a chart is not quite so in the polygon, but along spokes and sides, and the regions of neighbouring triangles fit together.
// Where the sum is more than wanted a piece is divided in four, in its chart. What is left is conservative: a shift of S(q) along the
// surface away from its edge counts as distance (up to some five times the true one for coarse fans), and so does the spline beside the
// charts.
#pragma once

#include <span>
#include <vector>

#include "tess/face_shape.h"
#include "tess/pattern_cuts.h"

namespace iso {

// A pattern, what cuts it, and the weights at all of their points: shared by all patches of a basis.
struct PatternTables {
  DomainPattern pattern;
  PatternCuts cuts;
  CoordinateTable at_points, at_cuts;

  PatternTables(const PatchBasis& basis, Strategy strategy, const PatternLevels& levels);
};

// Places on the surface: of the pattern's points, then of the cuts'.
std::vector<Vec3> places_of(const PatternTables& tables, const NSidedPatch& patch);

class PatchBounds {
 public:
  // All must stay where they are.
  PatchBounds(const PatternTables& tables, const std::vector<Vec3>& places) : tables_(tables), places_(places) {}

  // A distance that is reached: the largest found, of the surface over the middles of pieces from their triangles. `charts`: the patch's
  // faces.
  double reached(std::span<const Face> charts) const;

  // World units, the largest of each chart's pieces: bounds that are no larger than `aim` are not sharpened.
  std::vector<double> proven(std::span<const FaceShape> shapes, double aim) const;
  // Whether all are at most this.
  bool within(std::span<const FaceShape> shapes, double most) const;

 private:
  const PatternTables& tables_;
  const std::vector<Vec3>& places_;
};

}  // namespace iso
