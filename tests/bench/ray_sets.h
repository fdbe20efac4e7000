// The rays that are measured, for both sides.
#pragma once

#include "raytracer/tracer.h"
#include "tests/bench/embree_triangles.h"

namespace iso::bench {

struct RaySet {
  std::string name;
  Tracer::Order order = Tracer::Order::coherent;
  std::vector<Ray> direct;
  std::vector<FloatRay> triangles;  // the same rays as the triangles meet them
};

// One ray for the middle of each pixel of a square picture that the framing camera takes, in blocks of 4 x 4 pixels. `count` is rounded to
// such a picture.
RaySet primary_rays(const Tracer& tracer, int count);

// One ray for every primary ray that hits on both sides, in the same order: cosine-distributed about the exact normal that faces the
// viewer. Each side starts at its own hit, a little off it: the exact surface's points lie behind some of the triangles.
RaySet bounce_rays(const Tracer& tracer, const EmbreeTriangles& triangles, const TriangleMesh& mesh, const RaySet& primary);

}  // namespace iso::bench
