// Isophote's own patch files (.ipatch): JSON as patches/io/ipatch.schema.json says. Numbers are read to the double they mean, so that what
// `ipatch_text` wrote comes back bit for bit. Damage is refused with line and column, or with the path inside the file.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "patches/io/json_value.h"
#include "patches/io/patch_set.h"
#include "patches/io/text_input.h"

namespace iso {
namespace {

constexpr std::uint64_t kMostDegree = 100;  // far beyond what any kind takes, whose own word is clearer

// The index of a word among those that are known.
std::size_t word_in(const JsonValue& value, const std::vector<std::string>& words) {
  const std::string word = value.text();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  std::string list;
  for (const std::string& known : words) list += (list.empty() ? "" : ", ") + known;
  value.fail(iso::quoted(word), list);
}

int small_whole(const JsonValue& value, std::uint64_t least, std::uint64_t most) {
  const std::uint64_t whole = value.whole();
  if (whole < least || whole > most) value.fail(fmt::format("{}", whole), fmt::format("{} to {}", least, most));
  return static_cast<int>(whole);
}

PatchBasis basis_of(const std::string& path, const JsonValue& patch) {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> words;
    for (int k = 0; k < kPatchKinds; ++k) words.push_back(word_of(static_cast<PatchKind>(k)));
    return words;
  }();
  PatchBasis basis;
  basis.kind = static_cast<PatchKind>(word_in(patch.at("kind"), kinds));
  basis.sides = small_whole(patch.at("sides"), 3, kMostSides);
  basis.degree = small_whole(patch.at("degree"), 1, kMostDegree);
  if (patch.has("parameters"))
    basis.parameters =
        static_cast<SideParameters>(word_in(patch.at("parameters"), {kSideParameterWords.begin(), kSideParameterWords.end()}));
  if (const std::string problem = problem_of(basis); !problem.empty())
    throw bad_input(path, patch.path(), "found " + problem + " (" + name_of(basis.kind) + ")");
  return basis;
}

Vec3 point_in(const JsonValue& value) {
  if (value.size() != 3) value.fail(fmt::format("{} entries", value.size()), "x, y and z");
  return {value.at(std::size_t{0}).number(), value.at(1).number(), value.at(2).number()};
}

NSidedPatch patch_in(const std::string& path, const JsonValue& value) {
  NSidedPatch patch;
  patch.basis = basis_of(path, value);
  const auto count = static_cast<std::size_t>(point_count(patch.basis));
  const JsonValue points = value.at("points");
  if (points.size() != count) points.fail(fmt::format("{} points", points.size()), fmt::format("{} for this kind", count));
  for (std::size_t i = 0; i < count; ++i) patch.points.push_back(point_in(points.at(i)));
  if (value.has("weights")) {
    const JsonValue weights = value.at("weights");
    if (weights.size() != count) weights.fail(fmt::format("{} weights", weights.size()), fmt::format("{}, one a point", count));
    for (std::size_t i = 0; i < count; ++i) patch.weights.push_back(weights.at(i).number());
  }
  if (const std::string problem = problem_of(patch); !problem.empty()) throw bad_input(path, value.path(), problem);
  return patch;
}

Colour colour_in(const JsonValue& value) {
  const Vec3 c = point_in(value);
  if (!(c.x >= 0 && c.y >= 0 && c.z >= 0)) value.fail("a negative number", "three numbers from 0 on, linear red, green, blue");
  return {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)};
}

PatchEntry entry_in(const std::string& path, const JsonValue& value) {
  value.check_members(ipatch_members("patch"));
  PatchEntry entry;
  entry.patch = patch_in(path, value);
  if (value.has("corners")) {
    const JsonValue corners = value.at("corners");
    const auto sides = static_cast<std::size_t>(entry.patch.basis.sides);
    if (corners.size() != sides) corners.fail(fmt::format("{} corners", corners.size()), fmt::format("{}, as many as sides", sides));
    for (std::size_t i = 0; i < sides; ++i) entry.corners.push_back(static_cast<long long>(corners.at(i).whole()));
  }
  if (value.has("colour")) entry.colour = colour_in(value.at("colour"));
  if (value.has("name")) entry.name = value.at("name").text();
  if (value.has("approximation_error")) {
    entry.approximation_error = value.at("approximation_error").number();
    if (!(entry.approximation_error >= 0)) value.at("approximation_error").fail("a negative number", "a distance");
  }
  if (value.has("comment")) static_cast<void>(value.at("comment").text());
  return entry;
}

}  // namespace

std::string word_of(PatchKind kind) {
  std::string word = name_of(kind);
  for (char& c : word) c = c == ' ' ? '-' : static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return word;
}

const std::vector<const char*>& ipatch_members(const std::string& object) {
  static const std::map<std::string, std::vector<const char*>> members{
      {"set", {"$schema", "format", "version", "name", "comment", "patches"}},
      {"patch",
       {"kind", "sides", "degree", "parameters", "points", "weights", "corners", "colour", "name", "approximation_error", "comment"}}};
  return members.at(object);
}

PatchSet parse_ipatch(const std::string& path, std::string_view text) {
  const nlohmann::json json = parse_json_text(path, text);
  const JsonValue root(path, json);
  root.check_members(ipatch_members("set"));
  static_cast<void>(word_in(root.at("format"), {kPatchFileFormat}));
  static_cast<void>(small_whole(root.at("version"), 1, 1));
  PatchSet set;
  for (const char* text_member : {"$schema", "comment"})
    if (root.has(text_member)) static_cast<void>(root.at(text_member).text());
  if (root.has("name")) set.name = root.at("name").text();
  const JsonValue patches = root.at("patches");
  if (patches.size() == 0) patches.fail("no patches", "at least one");
  for (std::size_t i = 0; i < patches.size(); ++i) set.patches.push_back(entry_in(path, patches.at(i)));
  return set;
}

}  // namespace iso
