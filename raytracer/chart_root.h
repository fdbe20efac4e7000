// From roots on the spline beside a chart of an n-sided patch to roots on the chart itself (patch_chart.h).
//
// Which rays meet a chart is decided by its spline, whose distance is proven and which neighbours share along their borders; where they
// meet it, by the chart.
#pragma once

#include "patches/surface/surface.h"
#include "raytracer/leaf_kernel.h"

namespace iso {

// The chart of a surface that is not its own spline, else null.
const PatchChart* blended_chart(const AnySurface& surface);

struct ChartRoot {
  Vec2 st{0.0};
  double t = 0;
  unsigned steps = 0;
  bool met = true;  // false: the ray touches the spline but not the chart, within the distance of the two; the nearest point found
};

// Newton from a root of the spline.
ChartRoot root_on_chart(const PatchChart& chart, const LocalRay& ray, const Vec2& start);

// A polynomial piece of the spline: powers about the middle of its unit square, as PartGeometry::powers, and where on the chart it lies.
struct SplinePiece {
  const double* powers;
  int pu, pv;
  Vec2 low, size;
};

// The same of several rays at once, from their roots in the piece's unit square to those on the chart, in (s, t) of the chart. Returns the
// lanes for which it did not end; theirs are left as they were, for `root_on_chart`. Instruction sets differ by rounding.
LaneMask roots_on_chart(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots);

// Steps smaller than this (of the chart's square) are taken, and the last: the next would be its square.
inline constexpr double kLastChartStep = 1e-7;
// So far beyond its borders a chart may be followed.
inline constexpr double kBeyondChart = 0.02;

}  // namespace iso
