// One face as triangles: its loops as the edge net samples them, points inside where the surface bends, a constrained Delaunay
// triangulation of both, and more points until the proven distance of every triangle keeps the tolerance.
#pragma once

#include "patches/triangle_mesh.h"
#include "tess/edge_net.h"

namespace iso {

struct FacePolicy {
  double distance = 0;             // world units
  double angle = kInf;             // radians: between the surface's normals at any two corners of a triangle
  bool borders_are_final = false;  // ask for no finer edges: what crosses is counted and left out
};

// A segment of the edge net: between the samples `segment` and `segment + 1`.
struct EdgeSegment {
  int edge = 0;
  std::uint32_t segment = 0;
  auto operator<=>(const EdgeSegment&) const = default;
};

struct FaceMesh {
  // `point` of a node is one of the net's; or, with kInner added, counts `inner`. The first `border` nodes are the samples of edges, in the
  // order of the loops; where the surface has no area others may share their points.
  static constexpr std::uint32_t kInner = 0x80000000u;
  std::vector<MeshNode> nodes;
  std::size_t border = 0;
  std::vector<Point3> inner;
  bool on_edge(std::uint32_t node) const { return nodes[node].point < kInner; }
  std::vector<Triangle> triangles;

  double bound = 0;                   // proven distance between surface and mesh, without `offset`
  double offset = 0;                  // largest distance of a border node from this face's surface: the model's own gap
  int unresolved = 0;                 // triangles whose bound is above the tolerance though nothing can be divided further
  int collapsed = 0;                  // triangles left out because two of their corners are one point in space (poles, parts without area)
  int folded = 0;                     // triangles turned against the surface
  int at_folds = 0;                   // of those: where the surface itself turns by more than a right angle within the triangle
  Point3 fold{0.0};                   // the first place where it does
  int crossings = 0;                  // segments that could not become sides of triangles: loops that cross
  std::vector<EdgeSegment> to_split;  // what must be sampled more finely before this face can be meshed; then nothing else is valid
};

// `extra`: points of the parameter plane that must become nodes (asked for by the caller to part meshes that touch).
FaceMesh mesh_face(const FaceShape& shape, const std::vector<std::vector<int>>& loops, const Boundary& boundary, const EdgeNet& net,
                   const FacePolicy& policy, const std::vector<UV>& extra);

}  // namespace iso
