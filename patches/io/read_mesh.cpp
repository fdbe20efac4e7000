// Readers of our own, because Open Asset Import keeps coordinates in float: no mesh could be compared with its model beyond seven digits.
#include "patches/io/read_mesh.h"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "patches/io/mesh_input.h"

namespace iso {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

using Reader = ForeignMesh (*)(const std::string& path, std::string_view content);
struct Format {
  const char *ending, *name;
  Reader read;
};
constexpr Format kFormats[] = {{".stl", "STL", stl_mesh},
                               {".obj", "OBJ", obj_mesh},
                               {".ply", "PLY", ply_mesh},
                               {".glb", "glTF", gltf_mesh},
                               {".gltf", "glTF", gltf_mesh}};

const Format* format_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const Format& f : kFormats)
    if (ending == f.ending) return &f;
  return nullptr;
}

// Multiplied and folded [Fibonacci hashing]: neighbours in space end far apart.
std::uint64_t hash_of(const Point3& p) {
  constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15;
  std::uint64_t h = 0;
  for (int c = 0; c < 3; ++c) {
    h = (h ^ std::bit_cast<std::uint64_t>(p[c])) * kFactor;
    h ^= h >> 32;
  }
  return h;
}

// What tells places apart: the coordinates. Those below the file's rounding count as 0, for what one face has as 0 its neighbour has as
// 1e-16, and floats keep that. Adding 0 makes -0 equal to 0.
Point3 key_of(const Point3& p, double rounding) {
  Point3 key = p + 0.0;
  for (int c = 0; c < 3; ++c)
    if (std::abs(p[c]) < rounding) key[c] = 0;
  return key;
}

// Leaves one point for each place that a triangle uses, in the order of the file.
void join_equal_places(ForeignMesh& mesh) {
  std::vector<std::uint32_t> joined(mesh.points.size(), kNone);
  constexpr std::uint32_t kUsed = 0;
  for (const PointTriangle& t : mesh.triangles)
    for (const std::uint32_t i : t) joined[i] = kUsed;

  // A table of twice as many slots as points, searched onward from the slot that the place hashes to.
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * mesh.points.size() + 1), kNone);
  std::uint32_t kept = 0;
  std::uint64_t unused = 0;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    if (joined[i] == kNone) {
      ++unused;
      continue;
    }
    const Point3 p = mesh.points[i] + 0.0, key = key_of(p, mesh.rounding);
    std::size_t slot = hash_of(key) & (slots.size() - 1);
    while (slots[slot] != kNone && key_of(mesh.points[slots[slot]], mesh.rounding) != key) slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] == kNone) {
      slots[slot] = kept;
      mesh.points[kept++] = p;
    }
    joined[i] = slots[slot];
  }
  mesh.points.resize(kept);
  mesh.points.shrink_to_fit();
  for (PointTriangle& t : mesh.triangles)
    for (std::uint32_t& i : t) i = joined[i];
  if (unused > 0) mesh.notes.push_back(fmt::format("points of no triangle, left out: {}", unused));
}

void note_collapsed(ForeignMesh& mesh) {
  std::uint64_t collapsed = 0;
  for (const PointTriangle& t : mesh.triangles) collapsed += t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  if (collapsed > 0) mesh.notes.push_back(fmt::format("triangles with a corner twice: {}", collapsed));
}

ForeignMesh read(const std::string& path, const Format& format, std::string_view content) {
  ForeignMesh mesh = format.read(path, content);
  mesh.file = path;
  mesh.format = format.name;
  if (mesh.triangles.empty()) throw bad_input(path, {}, "holds no triangles; expected a mesh");
  join_equal_places(mesh);
  note_collapsed(mesh);
  return mesh;
}

}  // namespace

double largest_coordinate(const std::vector<Point3>& points) {
  double largest = 0;
  for (const Point3& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

double float_rounding(double largest) {
  constexpr int kHalfUnit = std::numeric_limits<float>::digits, kLeast = std::numeric_limits<float>::min_exponent - 1;
  if (largest == 0) return 0;
  return std::sqrt(3.0) * std::ldexp(1.0, std::max(std::ilogb(largest), kLeast) - kHalfUnit);
}

void TextDigits::include(std::string_view number, double value) {
  int digits = 0;
  bool has_point = false;
  for (const char c : number) {
    if (c == 'e' || c == 'E') break;
    has_point = has_point || c == '.';
    digits += c >= '0' && c <= '9' && (c != '0' || digits > 0);
  }
  if (!has_point) return;
  most_ = std::max(most_, digits);
  largest_ = std::max(largest_, std::abs(value));
}

double TextDigits::rounding() const {
  constexpr int kFewest = 5, kFloat = std::numeric_limits<float>::max_digits10, kDouble = std::numeric_limits<double>::digits10;
  if (most_ < kFewest || most_ > kDouble || largest_ == 0) return 0;
  const double text = std::sqrt(3.0) * 0.5 * std::pow(10.0, std::floor(std::log10(largest_)) - most_ + 1);
  return most_ <= kFloat ? std::max(text, float_rounding(largest_)) : text;
}

Result<ForeignMesh> read_mesh(const std::string& path) {
  const Format* format = format_of(path);
  if (!format)
    return Error{Exit::bad_command_line, path, {}, "meshes are read from .stl, .obj, .ply, .glb or .gltf; expected one of these endings"};
  const auto content = read_text(path);
  if (!content) return content.error();
  try {
    return read(path, *format, *content);
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return bad_input(path, {}, "the mesh does not fit into memory");
  } catch (const std::length_error&) {
    return bad_input(path, {}, "the mesh does not fit into memory");
  }
}

}  // namespace iso
