// One leaf of a Bezier patch against the rays of a packet, sixteen at a time.
//
// A ray is the meet of two planes; in homogeneous form their equations f = n . P - d w are polynomials in (s, t).  [Kajiya 1982; Martin et
// al. 2000] Three steps, each on all rays that are left:
//
// 1. Proposal (proposal-inl.h), in float. The leaf's slab tells most rays that miss; where the ray crosses its middle gives the parameters
//    of the linear model, and a few Newton steps on the patch bring them next to the root.
// 2. Polish (polish-inl.h), in double. Newton until the next step would be rounding; t from the point on the surface.
// 3. Verdict. Over the leaf and a quarter of its half width beyond, the Jacobian differs from that of the linear model by at most the
//    strays E of its derivatives. For a ray at an angle with cosine c to the leaf's normal |J0^-1| E <= FaceCell::bend / c; below one the
//    map is one-to-one there. So a root in the leaf is the only one, and a root in the margin says that the leaf has none. What this does
//    not decide (grazing rays, roots within kDoubtful of the border, Newton that left the margin) is undecided: left to subdivision
//    (bezier_solve.h), which decides everything.
#pragma once

#include "raytracer/packet.h"

namespace iso {

struct alignas(64) LeafRoots {
  Lanes<double> s, t;      // in the patch's unit square
  Lanes<double> distance;  // along the local ray, in its t
  Lanes<float> steps;      // Newton steps of the polish
  LaneMask accepted = 0;   // lanes with one root
  LaneMask undecided = 0;  // lanes for subdivision
  LaneMask missed_slab = 0;
};

// Share of a leaf's half width at its border within which a root is left to subdivision.
inline constexpr double kDoubtful = 1e-7;

void roots_of_packet(const PartGeometry& geometry, const Leaf& leaf, const LocalRays& rays, LaneMask lanes, LeafRoots& roots);

}  // namespace iso
