// Patches with any number of sides, as control points and the functions that weigh them: S = sum_m p_m W_m, sum_m W_m = 1.
//
// The weights of a kind are fixed functions over one regular polygon: they depend on the kind, the number of sides and the degree only, not
// on the points. So they are written once per kind, generic over their number type (patch_basis-inl.h): doubles give points, jets
// derivatives, Taylor models proven bounds, packs of lanes speed.
//
// Domain. A regular polygon with corners v_0 .. v_(n-1), counter-clockwise; side k runs from v_(k-1) to v_k [Hettinga 2021, 2.3.5]. It is
// covered by n charts (s, t) in [0, 1]^2, one a corner: (0, 0) is the corner, s runs along side k + 1 to its middle, t along side k back to
// its middle, (1, 1) is the centre of the polygon; in between the map is bilinear. All formulas are written in the chart of corner 0; the
// others follow by turning the control points, since every kind treats its sides alike.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "patches/base/jet.h"

namespace iso {

enum class PatchKind : std::uint8_t {
  bezier_triangle,      // three sides, any degree [Hettinga 2021, 2.3.1]
  gregory_triangle,     // quartic with pairs of inner points [Longhi 1985; Hettinga 2021, 2.3.4]
  gregory_quad,         // bicubic with pairs of inner points [Chiyokura, Kimura 1983; Hettinga 2021, 2.3.4, erratum b22]
  generalised_bezier,   // any number of sides, degree 3 and up [Varady, Salvi, Kariko 2016; Hettinga 2021, 2.3.5]
  generalised_gregory,  // the cubic one with pairs of inner points [Hettinga, Kosinka 2018; Hettinga 2021, 2.3.5.1]
  charrot_gregory,      // corner interpolators, blended [Charrot, Gregory 1984; Hettinga 2021, 8.2.5 and its erratum]
};
inline constexpr int kPatchKinds = 6;
const char* name_of(PatchKind kind);  // "Bezier triangle", ...

// What the parameters of the sides are made of, for the kinds that have a choice.
enum class SideParameters : std::uint8_t { wachspress, mean_value, distance };

inline constexpr int kMostSides = 16;

struct PatchBasis {
  PatchKind kind = PatchKind::gregory_quad;
  int sides = 4;
  int degree = 3;  // of the boundary curves
  SideParameters parameters = SideParameters::wachspress;

  bool operator==(const PatchBasis&) const = default;
};

// Says what is wrong (sides, degree, or a choice that the kind does not have), or nothing (empty).
std::string problem_of(const PatchBasis& basis);

// The number of control points.
int point_count(const PatchBasis& basis);

// Entry m: which control point takes the place of m when the patch is seen from the next corner. The order of the points is told with
// each kind in kinds/.
std::vector<int> points_from_next_corner(const PatchBasis& basis);

// The control points of the boundary curve of a side, from v_(side-1) to v_side: degree + 1 indices.
std::vector<int> points_of_side(const PatchBasis& basis, int side);

// The pairs of inner points at the corners: where patches are built from a mesh they lie close together.
std::vector<std::pair<int, int>> pairs_of(const PatchBasis& basis);

// The weights at (s, t) in the chart of corner 0; W.size() == point_count. A little beyond the chart they continue, so that Newton may step
// over a border; with mean value coordinates not behind the corner.
void weights_at(const PatchBasis& basis, const Vec2& st, std::span<double> W);
// With derivatives in s and t. At the corner itself the second derivatives of blended kinds depend on the direction: those along s = t.
// With mean value coordinates the first ones do, too: those along the borders. The second are unbounded there: 0 stands for them [Hormann,
// Floater 2006].
void weights_at(const PatchBasis& basis, const Vec2& st, std::span<Dual2> W);

// Corner k of the polygon, and the point of it that belongs to (s, t) in the chart of corner 0. Circumscribed circle of radius 1 about the
// origin, corner 0 at (1, 0).
Vec2 domain_corner(int sides, int k);
Vec2 domain_point(int sides, const Vec2& st);

// The same as linear forms: x - v_0 = along_s s + along_t t + across s t, the distance from side k inward (0 and 1 meet in the corner), and
// v_k - v_0.
struct DomainRates {
  struct Side {
    double at_corner = 0, by_s = 0, by_t = 0, by_st = 0;
  };
  Vec2 along_s{0.0}, along_t{0.0}, across{0.0};
  std::array<Side, kMostSides> side;
  std::array<Vec2, kMostSides> corner;
};
// Made once; sides at most kMostSides.
const DomainRates& domain_rates(int sides);

}  // namespace iso
