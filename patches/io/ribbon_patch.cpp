#include "patches/io/ribbon_patch.h"

#include <fmt/format.h>

#include <algorithm>

#include "patches/io/side_curves.h"
#include "patches/io/text_input.h"
#include "patches/surface/kinds/generalised-inl.h"

namespace iso {
namespace {

// The control points of the sides in one degree: boundary, and second row where the file has one.
struct Ribbons {
  int degree = 3;
  double size = 0, boundary_error = 0, across_error = 0;
  std::vector<std::vector<Vec3>> row0, row1;

  std::size_t sides() const { return row0.size(); }
  std::size_t before(std::size_t k) const { return (k + sides() - 1) % sides(); }
  std::size_t after(std::size_t k) const { return (k + 1) % sides(); }
  double d() const { return degree; }
};

double size_of(const std::vector<RibbonSide>& sides) {
  Box3 box;
  for (const RibbonSide& side : sides)
    for (const Vec4& h : side.outer.poles) box.include(project(h));
  return box.diagonal();
}

int highest_degree(const std::vector<RibbonSide>& sides) {
  int degree = 3;
  for (const RibbonSide& side : sides) degree = std::max({degree, side.outer.degree, side.inner ? side.inner->degree : 0});
  return degree;
}

Ribbons ribbons_in(const std::vector<RibbonSide>& sides, int degree) {
  Ribbons ribbons;
  ribbons.degree = degree;
  ribbons.size = size_of(sides);
  for (const RibbonSide& side : sides) {
    SideCurve outer = bezier_side(side.outer, degree);
    ribbons.boundary_error = std::max(ribbons.boundary_error, outer.error);
    std::vector<Vec3> second;
    if (side.inner) {
      // The ribbon is linear; the rows of a patch are a degree-th part of its width apart.
      const SideCurve inner = bezier_side(*side.inner, degree);
      ribbons.across_error = std::max(ribbons.across_error, inner.error);
      for (std::size_t j = 0; j < outer.points.size(); ++j)
        second.push_back(outer.points[j] + (inner.points[j] - outer.points[j]) / ribbons.d());
    }
    ribbons.row0.push_back(std::move(outer.points));
    ribbons.row1.push_back(std::move(second));
  }
  return ribbons;
}

// The lowest degree in which the curves are themselves, or fit well enough.
Ribbons best_ribbons(const std::vector<RibbonSide>& sides) {
  Ribbons ribbons = ribbons_in(sides, highest_degree(sides));
  while (std::max(ribbons.boundary_error, ribbons.across_error) > kWantedFit * ribbons.size && ribbons.degree < kMostFitted)
    ribbons = ribbons_in(sides, ribbons.degree + 1);
  return ribbons;
}

void check_closed(const std::string& path, const std::vector<RibbonSide>& sides, Ribbons& ribbons) {
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Vec3 from = ribbons.row0[ribbons.before(k)].back(), to = ribbons.row0[k].front();
    if (!(glm::length(to - from) <= kSameSide * ribbons.size))
      fail(path, sides[k].line,
           fmt::format("found a curve that begins at ({:g}, {:g}, {:g}), expected the end of the one before, ({:g}, {:g}, {:g})", to.x,
                       to.y, to.z, from.x, from.y, from.z));
    ribbons.row0[ribbons.before(k)].back() = to;
  }
}

// Second rows where there are none.
void choose_tangents(Ribbons& ribbons) {
  for (std::size_t k = 0; k < ribbons.sides(); ++k) {
    if (!ribbons.row1[k].empty()) continue;
    const std::vector<Vec3>&before = ribbons.row0[ribbons.before(k)], &own = ribbons.row0[k], &after = ribbons.row0[ribbons.after(k)];
    const Vec3 at_start = before[before.size() - 2] - before.back(), at_end = after[1] - after[0];
    for (std::size_t j = 0; j < own.size(); ++j) {
      const double share = static_cast<double>(j) / ribbons.d();
      ribbons.row1[k].push_back(own[j] + (1 - share) * at_start + share * at_end);
    }
  }
}

// How far the ribbons' ends are from their neighbours' boundaries, which replace them; and how far apart the two inner points of a corner
// are.
struct Misfit {
  double tangent = 0, twist = 0;
};
Misfit misfit_of(const Ribbons& ribbons) {
  Misfit misfit;
  const auto d = static_cast<std::size_t>(ribbons.degree);
  for (std::size_t k = 0; k < ribbons.sides(); ++k) {
    const std::size_t before = ribbons.before(k);
    misfit.tangent = std::max({misfit.tangent, glm::length(ribbons.row1[k][0] - ribbons.row0[before][d - 1]),
                               glm::length(ribbons.row1[before][d] - ribbons.row0[k][1])});
    misfit.twist = std::max(misfit.twist, glm::length(ribbons.row1[k][1] - ribbons.row1[before][d - 1]));
  }
  return misfit;
}

// ---- the two kinds ---------------------------------------------------------------------------------------------------------

// File side k is side k + 1 of the polygon: it begins at corner k.
NSidedPatch generalised_bezier(const Ribbons& ribbons) {
  NSidedPatch patch;
  const int n = static_cast<int>(ribbons.sides()), d = ribbons.degree, rows = ribbon_rows(d);
  patch.basis = {PatchKind::generalised_bezier, n, d, SideParameters::wachspress};
  patch.points.assign(static_cast<std::size_t>(point_count(patch.basis)), Vec3(0.0));
  // Point (j, r) of a ribbon that goes on evenly.
  const auto even = [&](std::size_t k, int j, int r) {
    const auto i = static_cast<std::size_t>(j);
    return ribbons.row0[k][i] + static_cast<double>(r) * (ribbons.row1[k][i] - ribbons.row0[k][i]);
  };
  Vec3 innermost(0.0);
  int innermost_count = 0;
  for (std::size_t k = 0; k < ribbons.sides(); ++k)
    for (int r = 0; r < rows; ++r)
      for (int j = r; j < d - r; ++j) {
        const Vec3 own = even(k, j, r);
        const Vec3 p = r > 0 && j == r ? 0.5 * (own + even(ribbons.before(k), d - r, r)) : own;
        patch.points[static_cast<std::size_t>(ribbon_index(n, d, static_cast<int>(k) + 1, j, r))] = p;
        if (r + 1 < rows) continue;
        innermost += p;
        ++innermost_count;
      }
  patch.points[0] = innermost / static_cast<double>(innermost_count);
  return patch;
}

// Five points a corner (patches/surface/kinds/gregory-inl.h), and the centre.
NSidedPatch generalised_gregory(const Ribbons& ribbons) {
  NSidedPatch patch;
  patch.basis = {PatchKind::generalised_gregory, static_cast<int>(ribbons.sides()), 3, SideParameters::wachspress};
  Vec3 inner(0.0);
  for (std::size_t k = 0; k < ribbons.sides(); ++k) {
    const std::size_t before = ribbons.before(k);
    patch.points.insert(patch.points.end(),
                        {ribbons.row0[k][0], ribbons.row0[k][1], ribbons.row0[before][2], ribbons.row1[k][1], ribbons.row1[before][2]});
    inner += ribbons.row1[k][1] + ribbons.row1[before][2];
  }
  patch.points.push_back(inner / (2.0 * static_cast<double>(ribbons.sides())));
  return patch;
}

// Moves the central control point so that the centre of the patch is at a given place. Without weight there (four sides) it cannot.
bool move_centre(NSidedPatch& patch, const Vec3& to) {
  std::vector<double> W(patch.points.size());
  weights_at(patch.basis, {1, 1}, W);
  const std::size_t central = patch.basis.kind == PatchKind::generalised_bezier ? 0 : W.size() - 1;
  if (!(std::abs(W[central]) > 1e-6)) return false;
  Vec3 rest(0.0);
  for (std::size_t m = 0; m < W.size(); ++m)
    if (m != central) rest += W[m] * patch.points[m];
  patch.points[central] = (to - rest) / W[central];
  return true;
}

void report(PatchSet& set, const std::vector<RibbonSide>& sides, const Ribbons& ribbons, const Misfit& misfit) {
  using Kind = Problem::Kind;
  int pieces = 0;
  bool free = false;
  for (const RibbonSide& side : sides) {
    pieces += pieces_of(side.outer) > 1 || (side.inner && pieces_of(*side.inner) > 1);
    free = free || !side.inner;
  }
  if (pieces > 0)
    set.problems.push_back({Kind::approximated, "patch 1",
                            fmt::format("{} sides are B-splines of several pieces, of which a patch has one: fitted in degree {}, at most "
                                        "{:.3g} away; Charrot-Gregory patches between splines would keep them",
                                        pieces, ribbons.degree, ribbons.boundary_error),
                            1});
  if (free)
    set.problems.push_back({Kind::note, "patch 1",
                            "the file has boundary curves only: tangents across go evenly from one neighbour's to the other's, the inside "
                            "goes on from them",
                            1});
  const double near = kSameSide * ribbons.size;
  if (!free && misfit.tangent > near)
    set.problems.push_back(
        {Kind::approximated, "patch 1",
         fmt::format("ribbons do not end in their neighbours' boundaries: control points moved by up to {:.3g}", misfit.tangent), 1});
  if (!free && misfit.twist > near && set.patches[0].patch.basis.kind == PatchKind::generalised_bezier)
    set.problems.push_back(
        {Kind::approximated, "patch 1",
         fmt::format("ribbons that meet in a corner turn differently: inner control points are means, moved by up to {:.3g}",
                     0.5 * misfit.twist),
         1});
}

}  // namespace

PatchSet patch_of_ribbons(const std::string& path, std::vector<RibbonSide> sides, const std::optional<Vec3>& midpoint) {
  Ribbons ribbons = best_ribbons(sides);
  check_closed(path, sides, ribbons);
  choose_tangents(ribbons);
  const Misfit misfit = misfit_of(ribbons);
  const bool has_tangents = std::all_of(sides.begin(), sides.end(), [](const RibbonSide& s) { return s.inner.has_value(); });
  const bool pairs = has_tangents && ribbons.degree == 3 && misfit.twist > kSameSide * ribbons.size;

  PatchSet set;
  PatchEntry entry;
  entry.patch = pairs ? generalised_gregory(ribbons) : generalised_bezier(ribbons);
  entry.approximation_error = ribbons.boundary_error;
  const bool moved = !midpoint || move_centre(entry.patch, *midpoint);
  set.patches.push_back(std::move(entry));
  report(set, sides, ribbons, misfit);
  if (!moved)
    set.problems.push_back(
        {Problem::Kind::note, "patch 1", "the centre of a patch of this many sides cannot be given: midpoint not used", 1});
  return set;
}

}  // namespace iso
