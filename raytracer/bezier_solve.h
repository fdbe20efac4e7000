// All meets of a ray with one leaf of a rational Bezier patch.
//
// The ray is the meet of two planes; in homogeneous form their two equations f = n . P - d w are polynomials in (s, t).  [Kajiya 1982;
// Martin et al. 2000] Over the leaf the Jacobian of (f, g) differs from that of the linear model by at most the leaf's strays E. If |J0^-1|
// E < 1 the map is one-to-one there: a ray has at most one root, the linear root tells how far off it can be (so most rays end without an
// evaluation), and Newton finds it. Where the certificate fails (grazing rays, silhouettes, poles) the two polynomials themselves are
// subdivided, with the same test on their own coefficients, until every part is empty, certified, or as small as rounding: no root is lost.
#pragma once

#include <vector>

#include "raytracer/leaf.h"
#include "raytracer/local_ray.h"

namespace iso {

struct Root {
  Vec2 st{0.0};  // in the patch's unit square
  double t = 0;
  HitStatus status = HitStatus::converged;
  std::uint16_t steps = 0;
};

// Appends the roots in the leaf (and within rounding of its border), in no order, whatever their t.
void roots_in_leaf(const LeafPatch& patch, const Leaf& leaf, const LocalRay& ray, SolverStats& stats, std::vector<Root>& roots);

}  // namespace iso
