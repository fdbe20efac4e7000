// What a mesh file holds, and what its triangles make together: `isophote info` of STL, OBJ polygons, PLY and glTF.
#pragma once

#include <string>

#include "patches/base/vec.h"
#include "patches/triangle_mesh.h"
#include "tess/verify.h"

namespace iso {

// Whether the file is to be read as a mesh: its ending is one of the mesh formats; an .obj has polygons and no free-form surface. A file
// that cannot be read is not.
bool is_mesh_file(const std::string& path);

struct MeshInfo {
  const ForeignMesh* mesh = nullptr;
  Box3 box;
  TopologyReport topology;
  TriangleShapes shapes;
  double area = 0;
  double volume = 0;  // enclosed; negative if the triangles show their backs outside; without meaning if the mesh is open
};

// The mesh must stay where it is.
MeshInfo describe(const ForeignMesh& mesh);

// Aligned lines for people; and the same for programs.
std::string to_text(const MeshInfo& info);
std::string to_json(const MeshInfo& info);

}  // namespace iso
