// What `isophote compare` is asked for: strategies beside each other, and requests that it refuses.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "patches/base/vec.h"
#include "tests/support/compare_command.h"

namespace iso::test {
namespace {

// ---- strategies ----

// A solid with squares and polygons of more sides, and with few faces: every chart is measured once per strategy, which takes long.
std::string prism_on_a_pentagon() {
  constexpr int kSides = 5;
  std::string text, floor = "f", roof = "f", walls;
  for (const double z : {-0.6, 0.6})
    for (int k = 0; k < kSides; ++k) text += fmt::format("v {} {} {}\n", std::cos(kTwoPi * k / kSides), std::sin(kTwoPi * k / kSides), z);
  for (int k = 0; k < kSides; ++k) {
    const int next = (k + 1) % kSides;
    floor += fmt::format(" {}", kSides - k);
    roof += fmt::format(" {}", kSides + 1 + k);
    walls += fmt::format("f {} {} {} {}\n", 1 + k, 1 + next, kSides + 1 + next, kSides + 1 + k);
  }
  return text + floor + "\n" + roof + "\n" + walls;
}

TEST_F(CompareCommand, StrategiesStandBesideEachOther) {
  const std::string model = path("prism.obj");
  std::ofstream(model) << prism_on_a_pentagon();
  const ChildResult result =
      run({model, "--patches", "gregory", "-o", path("report"), "--strategies", "--level", "9", "--size", "96x72", "--samples", "1", "-q"});
  ASSERT_EQ(result.code, 0) << result.summary();
  const json r = report();
  const char* names[] = {"fan-triangles", "fan-quads", "symmetric-triangles", "symmetric-quads", "adaptive"};
  ASSERT_EQ(r["meshes"].size(), std::size(names));
  for (std::size_t m = 0; m < std::size(names); ++m) {
    const json& mesh = r["meshes"][m];
    EXPECT_EQ(mesh["strategy"], names[m]);
    EXPECT_LE(mesh["distance"]["max"], mesh["guaranteed"]);
    EXPECT_TRUE(mesh["faults"].empty()) << mesh["faults"].dump();
    EXPECT_GT(mesh["mean_curvature"]["points"], 500);
    EXPECT_GE(mesh["mean_curvature"]["max"], mesh["mean_curvature"]["rms"]);
    EXPECT_TRUE(fs::exists(path("report/mesh-" + std::to_string(m + 1) + "-discrete-curvature.exr")));
  }
  EXPECT_TRUE(fs::exists(path("report/mean-curvature.exr")));
  EXPECT_NE(page().find("<section id=\"strategies\">"), std::string::npos);
}

// ---- wrong requests ----

TEST_F(CompareCommand, WrongRequestsAreRefusedInOneLineAndLeaveNothing) {
  const std::string model = data(kCone), folder = path("report"), teapot = data("patches/teapot.bpt"), text = data("README.md");
  const TemporaryDir other;
  const std::string here = other.path() / "file.txt", mesh = other.path() / "bad.stl", good = meshed(kCone, "good.obj");
  fs::remove(path("good.mtl"));
  fs::rename(good, other.path() / "good.obj");
  const std::string fine = other.path() / "good.obj";
  std::ofstream(here) << "text\n";
  std::ofstream(mesh) << "this is no mesh\n";
  const struct {
    std::vector<std::string> arguments;
    Exit code;
    const char* part;
  } wrong[] = {{{}, Exit::bad_command_line, "nothing to compare"},
               {{path("none.step"), "-o", folder}, Exit::read_write, "no such file"},
               {{text, "-o", folder}, Exit::bad_input, "expected STEP"},
               {{model, "-o", folder, "--mesh", path("none.stl")}, Exit::read_write, "none.stl"},
               {{model, "-o", folder, "--mesh", mesh}, Exit::bad_input, "bad.stl"},
               {{model, "-o", folder, "--mesh", here}, Exit::bad_command_line, ".stl, .obj, .ply, .glb or .gltf"},
               {{model, "-o", folder, "--tolerances", "1e-3d,thin"}, Exit::bad_command_line, "--tolerances: found 'thin'"},
               {{model, "-o", folder, "--tolerances", "0"}, Exit::bad_command_line, "--tolerances: found '0'"},
               {{model, "-o", folder, "--tolerances", "1e-3d,"}, Exit::bad_command_line, "--tolerances: found ''"},
               {{model, "-o", folder, "--tolerances", "1e-14d"}, Exit::bad_command_line, "finer than its coordinates"},
               {{model, "-o", folder, "--reference", "-1"}, Exit::bad_command_line, "--reference: found '-1'"},
               {{model, "-o", folder, "--fail-above", "much"}, Exit::bad_command_line, "--fail-above: found 'much'"},
               {{model, "-o", folder, "--fail-normal", "nan"}, Exit::bad_command_line, "--fail-normal"},
               {{model, "-o", folder, "--size", "0x0"}, Exit::bad_command_line, "--size"},
               {{model, "-o", folder, "--strategies"}, Exit::bad_command_line, "--strategies: face 0 is a"},
               {{model, "-o", folder, "--level", "4"}, Exit::bad_command_line, "--level needs --strategies"},
               {{model, "-o", folder, "--strategies", "--advise"}, Exit::bad_command_line, "one of them"},
               {{model, "-o", folder, "--strategies", "--level", "4", "--tolerances", "1"}, Exit::bad_command_line, "one of them"},
               {{model, "-o", path("none/report")}, Exit::read_write, "No such file or directory"},
               {{model, "-o", here}, Exit::read_write, "is no folder"},
               {{model, "-o", folder, "--mesh-unit", "in"}, Exit::bad_command_line, "--mesh-unit needs --mesh"},
               {{model, "-o", folder, "--mesh-unit", "mile", "--mesh", fine}, Exit::bad_command_line, "--mesh-unit"},
               {{teapot, "-o", folder, "--mesh", fine, "--mesh-unit", "in"}, Exit::bad_command_line, "the model's own unit is not known"},
               {{teapot, "-o", folder, "--tolerances", "1mm"}, Exit::bad_command_line, "the unit of the model is unknown"},
               {{teapot, "-o", folder, "--fail-above", "1mm"}, Exit::bad_command_line, "--fail-above"},
               {{model, "-o", folder, "--pixels", "1"}, Exit::bad_command_line, "need --advise"},
               {{model, "-o", folder, "--advise", "--pixels", "1", "--flip", "1"}, Exit::bad_command_line, "one of them"},
               {{model, "-o", folder, "--advise", "--pixels", "inf"}, Exit::bad_command_line, "--pixels"},
               {{model, "-o", folder, "--advise", "--flip", "1", "--no-pictures"}, Exit::bad_command_line, "--flip needs the pictures"},
               {{model, "--why", "because"}, Exit::bad_command_line, "--why needs --accept"},
               {{"--accept", "torus"}, Exit::bad_command_line, "--accept needs --why"},
               {{"--accept", "torus", "--why", "  "}, Exit::bad_command_line, "the reason"},
               {{model, "--accept", "torus", "--why", "because"}, Exit::bad_command_line, "names the scene itself"},
               {{"--accept", "no-such-scene", "--why", "because"}, Exit::read_write, "no-such-scene"}};
  int refused = 0;
  for (const auto& w : wrong) {
    const ChildResult result = run(w.arguments);
    EXPECT_EQ(result.code, static_cast<int>(w.code)) << w.part << ": " << result.summary();
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(w.part), std::string::npos) << w.part << ": " << result.err;
    EXPECT_EQ(files(""), std::set<std::string>{}) << w.part;
    ++refused;
  }
  EXPECT_EQ(refused, 34);
  EXPECT_EQ(detail::content_of(here), "text\n");
}

}  // namespace
}  // namespace iso::test
