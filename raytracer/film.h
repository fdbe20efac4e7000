// The picture while it is made: radiance with coverage, and data of the surface at each pixel's centre.
#pragma once

#include <string>
#include <vector>

#include "raytracer/camera.h"

namespace iso {

inline constexpr int kMaxImageSide = 65536;
inline constexpr long long kMaxPixels = 1ll << 30;

// What is kept beside the colour; a set of bits.
enum Aov : unsigned { kAovNone = 0, kAovNormal = 1, kAovPosition = 2, kAovDepth = 4, kAovUv = 8, kAovId = 16, kAovAll = 31 };

// The surface at the pixel's centre, unfiltered.
struct PixelData {
  Vec3 n{0.0};      // unit outward normal of the face, world axes; zero where nothing is hit
  Vec3 p{0.0};      // world coordinates; zero where nothing is hit
  double z = kInf;  // distance along the line of sight, infinite where nothing is hit
  UV uv{0.0};       // the surface's own parameters
  std::int32_t instance = -1, face = -1;
};

// A plane of numbers beside the colour, under a name of its own: "deviation".
struct NamedPlane {
  std::string name;
  std::vector<float> values;  // width * height
};

class Film {
 public:
  // Throws std::bad_alloc if the picture does not fit.
  Film(const ImageSize& size, unsigned aovs);

  const ImageSize& size() const { return size_; }
  unsigned aovs() const { return aovs_; }

  // Both may be called for different pixels at the same time. The colour is premultiplied by its alpha.
  void set_colour(int x, int y, const glm::vec4& premultiplied);
  void set_data(int x, int y, const PixelData& data);

  // Planes of width * height values from the upper left, row by row; those of an AOV that is not kept are empty.
  std::vector<glm::vec4> rgba;
  std::vector<glm::vec3> n, p;
  std::vector<float> z;
  std::vector<glm::vec2> uv;
  std::vector<float> instance, face;  // whole numbers, exact up to 2^24; -1: nothing
  std::vector<NamedPlane> planes;     // any others

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * size_.width + x; }
  ImageSize size_;
  unsigned aovs_;
};

}  // namespace iso
