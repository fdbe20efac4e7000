// Salvi's files: .gbp, .lop and .mp (patch_set.h). Damaged files are refused with the line; what follows is reported.
#include "patches/base/bspline_basis.h"
#include "patches/io/patch_set.h"
#include "patches/io/ribbon_patch.h"
#include "patches/io/word_stream.h"

namespace iso {
namespace {

constexpr int kMostPoints = 10'000;  // of a curve

void report_rest(WordStream& words, PatchSet& set) {
  if (words.at_end()) return;
  Problem problem{Problem::Kind::dropped, "line " + std::to_string(words.line()), "numbers after the last that belongs to the patch", 1};
  problem.count = words.rest();
  set.problems.push_back(std::move(problem));
}

int sides_in(WordStream& words) {
  return static_cast<int>(words.integer(3, kMostSides, "", "the number of sides, 3 to " + std::to_string(kMostSides)));
}

std::vector<double> knots_in(WordStream& words, long count, const std::string& where) {
  std::vector<double> knots;
  for (long i = 1; i <= count; ++i)
    knots.push_back(words.number(where + "knot " + std::to_string(i) + " of " + std::to_string(count) + ": ", "a knot"));
  return knots;
}

void points_in(WordStream& words, long count, const std::string& where, NurbsCurve<Vec3>& curve) {
  for (long i = 1; i <= count; ++i)
    curve.poles.push_back(homogeneous(words.point(where + "point " + std::to_string(i) + " of " + std::to_string(count) + ": "), 1.0));
  if (const std::string problem = problem_of(curve); !problem.empty()) words.fail_here(where + problem);
}

int degree_in(WordStream& words, const std::string& where) {
  return static_cast<int>(words.integer(1, kMostFitted, where, "a degree from 1 to " + std::to_string(kMostFitted)));
}

// degree; knots; points
NurbsCurve<Vec3> loop_curve(WordStream& words, const std::string& where) {
  NurbsCurve<Vec3> curve;
  curve.degree = degree_in(words, where);
  const long knots =
      words.integer(2 * curve.degree + 2, kMostPoints, where, "the number of knots, at least " + std::to_string(2 * curve.degree + 2));
  curve.knots = knots_in(words, knots, where);
  const long wanted = knots - curve.degree - 1;
  const long points = words.integer(wanted, wanted, where, "the number of points, " + std::to_string(wanted) + " for these knots");
  points_in(words, points, where, curve);
  return curve;
}

// degree and points; knots; points
NurbsCurve<Vec3> ribbon_curve(WordStream& words, const std::string& where) {
  NurbsCurve<Vec3> curve;
  curve.degree = degree_in(words, where);
  const long points =
      words.integer(curve.degree + 1, kMostPoints, where, "the number of points, at least " + std::to_string(curve.degree + 1));
  curve.knots = knots_in(words, points + curve.degree + 1, where);
  points_in(words, points, where, curve);
  return curve;
}

std::string side_name(int side, int sides) { return "side " + std::to_string(side) + " of " + std::to_string(sides) + ": "; }

}  // namespace

PatchSet parse_gbp(const std::string& path, std::string_view text) {
  WordStream words(path, text);
  PatchSet set;
  PatchEntry entry;
  PatchBasis& basis = entry.patch.basis;
  basis = {PatchKind::generalised_bezier, sides_in(words), 3, SideParameters::wachspress};
  basis.degree = static_cast<int>(words.integer(1, 1000, "", "a degree"));
  if (const std::string problem = problem_of(basis); !problem.empty()) words.fail_here("found " + problem);
  // The order of the file is that of the kind.
  const int count = point_count(basis);
  for (int i = 1; i <= count; ++i)
    entry.patch.points.push_back(words.point("point " + std::to_string(i) + " of " + std::to_string(count) + ": "));
  set.patches.push_back(std::move(entry));
  report_rest(words, set);
  return set;
}

namespace {

// The number of sides, then each side as `read` has it.
template <class Read>
std::vector<RibbonSide> read_sides(WordStream& words, const Read& read) {
  const int n = sides_in(words);
  std::vector<RibbonSide> sides(static_cast<std::size_t>(n));
  for (int k = 1; k <= n; ++k) read(sides[static_cast<std::size_t>(k) - 1], side_name(k, n));
  return sides;
}

}  // namespace

PatchSet parse_lop(const std::string& path, std::string_view text) {
  WordStream words(path, text);
  std::vector<RibbonSide> sides = read_sides(words, [&](RibbonSide& side, const std::string& name) {
    side.outer = loop_curve(words, name);
    side.line = words.line();
  });
  PatchSet set = patch_of_ribbons(path, std::move(sides), {});
  report_rest(words, set);
  return set;
}

PatchSet parse_mp(const std::string& path, std::string_view text) {
  WordStream words(path, text);
  std::vector<RibbonSide> sides = read_sides(words, [&](RibbonSide& side, const std::string& name) {
    side.outer = ribbon_curve(words, name + "outer curve: ");
    side.line = words.line();
    side.inner = ribbon_curve(words, name + "inner curve: ");
  });
  std::optional<Vec3> midpoint;
  if (!words.at_end()) midpoint = words.point("midpoint: ");
  PatchSet set = patch_of_ribbons(path, std::move(sides), midpoint);
  report_rest(words, set);
  return set;
}

}  // namespace iso
