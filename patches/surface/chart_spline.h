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

struct WeightSplines {
  std::vector<double> knots;               // the same in s and t; degree 5, inner knots three times
  int count = 0;                           // poles in s, and in t
  std::vector<std::vector<double>> poles;  // per control point, count * count, t fastest
  // Bounds, for |W_m - spline|: of all points alone; of the pairs by sum and half difference.
  std::vector<double> error;
  std::vector<std::pair<int, int>> pairs;  // inner points of a corner, close to each other: their errors all but cancel
  std::vector<double> error_of_sum, error_of_difference;
};

// Made once per basis, kept while the program runs; safe from all threads.
std::shared_ptr<const WeightSplines> weight_splines(const PatchBasis& basis);

}  // namespace iso
