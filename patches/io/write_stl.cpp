// Binary STL: 80 bytes of header, the number of triangles, 50 bytes for each.
#include <fmt/format.h>

#include <limits>

#include "patches/io/placed_mesh.h"

namespace iso {
namespace {

// The first words must not be "solid": that is how the text format starts.
std::string header(const Model& model, const WriteMeshOptions& options) {
  std::string text = "isophote" + (options.version.empty() ? "" : " " + options.version);
  text += "; unit " + (model.unit.empty() ? "unknown" : model.unit);
  text.resize(80, ' ');
  return text;
}

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = glm::cross(b - a, c - a);
  const double length = glm::length(n);
  return length > 0 && finite(length) ? n / length : Vec3(0.0);
}

// Writes the triangles of one instance; gives the first point that float cannot hold.
std::optional<Vec3> write_triangles(OutputFile& file, const PlacedMesh& placed, WrittenMesh& written) {
  const PartMesh& mesh = *placed.mesh;
  for (const Triangle& stored : mesh.triangles) {
    const Triangle t = placed.turned(stored);
    const Vec3 a = placed.point(mesh.corner(t, 0)), b = placed.point(mesh.corner(t, 1)), c = placed.point(mesh.corner(t, 2));
    const FloatPoint corners[] = {FloatPoint(a), FloatPoint(b), FloatPoint(c)};
    for (const FloatPoint& p : corners)
      if (!p.is_finite()) return &p == corners ? a : &p == corners + 1 ? b : c;
    put(file, FloatPoint(unit_normal(a, b, c)));
    put(file, corners);
    put(file, std::uint16_t{0});
    written.collapsed += without_area(corners[0], corners[1], corners[2]);
  }
  return {};
}

}  // namespace

Result<WrittenMesh> write_stl(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options) {
  WrittenMesh written;
  for (const PlacedMesh& p : placed) written.triangles += p.mesh->triangles.size();
  if (written.triangles > std::numeric_limits<std::uint32_t>::max())
    return bad_input(path, {}, fmt::format("STL cannot hold {} triangles; expected fewer than 2^32", written.triangles));

  auto file = OutputFile::open(path);
  if (!file) return file.error();
  file->write(header(model, options));
  put(*file, static_cast<std::uint32_t>(written.triangles));
  for (const PlacedMesh& p : placed)
    if (const auto beyond = write_triangles(*file, p, written)) return beyond_float(path, *beyond);
  if (const auto done = file->put_in_place(); !done) return done.error();
  written.bytes = file->size();
  written.files = {path};
  return written;
}

}  // namespace iso
