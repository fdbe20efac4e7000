// Uniform grids of triangles over the Bezier pieces of untrimmed faces: the tessellation to compare with where there is no CAD kernel's.
#pragma once

#include "raytracer/trace_scene.h"
#include "tests/bench/triangle_mesh.h"

namespace iso::bench {

// Each piece gets about the coarsest grid (its measured error lies within a twentieth below `tolerance`, where the number of cells allows
// that), so the comparison is not with more triangles than are needed. Neighbours with different grids leave cracks below the tolerance.
// The surface is sampled at the middle and the mid-sides of every triangle. Faces must be untrimmed.
TriangleMesh mesh_uniformly(const TraceScene& scene, double tolerance);

}  // namespace iso::bench
