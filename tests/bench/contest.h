// Contests over arrays of rays: the exact surfaces and the builds of triangles take turns.
//
// The rule of modes, fixed beforehand: direct goes through the rays in packets of 16, but through scattered ones singly. Triangles go
// through coherent sets (primary, occlusion) in packets, through scattered ones singly, and through bounce and room both ways: the better
// one counts.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/ray_sets.h"
#include "tests/bench/timing.h"

namespace iso::bench {

// What the figures of a row are.
enum class Unit { ns_per_ray, ns, bytes };

// One build of triangles, gone through in one mode.
struct Opponent {
  Build build = Build::medium;
  Mode mode = Mode::packets;
  Timing figure;
  std::size_t hits = 0;
};

struct Row {
  std::string scene, rays;
  double tolerance = 0;                         // of the tessellation, as a share of the scene's diagonal: what it was asked for,
  double triangles_error = 0, usual_error = 0;  // and measured: the largest, and of all triangles but one in a hundred
  Unit unit = Unit::ns_per_ray;
  Timing direct, triangles;  // `triangles`: of the best opponent
  std::string triangles_build, triangles_mode;
  double ratio() const { return triangles.median / direct.median; }  // above 1: direct is better

  // Of rays only.
  std::size_t count = 0;
  std::size_t direct_hits = 0, triangle_hits = 0;
  std::size_t only_one_hits = 0;  // rays that hit on one side only
  SolverStats stats;              // of one round
  double newton_per_hit = 0;      // mean steps of the hits that Newton found
  std::vector<Opponent> opponents;
};

// Breaks off with an ISO_CHECK if a round's answer differs from the first one's.
Row contest(const RaySet& set, const Tracer& tracer, const std::vector<EmbreeTriangles>& triangles, int rounds);

// The first half of the rays on one thread and the second on another, against all on one; wall clock.
Row two_threads_against_one(const RaySet& set, const Tracer& tracer, int rounds);

}  // namespace iso::bench
