// Whether a noisy picture is one of a kind: judged against the mean and the deviation of pictures with other seeds.
//
// z of a value is its distance from the mean in standard deviations of that distance, the root of the sum of
//   s^2 (1 + 1 / seeds), s^2 being the variance among the seeds, averaged over 3 x 3 pixels: that of one pixel, from few seeds, is often
//     too small;
//   c^2 / (samples^2 seeds), c being the range of the means over 5 x 5 pixels, as far as the pixel filter reaches, and 0: what no sample
//     has met so far, an edge's other side or a shadow, one of samples * seeds still may; it changes the value by up to c / samples, and z
//     by the root of `seeds`;
//   q^2, the step of a half at the mean: pictures are stored in halves.
// A block's z is that of the sum of its values, for what is too faint to be seen at a pixel. It goes without c, since what is rare averages
// out there, and adds the steps, since rounding goes the same way where a picture is even.
#pragma once

#include <span>

#include "raytracer/image_metrics.h"

namespace iso {

inline constexpr int kNoiseBlock = 8;  // pixels of a block's side; those at the right and lower border may be smaller

struct NoiseModel {
  Image mean, deviation;       // of R G B A, among the seeds
  int seeds = 0, samples = 0;  // samples: of each pixel with each seed
};

// At least two pictures of one size, each with a seed of its own. Deviations are kept to two bits after the first one, which costs less
// than their uncertainty and makes them small as a file.
NoiseModel noise_model(std::span<const Image> pictures, int samples);

struct NoiseFigures {
  double z_max = 0;  // of R, G, B, A of all pixels
  PixelPlace worst;
  std::uint64_t over_soft = 0;  // pixels with a value beyond it
  double block_z_max = 0;
  PixelPlace worst_block;  // its upper left pixel
};

// The picture has the model's size. What is not a number is infinitely far.
NoiseFigures noise_figures(const NoiseModel& model, const Image& picture, double z_soft);

}  // namespace iso
