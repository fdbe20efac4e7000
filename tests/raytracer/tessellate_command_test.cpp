// `isophote tessellate` and `render --mode tessellated` through the program: files, figures, exit codes, pictures.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>

#include "patches/base/result.h"
#include "raytracer/cmd/mesh_report.h"
#include "raytracer/image_io.h"
#include "tests/support/child.h"
#include "tests/support/mesh_files.h"
#include "tests/support/patch_meshes.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kCone = "cad/occtjs-conical-surface.step", kCrank = "cad/occt-crank-arm.brep", kAssembly = "cad/stepcode-as1-oc-214.stp",
                  kPipe = "cad/nist-mbe-pmi-11.stp";

class TessellateCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_.path() / name; }
  ChildResult run(const std::string& model, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"tessellate", model});
    return run_isophote(arguments);
  }
  json report(const std::string& name) const { return json::parse(detail::content_of(path(name))); }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(dir_.path()), {})); }

  Image picture(const std::string& model, std::vector<std::string> arguments) const {
    const std::string file = path("picture.exr");
    arguments.insert(arguments.begin(), {"render", data(model), "-o", file, "--size", "160x120", "--samples", "16", "--aov", "none",
                                         "--background", "transparent", "--progress", "none", "-q"});
    const ChildResult result = run_isophote(arguments);
    EXPECT_EQ(result.code, 0) << model << ": " << result.summary();
    auto image = read_image(file);
    EXPECT_TRUE(image) << model;
    return image ? std::move(*image) : Image{};
  }

 private:
  TemporaryDir dir_;
};

// The number that the closing line gives before some words; blanks group its digits.
std::uint64_t number_before(const std::string& line, const std::string& words) {
  std::smatch match;
  if (!std::regex_search(line, match, std::regex("(\\d{1,3}(?: \\d{3})*) " + words))) return ~0ull;
  return std::stoull(std::regex_replace(match[1].str(), std::regex(" "), ""));
}

TEST_F(TessellateCommand, WritesAllFourFormatsWithTheTrianglesItTells) {
  std::size_t told = 0;
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.glb"}) {
    const ChildResult result = run(data(kCone), {"-o", path(name), "--report", path("r.json")});
    ASSERT_EQ(result.code, 0) << result.summary();
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    told = number_before(result.err, "triangles");
    std::uint64_t bytes = 0;  // an .obj has its .mtl beside it
    const json r = report("r.json");
    for (const json& file : r["written"]["files"]) bytes += fs::file_size(file.get<std::string>());
    EXPECT_EQ(r["written"]["bytes"], bytes);
    EXPECT_EQ(r["written"]["triangles"], told);
  }
  EXPECT_GT(told, 100u);
  EXPECT_EQ(read_stl_file(path("a.stl")).triangles.size(), told);
  EXPECT_EQ(read_obj_file(path("a.obj")).triangles.size(), told);
  EXPECT_EQ(read_ply_file(path("a.ply")).triangles.size(), told);
  EXPECT_EQ(placed_triangles(read_glb_file(path("a.glb"))).size(), told);
}

TEST_F(TessellateCommand, TheReportAndTheClosingLineAgreeAndEveryBoundIsWithinTheTolerance) {
  int faces = 0;
  for (const std::string& model : {kCone, kCrank, kAssembly}) {
    const ChildResult result = run(data(model), {"--report", path("r.json"), "--tolerance", "5e-4d", "--measure", "fine"});
    ASSERT_EQ(result.code, 0) << result.summary();
    const json r = report("r.json"), &totals = r["totals"];
    EXPECT_TRUE(r["kept"]);
    EXPECT_TRUE(r["written"].is_null());
    EXPECT_EQ(number_before(result.err, "faces"), totals["faces"]);
    EXPECT_EQ(number_before(result.err, "triangles"), totals["triangles"]);
    EXPECT_EQ(number_before(result.err, "open edges"), totals["open_edges"]);
    const std::string unit = r["unit"].is_null() ? "" : " " + r["unit"].get<std::string>();
    const std::string lengths = fmt::format("distance bound {:.3g}{}, measured {:.3g}{} at ", totals["bound"].get<double>(), unit,
                                            totals["measured"].get<double>(), unit);
    EXPECT_NE(result.err.find(lengths), std::string::npos) << result.err << lengths;

    std::uint64_t triangles = 0;
    for (const json& part : r["parts"])
      for (const json& face : part["faces"]) {
        EXPECT_LE(face["bound"], r["tolerance"]);
        EXPECT_LE(face["measured"], face["bound"].get<double>() + face["offset"].get<double>() + 1e-9 * r["tolerance"].get<double>());
        EXPECT_LE(face["to_mesh"]["rms"], face["to_mesh"]["max"]);
        EXPECT_GT(face["to_surface"]["samples"], 0);
        EXPECT_EQ(face["kept"], true);
        triangles += face["triangles"].get<std::uint64_t>();
        ++faces;
      }
    EXPECT_EQ(triangles, totals["triangles"]);
  }
  EXPECT_EQ(faces, 5 + 53 + 53);
}

TEST_F(TessellateCommand, SameBytesForAnyNumberOfThreads) {
  for (const char* name : {"a.ply", "a.glb"}) {
    ASSERT_EQ(run(data(kAssembly), {"-o", path(std::string("one-") + name), "-t", "1"}).code, 0);
    ASSERT_EQ(run(data(kAssembly), {"-o", path(std::string("two-") + name), "-t", "2"}).code, 0);
    EXPECT_TRUE(detail::content_of(path(std::string("one-") + name)) == detail::content_of(path(std::string("two-") + name))) << name;
  }
}

TEST_F(TessellateCommand, AdmeshFindsNothingToMend) {
  ASSERT_TRUE(fs::exists("/usr/bin/admesh")) << "admesh is not installed";
  for (const std::string& model : {kCone, kCrank, kPipe}) {
    const ChildResult result = run(data(model), {"-o", path("a.stl")});
    ASSERT_EQ(result.code, 0) << result.summary();
    const ChildResult told = run_child({"/usr/bin/admesh", path("a.stl")});
    ASSERT_EQ(told.code, 0) << told.summary();
    int checked = 0;
    for (const char* what : {"Total disconnected facets ", "Degenerate facets  ", "Edges fixed  ", "Facets removed  ", "Facets added  ",
                             "Facets reversed  ", "Backwards edges  ", "Normals fixed  "}) {
      std::smatch match;
      ASSERT_TRUE(std::regex_search(told.out, match, std::regex(std::string(what) + " *: *(\\d+) *(\\d*)"))) << what << told.out;
      EXPECT_EQ(match[match[2].length() > 0 ? 2 : 1].str(), "0") << model << ": " << what;
      ++checked;
    }
    EXPECT_EQ(checked, 8);
  }
}

TEST_F(TessellateCommand, WrongRequestsAreRefusedInOneLineAndLeaveNoFile) {
  const std::string model = data(kCone), mesh = path("a.stl"), patches = data("meshes/truncated-cuboctahedron.obj");
  const struct {
    std::vector<std::string> arguments;
    Exit code;
    const char* part;
  } wrong[] = {
      {{model}, Exit::bad_command_line, "nothing to write"},
      {{model, "-o", mesh, "--tolerance", "0"}, Exit::bad_command_line, "--tolerance: found '0'"},
      {{model, "-o", mesh, "--tolerance", "-0.1mm"}, Exit::bad_command_line, "--tolerance: found '-0.1mm'"},
      {{model, "-o", mesh, "--tolerance", "nan"}, Exit::bad_command_line, "--tolerance: found 'nan'"},
      {{model, "-o", mesh, "--tolerance", "1e-14d"}, Exit::bad_command_line, "finer than its coordinates"},
      {{model, "-o", mesh, "--trim-tolerance", "thin"}, Exit::bad_command_line, "--trim-tolerance: found 'thin'"},
      {{model, "-o", mesh, "--angle", "0"}, Exit::bad_command_line, "--angle: found 0"},
      {{model, "-o", mesh, "--angle", "nan"}, Exit::bad_command_line, "--angle: found nan"},
      {{model, "-o", mesh, "--strategy", "spiral"}, Exit::bad_command_line, "--strategy"},
      {{model, "-o", mesh, "--strategy", "fan-quads"}, Exit::bad_command_line, "expected patches with any number of sides only"},
      {{model, "-o", mesh, "--level", "4"}, Exit::bad_command_line, "--level needs --strategy"},
      {{patches, "--patches", "gregory", "-o", mesh, "--strategy", "fan-quads", "--level", "0"},
       Exit::bad_command_line,
       "--level: found 0"},
      {{patches, "-o", mesh, "--strategy", "fan-quads", "--level", "4", "--tolerance", "1"}, Exit::bad_command_line, "one of them"},
      {{patches, "-o", mesh, "--strategy", "fan-quads", "--angle", "4"}, Exit::bad_command_line, "--angle has no meaning"},
      {{patches, "-o", mesh, "--strategy", "fan-quads", "--sew", "off"}, Exit::bad_command_line, "--sew has no meaning"},
      {{model, "-o", path("a.fbx")}, Exit::bad_command_line, ".stl, .obj, .ply or .glb"},
      {{model, "-o", mesh, "--report", mesh}, Exit::bad_command_line, "the same file"},
      {{model, "--report", model}, Exit::bad_command_line, "is the model itself"},
      {{data("patches/teapot.bpt"), "-o", mesh, "--tolerance", "1mm"}, Exit::bad_command_line, "the unit of the model is unknown"},
      {{data("README.md"), "-o", mesh}, Exit::bad_input, "expected STEP"},
      {{path("none.step"), "-o", mesh}, Exit::read_write, "no such file"},
      {{model, "-o", path("none/a.stl")}, Exit::read_write, "No such file or directory"},
      {{model, "--report", "/dev/full"}, Exit::read_write, "No space left"}};
  for (const auto& w : wrong) {
    std::vector<std::string> arguments = w.arguments;
    arguments.insert(arguments.begin(), "tessellate");
    const ChildResult result = run_isophote(arguments);
    EXPECT_EQ(result.code, static_cast<int>(w.code)) << w.part << ": " << result.summary();
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(w.part), std::string::npos) << result.err;
  }
  EXPECT_EQ(files(), 0u);
}

TEST_F(TessellateCommand, StrategiesAreToldWithBothDistances) {
  const std::string model = data("meshes/truncated-cuboctahedron.obj");
  const struct {
    std::vector<std::string> arguments;
    const char* strategy;
    std::size_t triangles;  // 0: as many as it takes
  } asked[] = {{{}, "adaptive", 0},
               {{"--strategy", "fan-triangles", "--level", "4"}, "fan-triangles", 16 * (12 * 2 + 8 * 4 + 6 * 6)},
               {{"--strategy", "symmetric-quads", "--level", "4"}, "symmetric-quads", 16 * (12 * 4 + 8 * 6 + 6 * 8)},
               {{"--strategy", "symmetric-triangles"}, "symmetric-triangles", 0},
               {{"--strategy", "fan-quads", "--tolerance", "3e-3d"}, "fan-quads", 0}};
  for (const auto& a : asked) {
    std::vector<std::string> arguments{"--patches", "gregory", "-o", path("a.ply"), "--report", path("r.json")};
    arguments.insert(arguments.end(), a.arguments.begin(), a.arguments.end());
    const ChildResult result = run(model, arguments);
    ASSERT_EQ(result.code, 0) << a.strategy << ": " << result.summary();
    const json r = report("r.json");
    const bool by_level = !r["level"].is_null();
    EXPECT_EQ(r["strategy"], a.strategy);
    EXPECT_EQ(by_level, r["tolerance"].is_null());
    EXPECT_GT(r["totals"]["measured"], 0.0);
    EXPECT_LE(r["totals"]["measured"], r["totals"]["bound"]);
    if (!by_level) {
      EXPECT_LE(r["totals"]["bound"], r["tolerance"]);
    }
    if (a.triangles > 0) {
      EXPECT_EQ(r["totals"]["triangles"], a.triangles);
    }
    EXPECT_EQ(r["totals"]["open_edges"], 0);
    EXPECT_EQ(r["parts"][0]["levels"].is_null(), std::string(a.strategy) == "adaptive");
    EXPECT_GT(r["parts"][0]["mean_curvature"]["points"], 100);
    EXPECT_EQ(read_ply_file(path("a.ply")).triangles.size(), r["totals"]["triangles"]);
  }
}

TEST_F(TessellateCommand, TheExitCodeTellsWhetherAllPromisesAreKept) {
  int kept = 0, broken = 0;
  for (const char* model : {"cad/occt-wing.brep", "cad/afem-simple-wing-openvsp.stp", "cad/bladex-shaft.iges", "patches/teacup.bpt"}) {
    const ChildResult result = run(data(model), {"-o", path("a.stl"), "--report", path("r.json")});
    const json r = report("r.json");
    EXPECT_EQ(result.code, r["kept"] ? 0 : 1) << model << ": " << result.summary();
    EXPECT_EQ(r["broken"].empty(), r["kept"]);
    EXPECT_EQ(result.error_lines(), 1 + static_cast<long>(std::min<std::size_t>(r["broken"].size(), 9))) << result.err;
    EXPECT_TRUE(fs::exists(path("a.stl")));
    r["kept"] ? ++kept : ++broken;
  }
  std::cout << kept << " kept, " << broken << " not\n";
  EXPECT_EQ(kept + broken, 4);
}

// ---- what is told of a mesh that is not as promised ----

TEST(MeshReportLines, EachBrokenPromiseIsALineAndNumbersThatAreNotFiniteAreNull) {
  Part part;
  part.name = "bolt";
  part.faces.resize(3);
  MeshFigures figures;
  figures.unit = "mm";
  figures.settings.distance = 0.1;
  PartFigures made;
  made.part = &part;
  made.faces.resize(3);
  made.check.shapes_of_face.resize(3);
  figures.parts.push_back(made);
  EXPECT_TRUE(broken_promises(figures).empty());

  PartFigures& p = figures.parts[0];
  p.faces[0].within = false;
  p.faces[0].report.bound = kInf;
  p.faces[0].report.unresolved = 2;
  p.faces[1].report.failure = "its loops enclose nothing";
  p.faces[2].report.crossings = 1;
  p.faces[2].report.folded = 3;
  p.check.cracks.add({Point3(1, 2, 3), 7, 2});
  const std::vector<std::string> lines = broken_promises(figures);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0], "face 0: distance bound unknown, beyond the tolerance 0.1 mm: 2 triangles could not be divided");
  EXPECT_EQ(lines[1], "face 1: no triangles: its loops enclose nothing");
  EXPECT_EQ(lines[3], "face 2: 3 triangles turned against the surface");
  EXPECT_EQ(lines[4], "1 open edge where the model is closed at 1 2 3, face 2");
  const json report = json::parse(report_json(figures, lines, {}));
  EXPECT_TRUE(report["parts"][0]["faces"][0]["bound"].is_null());
  EXPECT_EQ(report["broken"].size(), 5u);
  EXPECT_FALSE(report["kept"]);
}

TEST(MeshReport, AFoldOfTheSurfaceIsToldAsTheSurfacesOwn) {
  Part part;
  part.faces.resize(1);
  MeshFigures figures;
  PartFigures made;
  made.part = &part;
  made.faces.resize(1);
  made.faces[0].report.folded = made.faces[0].report.at_folds = 3;
  made.faces[0].report.fold = {1, 2, 3};
  for (std::uint32_t t = 0; t < 3; ++t) made.check.folded.add({Point3(0.0), t, 0});
  figures.parts.push_back(made);
  EXPECT_EQ(broken_promises(figures),
            (std::vector<std::string>{"face 0: the surface itself folds at 1 2 3: 3 triangles lie against its normals there"}));
  // One more that no fold explains.
  figures.parts[0].faces[0].report.folded = 4;
  figures.parts[0].check.folded.add({Point3(4, 5, 6), 3, 0});
  const std::vector<std::string> lines = broken_promises(figures);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[1], "face 0: 1 triangle turned against the surface");
  EXPECT_NE(lines[2].find("4 triangles folded against their normals"), std::string::npos);
}

// With the mean of its polygons' normals, each as large as its area, stated in the file, patches of the cow fold at sharp vertices; with
// our own they do not.
TEST_F(TessellateCommand, SaysThatTheSurfaceFoldsWherePatchesDo) {
  const PolygonMesh cow = read_polygons(data("meshes/spot-control-mesh.obj"));
  std::string text;
  for (const Vec3& p : cow.points) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (const Vec3& n : vertex_normals(cow)) text += fmt::format("vn {} {} {}\n", n.x, n.y, n.z);
  for (const std::vector<int>& polygon : cow.polygons) {
    text += "f";
    for (const int v : polygon) text += fmt::format(" {0}//{0}", v + 1);
    text += "\n";
  }
  std::ofstream(path("cow.obj")) << text;
  const ChildResult result = run(path("cow.obj"), {"--patches", "gregory", "-o", path("cow.stl"), "-q"});
  EXPECT_EQ(result.code, 1) << result.summary();
  EXPECT_NE(result.err.find("the surface itself folds at"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("turned against the surface"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("folded against their normals"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(path("cow.stl")));
  EXPECT_EQ(run(data("meshes/spot-control-mesh.obj"), {"--patches", "gregory", "-o", path("ours.stl"), "-q"}).code, 0);
}

TEST(Stretch, IsTheLargestFactorByWhichAMapLengthens) {
  EXPECT_EQ(stretch_of({}), 1.0);
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Mat3 turn(Vec3(c, s, 0), Vec3(-s, c, 0), Vec3(0, 0, 1));
  EXPECT_EQ(stretch_of({turn, Vec3(5)}), 1.0);
  EXPECT_NEAR(stretch_of({turn * Mat3(Vec3(2, 0, 0), Vec3(0, -7, 0), Vec3(0, 0, 0.1)), Vec3(0)}), 7, 1e-12);
  EXPECT_NEAR(stretch_of({Mat3(1, 0, 0, 1, 1, 0, 0, 0, 1), Vec3(0)}), (1 + std::sqrt(5.0)) / 2, 1e-12);  // a shear: the golden ratio
}

// ---- pictures ----

// Pixels of `b` that contradict `a` where a pixel and its eight neighbours are all inside, or all outside.
int contradictions(const Image& a, const Image& b, int& decided) {
  int wrong = 0;
  const auto alpha = [](const Image& image, int x, int y) { return image.rgba[static_cast<std::size_t>(y * image.width + x)].a; };
  for (int y = 1; y + 1 < a.height; ++y)
    for (int x = 1; x + 1 < a.width; ++x) {
      float low = 1, high = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          low = std::min(low, alpha(a, x + dx, y + dy));
          high = std::max(high, alpha(a, x + dx, y + dy));
        }
      if (low < 1 && high > 0) continue;
      ++decided;
      wrong += std::abs(alpha(b, x, y) - low) > 1e-3f;
    }
  return wrong;
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(a.rgba[i].g - b.rgba[i].g);
  return sum / static_cast<double>(a.rgba.size());
}

TEST_F(TessellateCommand, TessellatedPicturesHaveTheSilhouetteOfTheExactOnes) {
  for (const std::string& model : {kCrank, kPipe}) {
    const Image exact = picture(model, {}), mesh = picture(model, {"--mode", "tessellated", "--tolerance", "1e-4d"});
    ASSERT_EQ(exact.rgba.size(), 160u * 120u);
    ASSERT_EQ(mesh.rgba.size(), exact.rgba.size());
    int decided = 0;
    EXPECT_EQ(contradictions(exact, mesh, decided), 0) << model;
    EXPECT_GT(decided, 10000) << model;
    EXPECT_LT(mean_difference(exact, mesh), 0.005) << model;
  }
}

TEST_F(TessellateCommand, FlatShowsTheFacetsAndTheExactPictureHasNone) {
  const std::vector<std::string> coarse{"--mode", "tessellated", "--tolerance", "1e-2d"};
  std::vector<std::string> with_flat = coarse;
  with_flat.push_back("--flat");
  const Image smooth = picture(kCrank, coarse), flat = picture(kCrank, with_flat);
  EXPECT_GT(mean_difference(smooth, flat), 0.005);
  const ChildResult refused = run_isophote({"render", data(kCrank), "-o", path("b.exr"), "--mode", "direct", "--flat"});
  EXPECT_EQ(refused.code, static_cast<int>(Exit::bad_command_line));
  EXPECT_NE(refused.err.find("--flat needs --mode tessellated"), std::string::npos);
}

TEST_F(TessellateCommand, TheClosingLineOfATessellatedPictureTellsItsDistance) {
  const ChildResult result = run_isophote({"render", data(kCone), "-o", path("a.exr"), "--mode", "tessellated", "--tolerance", "0.05mm",
                                           "--size", "64x48", "--samples", "1", "--progress", "none", "--stats"});
  EXPECT_EQ(result.code, 0) << result.summary();
  for (const char* part : {"tessellated: 5 faces, ", "0 open edges; distance bound 0.0", " mm, measured 0.0", "\nmesh\n  tolerance "})
    EXPECT_NE(result.err.find(part), std::string::npos) << part << "\n" << result.err;
}

}  // namespace
}  // namespace iso::test
