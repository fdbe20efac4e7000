// The biquintic spline beside a chart of an n-sided patch (patch_chart.h), and the proof of its distance.
//
// The weights of a kind are fixed functions, so each has one spline for all patches: Hermite interpolation of the derivatives through
// (2, 2) at the nodes of a grid that is graded toward the corner. Its distance from the weight is bounded by Taylor models over divided
// cells (taylor.h). A chart's spline has the poles sum_m p_m (poles of weight m), and its distance is at most the sum of the distances.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "patches/surface/patch_basis.h"

namespace iso {

// Cells: each level halves those of the one before, the first of a row twice, which divides the distance by about sixteen. Fine at the
// corner: there the first cell of a row is halved further. Second derivatives of a blended chart depend on the direction at its corner,
// which no spline follows; so in the first cells, whatever their size, the spline's tangents are off by some share of that size.
enum class AtCorner : std::uint8_t { coarse, fine };
struct SplineGrid {
  int level = 0;
  AtCorner at_corner = AtCorner::coarse;

  bool operator==(const SplineGrid&) const = default;
};
inline constexpr int kSplineLevels = 4, kSplineDegree = 5;

// First derivatives at one place, per control point: the weights', and those of their splines.
struct SampledSlopes {
  std::vector<double> s, t, spline_s, spline_t;
};

struct WeightSplines {
  std::vector<double> knots;               // the same in s and t; degree 5, inner knots three times
  int count = 0;                           // poles in s, and in t
  std::vector<std::vector<double>> poles;  // per control point, count * count, t fastest
  // Bounds of |W_m - spline| over each of `cells` cells, one cell after the other: of all points alone; of the pairs by sum and half
  // difference, since pairs lie close to each other and their errors all but cancel.
  int cells = 0;
  std::vector<double> error;
  std::vector<std::pair<int, int>> pairs;
  std::vector<double> error_of_sum, error_of_difference;
  // In the middle of the cells' sides along both borders at the corner, and of the cells on the diagonal.
  std::vector<SampledSlopes> slopes;
};

// Made once per basis and grid, kept while the program runs; safe from all threads.
std::shared_ptr<const WeightSplines> weight_splines(const PatchBasis& basis, const SplineGrid& grid);

}  // namespace iso
