// Differences of pictures in numbers, FLIP against the figures of its published implementation.
#include "raytracer/image_metrics.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "tests/support/test_pictures.h"

namespace iso::test {
namespace {

constexpr int kWidth = 96, kHeight = 64;

// Made with the C++ code of https://github.com/NVlabs/flip, version 1.6, commit 1eb247c, its defaults, on the pictures of
// support/test_pictures.h; the means are those of its map, added up in double.
struct PublishedFigures {
  const char* name;
  Image reference, test;
  double ldr_mean, ldr_max, hdr_mean, hdr_max;
};
std::vector<PublishedFigures> published() {
  const Image disc = disc_picture(kWidth, kHeight, 0, 0.75f, 0, 1);
  return {
      {"noise", noise_picture(kWidth, kHeight, 1), noise_picture(kWidth, kHeight, 2), 0.393831587, 0.959569395, 0.339845976, 0.9314695},
      {"disc, shifted", disc, disc_picture(kWidth, kHeight, 1, 0.75f, 0, 1), 0.0278915767, 0.538199008, 0.0183575203, 0.444986224},
      {"disc, rough", disc, disc_picture(kWidth, kHeight, 0, 0.75f, 0.03125f, 2), 0.124070794, 0.294285208, 0.176461444, 0.682335734},
      {"bright disc", disc_picture(kWidth, kHeight, 0, 64, 0.0625f, 1), disc_picture(kWidth, kHeight, 2, 48, 0.0625f, 2), 0.116889872,
       0.840427935, 0.184867844, 0.971848428},
      {"smaller than the filters", noise_picture(5, 3, 1), noise_picture(5, 3, 2), 0.492342365, 0.677226067, 0.428744541, 0.554854631},
  };
}

TEST(Flip, HasTheMeansOfThePublishedImplementation) {
  // The published code rounds to float at every step; its means and ours were found up to 2e-7 apart, single pixels up to 4e-5 (1.6e-4 on
  // the bright disc) where a root magnifies the rounding of a difference of equal edges.
  constexpr double kMeans = 1e-6, kPixels = 1e-5;
  int checked = 0;
  for (const PublishedFigures& p : published()) {
    SCOPED_TRACE(p.name);
    const FlipMap ldr = flip_ldr(p.reference, p.test), hdr = flip_hdr(p.reference, p.test);
    EXPECT_NEAR(ldr.mean, p.ldr_mean, kMeans);
    EXPECT_NEAR(ldr.max, p.ldr_max, kPixels);
    EXPECT_NEAR(hdr.mean, p.hdr_mean, kMeans);
    EXPECT_NEAR(hdr.max, p.hdr_max, kPixels);
    EXPECT_EQ(ldr.values.size(), p.reference.rgba.size());
    EXPECT_EQ(float(ldr.max), ldr.values[std::size_t(ldr.worst.y * p.reference.width + ldr.worst.x)]);
    ++checked;
  }
  EXPECT_EQ(checked, 5);
}

TEST(Flip, EqualPicturesAreNotApartAndBlackIsFarFromWhite) {
  const Image noise = noise_picture(kWidth, kHeight, 3);
  const auto grey = [](float v) { return picture(kWidth, kHeight, [v](int, int, int) { return v; }); };
  EXPECT_EQ(flip_ldr(noise, noise).max, 0);
  EXPECT_EQ(flip_hdr(noise, noise).max, 0);
  EXPECT_GT(flip_ldr(grey(0), grey(1)).mean, 0.95);
  EXPECT_EQ(flip_ldr(grey(1), grey(7)).mean, 0) << "LDR cuts at white";
  EXPECT_GT(flip_hdr(grey(1), grey(7)).mean, 0.05);
}

TEST(Flip, DegeneratePicturesGiveNumbers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();
  const Image black = picture(9, 7, [](int, int, int) { return 0.0f; });
  const Image mostly_black = picture(9, 7, [](int x, int, int) { return x == 4 ? 0.5f : 0.0f; });
  const Image wild = picture(9, 7, [&](int x, int, int) { return x % 4 == 0 ? kNan : x % 4 == 1 ? kInfinite : x % 4 == 2 ? -1.0f : 1.0f; });
  int checked = 0;
  for (const Image* a : {&black, &mostly_black, &wild})
    for (const Image* b : {&black, &mostly_black, &wild}) {
      for (const FlipMap& map : {flip_ldr(*a, *b), flip_hdr(*a, *b)})
        for (const float v : map.values) {
          EXPECT_TRUE(v >= 0 && v <= 1) << v;
          ++checked;
        }
      EXPECT_EQ(flip_hdr(*a, *b).mean > 0, a != b);
    }
  EXPECT_EQ(checked, 9 * 2 * 63);
}

TEST(Flip, SameBytesForAnyNumberOfThreads) {
  const Image a = disc_picture(130, 90, 0, 5, 0.1f, 1), b = disc_picture(130, 90, 1, 5, 0.1f, 2);
  const auto with_threads = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return std::pair(flip_hdr(a, b), difference_of(a, b));
  };
  const auto [flip1, difference1] = with_threads(1);
  const auto [flip3, difference3] = with_threads(3);
  EXPECT_EQ(flip1.values, flip3.values);
  EXPECT_EQ(flip1.mean, flip3.mean);
  EXPECT_EQ(difference1.mean, difference3.mean);
  EXPECT_EQ(difference1.rmse, difference3.rmse);
}

TEST(ImageDifference, CountsAndPlacesWhatIsChanged) {
  const Image a = noise_picture(40, 30, 5);
  EXPECT_EQ(difference_of(a, a).max, 0);
  EXPECT_EQ(difference_of(a, a).psnr, std::numeric_limits<double>::infinity());

  // One value by 1/2, another by 1/4, and a pixel's alpha.
  Image b = a;
  b.rgba[17 * 40 + 3].g += 0.5f;
  b.rgba[2 * 40 + 39].b -= 0.25f;
  b.rgba[29 * 40].a = 0.875f;
  const ImageDifference d = difference_of(a, b);
  EXPECT_NEAR(d.max, 0.5, 1e-7);
  EXPECT_EQ(d.worst.x, 3);
  EXPECT_EQ(d.worst.y, 17);
  EXPECT_EQ(d.differ, 3u);
  EXPECT_NEAR(d.mean, 0.75 / 3600, 1e-9);
  EXPECT_NEAR(d.rmse, std::sqrt(0.3125 / 3600), 1e-8);
  EXPECT_EQ(pixels_over(a, b, 0), 3u);
  EXPECT_EQ(pixels_over(a, b, 0.125), 2u);
  EXPECT_EQ(pixels_over(a, b, 0.3), 1u);
  EXPECT_EQ(silhouette_difference(a, b), 0u);
  b.rgba[29 * 40].a = 0.5f;
  EXPECT_EQ(silhouette_difference(a, b), 1u);
}

TEST(ImageDifference, PeakSignalToNoiseIsOfCodeValues) {
  // Code values 0.5 and 0.6 everywhere: 20 dB; beyond white nothing is seen.
  const auto linear = [](double code) { return float(std::pow((code + 0.055) / 1.055, 2.4)); };
  const auto grey = [](float v) { return picture(8, 8, [v](int, int, int) { return v; }); };
  EXPECT_NEAR(difference_of(grey(linear(0.5)), grey(linear(0.6))).psnr, 20, 1e-4);
  EXPECT_EQ(difference_of(grey(2), grey(3)).psnr, std::numeric_limits<double>::infinity());
}

TEST(ImageDifference, WhatIsNotANumberIsInfinitelyFarFromAllButItself) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Image a = noise_picture(4, 4, 1), b = a;
  a.rgba[5].r = kNan;
  EXPECT_EQ(difference_of(a, b).max, std::numeric_limits<double>::infinity());
  EXPECT_EQ(pixels_over(a, b, 1e30), 1u);
  b.rgba[5].r = kNan;
  EXPECT_EQ(difference_of(a, b).max, 0);
}

}  // namespace
}  // namespace iso::test
