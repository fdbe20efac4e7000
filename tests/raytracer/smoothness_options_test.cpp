// The shades of smoothness as the program and scene files ask for them: what is refused, what wins, and pictures without holes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "raytracer/cmd/scene_view.h"
#include "raytracer/image_io.h"
#include "tests/support/child.h"
#include "tests/support/mesh_shapes.h"

namespace iso::test {
namespace {

std::string with_options(const std::string& shade, const std::string& options) {
  return fmt::format(R"({{"models": [{{"file": "a.step"}}], "shade": "{}", "shade_options": {}}})", shade, options);
}

TEST(SmoothnessOptions, WhatMeansNothingIsRefusedWithExitCodeTwo) {
  const struct {
    std::vector<std::string> arguments;
    std::string part;
  } kCases[] = {
      {{"--shade", "zebra", "--range=-1,1"}, "--range has no meaning for --shade zebra; it belongs to mean-curvature and gauss-curvature"},
      {{"--range=-1,1"}, "--range has no meaning for --shade clay"},
      {{"--shade", "curvature", "--range=-1,1"}, "--range has no meaning for --shade curvature"},
      {{"--shade", "isophotes", "--no-legend"}, "--no-legend has no meaning for --shade isophotes"},
      {{"--shade", "mean-curvature", "--lines", "4"}, "--lines has no meaning for --shade mean-curvature; it belongs to zebra"},
      {{"--shade", "gauss-curvature", "--direction", "1,0,0"}, "--direction has no meaning for --shade gauss-curvature"},
      {{"--line-width", "0.2"}, "--line-width has no meaning for --shade clay"},
      {{"--shade", "mean-curvature", "--range", "1,1"}, "--range: found '1,1', expected LO,HI"},
      {{"--shade", "mean-curvature", "--range", "2,-1"}, "--range: found '2,-1'"},
      {{"--shade", "mean-curvature", "--range", "nan,1"}, "--range: found 'nan,1'"},
      {{"--shade", "mean-curvature", "--range", "0,inf"}, "--range: found '0,inf'"},
      {{"--shade", "mean-curvature", "--range=-1e308,1e308"}, "--range: found '-1e308,1e308'"},
      {{"--shade", "mean-curvature", "--range", "1"}, "--range: found '1'"},
      {{"--shade", "mean-curvature", "--range", "0,1,2"}, "--range: found '0,1,2'"},
      {{"--shade", "mean-curvature", "--range", "0,1x"}, "--range: found '0,1x'"},
      {{"--shade", "zebra", "--direction", "0,0,0"}, "--direction: found '0,0,0', expected X,Y,Z: three numbers, not all of them 0"},
      {{"--shade", "zebra", "--direction", "1,0"}, "--direction: found '1,0'"},
      {{"--shade", "zebra", "--direction", "1,nan,0"}, "--direction: found '1,nan,0'"},
      {{"--shade", "zebra", "--line-width", "0"}, "--line-width: found '0', expected a share of the period between 0 and 1"},
      {{"--shade", "zebra", "--line-width", "1"}, "--line-width: found '1'"},
      {{"--shade", "zebra", "--line-width", "nan"}, "--line-width: found 'nan'"},
      {{"--shade", "zebra", "--lines", "0"}, "--lines"},
      {{"--shade", "zebra", "--lines", "1001"}, "--lines"},
      {{"--shade", "zebra", "--lines", "2.5"}, "--lines"},
      {{"--shade", "gaussian"}, "--shade"},
  };
  const TemporaryDir dir;
  const std::string output = dir.path() / "picture.exr";
  int refused = 0;
  for (const auto& c : kCases) {
    std::vector<std::string> arguments{"render", data("patches/teapot.bpt"), "-o", output, "--size", "16x12", "--samples", "1", "-q"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const ChildResult result = run_isophote(arguments);
    EXPECT_EQ(result.code, 2) << c.part << ": " << result.summary();
    EXPECT_TRUE(result.err.starts_with("isophote: ")) << result.err;
    EXPECT_NE(result.err.find(c.part), std::string::npos) << result.err << "; expected: " << c.part;
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(output));
    ++refused;
  }
  EXPECT_EQ(refused, 25);
}

TEST(SmoothnessOptions, ScenesHaveTheSameAndNameTheirPlace) {
  const struct {
    std::string shade, options, message;
  } kCases[] = {
      {"clay", R"({"lines": 3})",
       "scenes/test.json:shade_options.lines: 'lines' has no meaning for \"shade\": \"clay\"; it belongs to zebra, reflection-lines and "
       "isophotes"},
      {"zebra", R"({"legend": true})",
       "scenes/test.json:shade_options.legend: 'legend' has no meaning for \"shade\": \"zebra\"; it belongs to mean-curvature and "
       "gauss-curvature"},
      {"zebra", R"({"lines": 0})", "scenes/test.json:shade_options.lines: found 0, expected a whole number from 1 to 1000"},
      {"zebra", R"({"line_width": 1})",
       "scenes/test.json:shade_options.line_width: found 1, expected a share of the period between 0 and 1"},
      {"zebra", R"({"direction": [0, 0, 0]})", "scenes/test.json:shade_options.direction: found [0, 0, 0], expected a direction"},
      {"mean-curvature", R"({"range": [1, -1]})",
       "scenes/test.json:shade_options.range: the first end of the range must be less than the second"},
      {"mean-curvature", R"({"range": [1]})", "scenes/test.json:shade_options.range: found a list of 1, expected a list of two numbers"},
      {"mean-curvature", R"({"rnage": [0, 1]})", "scenes/test.json:shade_options.rnage: unknown key 'rnage'; did you mean 'range'?"},
  };
  for (const auto& c : kCases) {
    const auto scene = scene_from_text(with_options(c.shade, c.options), "scenes/test.json");
    ASSERT_FALSE(scene) << c.message;
    EXPECT_EQ(scene.error().kind, Exit::bad_input);
    EXPECT_EQ(scene.error().text(), c.message);
  }
  const auto stripes = scene_from_text(with_options("zebra", R"({"direction": [0, 3, 4], "lines": 7, "line_width": 0.25})"), "a.json");
  ASSERT_TRUE(stripes);
  EXPECT_LT(glm::length(*stripes->shade_options.direction - Vec3(0, 0.6, 0.8)), 4 * kEps);
  EXPECT_EQ(stripes->shade_options.lines, 7);
  EXPECT_EQ(stripes->shade_options.line_width, 0.25);
  const auto scale = scene_from_text(with_options("gauss-curvature", R"({"range": [-1, 2], "legend": false})"), "a.json");
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->shade_options.range->hi, 2);
  EXPECT_EQ(scale->shade_options.legend, false);
}

// The light of a small picture.
std::vector<glm::vec4> rendered(const std::string& input, const std::vector<std::string>& more) {
  const TemporaryDir dir;
  const std::string path = dir.path() / "picture.exr";
  std::vector<std::string> arguments{"render", input, "-o", path, "--size", "97x73", "--samples", "1", "--aov", "none", "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ChildResult result = run_isophote(arguments);
  EXPECT_EQ(result.code, 0) << result.summary();
  auto image = read_image(path);
  EXPECT_TRUE(image);
  return std::move(image->rgba);
}

TEST(SmoothnessOptions, TheCommandLineWinsAndTheScenesOptionsGoWithItsShade) {
  const TemporaryDir dir;
  const std::string scene = dir.path() / "scene.json", model = data("patches/teapot.bpt");
  std::ofstream(scene) << R"({"models": [{"file": ")" << model << R"("}], "shade": "zebra", "background": "sky", )"
                       << R"("shade_options": {"lines": 5, "direction": [1, 1, 0]}})";
  const auto five = rendered(model, {"--shade", "zebra", "--lines", "5", "--direction", "1,1,0"});
  EXPECT_EQ(rendered(scene, {}), five);
  EXPECT_EQ(rendered(scene, {"--shade", "zebra"}), five);
  EXPECT_EQ(rendered(scene, {"--lines", "9"}), rendered(model, {"--shade", "zebra", "--lines", "9", "--direction", "1,1,0"}));
  EXPECT_EQ(rendered(scene, {"--shade", "isophotes"}), rendered(model, {"--shade", "isophotes"}));
  EXPECT_EQ(rendered(scene, {"--direction", "-1,-1,0"}), rendered(scene, {"--direction=-2e200,-2e200,0"}));
  EXPECT_NE(rendered(scene, {"--line-width", "0.1"}), five);
  EXPECT_EQ(rendered(scene, {"--shade", "clay"}), rendered(model, {}));
}

TEST(SmoothnessOptions, PolesCollapsedSidesAndMeshesLeaveNoHolesInThePicture) {
  int pictures = 0;
  for (const char* model : {"patches/teapot.bpt", "patches/sphere-rational-bspline.obj", "cad/occtjs-conical-surface.step"})
    for (const char* shade : {"zebra", "reflection-lines", "isophotes", "mean-curvature", "gauss-curvature"})
      for (const std::vector<std::string>& more : {std::vector<std::string>{"--view", "top", "--ortho"},
                                                   {"--view", "front"},
                                                   {"--mode", "tessellated", "--flat", "--tolerance", "3e-2d"}}) {
        std::vector<std::string> arguments{"--shade", shade};
        arguments.insert(arguments.end(), more.begin(), more.end());
        for (const glm::vec4& p : rendered(data(model), arguments))
          ASSERT_TRUE(std::isfinite(p.r + p.g + p.b) && p.a == 1) << model << " " << shade << " " << more[1];
        ++pictures;
      }
  EXPECT_EQ(pictures, 45);
}

}  // namespace
}  // namespace iso::test
