// Rays against patches with any number of sides, beside bicubic Bezier patches of the same size: each row covers the unit sphere with about
// as many patches, and meets the same primary rays from the same eye. One thread, CPU time, medians of interleaved rounds.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/timing.h"

namespace iso::bench {

struct PatchRays {
  std::string name;
  int patches = 0, hits = 0;
  double proven = 0;      // the largest distance of a chart from its spline
  double build = 0;       // seconds: charts, and the tracer
  Timing nanoseconds;     // a ray
  double of_bicubic = 0;  // time over that of the first row
  double megabytes = 0;
};

// The first row is the bicubic one.
std::vector<PatchRays> measure_patch_rays(int rays, int rounds);

}  // namespace iso::bench
