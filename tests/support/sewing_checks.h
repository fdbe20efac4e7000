// What must hold for every part after sewing, looked at from outside: the curves are compared by samples, not by the sewing's own places.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace iso::test {

// What was done, so that a corpus or a generator that does nothing shows.
struct SewingCounts {
  int models = 0, free_edges = 0, joined = 0, split = 0, open = 0, collapsed = 0, shared = 0, compared = 0, triangles = 0;
};

// Sews and meshes the faces that the bytes say (sewing_model.h) and checks: the report's counts agree with the boundary; no edge has more
// uses than the file gave it, or two; loops go on end to end and cover the same curves; edges that were joined lie within the tolerance of
// each other, and are of one solid; open edges within half the tolerance of each other all along are told as joined; the mesh has no
// cracks and keeps its bound; faces in another order give the same. Gives what went wrong first, or an empty text.
std::string run_sewing(std::span<const std::uint8_t> bytes, SewingCounts& counts);

}  // namespace iso::test
