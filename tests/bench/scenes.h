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
  std::string what;  // one line for the reader
  std::function<Result<TraceScene>()> load;
  // Triangles of the loaded scene; `tolerance` in world units. May throw std::runtime_error.
  std::function<TriangleMesh(const TraceScene& scene, double tolerance)> mesh;
};

std::vector<BenchScene> bench_scenes();

}  // namespace iso::bench
