#include "patches/io/ply_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "patches/io/mesh_input.h"

namespace iso {
namespace {

std::optional<PlyScalar> scalar_named(std::string_view name) {
  static constexpr std::pair<std::string_view, PlyScalar> kNames[] = {
      {"char", PlyScalar::i8},   {"int8", PlyScalar::i8},     {"uchar", PlyScalar::u8},   {"uint8", PlyScalar::u8},
      {"short", PlyScalar::i16}, {"int16", PlyScalar::i16},   {"ushort", PlyScalar::u16}, {"uint16", PlyScalar::u16},
      {"int", PlyScalar::i32},   {"int32", PlyScalar::i32},   {"uint", PlyScalar::u32},   {"uint32", PlyScalar::u32},
      {"float", PlyScalar::f32}, {"float32", PlyScalar::f32}, {"double", PlyScalar::f64}, {"float64", PlyScalar::f64}};
  for (const auto& [known, scalar] : kNames)
    if (name == known) return scalar;
  return std::nullopt;
}

class HeaderReader {
 public:
  HeaderReader(const std::string& path, std::string_view content) : path_(path), content_(content) {}

  PlyHeader read() {
    if (next() != "ply") fail(path_, 1, "found " + quoted(content_.substr(0, 16)) + ", expected `ply`");
    bool has_format = false;
    for (;;) {
      const std::string_view key = next();
      if (key == "end_header") break;
      if (key == "format") has_format = format();
      if (key == "element") element();
      if (key == "property") property();
      static constexpr std::string_view kKnown[] = {"format", "element", "property", "comment", "obj_info", ""};
      if (std::find(std::begin(kKnown), std::end(kKnown), key) == std::end(kKnown)) unexpected(key, "a line of a PLY header");
    }
    if (!has_format) fail(path_, header_.lines, "found the end of the header, expected a line `format` in it");
    return std::move(header_);
  }

 private:
  // The first word of the next line, which words_ holds.
  std::string_view next() {
    ++header_.lines;
    const std::size_t end = content_.find('\n', header_.bytes);
    if (end == content_.npos) fail(path_, header_.lines, "found the end of the file, expected `end_header`");
    TextLines lines(content_.substr(header_.bytes, end - header_.bytes), LineEnd::always_ends);
    header_.bytes = end + 1;
    if (!lines.next(line_)) return "";
    return line_.words[0];
  }

  [[noreturn]] void unexpected(std::string_view word, const std::string& expected) const {
    fail(path_, header_.lines, "found " + quoted(word) + ", expected " + expected);
  }
  std::string_view word(std::size_t i, const std::string& expected) const {
    if (i >= line_.words.size()) unexpected("", expected);
    return line_.words[i];
  }

  bool format() {
    const std::string_view name = word(1, "the name of a format");
    if (name == "ascii")
      header_.order = PlyOrder::text;
    else if (name == "binary_little_endian")
      header_.order = PlyOrder::little;
    else if (name == "binary_big_endian")
      header_.order = PlyOrder::big;
    else
      unexpected(name, "ascii, binary_little_endian or binary_big_endian");
    return true;
  }

  void element() {
    PlyElement e;
    e.name = word(1, "the name of an element");
    const auto rows = parse_integer(word(2, "the number of rows"));
    if (!rows || *rows < 0 || static_cast<std::uint64_t>(*rows) > kMostIndices)
      unexpected(line_.words[2], fmt::format("the number of rows, 0 to {}", kMostIndices));
    e.rows = static_cast<std::uint64_t>(*rows);
    header_.elements.push_back(std::move(e));
  }

  PlyScalar scalar(std::size_t i) const {
    const auto s = scalar_named(word(i, "the type of a number"));
    if (!s) unexpected(line_.words[i], "char, uchar, short, ushort, int, uint, float or double");
    return *s;
  }

  void property() {
    if (header_.elements.empty()) unexpected("property", "an element before it");
    PlyProperty p;
    const bool is_list = word(1, "a type") == "list";
    if (is_list) p.count = scalar(2);
    p.type = scalar(is_list ? 3 : 1);
    p.name = word(is_list ? 4 : 2, "the name of a property");
    header_.elements.back().properties.push_back(std::move(p));
  }

  const std::string& path_;
  std::string_view content_;
  PlyHeader header_;
  TextLine line_;
};

}  // namespace

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return i;
  return std::nullopt;
}

std::size_t size_of(PlyScalar s) {
  switch (s) {
    case PlyScalar::i8:
    case PlyScalar::u8:
      return 1;
    case PlyScalar::i16:
    case PlyScalar::u16:
      return 2;
    case PlyScalar::i32:
    case PlyScalar::u32:
    case PlyScalar::f32:
      return 4;
    case PlyScalar::f64:
      return 8;
  }
  ISO_CHECK(false);
}

PlyHeader read_ply_header(const std::string& path, std::string_view content) { return HeaderReader(path, content).read(); }

}  // namespace iso
