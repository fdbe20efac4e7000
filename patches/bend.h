// Bounds of a surface's second derivatives over boxes of its parameter plane: what decides how far flat triangles are from it.
#pragma once

#include <vector>

#include "patches/surface/surface.h"

namespace iso {

// Proven for all points of a box of (u, v).
struct Bend {
  Range uu, uv, vv;                  // of n . Suu, n . Suv, n . Svv, with n = Su x Sv / |Su x Sv|; [-inf, inf] where n has no bound
  double Muu = 0, Muv = 0, Mvv = 0;  // suprema of |Suu|, |Suv|, |Svv|; infinite across a knot where the tangent jumps
  double curvature = 0;              // supremum of the absolute normal curvature; infinite at poles and other singular points

  void include(const Bend& other);
};

// Divides the domain once, until the bounds of a cell are tight (the spread of each range small against its largest magnitude in it), then
// answers for any box.
class BendTree {
 public:
  BendTree(const AnySurface& surface, const Box2& domain);

  // Of the part of `uv` that lies in the domain (widened by rounding); `uv` may reach beyond it by rounding only.
  Bend over(const Box2& uv) const;

  // Knots inside the domain where the first derivative jumps, per direction, rising.
  const std::vector<double>& creases_u() const { return creases_u_; }
  const std::vector<double>& creases_v() const { return creases_v_; }

 private:
  std::vector<double> creases_u_, creases_v_;
};

}  // namespace iso
