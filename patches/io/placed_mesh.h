// What the writers of meshes share: meshes as instances place them, normals and colours as they are written, bytes.
#pragma once

#include <bit>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "patches/files/output_file.h"
#include "patches/io/write_mesh.h"

namespace iso {

static_assert(std::endian::native == std::endian::little, "the binary formats are written as numbers lie in memory");

// Instances that have a mesh, in the order of the model.
struct PlacedMesh {
  int number = 0;                // index into Model::instances
  std::uint64_t first_face = 0;  // how many faces the instances before it have
  const Instance* instance = nullptr;
  const Part* part = nullptr;
  const PartMesh* mesh = nullptr;
  bool mirrored = false;
  Mat3 normal_map{1.0};  // inverse transpose

  Point3 point(const Point3& p) const { return instance->to_model.point(p); }
  Vec3 normal(const Vec3& n) const { return glm::normalize(normal_map * n); }
  // Counter-clockwise seen from outside, also where the instance mirrors.
  Triangle turned(const Triangle& t) const { return mirrored ? Triangle{t[0], t[2], t[1]} : t; }
  std::optional<Colour> colour(int face) const;
};

// Checks everything that `write_mesh` demands of its input.
std::vector<PlacedMesh> placed_meshes(const Model& model, const ModelMesh& mesh);

// The normals of the nodes of a part; where there is none the mean of the triangles about the node, or +z if these have none either.
std::vector<Vec3> full_normals(const PartMesh& mesh);

bool any_colour(const std::vector<PlacedMesh>& placed);

inline constexpr Colour kUncoloured{0.93f, 0.885f, 0.82f};  // faces without a colour in a file that has colours: as pictures show them

// A linear value as a screen's: the sRGB curve of the value clamped to [0, 1].  [IEC 61966-2-1]
float to_srgb(float linear);

// A name without spaces and control characters (they become "_"); such a name is one word in a text file.
std::string one_word(const std::string& name);

// Calls f(face, triangle) for all triangles in order.
template <class F>
void for_each_triangle(const PartMesh& mesh, F f) {
  for (int face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t t = mesh.first_triangle[face]; t < mesh.first_triangle[face + 1]; ++t) f(face, mesh.triangles[t]);
}

// A float beyond its range is infinite; then the writer refuses the mesh.
struct FloatPoint {
  float x = 0, y = 0, z = 0;
  explicit FloatPoint(const Vec3& p) : x(static_cast<float>(p.x)), y(static_cast<float>(p.y)), z(static_cast<float>(p.z)) {}
  Vec3 exact() const { return {x, y, z}; }
  bool is_finite() const { return finite(exact()); }
};
inline bool without_area(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c) {
  return glm::cross(b.exact() - a.exact(), c.exact() - a.exact()) == Vec3(0.0);
}
Error beyond_float(const std::string& path, const Vec3& p);

template <class T>
void put(OutputFile& file, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  file.write({reinterpret_cast<const char*>(&value), sizeof value});
}

// The writers; the input has been checked.
using Placed = std::vector<PlacedMesh>;
Result<WrittenMesh> write_stl(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options);
Result<WrittenMesh> write_obj(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options);
Result<WrittenMesh> write_ply(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options);
Result<WrittenMesh> write_glb(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options);

}  // namespace iso
