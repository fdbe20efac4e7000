// The rays that are measured, for both sides.
#pragma once

#include "raytracer/tracer.h"
#include "tests/bench/embree_triangles.h"

namespace iso::bench {

struct RaySet {
  std::string name;
  Tracer::Order order = Tracer::Order::coherent;
  bool occlusion = false;   // asked whether, not where
  bool incoherent = false;  // though neighbours start near each other: the triangles may take single rays
  std::vector<Ray> direct;
  std::vector<FloatRay> triangles;  // the same rays as the triangles meet them
};

// One ray for the middle of each pixel of a square picture that the framing camera takes, in blocks of 4 x 4 pixels. `count` is rounded to
// such a picture.
RaySet primary_rays(const Tracer& tracer, int count);

// Secondary rays start at the primary rays that hit on both sides, in the same order. Each side starts at its own hit, a little off it: the
// exact surface's points lie behind some of the triangles.
class SecondaryRays {
 public:
  // `triangles` are those of `mesh`, not its grids.
  SecondaryRays(const Tracer& tracer, const EmbreeTriangles& triangles, const TriangleMesh& mesh, const RaySet& primary);

  RaySet bounce() const;     // cosine-distributed about the exact normal that faces the viewer
  RaySet room() const;       // about the opposite normal: inside a closed surface every ray hits
  RaySet scattered() const;  // `room` in random order
  RaySet occlusion() const;  // toward a light as far away as the scene is large, where it is above the horizon on both sides

 private:
  struct Start {
    Hit hit;
    SurfacePoint exact;
    Vec3 n;                   // faces the viewer
    Vec3 p, triangle_normal;  // of the triangle that is hit
    std::uint32_t ray;
  };
  void add(RaySet& set, const Start& start, const Vec3& d, double tmax) const;
  RaySet cosine_rays(const char* name, double side) const;

  Box3 box_;
  std::vector<Start> starts_;
};

}  // namespace iso::bench
