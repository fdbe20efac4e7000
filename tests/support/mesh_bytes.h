// Mesh files made by hand, byte by byte, and what tells a mesh that was read from them.
#pragma once

#include <string>
#include <vector>

#include "patches/triangle_mesh.h"

namespace iso::test {

// Volume that the triangles enclose, if they are closed and turned outward.
double volume_of(const ForeignMesh& mesh);
// Directed edges whose opposite does not occur exactly once.
int unpaired_edges(const ForeignMesh& mesh);

std::string binary_stl(const std::vector<Point3>& points, const std::vector<PointTriangle>& triangles, const std::string& header = {});
std::string text_stl(const std::vector<Point3>& points, const std::vector<PointTriangle>& triangles);

// The tetrahedron of the origin and the axes' unit points, with numbers of these types.
enum class PlyBytes { text, little, big };
std::string tetrahedron_ply(PlyBytes order, const std::string& coordinate, const std::string& length, const std::string& index,
                            const std::string& list);

// The same in glTF, y up, so that it reads z up. `node`: members of node 0, `more` as well; further nodes may follow by "},{". The buffer's
// `uri`: "data": within the file; empty: none.
enum class GltfScene { first, none };
std::string tetrahedron_gltf(const std::string& node, const std::string& more = R"("mesh":0)", GltfScene scene = GltfScene::first,
                             const std::string& uri = "data");
std::string gltf_numbers();  // its buffer
std::string glb_of(const std::string& json, const std::string& numbers);

// A square of the points (0, 0), (1, 0), (0, 1), (1, 1) with one mesh of this primitive. Accessors: 0 its points; 1, 2, 3 the indices of
// two triangles as u8, u16, u32; 4 the points 16 bytes apart; 5 the points, with the last one replaced by (9, 8, 7); 6 the points as i16.
std::string square_gltf(const std::string& primitive);

}  // namespace iso::test
