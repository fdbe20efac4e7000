// Polygons of OBJ files: `v` and `f`. What else such files hold is passed over.
#include <fmt/format.h>

#include <algorithm>

#include "patches/io/mesh_input.h"

namespace iso {
namespace {

// Statements that say nothing of where polygons are.
constexpr std::string_view kSilent[] = {"vn", "vt", "g", "o", "s", "usemtl", "mtllib", "mg", "lod", "bevel", "c_interp", "d_interp"};

class ObjPolygons {
 public:
  ObjPolygons(const std::string& path, std::string_view content) : path_(path), lines_(content) {}

  ForeignMesh read() {
    while (lines_.next(line_)) {
      const std::string_view key = line_.words[0];
      if (key == "v")
        vertex();
      else if (key == "f" || key == "fo")
        face();
      else if (std::find(std::begin(kSilent), std::end(kSilent), key) == std::end(kSilent))
        pass_over();
    }
    if (last_used_ > mesh_.points.size())
      fail(path_, last_used_line_,
           fmt::format("found the point {}, expected at most {}, as many as there are", last_used_, mesh_.points.size()));
    cut_polygons(polygons_, mesh_);
    if (passed_over_ > 0)
      mesh_.notes.push_back(fmt::format("statements that are no polygons, left out: {}, the first ({}) in line {}", passed_over_,
                                        first_passed_over_, first_passed_over_line_));
    mesh_.rounding = digits_.rounding();
    return std::move(mesh_);
  }

 private:
  // x y z, x y z w, x y z r g b or x y z w r g b; weights belong to curves and surfaces.
  void vertex() {
    const std::size_t numbers = line_.words.size() - 1;
    if (numbers != 3 && numbers != 4 && numbers != 6 && numbers != 7)
      fail(path_, line_.number, fmt::format("v has {} numbers, expected x y z and perhaps a weight or a colour", numbers));
    if (mesh_.points.size() >= kMostIndices) fail(path_, line_.number, fmt::format("more points than {}, the most expected", kMostIndices));
    Point3 p;
    for (std::size_t c = 0; c < 3; ++c) {
      p[static_cast<int>(c)] = number_in(path_, line_.number, line_.words[c + 1], "a coordinate");
      digits_.include(line_.words[c + 1], p[static_cast<int>(c)]);
    }
    mesh_.points.push_back(p);
  }

  void face() {
    const std::size_t corners = line_.words.size() - 1;
    if (corners > kMostCorners)
      fail(path_, line_.number, fmt::format("found a polygon of {} corners, expected at most {}", corners, kMostCorners));
    for (std::size_t k = 1; k <= corners; ++k) polygons_.corners.push_back(point(line_.words[k]));
    polygons_.end_polygon();
    if (polygons_.corners.size() > kMostIndices)
      fail(path_, line_.number, fmt::format("more triangles than {}, the most expected", kMostIndices));
  }

  // The index that "7", "7/1", "7//2", "7/1/2" or "-1" refers to; points may follow their polygons.
  std::uint32_t point(std::string_view word) {
    const auto number = parse_integer(word.substr(0, word.find('/')));
    if (!number || *number == 0) fail(path_, line_.number, "found " + quoted(word) + ", expected the number of a point");
    const auto so_far = static_cast<long>(mesh_.points.size());
    if (*number < -so_far || *number > static_cast<long>(kMostIndices))
      fail(path_, line_.number, fmt::format("found {}, expected the number of a point; there are {} up to here", quoted(word), so_far));
    if (*number < 0) return static_cast<std::uint32_t>(so_far + *number);
    if (static_cast<std::uint64_t>(*number) > last_used_) {
      last_used_ = static_cast<std::uint64_t>(*number);
      last_used_line_ = line_.number;
    }
    return static_cast<std::uint32_t>(*number - 1);
  }

  void pass_over() {
    if (passed_over_++ > 0) return;
    first_passed_over_ = quoted(line_.words[0]);
    first_passed_over_line_ = line_.number;
  }

  const std::string& path_;
  TextLines lines_;
  TextLine line_;
  ForeignMesh mesh_;
  Polygons polygons_;
  TextDigits digits_;
  std::uint64_t last_used_ = 0, passed_over_ = 0;
  std::string first_passed_over_;
  int last_used_line_ = 0, first_passed_over_line_ = 0;
};

}  // namespace

ForeignMesh obj_mesh(const std::string& path, std::string_view content) { return ObjPolygons(path, content).read(); }

}  // namespace iso
