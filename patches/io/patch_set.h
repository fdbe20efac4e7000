// Sets of n-sided patches as files hold them, and how they become a model. Four formats, told apart by the ending of the name or, for ours,
// by the content:
//   .ipatch  ours: every kind of patch, exactly (patches/io/ipatch.schema.json); not .json, which names a scene
//   .gbp     one generalised Bezier patch: "sides degree", the central control point, then the rows of control points, outermost first,
//            side by side [Salvi, https://github.com/salvipeter/transfinite]
//   .lop     a loop of B-spline curves, one a side: degree; number of knots and the knots; number of points and the points [Salvi, as
//            above]
//   .mp      ribbons: for each side an outer and an inner B-spline curve, each "degree points", knots, points; a midpoint may be last
//            [Salvi, https://github.com/salvipeter/midpoint]
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "patches/base/result.h"
#include "patches/n_sided_part.h"

namespace iso {

struct PatchSet {
  std::string name;  // empty: none
  std::vector<PatchEntry> patches;
  std::vector<Problem> problems;
};

inline constexpr const char* kPatchFileFormat = "isophote-patches";  // what an .ipatch file calls itself

// The name of a kind in files and on the command line: "generalised-bezier".
std::string word_of(PatchKind kind);
inline constexpr std::array kSideParameterWords{"wachspress", "mean-value", "distance"};

// `path` is for messages only. Each throws an `Error` with line, or path inside the JSON.
PatchSet parse_ipatch(const std::string& path, std::string_view text);
PatchSet parse_gbp(const std::string& path, std::string_view text);
PatchSet parse_lop(const std::string& path, std::string_view text);
PatchSet parse_mp(const std::string& path, std::string_view text);

// The members of each kind of object of an .ipatch file, by its name in the schema's $defs ("set" is the root): the reader knows no others.
const std::vector<const char*>& ipatch_members(const std::string& object);

// One part, placed once; named after the set, or the file.
Model model_of_patches(const std::string& path, const std::string& format, PatchSet set);

}  // namespace iso
