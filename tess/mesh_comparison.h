// A triangle mesh of any origin against the exact faces of a model: distances both ways by closest points, normals, coverage, topology, and
// what is wrong with it, by name.
//
// The faces are held as a proven mesh of our own (tessellate.h), fine enough for what is to be measured; closest points are found on it and
// polished on the exact surface by Newton. `max` is attained at a point. `bound` is proven: pieces of a triangle are compared with single
// triangles of the other mesh, from which the distance is convex, so that its largest value is at the pieces' corners; to that comes the
// distance of our own mesh from the surface, `reference_bound`.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"
#include "tess/exact_faces.h"
#include "tess/verify.h"

namespace iso {

// World units; mean, rms and the 99.9 percentile are over area, from samples.
struct OneSided {
  double max = 0, mean = 0, rms = 0, p999 = 0;
  double bound = 0;  // no point is farther
  Point3 at{0.0};    // where `max` was found
  double area = 0;   // that was measured
};

struct FaceComparison {
  int placed = -1, face = -1;    // which exact face
  std::uint64_t triangles = 0;   // of the mesh that lie nearest to it
  double area = 0, covered = 0;  // of the face, and of those triangles
  double inward = 0;             // the area of those of them that show their back outside
  OneSided to_surface, to_mesh;  // of those triangles from the faces; of the face from the mesh
  // Radians, between the triangles and the surface under their middles, and near their corners where it does not turn its back there: that
  // may be another sheet of the face, or a rounding tighter than the triangle, and is not told apart.
  double worst_angle = 0, mean_angle = 0;
  Point3 worst_angle_at{0.0};
  TriangleShapes shapes;
  std::uint64_t open_edges = 0;

  double worst() const { return std::max(to_surface.max, to_mesh.max); }
};

// What is wrong with a mesh. The first of them decide what is said first.
enum class MeshFault {
  unit,               // it is larger or smaller than the model by the ratio of two units
  size,               // by another ratio
  placement,          // it has the model's size, but stands elsewhere or turned
  missing_face,       // a face, or a part of it, without mesh near it
  foreign_triangles,  // triangles without surface near them
  inside_out,         // all of it shows its back
  turned_face,        // all of a face does
  turned_triangles,   // some triangles do
  far_points,         // points far off the surface among points on it
  doubled_triangles,
  zero_area,
  open_edges,  // where the model is closed
  non_manifold,
};
const char* name_of(MeshFault fault);  // "missing-face"

struct FaultFound {
  MeshFault fault = MeshFault::unit;
  std::uint64_t count = 0;
  std::string text;  // one sentence, with figures and place
  Point3 at{0.0};
  int placed = -1, face = -1;  // -1: of no face
  double ratio = 0;            // unit, size: the mesh's size over the model's
  std::string unit;            // unit: the one the mesh seems to be in
};

struct MeshComparison {
  std::vector<FaceComparison> faces;  // of all placed parts, in order
  FaceComparison all;
  int worst_face = -1, worst_angle_face = -1;  // index into `faces`; -1: none
  TopologyReport topology;
  double widest_gap = 0;         // of the mesh: the largest distance of an open edge from the next one, where the model is closed
  std::uint64_t free_edges = 0;  // open edges where the model itself ends
  std::vector<FaultFound> faults;
  std::uint64_t unmeasured_faces = 0;  // that our own mesh lacks: nothing is known of them
  double reference_bound = 0;          // how far our own mesh may be from the surface: bounds are right to this
  double model_gap = 0;                // how far the model's own edges are off their faces
  std::uint64_t reference_triangles = 0;
  double seconds = 0;
};

struct ComparisonSettings {
  std::string unit;      // of the model, may be empty
  double reference = 0;  // world units: how fine our own mesh is to be; 0: as the mesh asks for
};

// `progress` hears shares of the work, 0 to 1. Coordinates of the mesh are the world's. Same input, same result, for any number of threads.
MeshComparison compare_mesh(std::span<const PlacedPart> parts, const ForeignMesh& mesh, const ComparisonSettings& settings,
                            const std::function<void(double)>& progress);

}  // namespace iso
