// PLY: after the header (ply_header.h) the rows of its elements, as text or as numbers of either byte order.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "patches/io/mesh_input.h"
#include "patches/io/ply_header.h"

namespace iso {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers in big-endian order are turned");

// Hands out the numbers of the rows one after the other, with their places for errors.
class Rows {
 public:
  Rows(const std::string& path, std::string_view content, const PlyHeader& header)
      : order(header.order),
        path_(path),
        rest_(content.substr(header.bytes)),
        bytes_before_(header.bytes),
        lines_(rest_, LineEnd::always_ends, header.lines) {}

  // A row follows, of an element with properties. `least`: how many bytes it takes at least if binary, how many words if text.
  void begin(const PlyElement& element, std::uint64_t row) {
    element_ = &element;
    row_ = row;
    if (order != PlyOrder::text) return;
    if (!lines_.next(line_)) complain("the end of the file", fmt::format("{} rows", element.rows));
    word_ = 0;
  }
  void end() {
    if (order == PlyOrder::text && word_ < line_.words.size()) complain(quoted(line_.words[word_]), "the end of the line");
  }

  double number(PlyScalar type) {
    if (order != PlyOrder::text) return binary(type);
    const std::string_view word = next_word();
    const auto value = parse_number(word);
    if (!value) complain(quoted(word), "a number");
    return *value;
  }
  void skip(PlyScalar type) {
    if (order == PlyOrder::text)
      next_word();
    else
      take(size_of(type));
  }
  std::uint64_t whole(PlyScalar type, double most, const std::string& expected) {
    const double value = number(type);
    if (!(value >= 0 && value <= most && value == std::floor(value))) complain(fmt::format("{}", value), expected);
    return static_cast<std::uint64_t>(value);
  }
  std::string_view last_word() const { return line_.words[word_ - 1]; }

  // The file must have room for all rows before any memory is taken for them: a number takes its bytes, or one and a blank.
  void check_room(const PlyElement& element) {
    std::uint64_t least = 0;
    for (const PlyProperty& p : element.properties) least += order == PlyOrder::text ? 2 : size_of(p.count.value_or(p.type));
    element_ = &element;
    row_ = 0;
    if (least > 0 && element.rows > rest_.size() / least + 1)
      complain(fmt::format("{} bytes to the end of the file", rest_.size()), fmt::format("{} rows", element.rows));
  }

  [[noreturn]] void complain(const std::string& found, const std::string& expected) const {
    const std::string message = fmt::format("{} {}: found {}, expected {}", element_->name, row_ + 1, found, expected);
    if (order == PlyOrder::text) fail(path_, lines_.number(), message);
    fail_at_byte(path_, bytes_before_ + at_, message);
  }

  const PlyOrder order;

 private:
  std::string_view next_word() {
    if (word_ == line_.words.size()) complain("the end of the line", "a number");
    return line_.words[word_++];
  }

  std::size_t take(std::size_t bytes) {
    if (rest_.size() - at_ < bytes) complain("the end of the file", fmt::format("{} rows", element_->rows));
    return std::exchange(at_, at_ + bytes);
  }

  template <class T>
  double turned() {
    auto bytes = number_at<std::array<char, sizeof(T)>>(rest_, take(sizeof(T)));
    if (order == PlyOrder::big) std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<T>(bytes));
  }
  double binary(PlyScalar type) {
    switch (type) {
      case PlyScalar::i8:
        return turned<std::int8_t>();
      case PlyScalar::u8:
        return turned<std::uint8_t>();
      case PlyScalar::i16:
        return turned<std::int16_t>();
      case PlyScalar::u16:
        return turned<std::uint16_t>();
      case PlyScalar::i32:
        return turned<std::int32_t>();
      case PlyScalar::u32:
        return turned<std::uint32_t>();
      case PlyScalar::f32:
        return turned<float>();
      case PlyScalar::f64:
        return turned<double>();
    }
    ISO_CHECK(false);
  }

  const std::string& path_;
  std::string_view rest_;
  std::size_t bytes_before_, at_ = 0;
  TextLines lines_;
  TextLine line_;
  std::size_t word_ = 0;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

class PlyReader {
 public:
  PlyReader(const std::string& path, std::string_view content)
      : path_(path), header_(read_ply_header(path, content)), rows_(path, content, header_) {}

  ForeignMesh read() {
    const PlyElement* vertices = nullptr;
    for (const PlyElement& e : header_.elements)
      if (e.name == "vertex") vertices = &e;
    if (!vertices) fail(path_, header_.lines, "found no element `vertex`, expected one");
    points_ = static_cast<double>(vertices->rows);
    for (const PlyElement& e : header_.elements) {
      if (e.properties.empty()) continue;
      rows_.check_room(e);
      if (&e == vertices)
        read_vertices(e);
      else if (e.name == "face")
        read_lists(e, [&](std::vector<std::int64_t>& list) { add_polygon(list); });
      else if (e.name == "tristrips")
        read_lists(e, [&](std::vector<std::int64_t>& list) { add_strips(list); });
      else
        pass_over(e);
    }
    cut_polygons(polygons_, mesh_);
    return std::move(mesh_);
  }

 private:
  void read_vertices(const PlyElement& e) {
    std::vector<int> axis_of(e.properties.size(), -1);  // of properties
    bool in_float = false;
    for (int c = 0; c < 3; ++c) {
      const auto at = e.find(std::string(1, static_cast<char>('x' + c)));
      if (!at || e.properties[*at].count)
        fail(path_, header_.lines, fmt::format("found no property {} of vertex, expected x, y and z", static_cast<char>('x' + c)));
      axis_of[*at] = c;
      in_float = in_float || e.properties[*at].type == PlyScalar::f32;
    }
    TextDigits digits;
    mesh_.points.reserve(e.rows);
    for (std::uint64_t row = 0; row < e.rows; ++row) {
      rows_.begin(e, row);
      Point3 p;
      for (std::size_t i = 0; i < e.properties.size(); ++i) {
        if (axis_of[i] < 0) {
          skip(e.properties[i]);
          continue;
        }
        p[axis_of[i]] = rows_.number(e.properties[i].type);
        if (rows_.order == PlyOrder::text) digits.include(rows_.last_word(), p[axis_of[i]]);
      }
      if (!is_sensible(p)) rows_.complain(fmt::format("the point {} {} {}", p.x, p.y, p.z), kSensible);
      rows_.end();
      mesh_.points.push_back(p);
    }
    const double largest = largest_coordinate(mesh_.points);
    mesh_.rounding = std::max(digits.rounding(), in_float ? float_rounding(largest) : 0.0);
  }

  void skip(const PlyProperty& p) {
    if (!p.count) return rows_.skip(p.type);
    for (std::uint64_t n = length(p); n > 0; --n) rows_.skip(p.type);
  }

  std::uint64_t length(const PlyProperty& p) {
    return rows_.whole(*p.count, static_cast<double>(kMostIndices), "the length of the list " + p.name);
  }

  // Calls add(list) for the list of points of each row.
  template <class Add>
  void read_lists(const PlyElement& e, Add add) {
    auto at = e.find("vertex_indices");
    if (!at) at = e.find("vertex_index");
    if (!at || !e.properties[*at].count)
      fail(path_, header_.lines, fmt::format("found no list of {}, expected vertex_indices or vertex_index", e.name));
    std::vector<std::int64_t> list;
    for (std::uint64_t row = 0; row < e.rows; ++row) {
      rows_.begin(e, row);
      for (std::size_t i = 0; i < e.properties.size(); ++i) {
        if (i != *at) {
          skip(e.properties[i]);
          continue;
        }
        list.clear();
        for (std::uint64_t n = length(e.properties[i]); n > 0; --n) list.push_back(index(e.properties[i].type));
      }
      rows_.end();
      add(list);
    }
  }

  // An index of a point, or the -1 that ends a strip.
  std::int64_t index(PlyScalar type) {
    const double value = rows_.number(type);
    if (!(value >= -1 && value < points_ && value == std::floor(value)))
      rows_.complain(fmt::format("{}", value), fmt::format("the index of one of {} points", points_));
    return static_cast<std::int64_t>(value);
  }

  void add_polygon(const std::vector<std::int64_t>& list) {
    if (list.size() > kMostCorners) rows_.complain(fmt::format("{} corners", list.size()), fmt::format("at most {}", kMostCorners));
    for (const std::int64_t i : list) {
      if (i < 0) rows_.complain("-1", fmt::format("the index of one of {} points", points_));
      polygons_.corners.push_back(static_cast<std::uint32_t>(i));
    }
    end_polygon();
  }

  // Triangles of each three points that follow each other, every other one turned; -1 begins anew. A corner twice makes no triangle.
  void add_strips(const std::vector<std::int64_t>& list) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i] < 0) begin = i + 1;
      if (i < begin + 2 || list[i - 2] == list[i - 1] || list[i - 1] == list[i] || list[i] == list[i - 2]) continue;
      const std::size_t odd = (i - begin) % 2;
      for (const std::size_t k : {i - 2, i - 1 + odd, i - odd}) polygons_.corners.push_back(static_cast<std::uint32_t>(list[k]));
      end_polygon();
    }
  }

  void end_polygon() {
    polygons_.end_polygon();
    if (polygons_.corners.size() > kMostIndices) rows_.complain("more corners", fmt::format("at most {}", kMostIndices));
  }

  void pass_over(const PlyElement& e) {
    for (std::uint64_t row = 0; row < e.rows; ++row) {
      rows_.begin(e, row);
      for (const PlyProperty& p : e.properties) skip(p);
      rows_.end();
    }
  }

  const std::string& path_;
  const PlyHeader header_;
  Rows rows_;
  double points_ = 0;
  ForeignMesh mesh_;
  Polygons polygons_;
};

}  // namespace

ForeignMesh ply_mesh(const std::string& path, std::string_view content) { return PlyReader(path, content).read(); }

}  // namespace iso
