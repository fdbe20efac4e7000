// Bounds of a surface's second derivatives over boxes of its parameter plane: what decides how far flat triangles are from it
// [Filip et al. 1986], [Safko 2022, 4.2; the printed 2/9 is not the sharp factor: S - L = -1/2 sum_{i<j} l_i l_j d_ij^T S'' d_ij, whose
// weights sum to 1/3 at most].
#pragma once

#include <cstdint>
#include <vector>

#include "patches/surface/surface.h"

namespace iso {

// Proven for all points of a box of (u, v) where Su x Sv does not vanish.
struct Bend {
  Range uu, uv, vv;                  // of n . Suu, n . Suv, n . Svv, with n = Su x Sv / |Su x Sv|; [-inf, inf] where n has no bound
  double Muu = 0, Muv = 0, Mvv = 0;  // suprema of |Suu|, |Suv|, |Svv|; infinite across a crease
  double curvature = 0;              // supremum of the absolute normal curvature; infinite at poles and other singular points

  void include(const Bend& other);
};

// What `over` returns: also the sums of the jumps |S+ - S-| of Su, of Sv, over the knots strictly inside the box where the tangent plane is
// continuous and only the parametrisation has a kink: common where exporters chain spans with G1. S'' knows nothing of a jump: S - L gains
// up to (kink_u du + kink_v dv) / 4 for a triangle of the extents (du, dv), tangentially at the knots, so that along a normal of a point of
// the triangle it counts only by the sine of the angle between that normal and those at the knots.
struct BoxBend : Bend {
  double kink_u = 0, kink_v = 0;
  // All this is of a surface that S is no farther from than half of this (distance_of_pieces): S - L is that much more.
  double apart = 0;
};

// A knot where the first derivative across it jumps.
struct KnotJump {
  double at = 0, size = 0;
  bool crease = false;  // the tangent plane jumps too
};

// A bound times an extent: of no extent nothing counts, not even infinity.
inline double times(double bound, double extent) { return extent == 0 ? 0.0 : bound * extent; }

// |d^T S'' d| for a step d of (u, v), at most.
inline double second_difference(const Bend& bend, const Vec2& d) {
  return times(bend.Muu, d.x * d.x) + times(2 * bend.Muv, std::abs(d.x * d.y)) + times(bend.Mvv, d.y * d.y);
}

// How far S strays from its linear interpolation over a box of this extent, at most, because its first derivative jumps, and because the
// bounds are of a surface beside it.
inline double kink_stray(const BoxBend& bend, const Vec2& extent) {
  return 0.25 * (times(bend.kink_u, extent.x) + times(bend.kink_v, extent.y)) + bend.apart;
}

// Divides the domain once, until the bounds of a cell are tight (the spread of each range small against its largest magnitude in it), then
// answers for any box: with the hull over the cells that the box meets. Planes, cylinders, cones, spheres, tori, and extrusions of lines
// and conics need no cells: their bounds are closed forms of the box itself, exact but for rounding.
//
// Bounds hold for the exact surface of these numbers; they are widened by the rounding of their own evaluation. A smooth surface across a
// border of spans where only S'' jumps counts as both spans. At a singular point (pole, collapsed side) NURBS and revolutions answer with
// infinite ranges and curvature, but finite M; so do cones and spindle tori for boxes that cross the apex, where n turns over.
class BendTree {
 public:
  // `domain` is finite; what lies beyond a NURBS's own domain is continued by its end spans. `tolerance` (world units; 0: a ten thousandth
  // of the surface's size): cells that bend much less than it are not divided, since triangles will be larger than they.
  BendTree(const AnySurface& surface, const Box2& domain, double tolerance = 0);

  // Of the part of `uv` that lies in the domain (widened by rounding); `uv` may reach beyond it by rounding only. A box that reaches across
  // a knot by rounding only lies on one side of it. May be called by many threads.
  BoxBend over(const Box2& uv) const;

  // A part of the tree from which boxes inside its cell are answered faster.
  struct Place {
    std::int32_t node = 0;
    Box2 cell;
  };
  // The smallest cell that holds the box.
  Place place_of(const Box2& uv) const;
  // As above, and the same answer; boxes that reach beyond the cell are allowed and gain nothing.
  BoxBend over(const Box2& uv, const Place& place) const;

  // Knots inside the domain where the tangent plane jumps, per direction, rising.
  const std::vector<double>& creases_u() const { return creases_u_; }
  const std::vector<double>& creases_v() const { return creases_v_; }

  // How many cells the domain was divided into; 0 for closed forms.
  std::size_t cells() const { return (nodes_.size() + 1) / 2; }

 private:
  friend class BendTreeBuilder;

  enum class Cut : std::uint8_t { none, smooth, knot, crease };
  // The low child follows its parent; leaves have no cut.
  struct Node {
    Bend bend;
    double at = 0;
    std::int32_t high = -1;
    Cut cut = Cut::none;
    std::uint8_t direction = 0;
  };
  static_assert(sizeof(Node) <= 96);

  double kinks(int direction, const Box2& uv) const;
  void gather(std::int32_t node, Box2 cell, const Box2& uv, Bend& sum) const;

  AnySurface closed_form_;  // where there are no nodes
  Box2 domain_;
  double apart_ = 0;
  Vec2 touch_{0.0};  // closer than this to a knot is on it
  std::vector<Node> nodes_;
  std::vector<KnotJump> jumps_[2];  // rising
  std::vector<double> creases_u_, creases_v_;
};

}  // namespace iso
