// Proof that a flat triangle is near a surface where the bound of the whole triangle is too coarse: the triangle is divided in four, again
// and again. The corners of the parts are projected on the surface, which takes the shift along the surface out; a part is then no farther
// than the farthest of its corners and what the triangle over their feet is from the surface.
#pragma once

#include "tess/face_shape.h"

namespace iso {

class TriangleDivision {
 public:
  TriangleDivision(const FaceShape& shape, const std::array<SurfaceCorner, 3>& corners, double most);

  // `quick`: the proven bound of the whole. Parts are divided where they must be, as long as there is hope.
  FaceShape::Verdict verdict(double quick);

 private:
  static constexpr int kLevels = 3, kSide = 1 << kLevels;

  // A place of the finest grid, by its shares of the second and third corner in parts of kSide.
  struct Place {
    int i = 0, j = 0;
    std::size_t index() const { return static_cast<std::size_t>(j * (kSide + 1) - j * (j - 1) / 2 + i); }
  };
  using Part = std::array<Place, 3>;

  struct Foot {
    Point3 x;          // of the flat triangle
    SurfaceCorner at;  // on the surface, near it
    double off = -1;   // their distance; negative: not yet known
  };

  static Place between(const Place& a, const Place& b) { return {(a.i + b.i) / 2, (a.j + b.j) / 2}; }
  double find_foot(const Place& a, const Place& b);
  void approach(Foot& foot) const;
  double bound_of(const Part& part) const;

  const FaceShape& shape_;
  double most_;
  BendTree::Place place_;
  std::array<Foot, (kSide + 1) * (kSide + 2) / 2> feet_;
};

}  // namespace iso
