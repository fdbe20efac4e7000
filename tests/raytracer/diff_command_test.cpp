// `isophote diff`: its numbers, limits, exit codes and pictures, and the second opinion of OpenImageIO's idiff.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "patches/files/output_file.h"
#include "raytracer/difference_pictures.h"
#include "tests/support/child.h"
#include "tests/support/test_pictures.h"

namespace iso::test {
namespace {

using nlohmann::json;

constexpr int kWidth = 48, kHeight = 32;
constexpr double kHalf = 0x1p-11;  // rounding of a half near 1
constexpr double kPrinted = 1e-4;  // idiff prints 6 digits, the text of diff 4

class DiffCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_.path() / name; }
  std::string exr(const std::string& name, const Image& image) {
    const auto bytes = encode_image(image, "");
    EXPECT_TRUE(bytes && write_whole_file(path(name), *bytes));
    return path(name);
  }
  // Code values, as they are to be in the file.
  std::string png(const std::string& name, const Image& image) {
    EXPECT_TRUE(write_image_8bit(path(name), image));
    return path(name);
  }
  ChildResult diff(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "diff");
    return run_isophote(arguments);
  }
  json numbers(const std::string& a, const std::string& b) {
    const ChildResult result = diff({a, b, "--json"});
    EXPECT_LE(result.code, 1) << result.summary();
    return json::parse(result.out, nullptr, false);
  }

 private:
  TemporaryDir dir_;
};

Image base() { return disc_picture(kWidth, kHeight, 0, 0.75f, 0.0625f, 1); }

// One pixel of `base` with its red larger.
Image spotted(float by) {
  Image image = base();
  image.rgba[5 * kWidth + 7].r += by;
  return image;
}

double number_after(const std::string& text, const std::string& words) {
  std::smatch match;
  if (!std::regex_search(text, match, std::regex(words + "\\s*=?\\s*([-+.0-9eainf]+)"))) return NAN;
  return std::stod(match[1]);
}

TEST_F(DiffCommand, EqualPicturesEndWithZeroAndOneOtherPixelWithOne) {
  const std::string a = exr("a.exr", base()), b = exr("b.exr", spotted(0.5f));
  const ChildResult equal = diff({a, a});
  EXPECT_EQ(equal.code, 0) << equal.summary();
  EXPECT_TRUE(equal.out.starts_with("equal: 48 x 32 pixels\nFLIP mean 0, max 0 at (0, 0)\nHDR-FLIP mean 0,")) << equal.out;
  EXPECT_EQ(equal.err, "");

  const ChildResult other = diff({a, b});
  EXPECT_EQ(other.code, 1) << other.summary();
  EXPECT_EQ(other.error_lines(), 1) << other.err;
  EXPECT_NE(other.err.find("b.exr: not equal in 1 pixel\n"), std::string::npos) << other.err;
  EXPECT_NEAR(number_after(other.out, "max"), 0.5, kHalf);
  EXPECT_NE(other.out.find("at (7, 5)"), std::string::npos) << other.out;
}

TEST_F(DiffCommand, TheJsonHasTheNumbersOfTheFunctions) {
  const Image a = base(), b = disc_picture(kWidth, kHeight, 1, 0.75f, 0.0625f, 1);
  const std::string file_a = exr("a.exr", a), file_b = exr("b.exr", b);
  const json j = numbers(file_a, file_b);
  const auto read_a = read_image(file_a), read_b = read_image(file_b);
  ASSERT_TRUE(read_a && read_b);
  const ImageDifference d = difference_of(*read_a, *read_b);
  EXPECT_EQ(j["max"], d.max);
  EXPECT_EQ(j["worst"], (json{d.worst.x, d.worst.y}));
  EXPECT_EQ(j["mean"], d.mean);
  EXPECT_EQ(j["rmse"], d.rmse);
  EXPECT_EQ(j["psnr"], d.psnr);
  EXPECT_EQ(j["differ"], d.differ);
  EXPECT_EQ(j["flip_ldr"]["mean"], flip_ldr(*read_a, *read_b).mean);
  EXPECT_EQ(j["flip_hdr"]["mean"], flip_hdr(*read_a, *read_b).mean);
  EXPECT_EQ(j["kept"], false);
  EXPECT_EQ(numbers(file_a, file_a)["psnr"], nullptr) << "infinite";
}

TEST_F(DiffCommand, LimitsAreKeptOrToldWithExitCodeOne) {
  const std::string a = exr("a.exr", base()), b = exr("b.exr", spotted(0.5f));  // one pixel of 1536: 0.0651 %
  const struct {
    std::vector<std::string> limits;
    int code;
    const char* told;
  } cases[] = {
      {{"--hard", "0.51"}, 0, ""},
      {{"--hard", "0.49"}, 1, "over 0.49: 1 pixel, the worst, (7, 5), by 0."},
      {{"--soft", "0.1"}, 1, "0.0651 % of the pixels differ by more than 0.1; 0 % may"},
      {{"--soft", "0.1", "--percent", "0.07"}, 0, ""},
      {{"--soft", "0.1", "--percent", "0.06"}, 1, "0.06 % may"},
      {{"--soft", "0.1", "--percent", "0.07", "--hard", "0.2"}, 1, "over 0.2: 1 pixel"},
      {{"--flip", "0.5"}, 0, ""},
      {{"--flip", "0.00001"}, 1, "1e-05 is allowed"},
  };
  int checked = 0;
  for (const auto& c : cases) {
    std::vector<std::string> arguments{a, b};
    arguments.insert(arguments.end(), c.limits.begin(), c.limits.end());
    const ChildResult result = diff(arguments);
    EXPECT_EQ(result.code, c.code) << ++checked << ": " << result.summary();
    EXPECT_EQ(result.err.empty(), c.code == 0) << result.err;
    EXPECT_NE(result.err.find(c.told), std::string::npos) << result.err;
    EXPECT_NE(result.out.find("FLIP mean"), std::string::npos) << "numbers are always printed";
  }
}

TEST_F(DiffCommand, CodeValuesAreComparedAsLight) {
  // The same colours, half covered: as an EXR in light, as a PNG in code values that are not multiplied with alpha.
  Image light{kWidth, kHeight, true, {}}, code = light;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const float alpha = i % 3 == 0 ? 0.6f : 1.0f, value = float(i % 256) / 255;
    code.rgba.emplace_back(value, 1 - value, 0.2f, alpha);
    const auto decoded = [](float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); };
    light.rgba.emplace_back(glm::vec4(decoded(value), decoded(1 - value), decoded(0.2f), 1) * alpha);
  }
  const json j = numbers(exr("a.exr", light), png("b.png", code));
  EXPECT_LT(j["max"], 2 * kHalf);
  EXPECT_FALSE(j.contains("flip_hdr"));
  EXPECT_GT(j["psnr"], 70);
}

TEST_F(DiffCommand, ErrorsHaveTheirExitCodesAndNameTheFiles) {
  const std::string a = exr("a.exr", base()), small = exr("small.exr", disc_picture(40, 32, 0, 1, 0, 1)),
                    opaque = png("opaque.png", base());
  const ChildResult sizes = diff({a, small}), channels = diff({a, opaque}), missing = diff({a, path("none.png")});
  EXPECT_EQ(sizes.code, 3);
  EXPECT_NE(sizes.err.find("small.exr: 40 x 32 pixels"), std::string::npos) << sizes.err;
  EXPECT_NE(sizes.err.find("a.exr: 48 x 32 pixels"), std::string::npos) << sizes.err;
  EXPECT_EQ(channels.code, 3);
  EXPECT_NE(channels.err.find("channels R G B;"), std::string::npos) << channels.err;
  EXPECT_EQ(missing.code, 4);
  EXPECT_NE(missing.err.find("none.png"), std::string::npos) << missing.err;
  EXPECT_EQ(diff({a, a, "-o", path("none/d.png")}).code, 4);
  EXPECT_EQ(diff({a, a, "-o", path("d.nonsense")}).code, 2);
  int refused = 0;
  for (const std::vector<std::string>& bad : std::vector<std::vector<std::string>>{
           {a}, {a, a, "--percent", "1"}, {a, a, "--soft", "-1"}, {a, a, "--hard", "x"}, {a, a, "--flip", "2"}, {a, a, "--nonsense"}})
    refused += diff(bad).code == 2;
  EXPECT_EQ(refused, 6);
}

TEST_F(DiffCommand, PicturesShowWhereTheDifferenceIs) {
  const std::string a = exr("a.exr", base()), b = exr("b.exr", spotted(-0.25f));
  const ChildResult result = diff({a, b, "-o", path("d.png"), "--flip-map", path("f.png")});
  ASSERT_EQ(result.code, 1) << result.summary();
  EXPECT_NE(result.err.find("d.png: differences of code values times"), std::string::npos) << result.err;
  ASSERT_EQ(diff({a, b, "-o", path("d.exr")}).code, 1);
  const auto difference = read_image(path("d.png")), raw = read_image(path("d.exr")), map = read_image(path("f.png"));
  ASSERT_TRUE(difference && raw && map);
  const std::size_t spot = 5 * kWidth + 7, far = 20 * kWidth + 40;
  EXPECT_EQ(difference->rgba[spot].r, 0) << "darker, and the largest";
  EXPECT_NEAR(difference->rgba[spot].g, 0.5, 1 / 255.0);
  EXPECT_NEAR(difference->rgba[far].r, 0.5, 1 / 255.0);
  EXPECT_NEAR(raw->rgba[spot].r, -0.25, kHalf);
  EXPECT_EQ(raw->rgba[far].r, 0);
  EXPECT_GT(map->rgba[spot].r, 0.1);
  EXPECT_LT(map->rgba[far].r, 0.01);
}

TEST_F(DiffCommand, IdiffFindsTheSameMaximumMeanRmseAndPeakSignalToNoise) {
  // It counts alpha among the channels, which is equal here: its means are over four where ours are over three.
  const Image a = base(), b = disc_picture(kWidth, kHeight, 1, 0.75f, 0.0625f, 1);
  const std::string exr_a = exr("a.exr", a), exr_b = exr("b.exr", b), png_a = png("a.png", a), png_b = png("b.png", b);
  const ChildResult of_exr = run_child({"/usr/bin/idiff", exr_a, exr_b}), of_png = run_child({"/usr/bin/idiff", png_a, png_b});
  const json j = numbers(exr_a, exr_b);
  EXPECT_NEAR(number_after(of_exr.out, "Max error"), j["max"], kPrinted) << of_exr.out;
  EXPECT_NEAR(number_after(of_exr.out, "Mean error") * 4 / 3, j["mean"], kPrinted);
  EXPECT_NEAR(number_after(of_exr.out, "RMS error") * std::sqrt(4.0 / 3), j["rmse"], kPrinted);
  const std::string at = fmt::format("@ ({}, {}, ", int(j["worst"][0]), int(j["worst"][1]));
  EXPECT_NE(of_exr.out.find(at), std::string::npos) << at << of_exr.out;

  // Its PSNR is of the values in the file; ours is always of code values.
  EXPECT_NEAR(number_after(of_png.out, "Peak SNR"), numbers(png_a, png_b)["psnr"], 0.01) << of_png.out;
}

}  // namespace
}  // namespace iso::test
