// PLY, binary little endian. Vertices are nodes; see write_mesh.h.
#include <fmt/format.h>

#include <limits>

#include "patches/io/placed_mesh.h"

namespace iso {
namespace {

std::string header(const Model& model, const WriteMeshOptions& options, std::uint64_t vertices, std::uint64_t triangles, bool coloured) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += fmt::format("comment isophote{}{}; unit {}\n", options.version.empty() ? "" : " ", options.version,
                      model.unit.empty() ? "unknown" : model.unit);
  text += "comment vertices repeat, bit for bit, along the edges of faces: join equal places to close the mesh\n";
  text += "comment face_id runs over the faces of all instances in order\n";
  text += fmt::format("element vertex {}\n", vertices);
  for (const char* name : {"x", "y", "z"}) text += fmt::format("property double {}\n", name);
  for (const char* name : {"nx", "ny", "nz"}) text += fmt::format("property float {}\n", name);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nproperty int face_id\n", triangles);
  if (coloured)
    for (const char* name : {"red", "green", "blue"}) text += fmt::format("property uchar {}\n", name);
  return text + "end_header\n";
}

void write_vertices(OutputFile& file, const PlacedMesh& placed) {
  const std::vector<Vec3> normals = full_normals(*placed.mesh);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const FloatPoint n(placed.normal(normals[i]));
    ISO_CHECK(n.is_finite());
    put(file, placed.point(placed.mesh->points[placed.mesh->nodes[i].point]));
    put(file, n);
  }
}

std::array<std::uint8_t, 3> bytes_of(const Colour& c) {
  const auto byte = [](float linear) { return static_cast<std::uint8_t>(std::lround(255 * to_srgb(linear))); };
  return {byte(c.r), byte(c.g), byte(c.b)};
}

// `first_vertex`: how many the instances before have.
void write_triangles(OutputFile& file, const PlacedMesh& placed, std::uint32_t first_vertex, bool coloured) {
  for_each_triangle(*placed.mesh, [&](int face, const Triangle& stored) {
    Triangle t = placed.turned(stored);
    for (std::uint32_t& node : t) node += first_vertex;
    put(file, std::uint8_t{3});
    put(file, t);
    put(file, static_cast<std::int32_t>(placed.first_face) + face);
    if (coloured) put(file, bytes_of(placed.colour(face).value_or(kUncoloured)));
  });
}

}  // namespace

Result<WrittenMesh> write_ply(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options) {
  WrittenMesh written;
  std::uint64_t vertices = 0, faces = 0;
  for (const PlacedMesh& p : placed) {
    vertices += p.mesh->nodes.size();
    faces = p.first_face + p.part->faces.size();
    written.triangles += p.mesh->triangles.size();
  }
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (vertices > kMost || faces > kMost)
    return bad_input(path, {}, fmt::format("PLY cannot hold {} vertices of {} faces; expected fewer than 2^31", vertices, faces));

  auto file = OutputFile::open(path);
  if (!file) return file.error();
  const bool coloured = any_colour(placed);
  file->write(header(model, options, vertices, written.triangles, coloured));
  for (const PlacedMesh& p : placed) write_vertices(*file, p);
  std::uint32_t first_vertex = 0;
  for (const PlacedMesh& p : placed) {
    write_triangles(*file, p, first_vertex, coloured);
    first_vertex += static_cast<std::uint32_t>(p.mesh->nodes.size());
  }
  if (const auto done = file->put_in_place(); !done) return done.error();
  written.bytes = file->size();
  written.files = {path};
  return written;
}

}  // namespace iso
