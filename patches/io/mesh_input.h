// What the readers of meshes share: places in errors, polygons, and how far a format's numbers move points.
//
// A reader takes the content of a file and throws an `Error` with line, byte or JSON path; `read_mesh` turns it into a `Result`. It gives
// points and triangles as the file lists them, indices checked; `read_mesh` joins equal places and sets `file`.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "patches/io/text_input.h"
#include "patches/triangle_mesh.h"

namespace iso {

ForeignMesh stl_mesh(const std::string& path, std::string_view content);
ForeignMesh obj_mesh(const std::string& path, std::string_view content);
ForeignMesh ply_mesh(const std::string& path, std::string_view content);
ForeignMesh gltf_mesh(const std::string& path, std::string_view content);

[[noreturn]] inline void fail_at_byte(const std::string& path, std::uint64_t byte, const std::string& message) {
  throw bad_input(path, "byte " + std::to_string(byte), message);
}

// The number that stands at `at`, in the byte order of this machine.
template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Finite and of sensible size, as number_in demands of text.
inline bool is_sensible(const Point3& p) {
  for (int c = 0; c < 3; ++c)
    if (!(std::abs(p[c]) <= kLargestNumber)) return false;
  return true;
}
inline constexpr const char* kSensible = "finite numbers of at most 1e15 in size";

// Indices are 32 bits, and the last one stands for none.
inline constexpr std::uint64_t kMostIndices = 0xFFFFFFFE;

// Polygons as the file has them: of polygon i are the corners [ends[i - 1], ends[i]), indices of points.
struct Polygons {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint64_t> ends;

  void end_polygon() { ends.push_back(corners.size()); }
};
inline constexpr std::size_t kMostCorners = 20'000;  // of a polygon: cutting takes time in their square, here about a second

// Appends the triangles of polygons to those of `mesh`, in order and turned as they are, and notes what was cut or left out. Polygons may
// be concave, touch themselves along bridges to holes, and bend: they are cut as their view along the mean normal shows them, ear by ear,
// the shortest diagonal first [Meisters 1975]. Corners on a straight side stay corners, so neighbours keep their common sides. What crosses
// itself is cut as it comes, and noted.
void cut_polygons(const Polygons& polygons, ForeignMesh& mesh);

// How far rounding to float may have moved a point whose coordinates are at most `largest` in size: half a unit in the last place, in each
// of three directions.
double float_rounding(double largest);

// The same for numbers in text, by the most digits and the largest size of those with a decimal point; others are taken as meant. Under
// five digits, all are (a cube made by hand); with sixteen and more they are doubles; with nine and fewer they may be floats as well.
class TextDigits {
 public:
  void include(std::string_view number, double value);
  double rounding() const;

 private:
  int most_ = 0;
  double largest_ = 0;
};

double largest_coordinate(const std::vector<Point3>& points);

}  // namespace iso
