// `isophote continuity` through the program: table, JSON, picture, limits, refusals.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "patches/base/result.h"
#include "raytracer/image_io.h"
#include "tests/support/child.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kPipe = "cad/nist-mbe-pmi-11.stp", kTeapot = "patches/teapot.bpt";

class ContinuityCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_.path() / name; }
  static ChildResult run(const std::string& model, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"continuity", model});
    return run_isophote(arguments, {}, {.seconds = 120, .standard_output = {}});
  }
  json report(const std::string& model, std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.end(), {"--json", path("r.json"), "-q"});
    const ChildResult result = run(data(model), arguments);
    EXPECT_EQ(result.code, 0) << model << ": " << result.summary();
    EXPECT_EQ(result.out, "");
    return json::parse(detail::content_of(path("r.json")));
  }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(dir_.path()), {})); }

 private:
  TemporaryDir dir_;
};

std::set<std::string> keys(const json& object) {
  std::set<std::string> names;
  for (const auto& [key, value] : object.items()) names.insert(key);
  return names;
}

TEST_F(ContinuityCommand, TheTableCountsEveryEdgeAndTellsTheWorstFirst) {
  const ChildResult result = run(data(kPipe), {"--rows", "3"});
  ASSERT_EQ(result.code, 0) << result.summary();
  EXPECT_NE(result.out.find("10 faces, 26 edges: 26 between faces (0 sewn), 0 seams, 0 free, 0 non-manifold, 0 degenerate\n"),
            std::string::npos);
  EXPECT_NE(
      result.out.find("  8 G2 (curvature within 0.00112 /mm), 6 G1 (normal within 0.1 deg), 12 G0 (gap within 8.91e-05 mm), 0 apart\n"),
      std::string::npos)
      << result.out;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 2 + 1 + 3 + 1);
  EXPECT_NE(result.out.find("... and 23 more"), std::string::npos);
  EXPECT_EQ(result.err, "");
}

TEST_F(ContinuityCommand, FilletsOfThePipeJumpByOneOverTheirRadius) {
  // Rounds of radius 1.5 mm beside planes and cylinders.
  const json r = report(kPipe);
  int tangent = 0;
  for (const json& edge : r["parts"][0]["edges"]) {
    if (edge["class"] != "G1") continue;
    EXPECT_NEAR(edge["curvature"]["max"].get<double>(), 1 / 1.5, 1e-9);
    EXPECT_LT(edge["normal"]["max"].get<double>(), 1e-6);
    ++tangent;
  }
  EXPECT_EQ(tangent, 6);
}

TEST_F(ContinuityCommand, TheReportHasTheKeysThatAreDescribed) {
  const json r = report(kTeapot);
  EXPECT_EQ(keys(r), (std::set<std::string>{"isophote", "file", "unit", "diagonal", "tolerances", "broken", "totals", "parts"}));
  EXPECT_EQ(keys(r["totals"]),
            (std::set<std::string>{"faces", "copies", "shared", "seam", "free", "non-manifold", "degenerate", "sewn", "misoriented",
                                   "apart", "G0", "G1", "G2", "largest_gap", "largest_normal", "largest_curvature"}));
  const json& part = r["parts"][0];
  EXPECT_EQ(keys(part), (std::set<std::string>{"index", "name", "placements", "faces", "sew_tolerance", "edges"}));
  const std::string described = detail::content_of(fs::path(ISOPHOTE_SOURCE_DIR) / "raytracer/cmd/continuity_report.md");
  std::set<std::string> all = keys(r);
  for (const json& object : {r["totals"], part, part["edges"][1], part["edges"][1]["sides"][0], part["edges"][1]["gap"]})
    for (const std::string& key : keys(object)) all.insert(key);
  EXPECT_EQ(all.size(), 47u);
  for (const std::string& key : all) EXPECT_NE(described.find("`" + key + "`"), std::string::npos) << key;
}

TEST_F(ContinuityCommand, CountsOfTheReportAreThoseOfItsEdges) {
  int edges = 0;
  for (const std::string& model : {kPipe, kTeapot, std::string("cad/bladex-shaft.iges"), std::string("cad/occt-crank-arm.brep"),
                                   std::string("patches/teacup-bezier.obj"), std::string("cad/edge-cases/nonmanifold-four-use-edge.stp")}) {
    const json r = report(model);
    std::map<std::string, int> counted;
    for (const json& part : r["parts"])
      for (const json& edge : part["edges"]) {
        ++counted[edge["kind"]];
        if (!edge["class"].is_null()) ++counted[edge["class"]];
        const bool between_two = edge["kind"] == "shared" || edge["kind"] == "seam";
        EXPECT_EQ(edge["gap"].is_null(), !between_two && edge["kind"] != "non-manifold");
        for (const char* measure : {"gap", "off", "normal", "curvature"})
          if (!edge[measure].is_null()) {
            EXPECT_LE(edge[measure]["rms"].get<double>(), edge[measure]["max"].get<double>() * (1 + 1e-12));
          }
        if (between_two) {
          EXPECT_EQ(edge["sides"].size(), 2u);
          EXPECT_LE(edge["off"]["max"], edge["gap"]["max"]);
        }
        ++edges;
      }
    for (const char* key : {"shared", "seam", "free", "non-manifold", "degenerate", "apart", "G0", "G1", "G2"})
      EXPECT_EQ(r["totals"][key], counted[key]) << model << " " << key;
  }
  EXPECT_EQ(edges, 26 + 76 + 16 + 138 + 58 + 16);
}

TEST_F(ContinuityCommand, LimitsThatAreNotKeptGiveExitCodeOne) {
  const std::string pipe = data(kPipe), teapot = data(kTeapot);
  const struct {
    std::string model;
    std::vector<std::string> arguments;
    int code;
    const char* said;
  } cases[] = {{teapot, {"--fail-above-normal", "0.1deg", "--fail-above-gap", "1e-9d"}, 0, ""},
               {pipe, {"--fail-above-normal", "89"}, 1, "normal of up to 90 deg along 8 edges"},
               {pipe, {"--fail-above-normal", "91deg"}, 0, ""},
               {pipe, {"--fail-above-curvature", "0.6/mm"}, 1, "curvature of up to 0.667 /mm along 6 edges"},
               {pipe, {"--fail-above-curvature", "0.06/um"}, 0, ""},
               {pipe, {"--fail-above-curvature", "1/d"}, 1, "curvature of up to"},
               {pipe, {"--fail-above-gap", "1e-6mm", "--fail-open"}, 0, ""},
               {teapot, {"--fail-open"}, 1, "16 free and 0 non-manifold edges"},
               {pipe, {"--fail-open", "--sew", "off"}, 0, ""},
               {data("cad/axom-sliced-cylinder.step"), {"--fail-above-gap", "0.001mm"}, 1, "gap of up to 0.00284 mm"}};
  for (const auto& [model, arguments, code, said] : cases) {
    const ChildResult result = run(model, arguments);
    EXPECT_EQ(result.code, code) << result.summary();
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
    EXPECT_EQ(result.error_lines(), code);
  }
}

TEST_F(ContinuityCommand, SewingFollowsTheOption) {
  const json off = report(kTeapot, {"--sew", "off"}), automatic = report(kTeapot);
  EXPECT_EQ(off["totals"]["free"], 120);
  EXPECT_EQ(automatic["totals"]["free"], 16);
  EXPECT_EQ(automatic["totals"]["sewn"], 52);
}

TEST_F(ContinuityCommand, ThePictureShowsEdgesOverTheModel) {
  const std::string file = path("p.exr"), plain = path("plain.exr");
  const std::vector<std::string> view{"--size", "160x120", "--samples", "1", "--view", "iso"};
  std::vector<std::string> arguments{"--picture", file, "--by", "curvature", "--rows", "0"};
  arguments.insert(arguments.end(), view.begin(), view.end());
  const ChildResult result = run(data(kTeapot), arguments);
  ASSERT_EQ(result.code, 0) << result.summary();
  EXPECT_NE(result.out.find("colours: curvature jump"), std::string::npos) << result.out;
  std::vector<std::string> render{"render", data(kTeapot), "-o", plain, "-q"};
  render.insert(render.end(), view.begin(), view.end());
  ASSERT_EQ(run_isophote(render).code, 0);
  const auto with = read_image(file), without = read_image(plain);
  ASSERT_TRUE(with && without);
  ASSERT_EQ(with->rgba.size(), 160u * 120u);
  int violet = 0, red = 0, changed = 0;
  for (std::size_t i = 0; i < with->rgba.size(); ++i) {
    const glm::vec4 &p = with->rgba[i], &q = without->rgba[i];
    changed += glm::length(glm::vec3(p) - glm::vec3(q)) > 0.05f;
    violet += p.b > 1.3f * p.r && p.r > 3 * p.g;
    red += p.r > 3 * p.g && p.r > 2 * p.b;
  }
  EXPECT_GT(violet, 50) << "the smooth borders";
  EXPECT_GT(red, 0) << "free edges of lid, rim and spout";
  EXPECT_GT(changed, 300);
  EXPECT_LT(changed, 160 * 120 / 4) << "lines, no areas";
}

TEST_F(ContinuityCommand, SameBytesForAnyNumberOfThreads) {
  for (const char* threads : {"1", "2"})
    ASSERT_EQ(run(data(kTeapot), {"-t", threads, "--json", path(std::string(threads) + ".json"), "--picture",
                                  path(std::string(threads) + ".exr"), "--size", "80x60", "--samples", "1", "-q"})
                  .code,
              0);
  for (const char* ending : {".json", ".exr"})
    EXPECT_TRUE(detail::content_of(path(std::string("1") + ending)) == detail::content_of(path(std::string("2") + ending))) << ending;
}

TEST_F(ContinuityCommand, WrongRequestsAreRefusedInOneLineAndLeaveNoFile) {
  const std::string model = data(kTeapot);
  const struct {
    std::vector<std::string> arguments;
    Exit code;
    const char* part;
  } wrong[] = {{{}, Exit::bad_command_line, "MODEL"},
               {{model, "--by", "off"}, Exit::bad_command_line, "--by"},
               {{model, "--rows", "-1"}, Exit::bad_command_line, "--rows"},
               {{model, "--gap", "0"}, Exit::bad_command_line, "--gap: found '0'"},
               {{model, "--gap", "1mm"}, Exit::bad_command_line, "unit of the model is unknown"},
               {{model, "--normal", "181"}, Exit::bad_command_line, "--normal: found '181'"},
               {{model, "--normal", "1rad"}, Exit::bad_command_line, "--normal: found '1rad'"},
               {{model, "--curvature", "nan"}, Exit::bad_command_line, "--curvature: found 'nan'"},
               {{model, "--curvature", "1/"}, Exit::bad_command_line, "--curvature: found '1/'"},
               {{model, "--curvature", "1/2mm"}, Exit::bad_command_line, "--curvature: found '1/2mm'"},
               {{model, "--curvature", "1/mm"}, Exit::bad_command_line, "unit of the model is unknown"},
               {{model, "--fail-above-normal", "x"}, Exit::bad_command_line, "--fail-above-normal: found 'x'"},
               {{model, "--sew", "-1"}, Exit::bad_command_line, "--sew: found '-1'"},
               {{model, "--scale", "thick"}, Exit::bad_command_line, "--scale: found 'thick'"},
               {{model, "--picture", path("p.png")}, Exit::bad_command_line, "expected a name ending in .exr"},
               {{model, "--picture", path("p.exr"), "--size", "0x0"}, Exit::bad_command_line, "--size: found '0x0'"},
               {{model, "--json", model}, Exit::bad_command_line, "is the model itself"},
               {{model, "--json", path("a.exr"), "--picture", path("a.exr")}, Exit::bad_command_line, "name the same file"},
               {{model, "--json", path("no/such/r.json")}, Exit::read_write, "r.json"},
               {{path("missing.stp")}, Exit::read_write, "missing.stp"},
               {{data("README.md")}, Exit::bad_input, "README.md"}};
  for (const auto& [arguments, code, part] : wrong) {
    std::vector<std::string> all{"continuity"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ChildResult result = run_isophote(all);
    EXPECT_EQ(result.code, static_cast<int>(code)) << part << ": " << result.summary();
    EXPECT_NE(result.err.find(part), std::string::npos) << part << ": " << result.err;
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
  EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace iso::test
