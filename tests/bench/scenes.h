// The models that are measured: all from the source tree, the package occt-misc, or made here.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "patches/base/result.h"
#include "raytracer/trace_scene.h"
#include "tests/bench/triangle_mesh.h"

namespace iso::bench {

struct BenchScene {
  std::string name;
  std::string what;                // one line for the reader
  std::vector<std::string> rays;   // what is measured, see kRaySets
  std::vector<double> tolerances;  // of the tessellations, shares of the diagonal, falling; a quick run takes the first one only
  std::function<Result<TraceScene>()> load;
  // Triangles of the loaded scene; `tolerance` in world units. May throw std::runtime_error.
  std::function<TriangleMesh(const TraceScene& scene, double tolerance)> mesh;
  std::string file;  // read from here, if not empty
};

// Everything that is measured of scenes: rays, and what is made of them (direct_versus_triangles.h).
inline const std::vector<std::string> kRaySets{"primary",    "bounce",      "room",   "scattered",    "occlusion",   "build-grid",
                                               "build-high", "first-image", "memory", "primary-avx2", "bounce-avx2", "two-threads"};

std::vector<BenchScene> bench_scenes();

}  // namespace iso::bench
