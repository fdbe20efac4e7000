// `isophote compare` through the program: files, figures, what is said of damaged meshes, limits, advice, exit codes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "raytracer/image_io.h"
#include "tests/support/compare_command.h"
#include "tests/support/mesh_bytes.h"
#include "tests/support/mesh_files.h"

namespace iso::test {
namespace {

double largest(const json& mesh) { return mesh["distance"]["max"]; }

const json* fault_of(const json& mesh, const std::string& name) {
  for (const json& fault : mesh["faults"])
    if (fault["fault"] == name) return &fault;
  return nullptr;
}

bool has_line(const ChildResult& result, const std::vector<std::string>& parts) {
  std::istringstream lines(result.err);
  for (std::string line; std::getline(lines, line);)
    if (std::all_of(parts.begin(), parts.end(), [&](const std::string& part) { return line.find(part) != std::string::npos; })) return true;
  return false;
}

// ---- the report ----

TEST_F(CompareCommand, WritesThePageTheFiguresAndPicturesThatDiffReads) {
  const ChildResult result = run({data(kCone), "-o", path("report"), "--tolerances", "1e-2d,1e-3d", "--size", "64x48", "--samples", "1"});
  ASSERT_EQ(result.code, 0) << result.summary();
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.error_lines(), 3) << result.err;  // a line a mesh, and where the page is
  EXPECT_TRUE(has_line(result, {path("report/index.html")}));

  const json r = report();
  std::set<std::string> expected{"index.html", "report.json", "table.csv"};
  for (const json& picture : r["pictures"]) expected.insert(picture["file"]);
  for (const json& mesh : r["meshes"])
    for (const json& picture : mesh["pictures"]) expected.insert(picture["file"]);
  EXPECT_EQ(expected.size(), 3u + 1 + 2 * 6);
  EXPECT_EQ(files("report"), expected);
  int pictures = 0;
  for (const std::string& name : expected) {
    if (fs::path(name).extension() != ".exr") continue;
    ++pictures;
    const auto image = read_image(path("report/" + name));
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_EQ(image->width, 64) << name;
    EXPECT_EQ(image->height, 48) << name;
    const ChildResult same = program({"diff", path("report/" + name), path("report/" + name)});
    EXPECT_EQ(same.code, 0) << name << ": " << same.summary();
  }
  EXPECT_EQ(pictures, 13);
  EXPECT_EQ(program({"diff", path("report/direct.exr"), path("report/mesh-1-tessellated.exr")}).code, 1);

  // A header, a row a mesh and one a face of each.
  const std::string table = detail::content_of(path("report/table.csv"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 2 * (1 + kConeFaces));
  const std::string html = page();
  for (const json& mesh : r["meshes"]) EXPECT_NE(html.find(mesh["verdict"].get<std::string>()), std::string::npos);
  EXPECT_TRUE(r["machine"].is_string());
  EXPECT_GT(r["direct"]["primary_rate"], 0);
  EXPECT_TRUE(r["slope"].is_null()) << "two meshes tell no slope";
}

TEST_F(CompareCommand, OurMeshesAreNoFartherThanTheyGuaranteeAndHaveNoFaults) {
  int meshes = 0;
  for (const std::string& model : {kCone, kScrew, kPipe}) {
    SCOPED_TRACE(model);
    const ChildResult result = measure(data(model), {"--tolerances", "3e-3d,1e-3d"});
    ASSERT_EQ(result.code, 0) << result.summary();
    const json r = report();
    EXPECT_TRUE(r["failures"].empty());
    EXPECT_EQ(r["verdict"], r["meshes"][0]["verdict"]);
    EXPECT_TRUE(r["pictures"].empty());
    EXPECT_TRUE(r["direct"]["build_seconds"].is_null());
    const double rounding = 1e-12 * r["diagonal"].get<double>();
    for (const json& mesh : r["meshes"]) {
      ++meshes;
      const double guaranteed = mesh["guaranteed"], tolerance = mesh["tolerance"], bound = mesh["distance"]["bound"];
      EXPECT_LE(largest(mesh), guaranteed + rounding);
      EXPECT_LE(largest(mesh), bound);
      EXPECT_LE(guaranteed, tolerance + mesh["model_gap"].get<double>());
      EXPECT_GT(largest(mesh), 0.2 * tolerance);  // not finer than asked for
      EXPECT_EQ(mesh["faults"].size(), 0u) << mesh["faults"];
      EXPECT_EQ(mesh["kept"], true);
      EXPECT_NEAR(mesh["covered_share"].get<double>(), 1, 0.05);
      double worst = 0;
      for (const json& face : mesh["faces"]) worst = std::max(worst, face["max"].get<double>());
      EXPECT_EQ(worst, largest(mesh));
    }
    EXPECT_LT(largest(r["meshes"][1]), largest(r["meshes"][0]));
  }
  EXPECT_EQ(meshes, 6);
}

TEST_F(CompareCommand, AMeshOfOursThatIsVeryCoarseIsNotTakenForOneOfAnotherSize) {
  const ChildResult result = measure(data(kCone), {"--tolerances", "5e-2d"});
  EXPECT_EQ(result.code, 0) << result.summary();
  const json r = report(), &mesh = r["meshes"][0];
  EXPECT_TRUE(mesh["faults"].empty()) << mesh["faults"];
  EXPECT_EQ(mesh["notes"].size(), 1u);
  EXPECT_LE(largest(mesh), mesh["guaranteed"]);
}

TEST_F(CompareCommand, TheSameMeshInAnyFormatIsGradedAlike) {
  std::vector<std::string> arguments{"--tolerances", "1e-3d"};
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb"}) arguments.insert(arguments.end(), {"--mesh", meshed(kCone, name)});
  const ChildResult result = measure(data(kCone), arguments);
  ASSERT_EQ(result.code, 0) << result.summary();
  const json r = report();
  ASSERT_EQ(r["meshes"].size(), 5u);
  const json& ours = r["meshes"][0];
  constexpr double kLargest = 64;  // no coordinate of the model is larger
  const double rounding = std::sqrt(3.0) * kLargest * double(std::numeric_limits<float>::epsilon());
  for (std::size_t m = 1; m < 5; ++m) {
    const json& mesh = r["meshes"][m];
    SCOPED_TRACE(mesh["label"].get<std::string>());
    const bool text = m <= 2, gltf = m == 4;  // coordinates to the last bit in .obj and .ply, floats in the others
    EXPECT_NEAR(largest(mesh), largest(ours), text ? 1e-12 : rounding);
    EXPECT_NEAR(mesh["distance"]["rms"].get<double>(), ours["distance"]["rms"].get<double>(), text ? 1e-12 : rounding);
    EXPECT_EQ(mesh["triangles"], ours["triangles"]);
    EXPECT_EQ(mesh["points"], ours["points"]);
    EXPECT_EQ(mesh["topology"]["open_edges"], 0);
    EXPECT_TRUE(mesh["faults"].empty()) << mesh["faults"];
    EXPECT_TRUE(mesh["guaranteed"].is_null());
    ASSERT_EQ(mesh["notes"].size(), gltf ? 1u : 0u) << mesh["notes"];
    if (gltf) {
      EXPECT_EQ(mesh["notes"][0], "coordinates taken as m and turned into mm");
    }
  }
}

TEST_F(CompareCommand, ASceneWithTwoInstancesIsMeasuredWhereTheyStand) {
  std::ofstream(path("scene.json")) << json{
      {"models",
       {{{"file", data(kCone)}}, {{"file", data(kCone)}, {"transform", {{{"scale", {1, 1, -2}}}, {{"translate", {100, 0, 0}}}}}}}}};
  const ChildResult result = measure(path("scene.json"), {"--tolerances", "1e-3d"});
  ASSERT_EQ(result.code, 0) << result.summary();
  const json r = report(), &mesh = r["meshes"][0];
  EXPECT_EQ(r["faces"], 2 * kConeFaces);
  ASSERT_EQ(mesh["faces"].size(), 2u * kConeFaces);
  EXPECT_LE(largest(mesh), mesh["guaranteed"]);
  EXPECT_TRUE(mesh["faults"].empty()) << mesh["faults"];
  int far = 0;
  for (std::size_t f = 0; f < mesh["faces"].size(); ++f) {
    const json& face = mesh["faces"][f];
    EXPECT_EQ(face["placed"], f < kConeFaces ? 0 : 1);
    EXPECT_EQ(face["face"], f % kConeFaces);
    EXPECT_GT(face["triangles"], 0);
    EXPECT_NEAR(face["covered_share"].get<double>(), 1, 0.05);
    far += face["to_mesh"]["at"][0] > 60;
  }
  EXPECT_EQ(far, kConeFaces);
}

// ---- damage ----

struct Mesh {
  std::vector<Point3> points;
  std::vector<PointTriangle> triangles;
  std::vector<int> face_of;

  explicit Mesh(const std::string& obj) {
    const ObjFile file = read_obj_file(obj);
    points = file.points;
    triangles = file.triangles;
    face_of = file.group_of;
  }
  double diagonal() const {
    Box3 box;
    for (const Point3& p : points) box.include(p);
    return box.diagonal();
  }
  void scale(double by) {
    for (Point3& p : points) p *= by;
  }
  void without_face(int face) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (face_of[t] != face) triangles[kept++] = triangles[t];
    triangles.resize(kept);
  }
  std::string obj() const {
    std::string text;
    for (const Point3& p : points) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (const PointTriangle& t : triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return text;
  }
};

TEST_F(CompareCommand, DamageIsCaughtAndNamedOnStandardErrorAndInTheReport) {
  constexpr int kLargeFace = 1;  // of the pipe: a large face
  const struct {
    const char *file, *fault, *told;
    const std::string& model;
    std::function<void(Mesh&)> harm;
    int code;
  } cases[] = {
      {"missing.obj", "missing-face", "face 1 has no mesh near it", kPipe, [](Mesh& m) { m.without_face(kLargeFace); }, 0},
      {"missing.stl", "open-edges", "open where the model is closed", kCone, [](Mesh& m) { m.without_face(3); }, 0},
      {"moved.obj", "far-points", "1 point is far off", kCone,
       [](Mesh& m) { m.points[m.points.size() / 2] += Vec3(10 * 1e-3 * m.diagonal(), 0, 0); }, 0},
      {"turned.stl", "inside-out", "the mesh is inside out", kCone,
       [](Mesh& m) {
         for (PointTriangle& t : m.triangles) std::swap(t[1], t[2]);
       },
       0},
      {"doubled.obj", "doubled-triangles", "1 triangle is there twice", kCone, [](Mesh& m) { m.triangles.push_back(m.triangles[10]); }, 0},
      {"doubled.stl", "non-manifold", "3 edges of more than two triangles", kCone, [](Mesh& m) { m.triangles.push_back(m.triangles[10]); },
       0},
      {"large.obj", "unit", "converted from in to mm once too often", kCone, [](Mesh& m) { m.scale(25.4); }, 1},
      {"small.stl", "unit", "its numbers look like in where the model's are mm", kCone, [](Mesh& m) { m.scale(1 / 25.4); }, 1},
  };
  const Mesh cone(meshed(kCone, "cone.obj")), pipe(meshed(kPipe, "pipe.obj"));
  int caught = 0;
  for (const auto& c : cases) {
    SCOPED_TRACE(c.file);
    Mesh mesh = &c.model == &kCone ? cone : pipe;
    c.harm(mesh);
    std::ofstream(path(c.file), std::ios::binary)
        << (fs::path(c.file).extension() == ".stl" ? binary_stl(mesh.points, mesh.triangles) : mesh.obj());
    const ChildResult result = measure(data(c.model), {"--mesh", path(c.file)});
    EXPECT_EQ(result.code, c.code) << result.summary();
    EXPECT_TRUE(has_line(result, {std::string("  ") + c.fault + ": ", c.told})) << result.err;
    const json r = report(), &told = r["meshes"][0];
    const json* fault = fault_of(told, c.fault);
    ASSERT_TRUE(fault) << told["faults"];
    EXPECT_NE((*fault)["text"].get<std::string>().find(c.told), std::string::npos) << *fault;
    EXPECT_NE(page().find(c.fault), std::string::npos);
    EXPECT_EQ(r["failures"].size(), static_cast<std::size_t>(c.code));
    caught += 1;
    if (c.code == 1) {
      EXPECT_NEAR((*fault)["ratio"].get<double>(), std::string(c.file) == "large.obj" ? 25.4 : 1 / 25.4, 0.1);
      EXPECT_NE(r["failures"][0].get<std::string>().find(c.told), std::string::npos);
    }
    if (std::string(c.file) == "small.stl") {
      EXPECT_EQ((*fault)["unit"], "in");
    }
    if (std::string(c.file) == "moved.obj") {
      EXPECT_GT(largest(told), 5e-3 * r["diagonal"].get<double>());
    }
    if (std::string(c.file) == "missing.obj") {
      EXPECT_EQ(told["missing_faces"], 1);
    }
  }
  EXPECT_EQ(caught, 8);
}

TEST_F(CompareCommand, MeshUnitMendsAMeshInInches) {
  Mesh mesh(meshed(kCone, "cone.obj"));
  mesh.scale(1 / 25.4);
  std::ofstream(path("small.obj")) << mesh.obj();
  const ChildResult result = measure(data(kCone), {"--mesh", path("small.obj"), "--mesh", path("cone.obj"), "--mesh-unit", "in"});
  EXPECT_EQ(result.code, 1) << result.summary();  // the unit is of all meshes, so that the other one is too large now
  const json r = report(), &mended = r["meshes"][0];
  EXPECT_TRUE(mended["faults"].empty()) << mended["faults"];
  EXPECT_EQ(mended["notes"][0], "coordinates taken as in and turned into mm");
  EXPECT_LT(largest(mended), 1e-3 * r["diagonal"].get<double>());
  EXPECT_TRUE(fault_of(r["meshes"][1], "unit"));
}

// ---- limits and advice ----

TEST_F(CompareCommand, LimitsThatAreNotKeptGiveExitCodeOneAndALineWithTheReason) {
  const std::string good = meshed(kCone, "good.obj");
  Mesh holed(good), doubled(good);
  holed.without_face(3);
  doubled.triangles.push_back(doubled.triangles[0]);
  const std::string open = path("open.obj"), twice = path("twice.obj");
  std::ofstream(open) << holed.obj();
  std::ofstream(twice) << doubled.obj();
  const struct {
    std::vector<std::string> arguments;
    const char* told;  // null: the limit is kept
  } cases[] = {{{"--mesh", good, "--fail-above", "0.03mm", "--fail-normal", "30", "--fail-open", "--fail-faults"}, nullptr},
               {{"--mesh", good, "--fail-above", "0.02mm"}, "is above 0.02 mm"},
               {{"--tolerances", "1e-2d", "--fail-above", "1e-3d"}, "is above 0.0389 mm"},
               {{"--mesh", good, "--fail-normal", "0.1"}, "degrees apart at face"},
               {{"--mesh", open, "--fail-open"}, "open where the model is closed"},
               {{"--mesh", open}, nullptr},
               {{"--mesh", twice, "--fail-faults"}, "1 triangle is there twice"},
               {{"--mesh", twice, "--fail-above", "1mm"}, nullptr}};
  int broken = 0;
  for (const auto& c : cases) {
    std::vector<std::string> arguments = c.arguments;
    arguments.push_back("-q");
    const ChildResult result = measure(data(kCone), arguments);
    const json r = report();
    if (!c.told) {
      EXPECT_EQ(result.code, 0) << result.summary();
      EXPECT_EQ(result.err, "");
      EXPECT_TRUE(r["failures"].empty());
      continue;
    }
    ++broken;
    EXPECT_EQ(result.code, 1) << c.told << result.summary();
    EXPECT_TRUE(has_line(result, {"isophote: " + data(kCone), c.told})) << result.err;
    ASSERT_FALSE(r["failures"].empty());
    EXPECT_EQ(static_cast<std::size_t>(result.error_lines()), r["failures"].size());
    EXPECT_NE(r["failures"][0].get<std::string>().find(c.told), std::string::npos) << r["failures"];
    EXPECT_EQ(r["verdict"], r["failures"][0]);
    EXPECT_NE(page().find(c.told), std::string::npos);
  }
  EXPECT_EQ(broken, 5);
}

TEST_F(CompareCommand, AdviceIsTheCoarsestToleranceThatKeepsWhatWasAskedFor) {
  const struct {
    std::vector<std::string> arguments;
    double limit;
    std::function<double(const json&)> value;
  } cases[] = {
      {{"--pixels", "0.5", "--no-pictures", "--size", "320x240"}, 0.5, [](const json& m) { return m["distance"]["pixels"].get<double>(); }},
      {{"--flip", "0.01", "--size", "64x48", "--samples", "1"}, 0.01, [](const json& m) { return m["images"]["flip"].get<double>(); }}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.arguments[0]);
    std::vector<std::string> arguments{data(kCone), "-o", path("report"), "--advise"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const ChildResult result = run(arguments);
    ASSERT_EQ(result.code, 0) << result.summary();
    const json r = report();
    const std::size_t tried = r["meshes"].size();
    ASSERT_GE(tried, 2u);
    const json &advised = r["meshes"][tried - 1], &coarser = r["meshes"][tried - 2];
    EXPECT_LE(c.value(advised), c.limit);
    EXPECT_GT(c.value(coarser), c.limit);
    EXPECT_LT(advised["tolerance"], coarser["tolerance"]);
    const std::string advice = r["advice"];
    EXPECT_NE(advice.find(fmt::format("a tolerance of {:.3g} mm", advised["tolerance"].get<double>())), std::string::npos) << advice;
    EXPECT_TRUE(has_line(result, {advice}));
    EXPECT_EQ(r["verdict"], advised["verdict"]);
    EXPECT_NE(page().find(advice), std::string::npos);
  }
}

TEST_F(CompareCommand, MeshesThatAreNotAdvisedFailNoLimit) {
  const ChildResult result = measure(data(kCone), {"--advise", "--pixels", "0.5", "--size", "320x240", "--fail-above", "3e-3d"});
  EXPECT_EQ(result.code, 0) << result.summary();
  const json r = report();
  EXPECT_GT(largest(r["meshes"][0]), 3e-3 * r["diagonal"].get<double>());
  EXPECT_TRUE(r["failures"].empty());
}

TEST_F(CompareCommand, AnEarlierReportStaysWhenANewOneIsRefused) {
  ASSERT_EQ(measure(data(kCone), {"--tolerances", "1e-2d"}).code, 0);
  const std::string before = page();
  EXPECT_EQ(measure(data(kCone), {"--mesh", path("none.stl")}).code, static_cast<int>(Exit::read_write));
  EXPECT_TRUE(page() == before);
}

// ---- determinism, interrupts ----

// What differs from run to run, taken out: times, rates, and the command line.
json without_times(json r) {
  for (const char* key : {"command", "machine", "direct"}) r.erase(key);
  for (json& mesh : r["meshes"]) {
    mesh.erase("seconds");
    mesh.erase("cost");
  }
  return r;
}

std::string without_times(const std::string& html) {
  std::string text = std::regex_replace(html, std::regex("compared in [^\\n]*"), "");
  text = std::regex_replace(text, std::regex("<dt>Command[^\\n]*"), "");
  text = std::regex_replace(text, std::regex("Measured on [^\\n]*"), "");
  for (const auto& [from, to] : {std::pair{"<section id=\"cost\">", "</section>"}, {"Error against time", "</figure>"}})
    if (const auto begin = text.find(from), end = text.find(to, begin); begin != std::string::npos) text.erase(begin, end - begin);
  return text;
}

TEST_F(CompareCommand, TheReportIsTheSameForAnyNumberOfThreadsButForTimes) {
  const std::string mesh = meshed(kCone, "a.stl");
  std::vector<json> reports;
  std::vector<std::string> pages, tables, pictures;
  for (const char* threads : {"1", "2", "2"}) {
    const ChildResult result = run(
        {data(kCone), "-o", path("report"), "--tolerances", "1e-2d", "--mesh", mesh, "--size", "64x48", "--samples", "1", "-t", threads});
    ASSERT_EQ(result.code, 0) << result.summary();
    reports.push_back(without_times(report()));
    pages.push_back(without_times(page()));
    tables.push_back(detail::content_of(path("report/table.csv")));
    std::string all;
    for (const std::string& name : files("report"))
      if (fs::path(name).extension() == ".exr") all += detail::content_of(path("report/" + name));
    pictures.push_back(all);
  }
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_EQ(reports[0], reports[i]) << json::diff(reports[0], reports[i]);
    EXPECT_TRUE(pages[0] == pages[i]);
    EXPECT_TRUE(tables[0] == tables[i]);
    EXPECT_TRUE(pictures[0] == pictures[i]);
  }
  EXPECT_GT(pages[0].size(), 20000u);
}

// Sent SIGINT once the file `when` is there, or, if that is empty, once it says something.
int interrupted(const std::vector<std::string>& arguments, const std::string& when, std::string& said) {
  const TemporaryDir dir;
  const std::string err = dir.path() / "err";
  std::vector<std::string> words{ISOPHOTE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    detail::take_place({}, "/dev/null", "/dev/null", err.c_str());
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  bool sent = false;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!sent && (when.empty() ? fs::exists(err) && fs::file_size(err) > 0 : fs::exists(when))) sent = ::kill(child, SIGINT) == 0;
    if (std::chrono::steady_clock::now() > end) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  said = detail::content_of(err);
  return sent && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(CompareCommand, AnInterruptEndsWithItsCodeAndLeavesWholePicturesOnly) {
  const std::vector<std::string> start{"compare", data(kCrank), "-o", path("report"), "--progress", "json", "--tolerances", "1e-2d,1e-4d"};
  // While pictures are made, and while a mesh is measured.
  for (const bool pictures : {true, false}) {
    std::vector<std::string> arguments = start;
    if (pictures)
      arguments.insert(arguments.end(), {"--size", "200x150", "--samples", "16"});
    else
      arguments.push_back("--no-pictures");
    std::string said;
    EXPECT_EQ(interrupted(arguments, pictures ? path("report/direct.exr") : std::string(), said), 130) << said;
    EXPECT_NE(said.find("isophote: interrupted"), std::string::npos) << said;
    if (!pictures) {
      EXPECT_FALSE(fs::exists(path("report"))) << "an empty folder is left";
      continue;
    }
    for (const std::string& name : files("report")) {
      EXPECT_EQ(fs::path(name).extension(), ".exr");
      EXPECT_TRUE(read_image(path("report/" + name))) << name;
    }
    fs::remove_all(path("report"));
  }
}

}  // namespace
}  // namespace iso::test
