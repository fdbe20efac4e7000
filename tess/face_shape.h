// How far flat triangles and straight segments are from the surface of a face.
//
// A triangle with corners at a, b, c of the parameter plane and S(a), S(b), S(c) in space is compared with S over the flat triangle a, b,
// c: with L the linear interpolation, e = S - L = -1/2 sum_{i<j} l_i l_j d_ij^T S'' d_ij (d_ij = differences of the corners, l =
// barycentric coordinates) [Filip et al. 1986; Safko 2022, 4.2]. The printed bound takes norms; kept here are the signs of the second
// fundamental form, so that a saddle costs what it costs, and the shift along the surface, which makes no distance, is counted to second
// order only.
#pragma once

#include <array>
#include <optional>

#include "patches/bend.h"
#include "patches/brep.h"
#include "tess/surface_eval.h"

namespace iso {

// A corner: its parameters and its place on the surface.
struct SurfaceCorner {
  UV uv{0.0};
  Point3 S{0.0};
};

class FaceShape {
 public:
  // `tolerance`: world units, of the meshes to be judged; finer bounds than that are not prepared.
  FaceShape(const Face& face, double tolerance);

  const Face& face() const { return *face_; }
  const BendTree& bend() const { return bend_; }
  const SurfaceEval& eval() const { return eval_; }

  // Parameters per axis, rising, across which no triangle may lie: those of the bend tree, and the ends of spans in which the surface has
  // no area, for beyond them it has no tangent plane.
  const std::vector<double>& creases(int axis) const { return creases_[static_cast<std::size_t>(axis)]; }

  // Whether there are such spans.
  bool is_line_somewhere() const { return is_line_somewhere_; }

  // World units: no point of the triangle is farther from the surface, and no point of the surface over a, b, c farther from the triangle
  // and its neighbours. Infinite where nothing is proven. Closed forms for planes, cylinders, cones and spheres.
  double triangle_bound(const SurfaceCorner& a, const SurfaceCorner& b, const SurfaceCorner& c) const;
  // The diagonal of a box of the corners and the surface over their box of (u, v); infinite where there is none or the corners alone are
  // farther apart than `most`.
  double box_bound(const std::array<SurfaceCorner, 3>& corners, double most) const;

  // Whether the bound is at most `most`, found with as little work as that takes. Where `triangle_bound` is too coarse (rough surfaces,
  // large triangles) the triangle is divided: its points are projected on the surface, which takes the shift along the surface out, and
  // between them the same bound of the smaller triangles holds. `bound` is what was proven, or a distance that was found to be larger than
  // `most`.
  struct Verdict {
    bool within = false;
    double bound = 0;
  };
  Verdict keeps(const SurfaceCorner& a, const SurfaceCorner& b, const SurfaceCorner& c, double most) const;

  // Where the surface has no area: whether over a triangle of the parameters it is no farther than `most` from the segment from a to b.
  Verdict stays_near(const Point3& a, const Point3& b, const std::array<UV, 3>& uv, double most) const;

  // There: the parameters between a and b where the surface, which runs along the line between them, comes through p.
  UV place_between(const SurfaceCorner& a, const SurfaceCorner& b, const Point3& p) const;

  // A place where the surface's own normal has turned by more than a right angle within a triangle of the parameters, if samples find one.
  std::optional<Point3> fold_within(const std::array<UV, 3>& uv) const;

  // As `triangle_bound`, of the segment between two corners and the surface's curve over the straight line between them in (u, v).
  double segment_bound(const SurfaceCorner& a, const SurfaceCorner& b) const;

  // The place and the unit outward normal at (u, v); `normal` is zero where there is none.
  struct Placed {
    Point3 S;
    Vec3 normal;
  };
  Placed place(UV uv) const { return place(uv, eval_.at(uv)); }
  Placed place(UV uv, const TangentJet& at) const;

  // Whether Su and Sv span a plane by more than rounding: not at poles, nor where the surface is only a line.
  bool is_regular(const TangentJet& at) const;

 private:
  void add_ends_of_area(const NurbsSurface& s);
  Vec3 limit_normal(const UV& uv) const;
  Verdict within_box(const std::array<SurfaceCorner, 3>& corners, double most, const Verdict& otherwise) const;
  const Face* face_;
  SurfaceEval eval_;
  BendTree bend_;
  std::array<std::vector<double>, 2> creases_;
  bool is_line_somewhere_ = false;
};

// World units.
inline double longest_side(const SurfaceCorner& a, const SurfaceCorner& b, const SurfaceCorner& c) {
  const Vec3 ab = a.S - b.S, bc = b.S - c.S, ca = c.S - a.S;
  return std::sqrt(std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)}));
}

// Bound of the triangle over three corners in a region that bends like this; `longest`: its longest side, world units.
double bound_in(const BoxBend& bend, const std::array<UV, 3>& uv, double longest);

}  // namespace iso
