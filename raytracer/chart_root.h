// From roots on the spline beside a chart of an n-sided patch to roots on the chart itself (patch_chart.h).
//
// Which rays meet a chart is decided by its spline, whose distance is proven and which neighbours share along their borders; where they
// meet it, by the chart. A root keeps its sense on the way: what enters the spline enters the chart. Where the surface folds, a ray may
// meet the two in different numbers of roots, and Newton may take a root of the one to the wrong root of the other. So its steps must
// shrink at once (but see kAboutCorner) and the ray must see the same side all the way; otherwise the root is followed through the surfaces
// between the two, (1 - x) spline + x chart, none of which is farther from the chart than the spline is. It arrives, or the ray touches one
// of them. And where the ray misses the spline beside a fold by less than that distance, the chart's own fold is looked for there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "patches/surface/surface.h"
#include "raytracer/leaf_kernel.h"

namespace iso {

// The chart of a surface that is not its own spline, else null.
const PatchChart* blended_chart(const AnySurface& surface);

struct ChartRoot {
  Vec2 st{0.0};
  double t = 0;
  unsigned steps = 0;
  bool met = true;  // false: the ray touches a surface between spline and chart; (s, t) of the last root found on the way there, at most
                    // the distance of the two off the ray
};

// From a root of the spline.
ChartRoot root_on_chart(const PatchChart& chart, const LocalRay& ray, const Vec2& start);

// Where the ray passes the spline beside a fold by no more than the chart is away: the two roots of the chart there, if it has them.
std::optional<std::array<ChartRoot, 2>> roots_at_fold(const PatchChart& chart, const LocalRay& ray, const Vec2& near);

// A polynomial piece of the spline: powers about the middle of its unit square, as PartGeometry::powers, and where on the chart it lies.
struct SplinePiece {
  const double* powers;
  int pu, pv;
  Vec2 low, size;
};

// The same of several rays at once, without the surfaces between: from their roots in the piece's unit square to those on the chart, in
// (s, t) of the chart. Returns the lanes for which it did not end as it should; theirs are left as they were, for `root_on_chart`.
// Instruction sets differ by rounding.
LaneMask roots_on_chart(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots);

// Steps smaller than this (of the chart's square) are taken, and the last: the next would be its square.
inline constexpr double kLastChartStep = 1e-7;
// By mean value coordinates the tangents of a chart depend on the direction in which its corner lies, so that what a step leaves is its
// square over the distance from the corner: by this steps must be smaller there.
inline bool turns_about_corner(const PatchChart& chart) { return chart.basis.parameters == SideParameters::mean_value; }
inline double scale_of_steps(const PatchChart& chart, double s, double t) {
  return turns_about_corner(chart) ? std::min(1.0, std::max(std::abs(s), std::abs(t))) : 1.0;
}
// So far beyond its borders a chart may be followed, and so long may a first step be.
inline constexpr double kBeyondChart = 0.02;
// Each of Newton's steps must be shorter than the one before by this: where it converges it soon squares them.
inline constexpr double kChartContraction = 0.25;

}  // namespace iso
