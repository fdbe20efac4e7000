// Isophote's own patch files (.ipatch): JSON as patches/io/ipatch.schema.json says. Numbers are read to the double they mean, so that what
// `ipatch_text` wrote comes back bit for bit. Damage is refused with the path inside the file.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "patches/io/json_value.h"
#include "patches/io/patch_set.h"

namespace iso {
namespace {

constexpr const char* kFormat = "isophote-patches";

[[noreturn]] void fail_word(const JsonValue& value, const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  value.fail(iso::quoted(value.text()), "one of " + list);
}

// The index of a word among those that are known.
std::size_t word_in(const JsonValue& value, const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), value.text());
  if (found == words.end()) fail_word(value, words);
  return static_cast<std::size_t>(found - words.begin());
}

int small_whole(const JsonValue& value, int least, int most) {
  const std::uint64_t whole = value.whole();
  if (whole < static_cast<std::uint64_t>(least) || whole > static_cast<std::uint64_t>(most))
    value.fail(fmt::format("{}", whole), fmt::format("{} to {}", least, most));
  return static_cast<int>(whole);
}

PatchBasis basis_of(const JsonValue& patch) {
  std::vector<std::string> kinds;
  for (int k = 0; k < kPatchKinds; ++k) kinds.push_back(word_of(static_cast<PatchKind>(k)));
  PatchBasis basis;
  basis.kind = static_cast<PatchKind>(word_in(patch.at("kind"), kinds));
  basis.sides = small_whole(patch.at("sides"), 3, kMostSides);
  basis.degree = small_whole(patch.at("degree"), 1, 100);
  if (patch.has("parameters"))
    basis.parameters =
        static_cast<SideParameters>(word_in(patch.at("parameters"), {kSideParameterWords.begin(), kSideParameterWords.end()}));
  if (const std::string problem = problem_of(basis); !problem.empty()) throw_problem(patch, problem);
  return basis;
}

NSidedPatch patch_of(const JsonValue& value) {
  NSidedPatch patch;
  patch.basis = basis_of(value);
  const auto count = static_cast<std::size_t>(point_count(patch.basis));
  const JsonValue points = value.at("points");
  if (points.size() != count) points.fail(fmt::format("{} points", points.size()), fmt::format("{}", count));
  for (std::size_t i = 0; i < count; ++i) patch.points.push_back(point_of(points.at(i)));
  if (value.has("weights")) {
    const JsonValue weights = value.at("weights");
    if (weights.size() != count) weights.fail(fmt::format("{} weights", weights.size()), fmt::format("{}, one a point", count));
    for (std::size_t i = 0; i < count; ++i) patch.weights.push_back(weights.at(i).number());
  }
  if (const std::string problem = problem_of(patch); !problem.empty()) throw_problem(value, problem);
  return patch;
}

}  // namespace
}  // namespace iso
