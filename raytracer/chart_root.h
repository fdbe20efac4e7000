// From a root on the spline beside a chart of an n-sided patch to the root on the chart itself (patch_chart.h).
//
// Which rays meet a chart is decided by its spline, whose distance is proven and which neighbours share along their borders; where they
// meet it, by the chart.
#pragma once

#include "patches/surface/surface.h"
#include "raytracer/local_ray.h"

namespace iso {

struct ChartRoot {
  Vec2 st{0.0};
  double t = 0;
  unsigned steps = 0;
  bool met = true;  // false: the ray touches the spline but not the chart, within the distance of the two; the nearest point found
};

// The chart of a surface that is not its own spline, else null.
const PatchChart* blended_chart(const AnySurface& surface);

// Newton from the root of the spline.
ChartRoot root_on_chart(const PatchChart& chart, const LocalRay& ray, const Vec2& start);

}  // namespace iso
