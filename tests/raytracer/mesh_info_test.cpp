// `isophote info` of meshes, through the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "patches/base/result.h"
#include "tests/support/child.h"
#include "tests/support/mesh_bytes.h"
#include "tests/support/mesh_files.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

using nlohmann::json;

class MeshInfoCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_.path() / name; }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  static json told(const std::string& file) {
    const ChildResult result = run_isophote({"info", file, "--json"});
    EXPECT_EQ(result.code, 0) << result.summary();
    EXPECT_EQ(result.err, "");
    return json::parse(result.out);
  }
  static std::string text(const std::string& file) {
    const ChildResult result = run_isophote({"info", file});
    EXPECT_EQ(result.code, 0) << result.summary();
    EXPECT_EQ(result.err, "");
    return result.out;
  }

 private:
  TemporaryDir dir_;
};

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST_F(MeshInfoCommand, TellsTheSameOfAMeshInAllFourFormats) {
  const std::string model = data("cad/occtjs-conical-surface.step");
  const char* formats[][2] = {{"a.obj", "OBJ"}, {"a.stl", "STL"}, {"a.ply", "PLY"}, {"a.glb", "glTF"}};
  json first;
  for (const auto& [name, format] : formats) {
    SCOPED_TRACE(name);
    const ChildResult made = run_isophote({"tessellate", model, "-o", path(name), "--tolerance", "1e-3d", "-q"});
    ASSERT_EQ(made.code, 0) << made.summary();
    const json j = told(path(name));
    if (first.is_null()) first = j;
    const bool gltf = std::string(format) == "glTF";
    const double scale = gltf ? 1e-3 : 1;
    EXPECT_EQ(j["format"], format);
    EXPECT_EQ(j["unit"], gltf ? json("m") : json());
    EXPECT_EQ(j["closed"], true);
    for (const char* key : {"points", "triangles", "edges"}) EXPECT_EQ(j[key], first[key]) << key;
    EXPECT_EQ(j["edges"].get<int>(), j["triangles"].get<int>() * 3 / 2);
    EXPECT_NEAR(j["area"].get<double>(), first["area"].get<double>() * scale * scale, 1e-5 * j["area"].get<double>());
    EXPECT_NEAR(j["volume"].get<double>(), first["volume"].get<double>() * scale * scale * scale, 1e-5 * j["volume"].get<double>());
    EXPECT_GT(j["volume"], 0);
    EXPECT_NEAR(j["box"]["hi"][2].get<double>(), first["box"]["hi"][2].get<double>() * scale, 1e-5);
    for (const char* finding : {"open_edges", "non_manifold_edges", "misoriented_edges", "zero_area", "duplicates", "t_junctions"}) {
      EXPECT_EQ(j[finding]["count"], 0) << finding;
      EXPECT_TRUE(j[finding]["at"].is_null());
    }
    EXPECT_NE(text(path(name)).find("surface      closed"), std::string::npos);
  }
  EXPECT_EQ(first["rounding"], 0);
}

TEST_F(MeshInfoCommand, MeasuresATetrahedron) {
  const std::string file = write("t.obj", kTetrahedron), said = text(file);
  const json j = told(file);
  EXPECT_EQ(j["points"], 4);
  EXPECT_EQ(j["triangles"], 4);
  EXPECT_EQ(j["edges"], 6);
  EXPECT_NEAR(j["volume"].get<double>(), 1 / 6.0, 1e-15);
  EXPECT_NEAR(j["area"].get<double>(), 1.5 + std::sqrt(3.0) / 2, 1e-15);
  EXPECT_NEAR(j["smallest_angle"].get<double>(), 45, 1e-9);
  for (const char* part : {"format       OBJ, a mesh of triangles\n", "size         1 x 1 x 1\n", "box          (0, 0, 0) to (1, 1, 1)\n",
                           "triangles    4, 4 points and 6 edges between them\n", "volume       0.166667\n",
                           "angles       45 degrees the smallest; 0 triangles under 1 degree\n"})
    EXPECT_NE(said.find(part), std::string::npos) << part << said;
}

TEST_F(MeshInfoCommand, NamesWhatIsWrongWithPlaces) {
  const struct {
    const char *more, *finding;
    int count;
    const char* line;
  } cases[] = {{"f 2 3 4\n", "duplicates", 1, "1 triangle that is there twice, the first at "},
               {"f 2 3 4\n", "non_manifold_edges", 3, "3 edges of more than two triangles, the first at "},
               {"f 1 2 2\n", "zero_area", 1, "1 triangle without area, the first at "},
               {"v 5 5 5\nv 6 5 5\nv 5 6 5\nf 5 6 7\n", "open_edges", 3, "3 open edges, the first at "}};
  for (const auto& c : cases) {
    const std::string file = write("bad.obj", std::string(kTetrahedron) + c.more), said = text(file);
    const json j = told(file);
    EXPECT_EQ(j["closed"], false);
    EXPECT_TRUE(j["volume"].is_null());
    EXPECT_EQ(j[c.finding]["count"], c.count) << c.finding;
    EXPECT_EQ(j[c.finding]["at"].size(), 3u);
    EXPECT_NE(said.find(c.line), std::string::npos) << c.line << said;
    EXPECT_NE(said.find("unknown: not closed"), std::string::npos) << said;
  }
  const std::string turned = write("turned.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  EXPECT_NEAR(told(turned)["volume"].get<double>(), -1 / 6.0, 1e-15);
  EXPECT_NE(text(turned).find("inside out"), std::string::npos);
}

TEST_F(MeshInfoCommand, AnObjWithFreeFormSurfacesIsAModelAndOneWithPolygonsAMesh) {
  EXPECT_TRUE(told(data("patches/teacup-bezier.obj")).contains("kinds"));
  const std::string sheet =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ncstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 1\nend\n";
  EXPECT_TRUE(told(write("sheet.obj", sheet)).contains("kinds"));
  EXPECT_TRUE(told(write("both.obj", sheet + "f 1 2 3\n")).contains("kinds"));
  EXPECT_EQ(told(write("polygons.obj", kTetrahedron))["triangles"], 4);
}

TEST_F(MeshInfoCommand, FilesThatAreNoMeshesAreRefusedInOneLine) {
  const struct {
    std::string file;
    Exit code;
  } wrong[] = {{path("none.stl"), Exit::read_write},
               {write("text.stl", "this is no mesh\n"), Exit::bad_input},
               {write("short.ply", "ply\nformat ascii 1.0\n"), Exit::bad_input},
               {write("empty.glb", ""), Exit::bad_input},
               {write("index.obj", "v 0 0 0\nf 1 2 3\n"), Exit::bad_input},
               {write("points.obj", "v 0 0 0\n"), Exit::bad_input}};
  for (const auto& w : wrong) {
    const ChildResult result = run_isophote({"info", w.file});
    EXPECT_EQ(result.code, static_cast<int>(w.code)) << w.file << result.summary();
    EXPECT_EQ(result.error_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(w.file), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

}  // namespace
}  // namespace iso::test
