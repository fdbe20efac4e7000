// Rays against exact surfaces: arrays of rays in, arrays of hits out. The only interface between the renderer and Embree.
//
// A hit is (instance, face, u, v, t) in double; everything else is evaluated from it. Rays may have directions of any finite length but
// zero; t counts in directions. Results do not depend on how rays are batched, nor on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "raytracer/trace_scene.h"

namespace iso {

struct Ray {
  Vec3 o, d;
  double tmin = 0, tmax = kInf;
  // Of the hit it leaves (`secondary_ray`; -1: of none): what cannot be met again from there is passed over.
  std::int32_t from_placed = -1, from_primitive = -1;
};

// How a hit was found; every value but `converged` is counted and shown.
enum class HitStatus : std::uint8_t {
  converged,  // closed form, or Newton with a certificate that the root is the only one in its leaf
  fallback,   // found by subdivision, then Newton
  tangent,    // subdivision ended at rounding level without a simple root: the ray touches the surface here
};

struct Hit {
  double t = kInf;
  UV uv{0.0};
  std::int32_t placed = -1;  // index into TraceScene::placed; -1: no hit
  std::int32_t face = -1;    // index into Part::faces
  HitStatus status = HitStatus::converged;
  bool by_tolerance = false;    // outside the trim loops, but within the gap of an edge
  std::uint16_t steps = 0;      // Newton steps or subdivision cells spent on it
  std::int32_t primitive = -1;  // of the tracer; for `secondary_ray`

  explicit operator bool() const { return placed >= 0; }
};

struct SolverStats {
  std::uint64_t rays = 0, leaf_visits = 0, slab_rejects = 0, solves = 0, newton_steps = 0, analytic = 0, trim_queries = 0;
  std::uint64_t fallbacks = 0, fallback_cells = 0, fallback_out_of_budget = 0, tangent = 0, by_tolerance = 0;

  SolverStats& operator+=(const SolverStats& other);
};

// A hit's surroundings in world coordinates. `n` is the unit outward normal of the face (not turned toward the ray).
struct SurfacePoint {
  Vec3 p, n, Su, Sv;
  double k1, k2;       // principal curvatures with respect to n, per world unit; NaN at singular points
  double error_bound;  // world units: how far p may be from the true surface by rounding; secondary rays start this far off
};

struct BuildStats {
  std::uint64_t bezier_patches = 0, leaves = 0, analytic_faces = 0, bytes = 0;
  double seconds = 0;
};

class Tracer {
 public:
  // `device`: Embree's own configuration, "isa=avx2" say; hits do not depend on it.
  explicit Tracer(TraceScene scene, const std::string& device = {});
  ~Tracer();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;

  const TraceScene& scene() const;
  const BuildStats& build_stats() const;

  // The nearest hit of each ray in [tmin, tmax]; hits.size() == rays.size(). `coherent`: neighbours in the array are neighbours in space.
  enum class Order { coherent, scattered };
  void nearest(std::span<const Ray> rays, std::span<Hit> hits, Order order, SolverStats& stats) const;

  // 1 where anything is hit in [tmin, tmax].
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked, Order order, SolverStats& stats) const;

  // All hits of each ray, sorted by t, duplicates at leaf borders and seams removed: hits of ray i are [offsets[i], offsets[i + 1]).
  void all(std::span<const Ray> rays, std::vector<Hit>& hits, std::vector<std::size_t>& offsets, SolverStats& stats) const;

  SurfacePoint surface_point(const Hit& hit) const;
  const Face& face(const Hit& hit) const;

  // Whether two hits lie on faces that share an edge with a gap, both so near to it that they may be one crossing met twice.
  bool meet_at_loose_edge(const Hit& a, const Hit& b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A ray that leaves a hit (`at` is its surface_point) on the side of `direction`: it starts at p moved along the normal by the error bound.
Ray secondary_ray(const Hit& hit, const SurfacePoint& at, const Vec3& direction, double tmax = kInf);

}  // namespace iso
