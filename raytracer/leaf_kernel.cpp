#include "raytracer/leaf_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raytracer/leaf_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, by its rules.
#include "raytracer/polish-inl.h"

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {

template <int kDegree, int kComponents>
void solve(const PartGeometry& geometry, const LeafPatch& patch, const Leaf& leaf, const LocalRays& rays, Proposal& proposal,
           LeafRoots& roots) {
  const hn::CappedTag<float, kWidth> narrow;
  const hn::CappedTag<double, 8> wide;
  const int pu = patch.piece.patch.pu, pv = patch.piece.patch.pv;
  const LeafBox box = box_of(leaf);
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(narrow))
    if (proposal.certain & lanes_from(first, hn::Lanes(narrow)))
      newton_in_float<kDegree, kComponents>(narrow, &geometry.float_powers[patch.powers], pu, pv, box, rays, first, proposal);
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(wide))
    if (proposal.certain & lanes_from(first, hn::Lanes(wide)))
      polish<kDegree, kComponents>(wide, &geometry.powers[patch.powers], pu, pv, box, rays, first, proposal, roots);
    else
      roots.undecided |= proposal.live & lanes_from(first, hn::Lanes(wide));
}

void roots_of_packet(const PartGeometry& geometry, const Leaf& leaf, const LocalRays& rays, LaneMask lanes, LeafRoots& roots) {
  const hn::CappedTag<float, kWidth> d;
  Proposal proposal;
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(d))
    if (lanes & lanes_from(first, hn::Lanes(d))) test_slab(d, leaf, rays, lanes, first, proposal);
  roots.accepted = roots.undecided = 0;
  roots.missed_slab = lanes & ~proposal.live;
  if (!proposal.certain) {
    roots.undecided = proposal.live;
    return;
  }
  const LeafPatch& patch = geometry.patches[leaf.patch];
  const int pu = patch.piece.patch.pu, pv = patch.piece.patch.pv, degree = pu == pv ? pu : 0;
  if (patch.rational) {
    if (degree == 2) return solve<2, 4>(geometry, patch, leaf, rays, proposal, roots);
    if (degree == 3) return solve<3, 4>(geometry, patch, leaf, rays, proposal, roots);
    return solve<0, 4>(geometry, patch, leaf, rays, proposal, roots);
  }
  if (degree == 2) return solve<2, 3>(geometry, patch, leaf, rays, proposal, roots);
  if (degree == 3) return solve<3, 3>(geometry, patch, leaf, rays, proposal, roots);
  solve<0, 3>(geometry, patch, leaf, rays, proposal, roots);
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace iso {

HWY_EXPORT(roots_of_packet);
void roots_of_packet(const PartGeometry& geometry, const Leaf& leaf, const LocalRays& rays, LaneMask lanes, LeafRoots& roots) {
  HWY_DYNAMIC_DISPATCH(roots_of_packet)(geometry, leaf, rays, lanes, roots);
}

}  // namespace iso
#endif
