// Small readers of the mesh formats that `write_mesh` writes, written from the formats' definitions and not from the writer.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "patches/base/vec.h"

namespace iso::test {

using Corners = std::array<std::uint32_t, 3>;

struct StlFile {
  std::string header;
  std::vector<std::array<Vec3, 3>> triangles;
  std::vector<Vec3> normals;
};
struct ObjFile {
  std::vector<Vec3> points, normals;
  std::vector<Corners> triangles, triangle_normals;  // from 0
  std::vector<std::string> objects, groups, materials;
  std::vector<int> object_of, group_of;  // of each triangle
  std::string library;
};
struct PlyFile {
  std::vector<std::string> header;
  std::vector<Vec3> points, normals;
  std::vector<Corners> triangles;
  std::vector<std::int32_t> face_ids;
  std::vector<std::array<std::uint8_t, 3>> colours;
};
// The structure has been checked: `complaints` names what is against the specification.
struct GlbFile {
  nlohmann::json json;
  std::string binary;
  std::vector<std::string> complaints;
};

// They throw std::runtime_error on a file that is cut off or not such a file.
StlFile read_stl_file(const std::string& path);
ObjFile read_obj_file(const std::string& path);
PlyFile read_ply_file(const std::string& path);
GlbFile read_glb_file(const std::string& path);

// The triangles of all nodes of a glTF scene in the root's coordinates (y up, metres).
std::vector<std::array<Vec3, 3>> placed_triangles(const GlbFile& file);

// Numbers of an accessor: components one after the other.
std::vector<double> numbers_of(const GlbFile& file, std::size_t accessor);

}  // namespace iso::test
