// Triangles in the plane of a face's parameters: whether they run the right way round, and whether any two overlap. Decided exactly.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

struct DomainOverlap {
  std::vector<std::uint32_t> turned;                      // triangles that do not run the way asked for, or have no area
  std::vector<std::array<std::uint32_t, 2>> overlapping;  // pairs, smaller first, in order, whose interiors have a point in common
  static constexpr std::size_t kMostPairs = 1000;         // of each triangle with later ones; more are not looked for
};

// `way`: 1 if triangles should run counter-clockwise, -1 if clockwise. Triangles without area overlap nothing.
DomainOverlap domain_overlap(std::span<const std::array<UV, 3>> triangles, int way);

}  // namespace iso
