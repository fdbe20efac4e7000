// One leaf of a Bezier patch against the rays of a packet, sixteen at a time.
//
// A ray is the meet of two planes; in homogeneous form their equations f = n . P - d w are polynomials in (s, t).  [Kajiya 1982; Martin et
// al. 2000] Four steps, the first three on all rays that are left:
//
// 1. Proposal (proposal-inl.h), in float. The leaf's slab tells most rays that miss; where the ray crosses its middle gives the parameters
//    of the linear model, and a few Newton steps on the patch bring them next to the root.
// 2. Polish (polish-inl.h), in double. Newton until the next step would be rounding; t from the point on the surface.
// 3. Verdict. Over the leaf and a quarter of its half width beyond, the Jacobian strays little from that of the linear model; how little
//    is known per leaf, and how much it matters to a ray grows with the tangent of its angle to the leaf's normal (FaceCell::tilt). Where
//    Newton's map contracts the plane equations are one-to-one: so a root in the leaf is the only one, and a root in the margin says that
//    the leaf has none.
// 4. A ray that grazes the leaf, for which the certificate fails, meets eight windows of it at a time (grazing-inl.h): each window is
//    missed, or has its own certificate and its own polish, or is divided.
//
// What is left then (roots within kDoubtful of a border, Newton that left the margin, rays that touch the surface to rounding) is decided
// by subdivision, ray by ray (bezier_solve.h).
#pragma once

#include "raytracer/packet.h"

namespace iso {

// Roots of some lanes, one a lane, as the polish leaves them.
struct alignas(64) LeafRoots {
  Lanes<double> s, t;      // in the patch's unit square
  Lanes<double> distance;  // along the local ray, in its t
  Lanes<float> steps;      // Newton steps of the polish
  LaneMask found = 0;      // lanes with a root
  LaneMask none = 0;       // lanes without, proven
  LaneMask turned = 0;     // of those with a root: the determinant of the two plane equations by (s, t) is negative
};

// A part of a patch's unit square.
struct Window {
  Vec2 middle{0.5}, half{0.5};

  Vec2 to_unit(const Vec2& ab) const { return middle + half * ab; }
};

// A leaf's middle about the middle of its patch, and its half widths with their inverses (all powers of two).
struct LeafBox {
  double x, y, half_x, half_y, to_a, to_b;

  Window window() const { return {{x + 0.5, y + 0.5}, {half_x, half_y}}; }
};
LeafBox box_of(const Leaf& leaf);

// Takes what is found. A lane may be called several times.
class RootSink {
 public:
  virtual void missed_slab(LaneMask lanes) = 0;
  virtual void found(const LeafRoots& roots) = 0;
  virtual void undecided(LaneMask lanes, const Window& window) = 0;  // for subdivision

 protected:
  ~RootSink() = default;
};

// Share of a leaf's half width at its border within which a root is left to subdivision.
inline constexpr double kDoubtful = 1e-7;

// `leaving`: lanes whose rays start on the leaf. Where the certificate holds that start is their only meeting with it.
void roots_of_packet(const PartGeometry& geometry, std::uint32_t leaf, const LocalRays& rays, LaneMask lanes, LaneMask leaving,
                     RootSink& sink);

}  // namespace iso
