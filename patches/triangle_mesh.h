// Triangle meshes of the faces of a part. The tessellator makes them, writers store them, the ray tracer renders them. And meshes of
// others.
//
// A point is a place in space; a node is a point as one face sees it, with its (u, v) and normal there. Nodes of several faces share the
// points of an edge, so a mesh is watertight where the indices of points say so. Nodes and triangles are stored face by face.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

struct MeshNode {
  std::uint32_t point = 0;  // index into PartMesh::points
  UV uv{0.0};               // of the face's surface
  Vec3 normal{0.0};         // unit outward normal of the exact surface there; zero if it has none
};

using Triangle = std::array<std::uint32_t, 3>;  // indices into PartMesh::nodes, counter-clockwise seen from outside

struct PartMesh {
  std::vector<Point3> points;  // in the coordinates of the part
  std::vector<MeshNode> nodes;
  std::vector<Triangle> triangles;
  // Of face f are the nodes [first_node[f], first_node[f + 1]) and the triangles [first_triangle[f], first_triangle[f + 1]).
  std::vector<std::uint32_t> first_node{0}, first_triangle{0};

  int face_count() const { return static_cast<int>(first_triangle.size()) - 1; }
  const Point3& corner(const Triangle& t, int k) const { return points[nodes[t[static_cast<std::size_t>(k)]].point]; }
};

// The meshes of the parts of a model, in its order; instances are those of the model.
struct ModelMesh {
  std::vector<PartMesh> parts;
};

using PointTriangle = std::array<std::uint32_t, 3>;  // indices of points

// A mesh of any origin, as a file has it: it knows nothing of surfaces.
struct ForeignMesh {
  std::string file, format;    // "STL", "OBJ", "PLY", "glTF"
  std::string unit;            // of the coordinates where the format fixes it ("m": glTF), else empty
  std::vector<Point3> points;  // equal places are one point
  std::vector<PointTriangle> triangles;
  double rounding = 0;  // how far the file's number format may have moved a point, in its units; 0: not at all, as far as is known
  std::vector<std::string> notes;  // what was mended or left out, a line each
};

}  // namespace iso
