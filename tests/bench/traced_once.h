// One set of rays, traced once: for profilers that count instructions and cache misses (reference/bench/counts.py).
#pragma once

#include <cstddef>
#include <string>

#include "patches/base/result.h"
#include "tests/bench/embree_triangles.h"
#include "tests/bench/scenes.h"

namespace iso::bench {

struct OnceOptions {
  std::string rays = "primary";  // primary, bounce, room, scattered or occlusion
  double tolerance = 1e-4;       // of the tessellation, a share of the diagonal
  int count = 1 << 16;           // primary rays
};

// How many rays there were, and how many of them hit. Both sides trace within `collected`, a function that is never inlined, the direct
// side as the mode rule of contest.h says; the triangles, too, but bounce and room singly. Errors: no such rays, or the model cannot be
// read.
struct Once {
  std::size_t rays = 0, hits = 0;
};
Result<Once> trace_directly_once(const BenchScene& scene, const OnceOptions& options);
Result<Once> trace_triangles_once(const BenchScene& scene, const OnceOptions& options, Build build);

}  // namespace iso::bench
