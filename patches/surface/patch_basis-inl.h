// The weights of every patch kind, once, generic over their number type T: it needs a default constructor, one from double, arithmetic
// among T and with doubles, `blend` and `share` (kinds/domain-inl.h), and for mean value coordinates `sqrt`, and `where_positive` unless it
// holds ranges. Only for the sources that need another T than double and Dual2 (patch_basis.h). The order of the points is told with each
// kind.
#pragma once

#include "patches/surface/kinds/bezier_triangle-inl.h"
#include "patches/surface/kinds/charrot_gregory-inl.h"
#include "patches/surface/kinds/generalised-inl.h"
#include "patches/surface/kinds/gregory-inl.h"

namespace iso {

// So near the corner, mean value coordinates are those of the corner itself: products of distances would be less than numbers go down to.
inline bool is_corner_by_mean_value(const PatchBasis& basis, const Vec2& st) {
  return basis.parameters == SideParameters::mean_value && std::max(std::abs(st.x), std::abs(st.y)) < 1e-50;
}

// The weights at (s, t) in the chart of corner 0. With mean value coordinates not at the corner itself.
template <class T>
void patch_weights(const PatchBasis& basis, const T& s, const T& t, T* W) {
  if (basis.kind == PatchKind::gregory_quad) return gregory_quad_weights(s, t, W);
  const DomainPoint<T> x = domain_point_in(basis.sides, s, t);
  switch (basis.kind) {
    case PatchKind::bezier_triangle:
      return bezier_triangle_weights(basis.degree, x, W);
    case PatchKind::gregory_triangle:
      return gregory_triangle_weights(x, W);
    case PatchKind::gregory_quad:
      return;
    case PatchKind::generalised_bezier:
      return generalised_bezier_weights(basis.degree, x, basis.parameters, W);
    case PatchKind::generalised_gregory:
      return generalised_gregory_weights(x, basis.parameters, W);
    case PatchKind::charrot_gregory:
      return charrot_gregory_weights(x, basis.parameters, W);
  }
}

}  // namespace iso
