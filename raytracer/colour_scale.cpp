#include "raytracer/colour_scale.h"

#include <array>

#include "raytracer/srgb.h"

namespace iso {
namespace {

using Level = std::array<int, 3>;  // sRGB, as on the screen

// [Brewer 2003, RdBu, eleven classes], from blue to red.
constexpr std::array<Level, 11> kDiverging{{{5, 48, 97},
                                            {33, 102, 172},
                                            {67, 147, 195},
                                            {146, 197, 222},
                                            {209, 229, 240},
                                            {247, 247, 247},
                                            {253, 219, 199},
                                            {244, 165, 130},
                                            {214, 96, 77},
                                            {178, 24, 43},
                                            {103, 0, 31}}};
constexpr std::array<Level, 17> kSequential{{{68, 1, 84},
                                             {72, 24, 106},
                                             {71, 45, 123},
                                             {66, 64, 134},
                                             {59, 82, 139},
                                             {51, 99, 141},
                                             {44, 114, 142},
                                             {38, 130, 142},
                                             {33, 145, 140},
                                             {31, 159, 136},
                                             {39, 173, 129},
                                             {61, 188, 116},
                                             {92, 200, 99},
                                             {129, 211, 77},
                                             {170, 220, 50},
                                             {213, 226, 26},
                                             {253, 231, 37}}};
constexpr Level kUndefined{255, 220, 60};

Colour linear(const Level& level) {
  Colour colour;
  for (int c = 0; c < 3; ++c) colour[c] = static_cast<float>(linear_from_srgb(level[static_cast<std::size_t>(c)] / 255.0));
  return colour;
}

// Straight between the two nearest colours of a list, whose ends are at 0 and 1.
template <std::size_t N>
Colour among(const std::array<Level, N>& levels, double at) {
  const double x = std::clamp(at, 0.0, 1.0) * (N - 1);
  const auto i = std::min(static_cast<std::size_t>(x), N - 2);
  return glm::mix(linear(levels[i]), linear(levels[i + 1]), static_cast<float>(x - static_cast<double>(i)));
}

}  // namespace

Colour ColourScale::colour(double value) const {
  if (std::isnan(value)) return linear(kUndefined);
  if (diverges()) return among(kDiverging, 0.5 + 0.5 * std::clamp(value, range.lo, range.hi) / range.magnitude());
  return among(kSequential, (value - range.lo) / range.width());
}

std::vector<Colour> even_scale() {
  std::vector<Colour> colours;
  for (const Level& level : kSequential) colours.push_back(Colour(level[0], level[1], level[2]) / 255.0f);
  return colours;
}

double round_up(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  constexpr double kRounding = 1e-9;  // of the power, which may be off by its last bits
  for (const double digit : {1.0, 2.0, 5.0})
    if (x <= digit * power * (1 + kRounding)) return digit * power;
  return 10 * power;
}

}  // namespace iso
