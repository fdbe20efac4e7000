#include "raytracer/filter.h"

namespace iso {
namespace {

// The window over x in [0, 1], its top at 1/2.  [Harris 1978, four terms, -92 dB]
double blackman_harris(double x) {
  return 0.35875 - 0.48829 * std::cos(kTwoPi * x) + 0.14128 * std::cos(2 * kTwoPi * x) - 0.01168 * std::cos(3 * kTwoPi * x);
}

}  // namespace

PixelFilter::PixelFilter() {
  // Cumulative sums by the trapezoid rule, scaled to end at one.
  for (int i = 0; i < kSteps; ++i) {
    const double a = blackman_harris(double(i) / kSteps), b = blackman_harris(double(i + 1) / kSteps);
    cumulative_[i + 1] = cumulative_[i] + 0.5 * (a + b);
  }
  const double total = cumulative_[kSteps];
  for (double& c : cumulative_) c /= total;
  for (int k = 0, i = 0; k < kSteps; ++k) {
    while (i + 1 < kSteps && cumulative_[i + 1] <= double(k) / kSteps) ++i;
    guide_[k] = i;
  }
}

double PixelFilter::invert(double random) const {
  // The step that holds the number, then linear inside it.
  int i = guide_[std::clamp(static_cast<int>(random * kSteps), 0, kSteps - 1)];
  while (i + 1 < kSteps && cumulative_[i + 1] <= random) ++i;
  const double width = cumulative_[i + 1] - cumulative_[i];
  const double inside = width > 0 ? (random - cumulative_[i]) / width : 0.5;
  return kRadius * (2 * (i + inside) / kSteps - 1);
}

}  // namespace iso
