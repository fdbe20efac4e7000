// The program on bad input: the exit code of the published table, one clear line that names the file, no crash, no half-written picture.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "patches/base/result.h"
#include "tests/support/child.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;

std::string file_text(const std::string& name) { return detail::content_of(data(name)); }

// The text with every `from` replaced; it has to occur.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), text.npos) << from;
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

class BadInput : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  std::string path(const std::string& name) const { return dir_.path() / name; }

  // One line "isophote: <file>...: <message>", the exit code, and nothing on standard output.
  void expect_refusal(const ChildResult& result, Exit code, const std::string& file, const std::string& part) {
    ++checked_;
    const std::string what = file + ": " + result.summary();
    EXPECT_EQ(result.code, static_cast<int>(code)) << what;
    EXPECT_EQ(result.error_lines(), 1) << what;
    EXPECT_TRUE(result.err.starts_with("isophote: ")) << what;
    EXPECT_NE(result.err.find(file), std::string::npos) << what;
    EXPECT_NE(result.err.find(part), std::string::npos) << what << "; expected: " << part;
    EXPECT_EQ(result.out, "") << what;
  }
  // The same refusal by every command that reads models; no picture is left, not even a part of one.
  void refused_by_all(const std::string& model, Exit code, const std::string& part) {
    expect_refusal(run_isophote({"info", model}), code, model, part);
    expect_refusal(run_isophote({"hit", model}, "0 0 0 1 0 0\n"), code, model, part);
    refused_by_render(model, code, model, part);
  }
  void refused_by_render(const std::string& input, Exit code, const std::string& file, const std::string& part) {
    const std::size_t files_before = files();
    expect_refusal(run_isophote({"render", input, "-o", path("picture.exr"), "--size", "16x12", "--samples", "1", "--progress", "none"}),
                   code, file, part);
    EXPECT_EQ(files(), files_before) << input << " left a file behind";
  }
  void refused_by_info(const std::string& model, const std::string& part) {
    expect_refusal(run_isophote({"info", model}), Exit::bad_input, model, part);
  }
  void refused_by_hit(const std::string& model, const std::string& part) {
    expect_refusal(run_isophote({"hit", model}, "0 0 0 1 0 0\n"), Exit::bad_input, model, part);
  }
  // Readable in part: what could not be used is told.
  void read_with_report(const std::string& model, const std::string& part) {
    ++checked_;
    const ChildResult result = run_isophote({"info", model});
    EXPECT_EQ(result.code, 0) << model << ": " << result.summary();
    EXPECT_EQ(result.err, "") << model;
    EXPECT_NE(result.out.find(part), std::string::npos) << result.out << "; expected: " << part;
  }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(dir_.path()), {})); }
  void expect_checked(int count) const { EXPECT_EQ(checked_, count); }

 private:
  TemporaryDir dir_;
  int checked_ = 0;
};

const std::string kCube = "cad/occtjs-cube-mm.step";

TEST_F(BadInput, MissingFilesAndFolders) {
  refused_by_all(path("missing.step"), Exit::read_write, "no such file");
  fs::create_directory(path("folder.step"));
  refused_by_all(path("folder.step"), Exit::read_write, "is a directory");
  refused_by_all("/dev/null", Exit::read_write, "not a regular file");
  expect_checked(9);
}

TEST_F(BadInput, EmptyFilesAndRandomBytesUnderEveryName) {
  std::mt19937_64 random(7);
  std::string noise(3000, ' ');
  for (char& c : noise) c = static_cast<char>(random());
  for (const char* ending : {".step", ".stp", ".iges", ".igs", ".brep", ".obj", ".bpt", ".json", ""}) {
    const std::string empty = write(std::string("empty") + ending, ""), bytes = write(std::string("random") + ending, noise);
    if (std::string(ending) == ".json") {
      refused_by_render(empty, Exit::bad_input, empty, "");
      refused_by_render(bytes, Exit::bad_input, bytes, "");
      continue;
    }
    refused_by_info(empty, "found an empty file");
    refused_by_info(bytes, "expected");
  }
  refused_by_all(path("random.step"), Exit::bad_input, "found binary data");
  expect_checked(21);
}

TEST_F(BadInput, FilesOfOtherKindsAreNamed) {
  refused_by_hit(write("mesh.stl", "solid x\n facet normal 0 0 1\n"), "an STL mesh");
  refused_by_info(write("packed.step", std::string("PK\x03\x04....", 8)), "a zip archive");
  refused_by_hit(write("polygons.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "free-form");
  expect_checked(3);
}

TEST_F(BadInput, CoordinatesThatAreNoNumbersOrTooLarge) {
  const std::string cube = file_text(kCube), wing = file_text("cad/occt-wing.brep");
  for (const char* number : {"NaN", "-inf", "1.#QNAN", "1.E+300", "1e34"})
    refused_by_info(write(fmt::format("cube{}.step", number), replaced(cube, "(0.,0.,1.E+03)", fmt::format("(0.,0.,{})", number))),
                    fmt::format(":57: found \"{}\"", number));
  const std::string pole = "3.3500000000000001 0 0.84999599999999997";
  read_with_report(write("nan.brep", replaced(wing, pole, "NaN 0 0.84999599999999997")), "not finite");
  read_with_report(write("huge.brep", replaced(wing, pole, "1e300 0 0.84999599999999997")), "larger than 1e15");
  refused_by_info(write("word.brep", replaced(wing, pole, "x 0 0.84999599999999997")), "found \"x\"");
  refused_by_info(write("nan.bpt", "1\n1 1\n0 0 0\n1 0 nan\n0 1 0\n1 1 0\n"), ":4: found \"nan\"");
  refused_by_info(write("huge.bpt", "1\n1 1\n0 0 0\n1 0 1e300\n0 1 0\n1 1 0\n"), ":4: found \"1e300\"");
  expect_checked(10);
}

TEST_F(BadInput, KnotsAndWeights) {
  const std::string sheet =
      "v 0 0 0 1\nv 1 0 0 {0}\nv 0 1 0 1\nv 1 1 0 1\ncstype rat bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 0 {1} 1\nparm v 0 0 1 "
      "1\nend\n";
  const auto with = [&](const char* weight, const char* knot) { return replaced(replaced(sheet, "{0}", weight), "{1}", knot); };
  EXPECT_EQ(run_isophote({"info", write("good.obj", with("0.5", "1"))}).code, 0);
  refused_by_info(write("zero.obj", with("0", "1")), "weight");
  refused_by_info(write("negative.obj", with("-1", "1")), "weight");
  refused_by_info(write("decreasing.obj", with("1", "-1")), "value 3 of 4 is smaller than the one before it");
  refused_by_info(write("nan.obj", with("1", "nan")), "found \"nan\"");

  // The same in STEP: a rational cylinder.
  const std::string weights = "((1.,0.707106781186548,", solid = file_text("cad/edge-cases/periodic-edge-propagation.stp");
  for (const char* bad : {"((1.,0.,", "((1.,-1.,"}) {
    const std::string file = write(fmt::format("weight{}.stp", bad[5]), replaced(solid, weights, bad));
    const ChildResult result = run_isophote({"info", file});
    EXPECT_TRUE(result.code == 0 || result.code == 3) << result.summary();
    EXPECT_LE(result.error_lines(), 1);
    if (result.code == 0) {
      EXPECT_TRUE(result.out.find("dropped") != std::string::npos) << bad << "\n" << result.out;
    }
  }
  const ChildResult knots =
      run_isophote({"info", write("knots.stp", replaced(solid, "1.570796326794897,3.141592653589793", "3.141592653589793,1.5"))});
  EXPECT_TRUE(knots.code == 0 || knots.code == 3) << knots.summary();
  if (knots.code == 0) {
    EXPECT_TRUE(knots.out.find("dropped") != std::string::npos) << knots.out;
  }
  expect_checked(4);
}

TEST_F(BadInput, ModelsWithoutFaces) {
  const std::string cube = file_text(kCube);
  const std::size_t begin = cube.find("DATA;") + 5, end = cube.find("ENDSEC;", begin);
  refused_by_info(write("no-data.step", cube.substr(0, begin) + "\n" + cube.substr(end)), "without shapes");
  refused_by_info(
      write("point.brep",
            "CASCADE Topology V1, (c) Matra-Datavision\nLocations 0\nCurve2ds 0\nCurves 0\nPolygon3D 0\n"
            "PolygonOnTriangulations 0\nSurfaces 0\nTriangulations 0\n\nTShapes 1\nVe\n1e-07\n1 2 3\n0 0\n\n0101101\n*\n\n+1 0\n"),
      "no faces that can be used");
  refused_by_all(write("curves.obj", "v 0 0 0\nv 1 0 0\ncstype bezier\ndeg 1\ncurv 0 1 1 2\nparm u 0 1\nend\n"), Exit::bad_input, "");
  read_with_report(data("cad/edge-cases/exact-distinct-edge-zero-area-face.stp"), "it has no area");
  expect_checked(6);
}

TEST_F(BadInput, SceneFiles) {
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& part) {
    const std::string scene = write(name, text);
    refused_by_render(scene, Exit::bad_input, scene, part);
  };
  const std::string models = R"("models": [{"file": ")" + data(kCube) + R"("}])";
  refused("unknown.json", "{" + models + R"(, "camra": {}})", "camra: unknown key 'camra'; did you mean 'camera'?");
  refused("type.json", R"({"models": [{"file": 7}]})", "models[0].file: found 7, expected a text");
  refused("syntax.json", "{\n  \"models\": [,]\n}", ":2:14: syntax error");
  refused("array.json", "[]", "");
  refused("deep.json", std::string(100000, '['), "");
  refused("size.json", "{" + models + R"(, "image": {"width": 1e9}})", "");
  refused("fine.json", "{" + models + R"(, "mesh": {"tolerance": "1e-30d"}})", "mesh.tolerance: found");
  const std::string scene = write("gone.json", R"({"models": [{"file": "gone.step"}]})");
  refused_by_render(scene, Exit::read_write, path("gone.step"), "no such file");
  refused_by_render(path("missing.json"), Exit::read_write, path("missing.json"), "");
  expect_checked(9);
}

TEST_F(BadInput, CommandLines) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& part) {
    expect_refusal(run_isophote(arguments), Exit::bad_command_line, "", part);
  };
  refused({"rendr"}, "did you mean 'render'?");
  refused({"render", data(kCube)}, "--output is required");
  refused({"render", data(kCube), "-o", path("picture.png")}, ".exr");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--size", "0x5"}, "--size");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--samples", "many"}, "--samples");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--tolerance", "1mm"}, "--tolerance needs --mode tessellated");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--flat"}, "--flat needs --mode tessellated");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--terminator-fix"}, "--terminator-fix needs --mode tessellated");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--mode", "tessellated", "--tolerance", "1parsec"}, "unit 'parsec'");
  refused({"render", data(kCube), "-o", path("picture.exr"), "--mode", "tessellated", "--flat", "--terminator-fix"},
          "no meaning with --flat");
  refused({"info"}, "FILE is required");
  EXPECT_EQ(files(), 0u);
  expect_checked(11);
}

TEST_F(BadInput, PatchesWithoutAControlMesh) {
  const std::string surfaces = data("patches/teacup-bezier.obj");
  expect_refusal(run_isophote({"info", surfaces, "--patches", "gregory"}), Exit::bad_input, surfaces, "expected polygons (f)");
  const std::string scene = write("scene.json", "{\"models\": [{\"file\": \"" + data("patches/teapot.bpt") + "\"}]}");
  expect_refusal(run_isophote({"render", scene, "--patches", "gregory", "-o", path("picture.exr"), "--size", "16x12"}), Exit::bad_input,
                 scene, "expected a model that is an OBJ file");
  // Beside a mesh, surfaces stay what they are.
  const std::string mixed = write(
      "mixed.json", "{\"models\": [{\"file\": \"" + data("meshes/truncated-cuboctahedron.obj") + "\"}, {\"file\": \"" + surfaces + "\"}]}");
  EXPECT_EQ(
      run_isophote({"render", mixed, "--patches", "gregory", "-o", path("picture.exr"), "--size", "16x12", "--samples", "1", "-q"}).code,
      0);
  expect_checked(2);
}

TEST_F(BadInput, RaysThatAreNone) {
  for (const char* line : {"1 2 3\n", "0 0 0 0 0 0\n", "0 0 0 1 0 nan\n", "0 0 0 1 0 zero\n", "0 0 0 1e999 0 0\n"}) {
    const ChildResult result = run_isophote({"hit", data(kCube)}, std::string("0 0 0 1 0 0\n") + line);
    EXPECT_EQ(result.code, 3) << line << result.summary();
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    EXPECT_TRUE(result.err.starts_with("isophote: standard input:line 2: ")) << result.err;
  }
}

TEST_F(BadInput, OutputThatCannotBeWritten) {
  const auto render_to = [&](const std::string& output, const ChildLimits& limits = {}) {
    return run_isophote({"render", data(kCube), "-o", output, "--size", "64x48", "--samples", "1", "--progress", "none"}, {}, limits);
  };
  expect_refusal(render_to(path("no/such/folder/a.exr")), Exit::read_write, path("no/such/folder/a.exr"), "No such file or directory");
  fs::create_directory(path("folder.exr"));
  expect_refusal(render_to(path("folder.exr")), Exit::read_write, path("folder.exr"), "is a folder");
  expect_refusal(render_to("/proc/a.exr"), Exit::read_write, "/proc/a.exr", "cannot be created");
  expect_refusal(render_to("/dev/full"), Exit::read_write, "/dev/full", "No space left on device");
  expect_refusal(render_to(path("large.exr"), {.seconds = 20, .file_bytes = 4096, .memory_bytes = -1, .standard_output = {}}),
                 Exit::read_write, path("large.exr"), "File too large");
  EXPECT_EQ(files(), 1u) << "only the folder";

  // A picture that was there before stays as it was.
  write("large.exr", "old");
  expect_refusal(render_to(path("large.exr"), {.seconds = 20, .file_bytes = 4096, .memory_bytes = -1, .standard_output = {}}),
                 Exit::read_write, path("large.exr"), "File too large");
  EXPECT_EQ(detail::content_of(path("large.exr")), "old");
  EXPECT_EQ(files(), 2u);

  // A folder without write permission; the superuser may write everywhere.
  if (::geteuid() != 0) {
    fs::create_directory(path("locked"));
    fs::permissions(path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    expect_refusal(render_to(path("locked/a.exr")), Exit::read_write, path("locked/a.exr"), "Permission denied");
    fs::permissions(path("locked"), fs::perms::owner_all);
  }
  expect_checked(::geteuid() != 0 ? 7 : 6);
}

TEST_F(BadInput, FullStandardOutput) {
  const ChildLimits full{.seconds = 20, .file_bytes = -1, .memory_bytes = -1, .standard_output = "/dev/full"};
  expect_refusal(run_isophote({"info", data(kCube)}, {}, full), Exit::read_write, "standard output", "No space left on device");
  expect_refusal(run_isophote({"hit", data(kCube)}, "0 0 0 1 0 0\n", full), Exit::read_write, "standard output", "No space left on device");
  expect_checked(2);
}

}  // namespace
}  // namespace iso::test
