#include "raytracer/leaf_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raytracer/leaf_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, by its rules.
#include "raytracer/grazing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {

template <int kDegree, int kComponents>
void solve(const PartGeometry& geometry, std::uint32_t index, const LocalRays& rays, Proposal& proposal, RootSink& sink) {
  const hn::CappedTag<float, kWidth> narrow;
  const hn::CappedTag<double, 8> wide;
  const Leaf& leaf = geometry.leaves[index];
  const LeafPatch& patch = geometry.patches[leaf.patch];
  const int pu = patch.piece.patch.pu, pv = patch.piece.patch.pv;
  const LeafBox box = box_of(leaf);
  LeafRoots roots;
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(narrow))
    if (proposal.certain & lanes_from(first, hn::Lanes(narrow)))
      newton_in_float<kDegree, kComponents>(narrow, &geometry.float_powers[patch.powers], pu, pv, box, rays, first, proposal);
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(wide))
    if (proposal.certain & lanes_from(first, hn::Lanes(wide)))
      polish_lanes<kDegree, kComponents>(wide, &geometry.powers[patch.powers], pu, pv, box, rays, first, proposal, roots);
  if (roots.found) sink.found(roots);
  for_each_lane(proposal.live & ~(roots.found | roots.none), [&](int lane) {
    GrazingRay<kDegree, kComponents>(geometry.curls[index], &geometry.powers[patch.powers], pu, pv, box, rays, lane, sink).run();
  });
}

void meet_packet(const PartGeometry& geometry, std::uint32_t index, const LocalRays& rays, LaneMask lanes, LaneMask leaving,
                 RootSink& sink) {
  const Leaf& leaf = geometry.leaves[index];
  const hn::CappedTag<float, kWidth> d;
  Proposal proposal;
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(d))
    if (lanes & lanes_from(first, hn::Lanes(d))) test_slab(d, leaf, rays, lanes, first, proposal);
  proposal.live &= ~(leaving & proposal.certain);
  proposal.certain &= ~leaving;
  sink.missed_slab(lanes & ~proposal.live);
  if (!proposal.live) return;
  const LeafPatch& patch = geometry.patches[leaf.patch];
  if (patch.powers == LeafPatch::kNoPowers) return sink.undecided(proposal.live, window_of(leaf));
  const int pu = patch.piece.patch.pu, pv = patch.piece.patch.pv, degree = pu == pv ? pu : 0;
  if (patch.rational) {
    if (degree == 2) return solve<2, 4>(geometry, index, rays, proposal, sink);
    if (degree == 3) return solve<3, 4>(geometry, index, rays, proposal, sink);
    return solve<0, 4>(geometry, index, rays, proposal, sink);
  }
  if (degree == 2) return solve<2, 3>(geometry, index, rays, proposal, sink);
  if (degree == 3) return solve<3, 3>(geometry, index, rays, proposal, sink);
  solve<0, 3>(geometry, index, rays, proposal, sink);
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace iso {

HWY_EXPORT(meet_packet);
void roots_of_packet(const PartGeometry& geometry, std::uint32_t leaf, const LocalRays& rays, LaneMask lanes, LaneMask leaving,
                     RootSink& sink) {
  HWY_DYNAMIC_DISPATCH(meet_packet)(geometry, leaf, rays, lanes, leaving, sink);
}

Window window_of(const Leaf& leaf) {
  const Vec2 half{0.5 / static_cast<double>(1u << leaf.level[0]), 0.5 / static_cast<double>(1u << leaf.level[1])};
  return {Vec2{(leaf.corner >> 16) / kLeafGrid, (leaf.corner & 0xffffu) / kLeafGrid} + half, half};
}

}  // namespace iso
#endif
