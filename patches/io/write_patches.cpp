#include "patches/io/write_patches.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "patches/files/output_file.h"

namespace iso {
namespace {

// fmt writes the fewest digits; a negative zero needs its point, or JSON takes it for a whole number.
std::string number_text(double value) { return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value); }

// Names need not be valid UTF-8.
std::string quoted_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

template <class List, class TextOf>
std::string list_text(const List& list, const char* between, TextOf text_of) {
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : between) + text_of(item);
  return text;
}

std::string entry_text(const PatchEntry& entry) {
  const PatchBasis& basis = entry.patch.basis;
  std::string text = "    {\n";
  if (!entry.name.empty()) text += fmt::format("      \"name\": {},\n", quoted_text(entry.name));
  text +=
      fmt::format("      \"kind\": \"{}\",\n      \"sides\": {},\n      \"degree\": {},\n", word_of(basis.kind), basis.sides, basis.degree);
  if (basis.parameters != SideParameters::wachspress)
    text += fmt::format("      \"parameters\": \"{}\",\n", kSideParameterWords[static_cast<std::size_t>(basis.parameters)]);
  if (!entry.corners.empty())
    text += fmt::format("      \"corners\": [{}],\n", list_text(entry.corners, ", ", [](long long c) { return std::to_string(c); }));
  if (entry.colour)
    text += fmt::format("      \"colour\": [{}, {}, {}],\n", number_text(double{entry.colour->r}), number_text(double{entry.colour->g}),
                        number_text(double{entry.colour->b}));
  if (entry.approximation_error != 0) text += fmt::format("      \"approximation_error\": {},\n", number_text(entry.approximation_error));
  if (!entry.patch.weights.empty()) text += fmt::format("      \"weights\": [{}],\n", list_text(entry.patch.weights, ", ", number_text));
  const auto point_text = [](const Vec3& p) {
    return fmt::format("        [{}, {}, {}]", number_text(p.x), number_text(p.y), number_text(p.z));
  };
  return text + "      \"points\": [\n" + list_text(entry.patch.points, ",\n", point_text) + "\n      ]\n    }";
}

}  // namespace

std::string ipatch_text(const PatchSet& set) {
  std::string text = fmt::format("{{\n  \"format\": \"{}\",\n  \"version\": 1,\n", kPatchFileFormat);
  if (!set.name.empty()) text += fmt::format("  \"name\": {},\n", quoted_text(set.name));
  return text + "  \"patches\": [\n" + list_text(set.patches, ",\n", entry_text) + "\n  ]\n}\n";
}

Status write_patches(const std::string& path, const PatchSet& set) { return write_whole_file(path, ipatch_text(set)); }

}  // namespace iso
