// How fast the meshes of a comparison come near: the slope of error against width of the triangles, 2 for flat triangles that are made
// well.
#pragma once

#include "raytracer/cmd/compare_report.h"
#include "raytracer/trace_scene.h"

namespace iso {

// The mean height of the triangles over their longest side, weighted by area, on faces that are not planes; world units, 0 without such
// triangles. Where a surface bends one way only triangles are long along the other, and the length of a side tells nothing of the error;
// their width does. Every part of the scene is placed with a mesh.
double mean_width(const TraceScene& scene);

// Of log(root mean square of the distance) against log(width), by least squares over the report's own meshes that have both; 0: they are
// fewer than three, or of one width.
double slope_of(const CompareReport& report);

}  // namespace iso
