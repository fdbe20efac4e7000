// FLIP for two pictures, in steps: opponent colours, filtered as the eye's contrast sensitivity does; their distance in a perceptual space;
// the difference of edges and points, which amplifies it. All filters are separable: a row at a time, each row by one thread.
#include <tbb/parallel_for.h>

#include <array>
#include <glm/matrix.hpp>

#include "patches/base/vec.h"
#include "raytracer/image_metrics.h"

namespace iso {
namespace {

constexpr float kLargestHalf = 65504;

// ---------------------------------------------------------------------------------------------------------------- planes and filters

struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;
  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float* row(int y) { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
  const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
};
using Planes = std::array<Plane, 3>;

// Weights at -radius ... radius.
struct Taps {
  int radius = 0;
  std::vector<float> weights;
  float at(int i) const { return weights[static_cast<std::size_t>(i + radius)]; }
};

// out = sum of the taps over `source`, which is shifted by each: `source(i)` is where the row that is shifted by i begins.
template <class Source>
void add_taps(const Taps& taps, int width, float* out, Source source) {
  for (int i = -taps.radius; i <= taps.radius; ++i) {
    const float weight = taps.at(i);
    const float* from = source(i);
    for (int x = 0; x < width; ++x) out[x] += weight * from[x];
  }
}

// Beyond its border the picture goes on as the border's pixel.
Plane along_x(const Plane& plane, const Taps& taps) {
  Plane out(plane.width, plane.height);
  tbb::parallel_for(0, plane.height, [&](int y) {
    const float* row = plane.row(y);
    std::vector<float> wide(static_cast<std::size_t>(taps.radius), row[0]);
    wide.insert(wide.end(), row, row + plane.width);
    wide.insert(wide.end(), static_cast<std::size_t>(taps.radius), row[plane.width - 1]);
    add_taps(taps, plane.width, out.row(y), [&](int i) { return wide.data() + taps.radius + i; });
  });
  return out;
}

Plane along_y(const Plane& plane, const Taps& taps) {
  Plane out(plane.width, plane.height);
  tbb::parallel_for(0, plane.height, [&](int y) {
    add_taps(taps, plane.width, out.row(y), [&](int i) { return plane.row(std::clamp(y + i, 0, plane.height - 1)); });
  });
  return out;
}

// Calls f(i) for every pixel's index.
template <class F>
void for_pixels(const Plane& like, F f) {
  const auto width = static_cast<std::size_t>(like.width);
  tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(like.height), [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) f(i);
  });
}

// ---------------------------------------------------------------------------------------------------------------- colours

// Linear Rec. 709 to XYZ over the XYZ of white.
const glm::dmat3& xyz_matrix() {
  static const glm::dmat3 matrix = [] {
    const glm::dmat3 rows{{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                          {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                          {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
    glm::dmat3 over_white = rows;
    for (int i = 0; i < 3; ++i) over_white[i] /= rows[i][0] + rows[i][1] + rows[i][2];
    return glm::transpose(over_white);
  }();
  return matrix;
}
const glm::mat3& to_xyz() {
  static const glm::mat3 matrix(xyz_matrix());
  return matrix;
}
const glm::mat3& from_xyz() {
  static const glm::mat3 matrix(glm::inverse(xyz_matrix()));
  return matrix;
}

// YCxCz: linear opponent colours, lightness, red-green and blue-yellow.  [Andersson et al. 2020, 4.1]
glm::vec3 opponent(const glm::vec3& rgb) {
  const glm::vec3 xyz = to_xyz() * rgb;
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}
glm::vec3 rgb_of_opponent(const glm::vec3& ycxcz) {
  const float y = (ycxcz.x + 16) / 116;
  return from_xyz() * glm::vec3(y + ycxcz.y / 500, y, y - ycxcz.z / 200);
}

// CIELAB, its chroma less where it is dark (Hunt's effect).
glm::vec3 hunt_lab(const glm::vec3& rgb) {
  constexpr float kDelta = 6.0f / 29;
  const auto curve = [](float t) { return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29; };
  const glm::vec3 xyz = to_xyz() * rgb;
  const float x = curve(xyz.x), y = curve(xyz.y), z = curve(xyz.z);
  const float lightness = 116 * y - 16, dim = 0.01f * lightness;
  return {lightness, dim * 500 * (x - y), dim * 200 * (y - z)};
}

// HyAB: city block between lightness and chroma; Euclidean within chroma.
float hyab(const glm::vec3& a, const glm::vec3& b) {
  const float da = a.y - b.y, db = a.z - b.z;
  return std::abs(a.x - b.x) + std::sqrt(da * da + db * db);
}

// ---------------------------------------------------------------------------------------------------------------- colour pipeline

// Contrast sensitivities as Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees; that of blue-yellow is the sum of two. [same, 4.1.1]
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kLightness{1, 0.0047}, kRedGreen{1, 0.0053}, kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

// One direction of it; `part` of the weight in two directions.
Taps gaussian(const Sensitivity& s, double pixels_per_degree, double part) {
  const double widest = std::sqrt(kBlueYellow[0].b / (2 * kPi * kPi));  // three standard deviations of it
  Taps taps{static_cast<int>(std::ceil(3 * widest * pixels_per_degree)), {}};
  std::vector<double> weights;
  double sum = 0;
  for (int i = -taps.radius; i <= taps.radius; ++i) {
    const double x = i / pixels_per_degree;
    weights.push_back(std::exp(-kPi * kPi * x * x / s.b));
    sum += weights.back();
  }
  for (const double w : weights) taps.weights.push_back(static_cast<float>(std::sqrt(part) * w / sum));
  return taps;
}

// The share of each Gaussian in the blue-yellow filter: its sum over the plane of pixels.
std::array<double, 2> blue_yellow_parts(double pixels_per_degree) {
  const int radius = gaussian(kLightness, pixels_per_degree, 1).radius;
  std::array<double, 2> weights{};
  for (std::size_t k = 0; k < 2; ++k) {
    const Sensitivity& s = kBlueYellow[k];
    double line = 0;
    for (int i = -radius; i <= radius; ++i) line += std::exp(-kPi * kPi * i * i / (pixels_per_degree * pixels_per_degree * s.b));
    weights[k] = s.a * std::sqrt(kPi / s.b) * line * line;
  }
  const double sum = weights[0] + weights[1];
  return {weights[0] / sum, weights[1] / sum};
}

Plane blurred(const Plane& plane, const Taps& taps) { return along_y(along_x(plane, taps), taps); }

// Opponent colours as seen from the distance.
Planes contrast_filtered(const Planes& p, double pixels_per_degree) {
  const auto parts = blue_yellow_parts(pixels_per_degree);
  Planes out{blurred(p[0], gaussian(kLightness, pixels_per_degree, 1)), blurred(p[1], gaussian(kRedGreen, pixels_per_degree, 1)),
             blurred(p[2], gaussian(kBlueYellow[0], pixels_per_degree, parts[0]))};
  const Plane second = blurred(p[2], gaussian(kBlueYellow[1], pixels_per_degree, parts[1]));
  for_pixels(second, [&](std::size_t i) { out[2].values[i] += second.values[i]; });
  return out;
}

// The distance of colours to the power 0.7, compressed so that 0.4 of the largest one, green to blue, maps to 0.95.  [same, 4.1.3]
constexpr float kPower = 0.7f, kKnee = 0.4f, kKneeValue = 0.95f;
float compressed(float distance) {
  static const float largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kPower);
  const float d = std::pow(distance, kPower), knee = kKnee * largest;
  return d < knee ? d * kKneeValue / knee : kKneeValue + (d - knee) / (largest - knee) * (1 - kKneeValue);
}

Plane colour_difference(const Planes& a, const Planes& b, double pixels_per_degree) {
  const Planes fa = contrast_filtered(a, pixels_per_degree), fb = contrast_filtered(b, pixels_per_degree);
  const auto lab = [](const Planes& p, std::size_t i) {
    return hunt_lab(glm::clamp(rgb_of_opponent({p[0].values[i], p[1].values[i], p[2].values[i]}), 0.0f, 1.0f));
  };
  Plane out(a[0].width, a[0].height);
  for_pixels(out, [&](std::size_t i) { out.values[i] = compressed(hyab(lab(fa, i), lab(fb, i))); });
  return out;
}

// ---------------------------------------------------------------------------------------------------------------- feature pipeline

// A Gaussian of 0.082 degrees width with its first two derivatives; their positive and negative weights sum to 1 and -1. [same, 4.2]
constexpr double kFeatureWidth = 0.082;
struct FeatureTaps {
  Taps smooth, first, second;
};
FeatureTaps feature_taps(double pixels_per_degree) {
  const double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  std::array<std::vector<double>, 3> weights;
  for (int i = -radius; i <= radius; ++i) {
    const double x = i / deviation, g = std::exp(-x * x / 2);
    weights[0].push_back(g);
    weights[1].push_back(-x * g);
    weights[2].push_back((x * x - 1) * g);
  }
  const auto normalised = [radius](const std::vector<double>& w) {
    double positive = 0, negative = 0;
    for (const double x : w) (x > 0 ? positive : negative) += std::abs(x);
    Taps taps{radius, {}};
    for (const double x : w) taps.weights.push_back(static_cast<float>(x / (x > 0 ? positive : negative)));
    return taps;
  };
  return {normalised(weights[0]), normalised(weights[1]), normalised(weights[2])};
}

// How strong an edge (first derivatives) and a point (second ones) each pixel is, of the lightness from 0 to 1.
struct Features {
  Plane edge, point;
};
Features features_of(const Plane& lightness, const FeatureTaps& taps) {
  Plane grey = lightness;
  for (float& y : grey.values) y = (y + 16) / 116;
  const Plane smooth = along_x(grey, taps.smooth);
  Features f{along_y(along_x(grey, taps.first), taps.smooth), along_y(along_x(grey, taps.second), taps.smooth)};
  const Plane dy = along_y(smooth, taps.first), ddy = along_y(smooth, taps.second);
  const auto length = [](float a, float b) { return std::sqrt(a * a + b * b); };
  for_pixels(grey, [&](std::size_t i) {
    f.edge.values[i] = length(f.edge.values[i], dy.values[i]);
    f.point.values[i] = length(f.point.values[i], ddy.values[i]);
  });
  return f;
}

// The larger of both differences, over its largest value, to the power 1/2, makes the colour's difference count more.  [same, 4.3]
void amplify(Plane& colour, const Features& a, const Features& b) {
  for_pixels(colour, [&](std::size_t i) {
    const float edge = std::abs(a.edge.values[i] - b.edge.values[i]), point = std::abs(a.point.values[i] - b.point.values[i]);
    const float feature = std::sqrt(std::max(edge, point) / std::sqrt(2.0f));
    colour.values[i] = std::pow(colour.values[i], 1 - feature);
  });
}

// ---------------------------------------------------------------------------------------------------------------- pictures

// Not a number and negative: 0; not finite: the largest half.
glm::vec3 sane(const glm::vec4& pixel) {
  const auto value = [](float x) { return x > 0 ? std::min(x, kLargestHalf) : 0.0f; };
  return {value(pixel.r), value(pixel.g), value(pixel.b)};
}

// `light` makes a pixel's colours, which are cut to [0, 1].
template <class Light>
Planes opponent_planes(const Image& image, Light light) {
  const Plane empty(image.width, image.height);
  Planes p{empty, empty, empty};
  for_pixels(empty, [&](std::size_t i) {
    const glm::vec3 colour = opponent(glm::clamp(light(sane(image.rgba[i])), 0.0f, 1.0f));
    for (std::size_t c = 0; c < 3; ++c) p[c].values[i] = colour[static_cast<int>(c)];
  });
  return p;
}

template <class Light>
Plane ldr_values(const Image& reference, const Image& test, double pixels_per_degree, Light light) {
  const Planes a = opponent_planes(reference, light), b = opponent_planes(test, light);
  Plane values = colour_difference(a, b, pixels_per_degree);
  const FeatureTaps taps = feature_taps(pixels_per_degree);
  amplify(values, features_of(a[0], taps), features_of(b[0], taps));
  return values;
}

FlipMap summed(Plane plane) {
  FlipMap map;
  double sum = 0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      const double value = plane.row(y)[x];
      sum += value;
      if (value > map.max) {
        map.max = value;
        map.worst = {x, y};
      }
    }
  map.mean = plane.values.empty() ? 0 : sum / static_cast<double>(plane.values.size());
  map.values = std::move(plane.values);
  return map;
}

void check_input(const Image& a, const Image& b, const FlipSettings& settings) {
  ISO_CHECK(a.width == b.width && a.height == b.height && a.width > 0 && a.height > 0);
  ISO_CHECK(settings.pixels_per_degree > 0);
}

// ---------------------------------------------------------------------------------------------------------------- exposures

// A rational fit of the ACES film curve, its own exposure of 0.6 taken back.  [Andersson et al. 2021, 3; Narkowicz 2015]
constexpr double kAces[6] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};
float aces(float light) {
  const float x = std::min(light, kLargestHalf);  // far beyond where it passes white
  const float k[6] = {float(kAces[0]), float(kAces[1]), float(kAces[2]), float(kAces[3]), float(kAces[4]), float(kAces[5])};
  return ((k[0] * x + k[1]) * x + k[2]) / ((k[3] * x + k[4]) * x + k[5]);
}

// From the brightest pixel to the median one at 0.85 of white, in steps of about one stop.  [Andersson et al. 2021, 3]
constexpr double kTarget = 0.85;
std::vector<double> exposures_for(const Image& reference) {
  std::vector<float> luminances;
  for (const glm::vec4& pixel : reference.rgba) luminances.push_back(glm::dot(sane(pixel), glm::vec3(0.2126f, 0.7152f, 0.0722f)));
  const auto median = [&] {
    const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    return double(*middle);
  };
  const double brightest = *std::max_element(luminances.begin(), luminances.end());
  if (brightest <= 0) return {0};
  double middle = median();
  if (middle <= 0) {
    std::erase_if(luminances, [](float l) { return l <= 0; });
    middle = median();
  }

  // Where the curve reaches the target.
  const double a = kAces[0] - kTarget * kAces[3], b = kAces[1] - kTarget * kAces[4], c = kAces[2] - kTarget * kAces[5];
  const double at_target = -b / (2 * a) + std::sqrt(b * b / (4 * a * a) - c / a);
  const double start = std::log2(at_target / brightest), stop = std::log2(at_target / middle);
  const int count = std::max(2, static_cast<int>(std::ceil(stop - start)));
  std::vector<double> exposures;
  for (int i = 0; i < count; ++i) exposures.push_back(start + (stop - start) * i / (count - 1));
  return exposures;
}

}  // namespace

FlipMap flip_ldr(const Image& reference, const Image& test, const FlipSettings& settings) {
  check_input(reference, test, settings);
  return summed(ldr_values(reference, test, settings.pixels_per_degree, [](const glm::vec3& rgb) { return rgb; }));
}

FlipMap flip_hdr(const Image& reference, const Image& test, const FlipSettings& settings) {
  check_input(reference, test, settings);
  Plane largest(reference.width, reference.height);
  for (const double exposure : exposures_for(reference)) {
    const auto factor = static_cast<float>(std::exp2(exposure));
    const auto light = [factor](const glm::vec3& rgb) {
      return glm::vec3(aces(factor * rgb.r), aces(factor * rgb.g), aces(factor * rgb.b));
    };
    const Plane values = ldr_values(reference, test, settings.pixels_per_degree, light);
    for_pixels(largest, [&](std::size_t i) { largest.values[i] = std::max(largest.values[i], values.values[i]); });
  }
  return summed(std::move(largest));
}

}  // namespace iso
