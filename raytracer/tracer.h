// Rays against exact surfaces: arrays of rays in, arrays of hits out. The only interface between the renderer and Embree.
//
// A hit is (instance, face, u, v, t) in double; everything else is evaluated from it. Parts that are placed with a mesh are met by its
// triangles instead: Embree says which one a ray passes, the rest is double too (see triangle_hits.h). Rays may have directions of any
// finite length but zero; t counts in directions. Results do not depend on how rays are batched, nor on the number of threads.
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
  std::int32_t primitive = -1;  // of the tracer, for `secondary_ray`; on a mesh, index into PartMesh::triangles
  glm::vec2 weights{0.0f};      // on a mesh: of the triangle's second and third corner; u and v are interpolated

  explicit operator bool() const { return placed >= 0; }
};

struct SolverStats {
  std::uint64_t rays = 0, leaf_visits = 0, slab_rejects = 0, solves = 0, newton_steps = 0, analytic = 0, trim_queries = 0;
  std::uint64_t fallbacks = 0, fallback_cells = 0, fallback_out_of_budget = 0, tangent = 0, by_tolerance = 0;

  SolverStats& operator+=(const SolverStats& other);
};

// A hit's surroundings in world coordinates. `n` is the unit outward normal of the face (not turned toward the ray).
//
// On a mesh, p lies on the triangle and n is for shading: interpolated from the exact normals of the nodes (the triangle's own where a node
// has none or where they contradict the triangle), or the triangle's own, as TraceScene::mesh_shading says. Su and Sv belong to the
// triangle: the derivatives of p in the interpolated (u, v), zero if its nodes lie on a line there.
struct SurfacePoint {
  Vec3 p, n, Su, Sv;
  double k1, k2;       // principal curvatures with respect to n, per world unit; NaN at singular points and on a mesh
  double error_bound;  // world units: how far p may be from the true surface (the triangle) by rounding; secondary rays start this far off
  Vec3 ng;             // unit outward normal of what was met: n, or the triangle's
  Vec3 side;           // what tells on which side a direction leaves: ng; n where a mesh's terminator is softened
  Vec3 lift_out{0.0}, lift_in{0.0};  // how far secondary rays are moved for a soft terminator, outside and inside
};

struct BuildStats {
  std::uint64_t bezier_patches = 0, leaves = 0, analytic_faces = 0, triangles = 0, bytes = 0;
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

  // Of the exact surface at (u, v), in world units, also for a hit on a mesh; NaN at singular points.
  Curvatures curvatures(const Hit& hit) const;

  // How the normal turns on the exact surface at (u, v), also for a hit on a mesh: dn = -S dp in world coordinates; see
  // iso::shape_operator.
  Mat3 shape_operator(const Hit& hit) const;

  const Face& face(const Hit& hit) const;

  // Whether two hits lie on faces that share an edge with a gap, both so near to it that they may be one crossing met twice.
  bool meet_at_loose_edge(const Hit& a, const Hit& b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A ray that leaves a hit (`at` is its surface_point) on the side of `direction`: it starts at p moved along the normal by the error bound,
// and by `lift_out` or `lift_in`. A triangle is not met again by the rays that leave it, but by those that are on the outside by `side` and
// go under it.
Ray secondary_ray(const Hit& hit, const SurfacePoint& at, const Vec3& direction, double tmax = kInf);

}  // namespace iso
