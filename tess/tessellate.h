// A part as a watertight mesh with a proven distance from its surfaces [Safko 2022, ch. 4]: its edges are sampled once (edge_net.h), its
// faces are meshed on their own between those samples (face_mesh.h), and where a face needs more samples on an edge, all faces of that edge
// are meshed again.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"
#include "tess/join_edges.h"
#include "tess/verify.h"

namespace iso {

// Faces that the part holds twice (copied_faces.h).
enum class Copies { MeshOnce, MeshAll };

struct TessellationOptions {
  double distance = 0;  // world units, positive: allowed between surface and mesh; more than a tenth of the part's size is not used
  double trim = 0;      // allowed between an edge and its polyline; 0: as `distance`
  double angle = kInf;  // radians: allowed between the surface's normals at any two corners of a triangle
  double sew = 0;       // world units: edges of different faces within this distance are one; 0: what the file states; negative: off
  Copies copies = Copies::MeshOnce;
};

// What is proven and what was counted of one face.
struct FaceReport {
  double bound = 0;   // no point of the mesh is farther from the face, no point of the face farther from the mesh; without `offset`
  double offset = 0;  // its border nodes lie this far off its surface: the gap between the faces of its edges, halved
  int triangles = 0;
  int unresolved = 0;   // triangles beyond the tolerance that could not be divided
  int collapsed = 0;    // triangles left out at poles
  int folded = 0;       // triangles turned against the surface
  int at_folds = 0;     // of those: where the surface itself turns by more than a right angle within the triangle
  Point3 fold{0.0};     // the first place where it does
  bool turned = false;  // looked to the other side than its neighbours: its triangles and normals do not, see orient.h
  int crossings = 0;    // border segments that cross others and are no sides of triangles
  int copy_of = -1;     // the face that it repeats and that is meshed for both; it has no triangles
  std::string failure;  // why the face has no triangles, if it has none and is no copy
};

struct PartTessellation {
  PartMesh mesh;
  std::vector<FaceReport> faces;
  int rounds = 0;  // times that faces were meshed again for want of samples on edges
  // The sides of triangles that lie on edges of one face only, as pairs of points (the smaller index first), sorted: where the model itself
  // ends the mesh ends too, and every other open side is a crack.
  std::vector<std::array<std::uint32_t, 2>> free_sides;
  int one_sided = 0;         // pairs of neighbours that look to different sides whatever is turned
  int unresolved_edges = 0;  // segments of edges beyond the tolerance that could not be divided
  JoinReport joins;          // of edges that the file does not share
};

// For `verify`.
MakersNotes notes_of(const PartTessellation& made);

// Parallel over faces; the result does not depend on the number of threads.
PartTessellation tessellate(const Part& part, const TessellationOptions& options);

}  // namespace iso
