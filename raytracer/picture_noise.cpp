#include "raytracer/picture_noise.h"

#include "patches/base/vec.h"

namespace iso {
namespace {

// 1, 1 1/4, 1 1/2, 1 3/4 times a power of two.
float rounded_deviation(double deviation) {
  int exponent = 0;
  const double mantissa = std::frexp(deviation, &exponent);
  return static_cast<float>(std::ldexp(std::round(8 * mantissa) / 8, exponent));
}

// The distance of two halves near `value`, at least of the smallest normal ones.
double half_step(float value) {
  constexpr int kHalfDigits = 11, kSmallestExponent = -13;
  int exponent = 0;
  std::frexp(value, &exponent);
  return std::ldexp(1.0, std::max(exponent, kSmallestExponent) - kHalfDigits);
}

std::size_t index_of(const Image& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
}

// Calls f(index) for the pixels at most `reach` away in x and y.
template <class F>
int for_neighbours(const Image& image, int x, int y, int reach, F f) {
  int count = 0;
  for (int j = std::max(y - reach, 0); j <= std::min(y + reach, image.height - 1); ++j)
    for (int i = std::max(x - reach, 0); i <= std::min(x + reach, image.width - 1); ++i, ++count) f(index_of(image, i, j));
  return count;
}

// The variance of the distance from the mean, without rounding and what was never met.
glm::dvec4 seen_variance(const NoiseModel& model, int x, int y) {
  glm::dvec4 squares(0.0);
  const int count = for_neighbours(model.deviation, x, y, 1, [&](std::size_t i) {
    const glm::dvec4 s(model.deviation.rgba[i]);
    squares += s * s;
  });
  return squares * ((1 + 1.0 / model.seeds) / count);
}

glm::dvec4 unseen_variance(const NoiseModel& model, int x, int y) {
  Box<glm::dvec4> means{glm::dvec4(0.0), glm::dvec4(0.0)};
  for_neighbours(model.mean, x, y, 2, [&](std::size_t i) { means.include(glm::dvec4(model.mean.rgba[i])); });
  const glm::dvec4 change = (means.hi - means.lo) / double(model.samples);
  return change * change / double(model.seeds);
}

double finite_or_far(double z) { return std::isnan(z) ? kInf : std::abs(z); }

struct Block {
  glm::dvec4 difference{0.0}, variance{0.0}, steps{0.0};
};

}  // namespace

NoiseModel noise_model(std::span<const Image> pictures, int samples) {
  ISO_CHECK(pictures.size() >= 2);
  const double count = static_cast<double>(pictures.size());
  NoiseModel model{pictures[0], pictures[0], static_cast<int>(pictures.size()), samples};
  for (std::size_t i = 0; i < model.mean.rgba.size(); ++i) {
    glm::dvec4 sum(0.0), squares(0.0);
    for (const Image& picture : pictures) sum += glm::dvec4(picture.rgba[i]);
    const glm::dvec4 mean = sum / count;
    for (const Image& picture : pictures) {
      const glm::dvec4 d = glm::dvec4(picture.rgba[i]) - mean;
      squares += d * d;
    }
    model.mean.rgba[i] = glm::vec4(mean);
    for (int c = 0; c < 4; ++c) model.deviation.rgba[i][c] = rounded_deviation(std::sqrt(squares[c] / (count - 1)));
  }
  return model;
}

NoiseFigures noise_figures(const NoiseModel& model, const Image& picture, double z_soft) {
  ISO_CHECK(picture.width == model.mean.width && picture.height == model.mean.height);
  NoiseFigures figures;
  const int across = (picture.width + kNoiseBlock - 1) / kNoiseBlock, down = (picture.height + kNoiseBlock - 1) / kNoiseBlock;
  std::vector<Block> blocks(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t i = index_of(picture, x, y);
      const glm::dvec4 difference = glm::dvec4(picture.rgba[i]) - glm::dvec4(model.mean.rgba[i]), variance = seen_variance(model, x, y);
      const glm::dvec4 unseen = unseen_variance(model, x, y);
      Block& block = blocks[static_cast<std::size_t>(y / kNoiseBlock * across + x / kNoiseBlock)];
      double z = 0;
      for (int c = 0; c < 4; ++c) {
        const double step = half_step(model.mean.rgba[i][c]);
        z = std::max(z, finite_or_far(difference[c] / std::sqrt(variance[c] + unseen[c] + step * step)));
        block.steps[c] += step;
      }
      block.difference += difference;
      block.variance += variance;
      figures.over_soft += z > z_soft;
      if (z > figures.z_max) {
        figures.z_max = z;
        figures.worst = {x, y};
      }
    }

  for (std::size_t k = 0; k < blocks.size(); ++k)
    for (int c = 0; c < 4; ++c) {
      const Block& b = blocks[k];
      const double z = finite_or_far(b.difference[c] / std::sqrt(b.variance[c] + b.steps[c] * b.steps[c]));
      if (z <= figures.block_z_max) continue;
      figures.block_z_max = z;
      figures.worst_block = {static_cast<int>(k) % across * kNoiseBlock, static_cast<int>(k) / across * kNoiseBlock};
    }
  return figures;
}

}  // namespace iso
