// Pictures made by whole-number hashes, the same everywhere: for figures that other programs found on them.
#pragma once

#include <cmath>
#include <cstdint>

#include "raytracer/image_io.h"

namespace iso::test {

// In [0, 1), a multiple of 2^-24.
inline float noise(std::uint32_t x, std::uint32_t y, std::uint32_t which) {
  std::uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ which * 0xc2b2ae3du;
  h = (h ^ h >> 16) * 0x7feb352du;
  h = (h ^ h >> 15) * 0x846ca68bu;
  return static_cast<float>((h ^ h >> 16) >> 8) * 0x1p-24f;
}

// Every channel of every pixel by f(x, y, channel), opaque.
template <class F>
Image picture(int width, int height, F f) {
  Image image{width, height, false, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.rgba.emplace_back(f(x, y, 0), f(x, y, 1), f(x, y, 2), 1.0f);
  return image;
}

// Independent noise in all pixels and channels.
inline Image noise_picture(int width, int height, std::uint32_t seed) {
  return picture(width, height, [seed](int x, int y, int c) {
    return noise(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 3 * seed + static_cast<std::uint32_t>(c));
  });
}

// A ramp with a brighter disc on it, moved to the right by `shift` pixels, and some noise. Up to `peak`.
inline Image disc_picture(int width, int height, int shift, float peak, float rough, std::uint32_t seed) {
  const Image rubble = noise_picture(width, height, seed);
  return picture(width, height, [&](int x, int y, int c) {
    const int dx = 2 * (x - shift) - width, dy = 2 * y - height;
    const bool inside = 4 * (dx * dx + dy * dy) < height * height;
    const float ramp = static_cast<float>(x + 2 * y + 8 * c) / static_cast<float>(width + 2 * height + 16);
    const float r = rubble.rgba[static_cast<std::size_t>(y * width + x)][c];
    return (inside ? peak : 0.25f * ramp) * (1 - 0.5f * static_cast<float>(c) * 0.25f) + rough * r;
  });
}

}  // namespace iso::test
