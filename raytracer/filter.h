// The pixel filter, by importance sampling: each sample is placed with the filter's density and counts fully, so that a pixel depends
// on no other pixel's samples and tiles need no borders.  [Ernst et al. 2006]
#pragma once

#include <array>

#include "patches/base/vec.h"

namespace iso {

// Separable Blackman-Harris window; non-negative, smooth, no ringing.
class PixelFilter {
 public:
  static constexpr double kRadius = 1.5;         // pixels; the visible width is about a third of the support
  static constexpr double kDeviation = 0.41552;  // pixels: the standard deviation of an offset along one axis

  PixelFilter();

  // Maps a point of (0, 1)^2 to an offset from the pixel centre, in pixels.
  Vec2 offset(const Vec2& random) const { return {invert(random.x), invert(random.y)}; }

 private:
  static constexpr int kSteps = 512;
  double invert(double random) const;
  std::array<double, kSteps + 1> cumulative_{};
  std::array<int, kSteps> guide_{};  // where the search for k / kSteps begins
};

}  // namespace iso
