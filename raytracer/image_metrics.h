// How far two pictures are apart, in numbers. Pictures are linear and premultiplied, of equal size. Values that are not numbers: equal ones
// do not differ; else they are infinitely far apart. Same numbers for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "raytracer/image_io.h"

namespace iso {

struct PixelPlace {
  int x = 0, y = 0;
};

struct ImageDifference {
  double max = 0;  // of the absolute differences of R, G, B, A
  PixelPlace worst;
  double mean = 0, rmse = 0;  // over pixels and channels R, G, B
  double psnr = 0;            // decibel, of the display-encoded pictures with peak 1; infinite if they are equal
  std::uint64_t differ = 0;   // pixels with any difference
};
ImageDifference difference_of(const Image& a, const Image& b);

// Pixels of which R, G, B or A differs by more than `limit`.
std::uint64_t pixels_over(const Image& a, const Image& b, double limit);

// FLIP: the difference a viewer sees when flipping between both [Andersson et al. 2020], 0 to 1 per pixel, row by row. Pictures over black.
// Values that are not numbers or negative count as 0, larger ones than the largest half as that. LDR-FLIP cuts at white.
struct FlipSettings {
  double pixels_per_degree = 67.0206;  // 0.7 m from a screen of 0.7 m and 3840 pixels
};
struct FlipMap {
  std::vector<float> values;
  double mean = 0, max = 0;
  PixelPlace worst;
};
FlipMap flip_ldr(const Image& reference, const Image& test, const FlipSettings& settings = {});
// HDR-FLIP: the largest over automatic exposures of the reference [Andersson et al. 2021], with the ACES curve. If more than half of the
// reference is black, the darkest exposure is that of the median of the rest, since the published one would be infinite.
FlipMap flip_hdr(const Image& reference, const Image& test, const FlipSettings& settings = {});

// Pixels covered (alpha over half) in one picture and not in the other.
std::uint64_t silhouette_difference(const Image& a, const Image& b);

}  // namespace iso
