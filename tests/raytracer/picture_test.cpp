// Camera, samples, filter, text of rays, and files that appear whole or not at all.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <set>

#include "patches/files/output_file.h"
#include "raytracer/camera.h"
#include "raytracer/exr_writer.h"
#include "raytracer/filter.h"
#include "raytracer/ray_text.h"
#include "raytracer/sampling.h"

namespace iso {
namespace {

Vec3 project(const Matrix44& m, const Vec3& p) {
  double q[4];
  for (int j = 0; j < 4; ++j) q[j] = p.x * m[0][j] + p.y * m[1][j] + p.z * m[2][j] + m[3][j];
  return Vec3(q[0], q[1], q[2]) / q[3];
}

std::vector<Vec3> random_points(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-1, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(300 + 5 * x(random), 40 * x(random), -70 + x(random));
  return points;
}

TEST(Camera, FramedPointsFillThePictureUpToTheMarginFromEverySide) {
  const std::vector<Vec3> points = random_points(7, 50);
  int checked = 0;
  for (const char* name : kViewNames)
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const ImageSize size : {ImageSize{640, 480}, ImageSize{100, 700}}) {
        const Camera camera = frame(points, *view_named(name), projection, 40, size);
        const Matrix44 m = world_to_ndc(camera, size, {1, 1000});
        Box2 seen;
        for (const Vec3& p : points) seen.include(Vec2(project(m, p)));
        const double free = std::min({seen.lo.x, seen.lo.y, 1 - seen.hi.x, 1 - seen.hi.y});
        EXPECT_NEAR(free, 0.05, 1e-9) << name;
        ++checked;
      }
  EXPECT_EQ(checked, 28);
}

TEST(Camera, RaysAndTheNdcMatrixAgree) {
  const ImageSize size{320, 200};
  int checked = 0;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Camera camera = *look_at(projection, {3, -4, 5}, {0.1, 0.2, 0.3}, {0, 0, 1}, 35);
    const Matrix44 m = world_to_ndc(camera, size, {1, 20});
    for (const Vec2 pixel : {Vec2(0, 0), Vec2(320, 200), Vec2(17.5, 180.25)}) {
      const Ray ray = camera_ray(camera, size, pixel.x, pixel.y);
      const Vec3 ndc = project(m, ray.o + 7.0 * ray.d);
      EXPECT_NEAR(ndc.x * size.width, pixel.x, 1e-9);
      EXPECT_NEAR(ndc.y * size.height, pixel.y, 1e-9);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 6);
  EXPECT_FALSE(look_at(Projection::perspective, {0, 0, 5}, {0, 0, 0}, {0, 0, 2}, 35));
}

TEST(Sampler, EachPixelsSamplesAndEachBlockOfPixelsAreStratified) {
  const Sampler sampler(3, 16);
  for (const Dimension dimension : {Dimension::filter, Dimension::sky, Dimension::key}) {
    std::set<int> x, y, cells;
    for (std::uint32_t s = 0; s < 16; ++s) {
      const Vec2 p = sampler.pair({1234, 567, s}, dimension);
      x.insert(static_cast<int>(16 * p.x));
      y.insert(static_cast<int>(16 * p.y));
      cells.insert(static_cast<int>(4 * p.x) * 4 + static_cast<int>(4 * p.y));
    }
    EXPECT_EQ(x.size(), 16u);
    EXPECT_EQ(y.size(), 16u);
    EXPECT_EQ(cells.size(), 16u);

    // Four neighbours together: 64 strata.
    std::set<int> together;
    for (std::uint32_t i = 0; i < 64; ++i)
      together.insert(static_cast<int>(64 * sampler.pair({8 + (i & 1), 6 + (i >> 1 & 1), i >> 2}, dimension).x));
    EXPECT_EQ(together.size(), 64u);
  }
}

TEST(PixelFilter, IsCentredSymmetricAndBounded) {
  const PixelFilter filter;
  double previous = -PixelFilter::kRadius;
  for (int i = 1; i < 1000; ++i) {
    const double u = i / 1000.0, x = filter.offset({u, 0.5}).x;
    EXPECT_GT(x, previous);
    EXPECT_NEAR(x, -filter.offset({1 - u, 0.5}).x, 1e-9);
    previous = x;
  }
  EXPECT_LT(previous, PixelFilter::kRadius);
  EXPECT_NEAR(filter.offset({0.5, 0.5}).y, 0, 1e-9);
}

TEST(Hemisphere, DirectionsHaveUnitLengthAndMeanCosineTwoThirds) {
  const Vec3 n = glm::normalize(Vec3(1, -2, -0.5));
  const Sampler sampler(1, 4096);
  double sum = 0;
  for (std::uint32_t s = 0; s < 4096; ++s) {
    const Vec3 d = cosine_hemisphere(n, sampler.pair({0, 0, s}, Dimension::sky));
    EXPECT_NEAR(glm::length(d), 1, 1e-14);
    EXPECT_GT(glm::dot(d, n), 0);
    sum += glm::dot(d, n);
  }
  EXPECT_NEAR(sum / 4096, 2.0 / 3, 1e-3);
}

TEST(RayText, GoodLinesAreRaysAndBadOnesSayWhy) {
  const auto ray = parse_ray("  1 -2.5e0\t+3 0 0 -2 \r");
  ASSERT_TRUE(ray);
  EXPECT_EQ(ray->o, Vec3(1, -2.5, 3));
  EXPECT_EQ(ray->d, Vec3(0, 0, -2));
  EXPECT_TRUE(is_skipped("  \t\r"));
  EXPECT_TRUE(is_skipped(" # 1 2 3"));
  int refused = 0;
  for (const char* line : {"1 2 3", "1 2 3 4 5 x", "1 2 3 0 0 0", "1 2 3 nan 0 1", "1 inf 3 0 0 1", "1 2 3 1 0 0 7", "1 2 3 1e300 0 0",
                           "1 2 3 1e-300 0 0", "1,2,3,4,5,6", "+-1 2 3 0 0 1", "1e999 0 0 0 0 1"})
    refused += !parse_ray(line);
  EXPECT_EQ(refused, 11);
}

TEST(OutputFile, AppearsWholeOrNotAtAll) {
  const auto folder = std::filesystem::temp_directory_path() / ("isophote_output_test_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string path = (folder / "a.exr").string();
  EXPECT_TRUE(check_writable(path));
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_TRUE(write_whole_file(path, "first"));
  EXPECT_TRUE(write_whole_file(path, "second"));
  EXPECT_EQ(std::filesystem::file_size(path), 6u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);

  // A folder in the way, a missing folder, a full device.
  EXPECT_EQ(write_whole_file(folder.string(), "x").error().kind, Exit::read_write);
  EXPECT_EQ(check_writable((folder / "none" / "a.exr").string()).error().kind, Exit::read_write);
  EXPECT_EQ(write_whole_file("/dev/full", "x").error().kind, Exit::read_write);
  std::filesystem::remove_all(folder);
}

TEST(ExrWriter, SameFilmSameBytesForAnyNumberOfThreads) {
  Film film({70, 50}, kAovAll);
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 70; ++x) film.set_colour(x, y, {0.1f * static_cast<float>(x), 1e9f, -1, 1});
  const auto one = encode_exr(film, {}, 1), four = encode_exr(film, {}, 4);
  ASSERT_TRUE(one && four);
  EXPECT_EQ(*one, *four);
  EXPECT_EQ(one->substr(0, 4), std::string("\x76\x2f\x31\x01", 4));
}

}  // namespace
}  // namespace iso
