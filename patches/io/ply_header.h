// The header of PLY files: text that lists elements and their properties.  [Turk 1994, "The PLY polygon file format"]
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace iso {

enum class PlyScalar { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class PlyOrder { text, little, big };

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::f64;
  std::optional<PlyScalar> count;  // of a list: how many values a row has
};
struct PlyElement {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties;

  std::optional<std::size_t> find(std::string_view property) const;
};
struct PlyHeader {
  PlyOrder order = PlyOrder::text;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  // of the header
  int lines = 0;
};

std::size_t size_of(PlyScalar scalar);

// Throws an `Error` with the line. That the file has room for the rows is not checked.
PlyHeader read_ply_header(const std::string& path, std::string_view content);

}  // namespace iso
