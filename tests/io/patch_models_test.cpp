// Models of n-sided patches: from patch files and from control meshes, with the edges that their charts share.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <map>

#include "patches/io/model_info.h"
#include "patches/io/patch_set.h"
#include "patches/io/read_model.h"
#include "patches/io/write_patches.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

Model model_of(const std::string& path, const ReadOptions& options = {}) {
  auto model = read_model(path, options);
  if (!model) throw std::runtime_error(model.error().text());
  return std::move(*model);
}

std::map<int, int> uses_of(const Part& part) {
  std::map<int, int> counts;
  for (const Edge& e : part.edges) ++counts[e.uses];
  return counts;
}

double largest_gap(const Part& part) {
  double gap = 0;
  for (const Edge& e : part.edges) gap = std::max(gap, e.gap);
  return gap;
}

std::string told(const Model& model) {
  std::string text;
  for (const Problem& p : model.problems) text += p.entity + ": " + p.what + " x" + std::to_string(p.count) + "\n";
  return text;
}

// Of a model of the size of 1: curves from the same points differ by rounding only.
constexpr double kRounding = 1e-13;

TEST(PatchModels, EveryPatchFileIsAModelOfCharts) {
  int files = 0;
  for (const auto& path : files_in(data_dir() / "patches", {".gbp", ".lop", ".mp"})) {
    const Model model = model_of(path);
    ++files;
    ASSERT_EQ(model.parts.size(), 1u) << path;
    const Part& part = model.parts[0];
    const std::size_t n = part.faces.size();
    EXPECT_GE(n, 3u) << path;
    // A patch alone: two free halves a side, and a spoke.
    EXPECT_EQ(uses_of(part), (std::map<int, int>{{1, 2 * static_cast<int>(n)}, {2, static_cast<int>(n)}})) << path;
    EXPECT_LE(largest_gap(part), kRounding * part.box.diagonal()) << path;
    EXPECT_EQ(part.faces[1].name, "patch 1, corner 2");
    EXPECT_EQ(part.solids, 0);
    for (const Face& face : part.faces) {
      EXPECT_EQ(problem_of(face.surface), "") << path;
      ASSERT_EQ(face.loops.size(), 1u);
      for (std::size_t i = 0; i < 4; ++i) {
        const TrimCurve &a = face.loops[0].curves[i], &b = face.loops[0].curves[(i + 1) % 4];
        EXPECT_EQ(jet(a.curve, a.t1).C, jet(b.curve, b.t0).C);
      }
    }
  }
  EXPECT_EQ(files, 7);
}

TEST(PatchModels, WhatWasWrittenReadsAsTheSameModel) {
  const TemporaryDir dir;
  const std::string source = data("patches/salvi-cagd-86.gbp"), path = dir.path() / "again.ipatch";
  std::ifstream in(source, std::ios::binary);
  PatchSet set = parse_gbp(source, std::string{std::istreambuf_iterator<char>(in), {}});
  set.patches[0].name = "cap";
  ASSERT_TRUE(write_patches(path, set));
  const Model a = model_of(source), b = model_of(path);
  EXPECT_EQ(b.format, "IPATCH");
  ASSERT_EQ(a.parts[0].faces.size(), b.parts[0].faces.size());
  EXPECT_EQ(b.parts[0].faces[0].name, "cap, corner 1");
  for (std::size_t f = 0; f < a.parts[0].faces.size(); ++f)
    for (double s = 0; s <= 1; s += 0.25)
      for (double t = 0; t <= 1; t += 0.25)
        EXPECT_EQ(point(a.parts[0].faces[f].surface, {s, t}), point(b.parts[0].faces[f].surface, {s, t}));
  // By its content, whatever it is called; not as a scene, which has another ending.
  std::filesystem::copy_file(path, dir.path() / "other.txt");
  EXPECT_EQ(model_of(dir.path() / "other.txt").format, "IPATCH");
}

struct MeshCount {
  const char* name;
  int polygons, sides, corners;  // sides: edges of the mesh; corners: of all polygons, each once
};

TEST(PatchModels, ClosedControlMeshesAreClosedSolids) {
  int checked = 0;
  for (const MeshCount& m : {MeshCount{"truncated-cuboctahedron", 26, 72, 144}, {"spot-control-mesh", 180, 366, 732}})
    for (const MeshPatches kind : {MeshPatches::gregory, MeshPatches::generalised_bezier, MeshPatches::charrot_gregory}) {
      if (m.polygons > 100 && kind != MeshPatches::gregory) continue;  // takes long, and tells no more
      const Model model = model_of(data("meshes/" + std::string(m.name) + ".obj"), {kind});
      const Part& part = model.parts.at(0);
      EXPECT_EQ(part.faces.size(), static_cast<std::size_t>(m.corners)) << m.name;
      // Two halves a side, and a spoke for each side of each polygon; every edge used twice.
      EXPECT_EQ(uses_of(part), (std::map<int, int>{{2, 2 * m.sides + m.corners}})) << m.name;
      EXPECT_EQ(part.solids, 1) << m.name;
      EXPECT_LE(largest_gap(part), kRounding * part.box.diagonal()) << m.name;
      const ModelInfo info = describe(model);
      long patches = 0;
      for (const PatchCount& c : info.patches) patches += c.stored;
      EXPECT_EQ(patches, m.polygons) << m.name;
      EXPECT_EQ(info.charts, m.corners) << m.name;
      EXPECT_LT(info.max_chart_error, 1e-2 * part.box.diagonal()) << m.name;
      ++checked;
    }
  EXPECT_EQ(checked, 4);
}

TEST(PatchModels, InfoCountsPatchesByKindAndSides) {
  const Model model = model_of(data("meshes/truncated-cuboctahedron.obj"), {MeshPatches::gregory});
  const ModelInfo info = describe(model);
  ASSERT_EQ(info.patches.size(), 3u);
  EXPECT_EQ(info.patches[0].kind, PatchKind::gregory_quad);
  EXPECT_EQ(info.patches[0].stored, 12);
  EXPECT_EQ(info.patches[1].sides, 6);
  EXPECT_EQ(info.patches[1].stored, 8);
  EXPECT_EQ(info.patches[2].sides, 8);
  EXPECT_EQ(info.patches[2].placed, 6);
  EXPECT_NE(to_text(info).find("26 in 144 charts"), std::string::npos) << to_text(info);
  EXPECT_NE(to_text(info).find("8  generalised Gregory, 6 sides"), std::string::npos) << to_text(info);
  EXPECT_NE(to_json(info).find("\"charts\": 144"), std::string::npos);
}

// Patches that interpolate points and normals of the unit sphere stay near it.
TEST(PatchModels, PatchesOverPointsOfASphereStayNearIt) {
  const Model model = model_of(data("meshes/truncated-cuboctahedron.obj"), {MeshPatches::gregory});
  double farthest = 0;
  for (const Face& face : model.parts[0].faces)
    for (double s = 0; s <= 1; s += 0.125)
      for (double t = 0; t <= 1; t += 0.125) {
        const Point3 p = model.instances[0].to_model.point(point(face.surface, {s, t}));
        farthest = std::max(farthest, std::abs(glm::length(p) - 1));
      }
  // The octagons are planes at 0.802 of the radius.
  EXPECT_LT(farthest, 0.5 * (1 - 0.802));
  std::cout << "farthest from the sphere: " << farthest << "\n";
}

// ---- what may be wrong with a control mesh ---------------------------------------------------------------------------------

Result<Model> read_mesh_text(const std::string& text, const ReadOptions& options = {MeshPatches::gregory}) {
  const TemporaryDir dir;
  std::ofstream(dir.path() / "mesh.obj", std::ios::binary) << text;
  return read_model(dir.path() / "mesh.obj", options);
}
constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

TEST(PatchModels, PolygonsAloneAskForPatches) {
  const auto model = read_mesh_text(kTetrahedron, {});
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().place, "5");
  EXPECT_NE(model.error().message.find("--patches gregory"), std::string::npos) << model.error().text();
  const auto other = read_model(data("patches/salvi-cagd-86.gbp"), {MeshPatches::gregory});
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("expected an OBJ file with polygons"), std::string::npos) << other.error().text();
  const auto surfaces = read_model(data("patches/teacup-bezier.obj"), {MeshPatches::gregory});
  ASSERT_FALSE(surfaces);
  EXPECT_NE(surfaces.error().message.find("expected polygons (f)"), std::string::npos) << surfaces.error().text();
}

TEST(PatchModels, TagsAndBadPolygonsAreToldAndTheRestIsRead) {
  std::string ring = "f";
  std::string text = kTetrahedron;
  for (int i = 0; i < 17; ++i) {
    text += "v " + std::to_string(i) + " " + std::to_string(i * i) + " 9\n";
    ring += " " + std::to_string(5 + i);
  }
  const auto model = read_mesh_text("g body\n" + text + ring + "\nf 1 1 2\nt crease 2/1/0 0 1 3\nt corner 1/1/0 2 1\n");
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->parts[0].faces.size(), 12u);
  EXPECT_EQ(model->parts[0].solids, 1);
  EXPECT_EQ(model->parts[0].faces[4].name, "body/patch 2, corner 2");
  const std::string problems = told(*model);
  for (const char* part : {"line 27: polygons of more than 16 sides x1", "line 28: polygons with a vertex twice x1",
                           "line 29: tags of subdivision surfaces (t: creases, corners, holes) are not used x2"})
    EXPECT_NE(problems.find(part), std::string::npos) << part << " in\n" << problems;
}

TEST(PatchModels, DamagedPolygonsAreRefusedWithTheirLine) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
  const struct {
    std::string text;
    const char *place, *says;
  } all[] = {{points + "f 1 2 9\n", "5", "f refers to vertex 9; the file has 3"},
             {points + "f 1 2 0\n", "5", "found \"0\", expected the number of a vertex"},
             {points + "f 1 2 -4\n", "5", "there are 3 up to here"},
             {points + "f 1//1 2//1 3//7\n", "5", "f refers to normal 7; the file has 1"},
             {points + "f 1//1 2//1 3//x\n", "5", "found \"x\", expected the number of a normal"},
             {points + "vn 0 1\n", "5", "vn has 2 numbers"},
             {points + "f 1 2\n", "", "no faces that can be used: line 5: polygons of fewer than 3 sides"}};
  int refused = 0;
  for (const auto& d : all) {
    const auto model = read_mesh_text(d.text);
    ASSERT_FALSE(model) << d.text;
    EXPECT_EQ(model.error().place, d.place) << model.error().text();
    EXPECT_NE(model.error().message.find(d.says), std::string::npos) << model.error().text();
    ++refused;
  }
  EXPECT_EQ(refused, 7);
}

// The larger collection, where it is at hand: every mesh becomes patches, and what the meshes close is closed.
TEST(PatchModelsSlow, EveryMeshOfTheCollectionBecomesPatches) {
  const auto shared = shared_data_dir();
  if (!shared) GTEST_SKIP() << "set ISOPHOTE_DATA";
  int meshes = 0, closed = 0;
  for (const auto& path : files_in(*shared / "meshes", {".obj"})) {
    const Model model = model_of(path, {MeshPatches::gregory});
    const Part& part = model.parts.at(0);
    EXPECT_LE(largest_gap(part), kRounding * part.box.diagonal()) << path << "\n" << told(model);
    EXPECT_FALSE(part.faces.empty()) << path;
    closed += uses_of(part) == std::map<int, int>{{2, static_cast<int>(part.edges.size())}};
    ++meshes;
  }
  EXPECT_GE(meshes, 30);
  EXPECT_GE(closed, 13);
  std::cout << meshes << " meshes, " << closed << " closed\n";
}

}  // namespace
}  // namespace iso::test
