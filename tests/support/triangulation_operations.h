// A triangulation driven by a string of bytes, and what it should be, kept in a slow way beside it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tess/triangulation.h"

namespace iso::test {

// What was done, so that a corpus or a generator that does nothing shows.
struct OperationCounts {
  int inserted = 0, met_again = 0, constrained = 0, refused = 0, swapped = 0, marked = 0;
};

// Reads the bytes as operations on a grid of 16 x 16 points, some of them a last place beside the grid, and checks after each that the
// triangulation is sound and holds what it was told. Three bytes are one operation: what, and its two arguments. Gives what went wrong
// first, or an empty text.
std::string run_triangulation_operations(std::span<const std::uint8_t> bytes, OperationCounts& counts);

// Bytes with much insertion at first and many constraints later.
std::vector<std::uint8_t> random_triangulation_operations(std::uint64_t seed);

}  // namespace iso::test
