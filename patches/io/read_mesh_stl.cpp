// STL, binary and text.
#include <fmt/format.h>

#include <bit>

#include "patches/io/mesh_input.h"

namespace iso {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read as numbers lie in memory");

constexpr std::size_t kHeader = 84, kEach = 50;  // 80 bytes of anything, the number of triangles; normal, corners, two bytes of anything

std::string lower(std::string_view word) {
  std::string s(word.substr(0, 16));
  for (char& c : s)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return s;
}

// Many binary files begin with "solid": the size decides. Where it fits neither kind, a zero byte among the first tells damaged binary.
bool is_binary(std::string_view content) {
  const std::string_view head = content.substr(0, kHeader);
  const std::size_t word = std::min(head.find_first_not_of(" \t\r\n"), head.size());
  if (lower(head.substr(word, 5)) != "solid" || head.find('\0') != head.npos) return true;
  return content.size() >= kHeader && content.size() == kHeader + kEach * std::size_t{number_at<std::uint32_t>(content, 80)};
}

void check_triangle_count(const std::string& path, std::uint64_t triangles) {
  if (3 * triangles > kMostIndices)
    throw bad_input(path, {}, fmt::format("{} triangles are too many; expected at most {}", triangles, kMostIndices / 3));
}

ForeignMesh read_binary(const std::string& path, std::string_view content) {
  if (content.size() < kHeader)
    fail_at_byte(path, content.size(), "found the end of the file, expected `solid` at its beginning, or the 84 bytes before triangles");
  const std::size_t count = number_at<std::uint32_t>(content, 80), room = (content.size() - kHeader) / kEach;
  if (count > room)
    fail_at_byte(path, content.size(),
                 fmt::format("found the end of the file in triangle {}, expected {} triangles as byte 80 says", room + 1, count));
  check_triangle_count(path, count);

  ForeignMesh mesh;
  mesh.points.reserve(3 * count);
  mesh.triangles.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = kHeader + i * kEach + 12 * (k + 1);
      const auto p = number_at<std::array<float, 3>>(content, at);
      mesh.points.emplace_back(p[0], p[1], p[2]);
      if (!is_sensible(mesh.points.back()))
        fail_at_byte(path, at, fmt::format("found the corner {} {} {} of triangle {}, expected {}", p[0], p[1], p[2], i + 1, kSensible));
    }
  }
  if (const std::size_t rest = content.size() - kHeader - count * kEach; rest > 0)
    mesh.notes.push_back(fmt::format("bytes after the last triangle, left out: {}", rest));
  mesh.rounding = float_rounding(largest_coordinate(mesh.points));
  return mesh;
}

// Statements in the order of the format; normals and names are passed over.
class TextStl {
 public:
  TextStl(const std::string& path, std::string_view content) : path_(path), lines_(content, LineEnd::always_ends) {}

  ForeignMesh read() {
    while (lines_.next(line_)) statement(lower(line_.words[0]));
    if (!ended_) fail(path_, lines_.number(), "found the end of the file, expected `endsolid`");
    mesh_.rounding = digits_.rounding();
    return std::move(mesh_);
  }

 private:
  void statement(const std::string& key) {
    if (key == "vertex")
      vertex();
    else if (key == "facet")
      corners_ = corners_ < 0 ? 0 : unexpected("`vertex` or `endfacet`");
    else if (key == "endfacet")
      end_facet();
    else if (key == "solid" || key == "endsolid" || key == "end")
      ended_ = corners_ < 0 ? key != "solid" : unexpected("`endfacet`");
    else if (key != "outer" && key != "endloop")
      unexpected("facet, outer loop, vertex, endloop, endfacet or endsolid");
  }

  int unexpected(const std::string& expected) const {
    fail(path_, line_.number, "found " + quoted(line_.words[0]) + ", expected " + expected);
  }

  void vertex() {
    if (corners_ < 0) unexpected("`facet` before it");
    if (corners_ == 3) unexpected("`endfacet` after three corners");
    if (line_.words.size() != 4) fail(path_, line_.number, fmt::format("vertex has {} numbers, expected x y z", line_.words.size() - 1));
    Point3 p;
    for (std::size_t c = 0; c < 3; ++c) {
      p[static_cast<int>(c)] = number_in(path_, line_.number, line_.words[c + 1], "a coordinate");
      digits_.include(line_.words[c + 1], p[static_cast<int>(c)]);
    }
    mesh_.points.push_back(p);
    ++corners_;
  }

  void end_facet() {
    if (corners_ != 3) fail(path_, line_.number, fmt::format("found a facet of {} corners, expected three", std::max(corners_, 0)));
    corners_ = -1;
    check_triangle_count(path_, mesh_.triangles.size() + 1);
    const auto first = static_cast<std::uint32_t>(mesh_.points.size() - 3);
    mesh_.triangles.push_back({first, first + 1, first + 2});
  }

  const std::string& path_;
  TextLines lines_;
  TextLine line_;
  ForeignMesh mesh_;
  TextDigits digits_;
  int corners_ = -1;  // of the facet so far; negative between facets
  bool ended_ = false;
};

}  // namespace

ForeignMesh stl_mesh(const std::string& path, std::string_view content) {
  return is_binary(content) ? read_binary(path, content) : TextStl(path, content).read();
}

}  // namespace iso
