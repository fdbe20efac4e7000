// A second opinion on a CAD file: Open CASCADE reads it with its plain readers and meshes it. Nothing of ours takes part, so a mistake of
// our readers, surfaces, trims or solvers shows as a difference. Its faults are its own: see `unmeshed` and `Triangle::deviation`.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "patches/base/vec.h"

namespace iso::test {

struct MeshTriangle {
  std::array<std::uint32_t, 3> corners;  // indices into OcctMesh::points
  std::int32_t face;                     // number of the face among the shape's different faces, from 0
  // Measured: largest distance between the plane of this triangle, or of one that shares a corner with it, and the surface as Open CASCADE
  // evaluates it at the triangle's parameters (middle and mid-sides). The mesher often exceeds the deflection it is asked for.
  float deviation;
};

struct OcctMesh {
  std::vector<Vec3> points;  // world coordinates; mm for STEP and IGES, else the file's
  std::vector<MeshTriangle> triangles;
  int faces = 0;
  double deflection = 0;      // asked for, world units
  std::vector<int> unmeshed;  // faces that the mesher left without triangles
  std::string status;         // what the mesher says of itself where it is not content, else empty
  Box3 box;                   // of the points
  double seconds = 0;         // CPU time of the mesher, without reading; of the calling thread, which does it all
};

// Deflection as a share of the box's diagonal, and the largest angle between neighbouring segments, radians.
struct MeshFineness {
  double deflection = 1e-4;
  double angle = 0.15;
};

// Nothing could be read or meshed; the message says what.
struct OcctFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

OcctMesh mesh_with_occt(const std::string& path, const MeshFineness& fineness);

// Whether Open CASCADE's own check (BRepCheck) finds nothing wrong with the shape of the file.
bool valid_for_occt(const std::string& path);

}  // namespace iso::test
