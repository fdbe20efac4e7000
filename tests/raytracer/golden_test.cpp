// Every scene of the gallery looks like its golden picture; what judges it sees what is wrong and nothing else.
#include "raytracer/cmd/golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "tests/support/child.h"
#include "tests/support/test_pictures.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 800'000;  // of all goldens together, 19 of them

fs::path source(const std::string& name) { return fs::path(ISOPHOTE_SOURCE_DIR) / name; }
std::string scene_file(const std::string& name) { return source("scenes/" + name + ".json"); }

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const fs::path& scene : files_in(source("scenes"), {".json"}))
    if (scene.filename() != "scene.schema.json") names.push_back(scene.stem());
  return names;
}

Golden golden_of(const std::string& scene) {
  const auto place = golden_place(scene);
  EXPECT_TRUE(place) << scene;
  auto golden = read_golden(*place);
  EXPECT_TRUE(golden) << golden.error().text();
  return std::move(*golden);
}

Image rendered(const std::string& scene, const Golden& golden, std::uint64_t seed) {
  const auto pictures = render_scene_pictures(scene, {{golden.size, golden.samples, seed}});
  EXPECT_TRUE(pictures) << pictures.error().text();
  return pictures->front();
}

// A tree with one scene, in the text of which `from` may be replaced, and a copy of its golden.
class Tree {
 public:
  explicit Tree(const std::string& name) : name_(name) {
    fs::create_directory(dir_.path() / "scenes");
    fs::create_directories(dir_.path() / "reference" / "golden");
    fs::create_directory_symlink(source("tests"), dir_.path() / "tests");
    fs::copy_file(scene_file(name), scene());
  }
  std::string scene() const { return dir_.path() / "scenes" / (name_ + ".json"); }
  fs::path golden() const { return dir_.path() / "reference" / "golden" / name_; }
  fs::path path() const { return dir_.path(); }

  void copy_golden() const { fs::copy(source("reference/golden/" + name_), golden()); }
  void replace(const std::string& from, const std::string& to) const {
    std::string text = detail::content_of(scene());
    const auto at = text.find(from);
    ASSERT_NE(at, text.npos) << from;
    std::ofstream(scene()) << text.replace(at, from.size(), to);
  }

 private:
  TemporaryDir dir_;
  std::string name_;
};

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(Golden, EverySceneOfTheGalleryLooksLikeItsGolden) {
  const std::string failures = fs::current_path() / "golden-failures";
  int scenes = 0;
  for (const std::string& name : scene_names()) {
    const auto verdict = check_golden(scene_file(name), 0, failures);
    ASSERT_TRUE(verdict) << verdict.error().text();
    EXPECT_TRUE(verdict->broken.empty()) << name << ":\n" << joined(verdict->broken);
    std::cout << fmt::format("{}: worst {:.4g} at ({}, {}), {:.3g} % over soft, block {:.3g}\n", name, verdict->worst_value,
                             verdict->worst.x, verdict->worst.y, verdict->percent_over_soft, verdict->worst_block);
    ++scenes;
  }
  EXPECT_GE(scenes, 11);
}

TEST(Golden, EachHasASceneAReasonAndLimitsAndTheyAreSmallTogether) {
  const auto names = scene_names();
  const std::set<std::string> scenes(names.begin(), names.end());
  std::uintmax_t bytes = 0;
  std::size_t goldens = 0;
  for (const auto& entry : fs::directory_iterator(source("reference/golden"))) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename();
    EXPECT_TRUE(scenes.count(name)) << name;
    const Golden golden = golden_of(scene_file(name));
    EXPECT_GT(golden.why.size(), 10u) << name;
    EXPECT_GT(golden.reason.size(), 10u) << name;
    EXPECT_GT(golden.limits.hard, golden.limits.soft) << name;
    EXPECT_EQ(golden.limits.block > 0, golden.test == GoldenTest::noise) << name;
    for (const auto& file : fs::directory_iterator(entry)) bytes += file.file_size();
    ++goldens;
  }
  EXPECT_EQ(goldens, scenes.size());
  EXPECT_LT(bytes, kMostBytes);
}

TEST(Golden, OtherSeedsPassTheTestOfNoise) {
  int checked = 0;
  for (const char* name : {"assembly", "trimmed-sheet"})
    for (const std::uint64_t other : {1, 2, 3}) {
      const auto verdict = check_golden(scene_file(name), other, fs::current_path() / "golden-failures");
      ASSERT_TRUE(verdict) << verdict.error().text();
      EXPECT_TRUE(verdict->broken.empty()) << name << ", " << other << ":\n" << joined(verdict->broken);
      EXPECT_GT(verdict->worst_value, 2) << "another seed has other noise";
      ++checked;
    }
  EXPECT_EQ(checked, 6);
}

Image shifted(const Image& image) {
  Image result = image;
  for (std::size_t i = 1; i < image.rgba.size(); ++i)
    if (i % static_cast<std::size_t>(image.width) != 0) result.rgba[i] = image.rgba[i - 1];
  return result;
}

Image brighter(Image image, float factor) {
  for (glm::vec4& pixel : image.rgba) pixel = glm::vec4(factor * glm::vec3(pixel), pixel.a);
  return image;
}

// The first pixel after the middle whose neighbours look alike: within a face, not at an edge, where a sample more or less is common.
std::size_t even_pixel(const Image& image) {
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t i = image.rgba.size() / 2; i < image.rgba.size() - 3 * width; ++i) {
    Range green;
    for (std::size_t k = 0; k < 25; ++k) green.include(image.rgba[i + (k / 5) * width + k % 5 - 2 * width - 2].g);
    if (green.width() < 0.05) return i;
  }
  ADD_FAILURE() << "no even place";
  return 0;
}

// A fifth of its range in one pixel: 3 samples of 16.
Image spotted(Image image) {
  glm::vec4& pixel = image.rgba[even_pixel(image)];
  pixel.g += pixel.g > 0.5f ? -0.2f : 0.2f;
  return image;
}

TEST(Golden, WrongPicturesFail) {
  int failed = 0, passed = 0;
  for (const std::string& name : scene_names()) {
    const Golden golden = golden_of(scene_file(name));
    const Image right = rendered(scene_file(name), golden, golden.seed + (golden.test == GoldenTest::noise ? 16 : 0));
    passed += judge(golden, right).broken.empty();
    const struct {
      const char* what;
      Image picture;
    } wrong[] = {
        {"shifted by a pixel", shifted(right)}, {"brighter by a hundredth", brighter(right, 1.01f)}, {"one pixel", spotted(right)}};
    for (const auto& w : wrong) {
      const GoldenVerdict verdict = judge(golden, w.picture);
      EXPECT_FALSE(verdict.broken.empty()) << name << ": " << w.what << ", worst " << verdict.worst_value << ", block "
                                           << verdict.worst_block;
      failed += !verdict.broken.empty();
    }
  }
  EXPECT_EQ(passed * 3, failed);
  EXPECT_GE(passed, 11);
}

TEST(Golden, AFaceOfAnotherColourFailsAndLeavesItsPicturesWhereItSays) {
  // One of five colours of the tea set, by six of 255 in green.
  const Tree tree("tea-set");
  tree.copy_golden();
  tree.replace("#b8bcc2", "#b8c2c2");
  const auto verdict = check_golden(tree.scene(), 0, tree.path() / "failures");
  ASSERT_TRUE(verdict) << verdict.error().text();
  ASSERT_GE(verdict->broken.size(), 2u);
  const fs::path folder = tree.path() / "failures" / "tea-set";
  EXPECT_EQ(verdict->broken.back(), folder.string() + ": got.exr, expected.exr, difference.png");
  int pictures = 0;
  for (const char* name : {"got.exr", "expected.exr", "difference.png"}) {
    const auto picture = read_image(folder / name);
    pictures += picture && picture->width == 160 && picture->height == 120;
  }
  EXPECT_EQ(pictures, 3);
}

TEST(Golden, AVerdictNamesTheWorstPixelWithBothColours) {
  const Golden golden = golden_of(scene_file("kinds"));
  Image wrong = golden.image;
  wrong.rgba[57 * 160 + 31] = {0.125f, 0.25f, 0.5f, 1.0f};
  const GoldenVerdict verdict = judge(golden, wrong);
  EXPECT_EQ(verdict.worst.x, 31);
  EXPECT_EQ(verdict.worst.y, 57);
  ASSERT_EQ(verdict.broken.size(), 1u);
  EXPECT_NE(verdict.broken[0].find("pixel (31, 57) differs by"), std::string::npos) << verdict.broken[0];
  EXPECT_NE(verdict.broken[0].find("got (0.125, 0.25, 0.5, 1), expected ("), std::string::npos) << verdict.broken[0];
}

// What accept_golden says and its exit code.
ChildResult accept(const std::string& scene, const std::string& why) {
  ChildResult result;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  result.code = static_cast<int>(accept_golden(scene, why));
  result.out = testing::internal::GetCapturedStdout();
  result.err = testing::internal::GetCapturedStderr();
  return result;
}

TEST(GoldenAccept, RefusesABlankReasonAndAnUnknownScene) {
  const Tree tree("poles");
  int refused = 0;
  for (const char* why : {"", "  ", "\t\n"}) {
    const ChildResult result = accept(tree.scene(), why);
    EXPECT_EQ(result.code, 2) << result.summary();
    EXPECT_NE(result.err.find("--why"), std::string::npos) << result.err;
    refused += !fs::exists(tree.golden());
  }
  EXPECT_EQ(refused, 3);
  const ChildResult unknown = accept("no-such-scene", "because");
  EXPECT_EQ(unknown.code, 4);
  EXPECT_NE(unknown.err.find("scenes/no-such-scene.json: no such scene"), std::string::npos) << unknown.err;
}

TEST(GoldenAccept, MakesAGoldenThatIsThenKeptAndTellsWhatChanges) {
  const Tree tree("poles");
  ASSERT_EQ(check_golden(tree.scene(), 0, tree.path()).error().kind, Exit::read_write) << "there is none yet";
  const ChildResult first = accept(tree.scene(), "a sphere with a seam");
  ASSERT_EQ(first.code, 0) << first.summary();
  EXPECT_EQ(first.out, "poles: 160 x 120, 16 samples, 1 seeds; there was none before\n");
  const auto kept = check_golden(tree.scene(), 0, tree.path());
  ASSERT_TRUE(kept) << kept.error().text();
  EXPECT_TRUE(kept->broken.empty()) << joined(kept->broken);
  EXPECT_EQ(golden_of(tree.scene()).why, "a sphere with a seam");

  // Other limits by hand, and another view.
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(detail::content_of(tree.golden() / "golden.json"));
  json["hard"] = 0.5;
  std::ofstream(tree.golden() / "golden.json") << json;
  tree.replace("\"fov\": 25", "\"fov\": 24");
  const ChildResult second = accept(tree.scene(), "seen from nearer");
  ASSERT_EQ(second.code, 0) << second.summary();
  EXPECT_NE(second.out.find("worst pixel ("), std::string::npos) << second.out;
  EXPECT_NE(second.out.find("): old ("), std::string::npos) << second.out;
  EXPECT_NE(second.out.find("), new ("), std::string::npos) << second.out;
  EXPECT_EQ(golden_of(tree.scene()).why, "seen from nearer");
  EXPECT_EQ(golden_of(tree.scene()).limits.hard, 0.5);
}

TEST(NoiseTest, NoiseOfTheSameKindPassesAndAFaintBiasDoesNot) {
  // A ramp with normal noise of a tenth of its value.
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  const auto noisy = [&](float factor) {
    return picture(64, 48, [&](int x, int, int c) {
      const float value = 0.2f + 0.01f * static_cast<float>(x) + 0.05f * static_cast<float>(c);
      return value * (factor + 0.1f * normal(random));
    });
  };
  std::vector<Image> pictures;
  for (int k = 0; k < 16; ++k) pictures.push_back(noisy(1));
  const NoiseModel model = noise_model(pictures, 16);
  double largest_share = 0, largest_block = 0;
  int seeds = 0;
  for (; seeds < 20; ++seeds) {
    const NoiseFigures figures = noise_figures(model, noisy(1), 3);
    largest_share = std::max(largest_share, double(figures.over_soft) / (64 * 48));
    largest_block = std::max(largest_block, figures.block_z_max);
  }
  EXPECT_EQ(seeds, 20);
  // Three channels beyond 3 deviations: 0.81 % of normal pixels, less as what was not met widens z.
  EXPECT_LT(largest_share, 0.0125);
  EXPECT_LT(largest_block, 5);
  const NoiseFigures biased = noise_figures(model, noisy(1.08f), 3);
  EXPECT_GT(biased.block_z_max, 5.5);
}

TEST(NoiseTest, WhatIsNotANumberIsInfinitelyFar) {
  const std::vector<Image> pictures{noise_picture(16, 12, 1), noise_picture(16, 12, 2), noise_picture(16, 12, 3)};
  const NoiseModel model = noise_model(pictures, 4);
  Image broken = pictures[0];
  broken.rgba[3 * 16 + 9].g = NAN;
  const NoiseFigures figures = noise_figures(model, broken, 4);
  EXPECT_TRUE(std::isinf(figures.z_max));
  EXPECT_EQ(figures.worst.x, 9);
  EXPECT_EQ(figures.worst.y, 3);
  EXPECT_TRUE(std::isinf(figures.block_z_max));
}

// Pictures of whole and cut tiles, in clay with all layers, and of an exact shade.
TEST(Determinism, APictureHasTheSameBytesForAnyNumberOfThreads) {
  const TemporaryDir dir;
  int compared = 0;
  for (const char* scene : {"tea-set", "curvature"})
    for (const char* size : {"97x70", "64x64"}) {
      std::string first;
      for (const char* threads : {"1", "2", "3"}) {
        const std::string file = dir.path() / "a.exr";
        const ChildResult result =
            run_isophote({"render", scene_file(scene), "-o", file, "--size", size, "--samples", "4", "-q", "-t", threads});
        ASSERT_EQ(result.code, 0) << result.summary();
        const std::string bytes = detail::content_of(file);
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << scene << " " << size << ", threads " << threads;
        ++compared;
      }
      EXPECT_GT(first.size(), 10000u);
    }
  EXPECT_EQ(compared, 12);
}

}  // namespace
}  // namespace iso::test
