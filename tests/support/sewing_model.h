// Loose faces read from a string of bytes: what a fuzzer, or a generator, lets the sewing work on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tests/support/loose_faces.h"

namespace iso::test {

// Faces on a lattice of points one `unit` apart, so that many borders run together: rectangles, NURBS with straight borders and random
// knots, quarters of cylinders and of discs, rings. Each lies beside its place by a few shares of the tolerance; each divides its borders
// by itself, into edges that run either way and evenly or not, some of no length.
struct SewingModel {
  LooseFaces faces;
  double unit = 1;
  double tolerance = 0;  // world units, about: the gaps and the places of cuts are multiples of it
  double sew = 0;        // for `join_edges`; 0 where the file states the tolerance
  int shared = 0;        // edges that the file shares, more than two uses included
};

inline constexpr std::size_t kSewingHeader = 1, kPatchBytes = 9, kMostPatches = 16;

// One byte says tolerance, scale and rotation, nine each say one patch; what is left over is not read. Any bytes are valid.
SewingModel sewing_model(std::span<const std::uint8_t> bytes);

std::vector<std::uint8_t> random_sewing_bytes(std::uint64_t seed);

}  // namespace iso::test
