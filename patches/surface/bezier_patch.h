// Rational tensor-product Bezier patches on [0, 1]^2, and the exact decomposition of every native surface into them.
// They are what rays meet: polynomial in homogeneous form, inside the hull of their net (all weights positive), cheap to split.
#pragma once

#include <vector>

#include "patches/surface/surface.h"

namespace iso {

// net[i * (pv + 1) + j]: homogeneous control points, i along s.
struct BezierPatch {
  int pu = 0, pv = 0;
  std::vector<Vec4> net;

  const Vec4& at(int i, int j) const { return net[static_cast<std::size_t>(i) * (pv + 1) + j]; }
  Vec4& at(int i, int j) { return net[static_cast<std::size_t>(i) * (pv + 1) + j]; }
};

// A patch with the closed-form maps from its unit square to the native (u, v) of its surface; both rise.
struct BezierPiece {
  BezierPatch patch;
  ParamMap u, v;

  UV to_native(const Vec2& st) const { return {u.to_native(st.x), v.to_native(st.y)}; }
  Box2 native_box() const { return {{u.a, v.a}, {u.b, v.b}}; }
};

// Homogeneous value and first derivatives.
struct HomogeneousJet {
  Vec4 H{0.0}, Hs{0.0}, Ht{0.0};
};
HomogeneousJet homogeneous_jet(const BezierPatch& patch, const Vec2& st);

// The part over the box [lo, hi], which may reach beyond the unit square (weights may then fall to zero or below).
BezierPatch part_of(const BezierPatch& patch, const Vec2& lo, const Vec2& hi);

// The halves of a patch, in s (direction 0) or t (direction 1). One of them may be the patch itself.
void split_in_half(const BezierPatch& patch, int direction, BezierPatch& low, BezierPatch& high);

Box3 hull_box(const BezierPatch& patch);

// The pieces of a surface that cover the finite box `uv`, clipped to it (a NURBS at its knots, angles in quarter turns at most).
std::vector<BezierPiece> bezier_pieces(const AnySurface& surface, const Box2& uv);

}  // namespace iso
