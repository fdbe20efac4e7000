// Exact surfaces against Embree's triangles of a fine tessellation: the same rays, in the same run, on one thread, in rounds that take
// turns.
#pragma once

#include "tests/bench/embree_triangles.h"
#include "tests/bench/scenes.h"
#include "tests/bench/timing.h"

namespace iso::bench {

struct MeasureOptions {
  int rounds = 11;
  int rays = 1 << 20;
  double tolerance = 1e-4;  // of the tessellation, as a share of the scene's diagonal
};

// One ray set of one scene.
struct RayRow {
  std::string scene, rays;
  std::size_t count = 0;
  std::size_t direct_hits = 0, triangle_hits = 0;
  std::size_t only_one_hits = 0;   // rays that hit on one side only
  Timing direct_ns, triangles_ns;  // per ray; of the faster build of triangles
  Build triangles_build = Build::medium;
  SolverStats stats;                                                       // of one round
  double newton_per_hit = 0;                                               // mean steps of the hits that Newton found
  double ratio() const { return triangles_ns.median / direct_ns.median; }  // above 1: direct is faster
};

struct TriangleBuild {
  Build build;
  double seconds = 0;
  std::size_t bytes = 0;
};

// What one scene costs before the first ray. All times are CPU time of one thread.
struct BuildRow {
  std::string scene, what;
  double load_seconds = 0, direct_seconds = 0;  // reading the file; leaves and tree
  BuildStats direct;
  std::size_t triangle_count = 0;
  double triangle_error = 0;  // measured, as a share of the diagonal
  double mesh_seconds = 0;    // of a CAD model: Open CASCADE's reading included
  std::vector<TriangleBuild> triangles;
};

struct SceneResult {
  BuildRow build;
  std::vector<RayRow> rows;
};

// `wanted(rays)` says which ray sets are measured. Errors: the model cannot be read or meshed. Breaks off with an ISO_CHECK if a round's
// answer differs from the first one's.
Result<SceneResult> measure(const BenchScene& scene, const MeasureOptions& options, const std::function<bool(const std::string&)>& wanted);

}  // namespace iso::bench
