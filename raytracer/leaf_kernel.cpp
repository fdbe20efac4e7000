#include "raytracer/leaf_kernel.h"

#include <bit>

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
  if (patch.powers == LeafPatch::kNoPowers) return sink.undecided(proposal.live, box_of(leaf).window());
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

LeafBox box_of(const Leaf& leaf) {
  const auto power_of_two = [](int exponent) { return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52); };
  LeafBox box;
  box.half_x = power_of_two(-1 - leaf.level[0]);
  box.half_y = power_of_two(-1 - leaf.level[1]);
  box.to_a = power_of_two(1 + leaf.level[0]);
  box.to_b = power_of_two(1 + leaf.level[1]);
  box.x = (leaf.corner >> 16) * (1 / kLeafGrid) + box.half_x - 0.5;
  box.y = (leaf.corner & 0xffffu) * (1 / kLeafGrid) + box.half_y - 0.5;
  return box;
}

}  // namespace iso
#endif
