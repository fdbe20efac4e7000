#include "raytracer/difference_pictures.h"

#include <array>

#include "patches/base/vec.h"
#include "raytracer/exr_writer.h"
#include "raytracer/srgb.h"

namespace iso {
namespace {

// What the screen shows, and black for what is not a number.
glm::vec3 shown(const glm::vec4& pixel) {
  const auto code = [](float light) { return light > 0 ? srgb_from_linear(std::min(light, 1.0f)) : 0.0f; };
  return {code(pixel.r), code(pixel.g), code(pixel.b)};
}

// "Magma" of matplotlib (public domain, CC0), every sixteenth part of it: even steps look even, also printed grey.
constexpr std::array<std::array<float, 3>, 17> kMagma{{{0.001f, 0.000f, 0.014f},
                                                       {0.040f, 0.031f, 0.134f},
                                                       {0.113f, 0.065f, 0.277f},
                                                       {0.212f, 0.062f, 0.419f},
                                                       {0.317f, 0.072f, 0.485f},
                                                       {0.415f, 0.110f, 0.505f},
                                                       {0.513f, 0.148f, 0.508f},
                                                       {0.614f, 0.182f, 0.499f},
                                                       {0.716f, 0.215f, 0.475f},
                                                       {0.817f, 0.256f, 0.436f},
                                                       {0.904f, 0.320f, 0.388f},
                                                       {0.961f, 0.418f, 0.360f},
                                                       {0.987f, 0.536f, 0.382f},
                                                       {0.996f, 0.654f, 0.446f},
                                                       {0.997f, 0.770f, 0.535f},
                                                       {0.992f, 0.884f, 0.640f},
                                                       {0.987f, 0.991f, 0.750f}}};
glm::vec3 magma(float value) {
  const float at = std::clamp(value, 0.0f, 1.0f) * (kMagma.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kMagma.size() - 2);
  const auto colour = [](std::size_t k) { return glm::vec3(kMagma[k][0], kMagma[k][1], kMagma[k][2]); };
  const float t = at - static_cast<float>(i);
  return (1 - t) * colour(i) + t * colour(i + 1);
}

}  // namespace

SignedDifference signed_difference(const Image& reference, const Image& test) {
  ISO_CHECK(reference.width == test.width && reference.height == test.height);
  std::vector<glm::vec3> differences;
  float largest = 0;
  for (std::size_t i = 0; i < test.rgba.size(); ++i) {
    differences.push_back(shown(test.rgba[i]) - shown(reference.rgba[i]));
    for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(differences.back()[c]));
  }
  SignedDifference result{{test.width, test.height, false, {}}, largest > 0 ? 1 / double(largest) : 1};
  for (const glm::vec3& d : differences) result.picture.rgba.emplace_back(0.5f + 0.5f * static_cast<float>(result.gain) * d, 1.0f);
  return result;
}

Image flip_picture(const FlipMap& map, int width, int height) {
  ISO_CHECK(map.values.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  Image image{width, height, false, {}};
  for (const float value : map.values) image.rgba.emplace_back(magma(value), 1.0f);
  return image;
}

Result<std::string> encode_image(const Image& image, const std::string& comment) {
  Film film({image.width, image.height}, kAovNone);
  film.rgba = image.rgba;
  ImageInfo info;
  info.comments = comment;
  return encode_exr(film, info, 1);
}

Result<std::string> encode_difference(const Image& reference, const Image& test) {
  ISO_CHECK(reference.width == test.width && reference.height == test.height);
  Image difference = test;
  for (std::size_t i = 0; i < test.rgba.size(); ++i) difference.rgba[i] -= reference.rgba[i];
  return encode_image(difference, "the second picture less the first");
}

}  // namespace iso
