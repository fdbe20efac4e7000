#include "patches/io/write_mesh.h"

#include <fmt/format.h>

#include <filesystem>

#include "patches/io/placed_mesh.h"

namespace iso {
namespace {

// Indices within their lists, face by face, and all numbers finite.
void check_part(const Part& part, const PartMesh& mesh) {
  const std::size_t faces = part.faces.size();
  ISO_CHECK(mesh.first_triangle.size() == faces + 1 && mesh.first_node.size() == faces + 1);
  ISO_CHECK(mesh.first_triangle.front() == 0 && mesh.first_triangle.back() == mesh.triangles.size());
  ISO_CHECK(mesh.first_node.front() == 0 && mesh.first_node.back() == mesh.nodes.size());
  for (std::size_t f = 0; f < faces; ++f) {
    ISO_CHECK(mesh.first_triangle[f] <= mesh.first_triangle[f + 1] && mesh.first_node[f] <= mesh.first_node[f + 1]);
    for (std::uint32_t t = mesh.first_triangle[f]; t < mesh.first_triangle[f + 1]; ++t)
      for (const std::uint32_t node : mesh.triangles[t]) ISO_CHECK(mesh.first_node[f] <= node && node < mesh.first_node[f + 1]);
  }
  for (const MeshNode& node : mesh.nodes) ISO_CHECK(node.point < mesh.points.size() && finite(node.normal));
  for (const Point3& p : mesh.points) ISO_CHECK(finite(p));
}

}  // namespace

std::optional<Colour> PlacedMesh::colour(int face) const {
  const std::optional<Colour>& own = part->faces[static_cast<std::size_t>(face)].colour;
  return own ? own : instance->colour;
}

std::vector<PlacedMesh> placed_meshes(const Model& model, const ModelMesh& mesh) {
  ISO_CHECK(mesh.parts.size() == model.parts.size());
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) check_part(model.parts[i], mesh.parts[i]);
  std::vector<PlacedMesh> placed;
  std::uint64_t first_face = 0;
  for (std::size_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    const auto part = static_cast<std::size_t>(instance.part);
    ISO_CHECK(instance.part >= 0 && part < model.parts.size());
    const std::uint64_t first = std::exchange(first_face, first_face + model.parts[part].faces.size());
    if (mesh.parts[part].triangles.empty()) continue;
    const double determinant = glm::determinant(instance.to_model.linear);
    const Mat3 normal_map = glm::transpose(glm::inverse(instance.to_model.linear));
    ISO_CHECK(finite(determinant) && determinant != 0 && finite(instance.to_model.translation));
    for (int c = 0; c < 3; ++c) ISO_CHECK(finite(normal_map[c]));
    for (const Point3& p : mesh.parts[part].points) ISO_CHECK(finite(instance.to_model.point(p)));
    placed.push_back({static_cast<int>(i), first, &instance, &model.parts[part], &mesh.parts[part], determinant < 0, normal_map});
  }
  return placed;
}

std::vector<Vec3> full_normals(const PartMesh& mesh) {
  // Sums of area times normal of the triangles about those nodes that have none.
  std::vector<Vec3> normals(mesh.nodes.size());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = mesh.nodes[i].normal;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 area = glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    for (const std::uint32_t node : t)
      if (mesh.nodes[node].normal == Vec3(0.0)) normals[node] += area;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (mesh.nodes[i].normal != Vec3(0.0)) continue;
    const double length = glm::length(normals[i]);
    normals[i] = finite(length) && length > 0 ? normals[i] / length : Vec3(0, 0, 1);
  }
  return normals;
}

bool any_colour(const std::vector<PlacedMesh>& placed) {
  for (const PlacedMesh& p : placed)
    for (int face = 0; face < p.mesh->face_count(); ++face)
      if (p.colour(face)) return true;
  return false;
}

float to_srgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

std::string one_word(const std::string& name) {
  std::string word = name;
  for (char& c : word)
    if (static_cast<unsigned char>(c) <= ' ' || c == 127) c = '_';
  return word;
}

Error beyond_float(const std::string& path, const Vec3& p) {
  return bad_input(path, {},
                   fmt::format("the point {} {} {} is beyond what this format can hold; expected less than 3.4e38", p.x, p.y, p.z));
}

Result<MeshFormat> mesh_format_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".stl") return MeshFormat::stl;
  if (ending == ".obj") return MeshFormat::obj;
  if (ending == ".ply") return MeshFormat::ply;
  if (ending == ".glb") return MeshFormat::glb;
  return Error{Exit::bad_command_line, path, {}, "meshes are written as .stl, .obj, .ply or .glb; expected one of these endings"};
}

Result<WrittenMesh> write_mesh(const std::string& path, const Model& model, const ModelMesh& mesh, const WriteMeshOptions& options) {
  const auto format = mesh_format_of(path);
  if (!format) return format.error();
  const std::vector<PlacedMesh> placed = placed_meshes(model, mesh);
  switch (*format) {
    case MeshFormat::stl:
      return write_stl(path, model, placed, options);
    case MeshFormat::obj:
      return write_obj(path, model, placed, options);
    case MeshFormat::ply:
      return write_ply(path, model, placed, options);
    case MeshFormat::glb:
      return write_glb(path, model, placed, options);
  }
  ISO_CHECK(false);
}

}  // namespace iso
