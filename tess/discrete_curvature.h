// Mean curvature of triangle meshes at their points, and how far it is from that of the surface there.
//
// Discrete: half the length of K = 1 / (2 A) sum_j (cot a_ij + cot b_ij) (x_i - x_j) over the edges to the neighbours, a and b the angles
// opposite to the edge, A the mixed area: Voronoi's, within obtuse triangles a half or a quarter of theirs [Meyer, Desbrun, Schroeder, Barr
// 2003, 3.3, 3.5; Hettinga 2021, 5.8.3]. Exact: (k1 + k2) / 2. Both 1 / world unit, positive where the surface bends toward its outward
// normal, as Curvatures has it: a sphere of radius r has -1 / r.
//
// The discrete one does not converge at every point of every mesh: only where neighbours lie evenly. That is what it is for here: it shows
// where triangles change their size abruptly.
#pragma once

#include <cstdint>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"

namespace iso {

// A point of a mesh on the surface it was made from.
struct SurfacePlace {
  int face = -1;  // -1: not known
  UV uv{0.0};
  bool inside = false;  // the face, or the patch that the face is a chart of: not on its border
};
// Of the points of a mesh whose nodes have their (u, v): a point of several faces is inside if they are charts of one patch, and it is not
// on its sides.
std::vector<SurfacePlace> places_of(const Part& part, const PartMesh& mesh);

// Of each point; NaN on open edges, without area, and where the triangles around it are no single fan.
std::vector<double> discrete_mean_curvature(const PartMesh& mesh);

// NaN at singular points.
double mean_curvature(const Part& part, const SurfacePlace& place);

struct CurvatureError {
  std::uint64_t points = 0;  // inside, where both are known: others are not measured, since the surface's curvature jumps there
  double max = 0, rms = 0;   // of the difference, over points
  double largest = 0;        // of the surface, by amount
};
CurvatureError curvature_error(const Part& part, const std::vector<double>& discrete, const std::vector<SurfacePlace>& places);

}  // namespace iso
