// Exact surfaces against Embree's triangles of a fine tessellation: the same rays, in the same run, on one thread, in rounds that take
// turns.
#pragma once

#include "tests/bench/contest.h"
#include "tests/bench/scenes.h"

namespace iso::bench {

struct MeasureOptions {
  int rounds = 5;
  int rays = 1 << 20;
  bool quick = false;  // the coarsest tessellation only
};

struct TriangleBuild {
  Build build;
  Timing seconds;
  std::size_t bytes = 0;
};

// What one scene costs before the first ray. All times are CPU time of one thread.
struct BuildRow {
  std::string scene, what;
  double load_seconds = 0;
  Timing direct_seconds;  // of leaves and tree, from the parsed model
  BuildStats direct;
  double tolerance = 0, triangle_error = 0, usual_error = 0;  // as in Row
  std::size_t triangle_count = 0;
  double mesh_seconds = 0;
  std::vector<TriangleBuild> triangles;
};

struct SceneResult {
  std::vector<BuildRow> builds;  // one per tolerance
  std::vector<Row> rows;
};

// `wanted(rays)` says which of kRaySets are measured. Errors: the model cannot be read or meshed.
Result<SceneResult> measure(const BenchScene& scene, const MeasureOptions& options, const std::function<bool(const std::string&)>& wanted);

}  // namespace iso::bench
