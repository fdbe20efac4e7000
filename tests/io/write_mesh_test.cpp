// Mesh files, read back by readers written from the formats' definitions, and by admesh and assimp.
#include "patches/io/write_mesh.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "tests/support/child.h"
#include "tests/support/grid_cube.h"
#include "tests/support/mesh_files.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;

constexpr double kSide = 10.0 / 3;
constexpr int kGrid = 3;
constexpr std::size_t kOne = 6 * 2 * kGrid * kGrid;  // triangles of a cube

// A cube placed as it is, turned and mirrored, and sheared; two faces are coloured, the mirrored instance is as well.
struct Sample {
  Model model;
  ModelMesh mesh;
};
Sample sample() {
  Sample s;
  GridCube cube(kGrid, kSide);
  cube.part.faces[2].colour = Colour(1, 0.2f, 0.05f);
  cube.part.faces[3].colour = Colour(1, 0.2f, 0.05f);
  cube.part.faces[4].name = "the top\tface";
  s.model.unit = "mm";
  s.model.file = "/some/where/cubes.step";
  s.model.parts.push_back(cube.part);
  s.mesh.parts.push_back(cube.mesh);
  s.model.instances.resize(3);
  s.model.instances[0].name = "left cube";
  s.model.instances[1].name = "left cube";
  s.model.instances[1].colour = Colour(0.1f, 0.5f, 0.9f);
  s.model.instances[1].to_model = {Mat3(Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)), Vec3(20, 0.7, 1)};
  s.model.instances[2].to_model = {Mat3(Vec3(1, 0, 0), Vec3(0.5, 1, 0), Vec3(0, 0, 2)), Vec3(-20, 0, 0)};
  return s;
}
constexpr double kVolume = kSide * kSide * kSide * (1 + 1 + 2);

// Six times the volume that triangles enclose, if they are turned outward and closed.
template <class Points>
double volume_of(const Points& triangles) {
  double sum = 0;
  for (const auto& t : triangles) sum += glm::dot(t[0], glm::cross(t[1], t[2]));
  return sum / 6;
}
std::vector<std::array<Vec3, 3>> corners_of(const std::vector<Vec3>& points, const std::vector<Corners>& triangles) {
  std::vector<std::array<Vec3, 3>> out;
  for (const Corners& t : triangles) out.push_back({points.at(t[0]), points.at(t[1]), points.at(t[2])});
  return out;
}

// Directed edges whose opposite does not occur exactly once.
template <class Key>
int unpaired_edges(const std::vector<std::array<Key, 3>>& triangles) {
  std::map<std::pair<Key, Key>, int> count;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++count[{t[k], t[(k + 1) % 3]}];
  int unpaired = 0;
  for (const auto& [edge, n] : count) {
    const auto opposite = count.find({edge.second, edge.first});
    unpaired += n != 1 || opposite == count.end() || opposite->second != 1;
  }
  return unpaired;
}
// The same by equal places, bit for bit.
int unpaired_places(const std::vector<std::array<Vec3, 3>>& triangles) {
  std::vector<std::array<std::array<double, 3>, 3>> keys;
  for (const auto& t : triangles) keys.push_back({{{t[0].x, t[0].y, t[0].z}, {t[1].x, t[1].y, t[1].z}, {t[2].x, t[2].y, t[2].z}}});
  return unpaired_edges(keys);
}

class WriteMesh : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (dir_.path() / name).string(); }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(dir_.path()), {})); }
  WrittenMesh write(const std::string& name, const Sample& s) {
    const auto written = write_mesh(path(name), s.model, s.mesh, {"1.2.3"});
    if (!written) throw std::runtime_error(written.error().text());
    std::uint64_t bytes = 0;
    for (const std::string& file : written->files) bytes += fs::file_size(file);
    EXPECT_EQ(bytes, written->bytes);
    EXPECT_EQ(files(), written->files.size()) << "nothing else may be left in the folder";
    return *written;
  }

 private:
  TemporaryDir dir_;
};

TEST_F(WriteMesh, StlHoldsAllInstancesClosedAndTurnedOutward) {
  const WrittenMesh written = write("a.STL", sample());
  const StlFile stl = read_stl_file(path("a.STL"));
  EXPECT_EQ(stl.header.substr(0, 24), "isophote 1.2.3; unit mm ");
  ASSERT_EQ(stl.triangles.size(), 3 * kOne);
  EXPECT_EQ(written.triangles, 3 * kOne);
  EXPECT_EQ(written.collapsed, 0u);
  EXPECT_EQ(unpaired_places(stl.triangles), 0);
  EXPECT_NEAR(volume_of(stl.triangles), kVolume, 1e-4 * kVolume) << "float";
  for (std::size_t i = 0; i < stl.triangles.size(); ++i) {
    const auto& [a, b, c] = stl.triangles[i];
    EXPECT_NEAR(glm::dot(stl.normals[i], glm::normalize(glm::cross(b - a, c - a))), 1, 1e-6);
  }
}

TEST_F(WriteMesh, StlTellsHowManyTrianglesCollapseInFloat) {
  Sample s = sample();
  s.model.instances.resize(1);
  s.model.instances[0].to_model.translation = Vec3(0, 0, 1e9);
  EXPECT_GT(write("a.stl", s).collapsed, 0u);
  EXPECT_EQ(read_stl_file(path("a.stl")).triangles.size(), kOne) << "all are written";
  fs::remove(path("a.stl"));
  EXPECT_EQ(write("a.glb", s).collapsed, 0u) << "numbers are relative to the part";
  s.model.instances[0].to_model.translation = Vec3(0, 1e39, 0);
  fs::remove(path("a.glb"));
  EXPECT_EQ(write_mesh(path("a.stl"), s.model, s.mesh).error().kind, Exit::bad_input);
  EXPECT_EQ(files(), 0u);
}

TEST_F(WriteMesh, ObjKeepsEveryBitIndexesSharedPointsAndNamesInstancesAndFaces) {
  const Sample s = sample();
  EXPECT_EQ(write("a.obj", s).files, (std::vector<std::string>{path("a.obj"), path("a.mtl")}));
  const ObjFile obj = read_obj_file(path("a.obj"));
  const std::size_t each = s.mesh.parts[0].points.size();
  ASSERT_EQ(obj.points.size(), 3 * each);
  for (std::size_t i = 0; i < obj.points.size(); ++i)
    EXPECT_EQ(obj.points[i], s.model.instances[i / each].to_model.point(s.mesh.parts[0].points[i % each]));
  ASSERT_EQ(obj.triangles.size(), 3 * kOne);
  EXPECT_EQ(unpaired_edges(obj.triangles), 0);
  const auto corners = corners_of(obj.points, obj.triangles);
  EXPECT_NEAR(volume_of(corners), kVolume, 1e-12 * kVolume);
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (const std::uint32_t n : obj.triangle_normals[i]) {
      const Vec3 flat = glm::normalize(glm::cross(corners[i][1] - corners[i][0], corners[i][2] - corners[i][0]));
      EXPECT_NEAR(glm::dot(obj.normals.at(n), flat), 1, 1e-6);
    }
  EXPECT_EQ(obj.objects, (std::vector<std::string>{"left_cube", "left_cube_2", "cube"}));
  EXPECT_EQ(obj.groups.size(), 18u);
  EXPECT_EQ(obj.groups[4], "face_4_the_top_face");
  EXPECT_EQ(obj.object_of[kOne], 1);
  EXPECT_EQ(obj.group_of[kOne], 6);
  EXPECT_EQ(obj.library, "a.mtl");
  EXPECT_EQ(std::set<std::string>(obj.materials.begin(), obj.materials.end()),
            (std::set<std::string>{"colour_1", "colour_2", "uncoloured"}));
}

TEST_F(WriteMesh, ObjWithoutColoursHasNoLibrary) {
  Sample s = sample();
  for (Face& face : s.model.parts[0].faces) face.colour.reset();
  s.model.instances[1].colour.reset();
  EXPECT_EQ(write("a.obj", s).files.size(), 1u);
  EXPECT_TRUE(read_obj_file(path("a.obj")).library.empty());
}

TEST_F(WriteMesh, PlyIsClosedOnceEqualPlacesAreJoinedAndNumbersFacesThroughAllInstances) {
  const Sample s = sample();
  write("a.ply", s);
  const PlyFile ply = read_ply_file(path("a.ply"));
  ASSERT_EQ(ply.points.size(), 3 * s.mesh.parts[0].nodes.size());
  ASSERT_EQ(ply.triangles.size(), 3 * kOne);
  const auto corners = corners_of(ply.points, ply.triangles);
  EXPECT_EQ(unpaired_places(corners), 0);
  EXPECT_NEAR(volume_of(corners), kVolume, 1e-12 * kVolume);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_EQ(ply.face_ids[i], static_cast<int>(i / (kOne / 6)));
    const Vec3 flat = glm::normalize(glm::cross(corners[i][1] - corners[i][0], corners[i][2] - corners[i][0]));
    for (const std::uint32_t v : ply.triangles[i]) EXPECT_NEAR(glm::dot(ply.normals[v], flat), 1, 1e-6);
  }
  ASSERT_EQ(ply.colours.size(), 3 * kOne);
  EXPECT_EQ(ply.colours[2 * kOne / 6], (std::array<std::uint8_t, 3>{255, 124, 63})) << "1, 0.2, 0.05 through the sRGB curve";
}

TEST_F(WriteMesh, GlbIsValidPlacesPartsByNodesAndSharesWhatIsEqual) {
  const Sample s = sample();
  write("a.glb", s);
  const GlbFile glb = read_glb_file(path("a.glb"));
  for (const std::string& complaint : glb.complaints) ADD_FAILURE() << complaint;
  EXPECT_EQ(glb.json["asset"]["generator"], "isophote 1.2.3");
  ASSERT_EQ(glb.json["nodes"].size(), 4u);
  EXPECT_EQ(glb.json["nodes"][0]["name"], "cubes");
  EXPECT_EQ(glb.json["nodes"][1]["name"], "left cube");
  EXPECT_FALSE(glb.json["nodes"][1].contains("matrix"));
  EXPECT_FALSE(glb.json["nodes"][3].contains("matrix")) << "a sheared instance has a mesh of its own";
  EXPECT_EQ(glb.json["meshes"].size(), 3u);
  EXPECT_EQ(glb.json["meshes"][0]["primitives"].size(), 2u);
  EXPECT_EQ(glb.json["materials"].size(), 3u);
  EXPECT_EQ(glb.json["accessors"].size(), 2 * (3 + 2u)) << "the mirrored instance shares the numbers of the first";

  // z up and millimetres become y up and metres.
  const auto triangles = placed_triangles(glb);
  ASSERT_EQ(triangles.size(), 3 * kOne);
  EXPECT_NEAR(volume_of(triangles), 1e-9 * kVolume, 1e-13 * kVolume);
  Box3 box;
  for (const auto& t : triangles)
    for (const Vec3& p : t) box.include(p);
  EXPECT_NEAR(box.hi.x, 0.020 + 0.0001 + 0.001 * kSide, 1e-8);
  EXPECT_NEAR(box.hi.y, 0.0002 + 0.002 * kSide, 1e-8);
  EXPECT_NEAR(box.lo.z, -0.0008 - 0.001 * kSide, 1e-8);
}

TEST_F(WriteMesh, GlbVertexAttributesNameTheFaceOfEachTriangle) {
  write("a.glb", sample());
  const GlbFile glb = read_glb_file(path("a.glb"));
  const auto& primitives = glb.json["meshes"][0]["primitives"];
  std::vector<std::set<double>> seen;
  for (const auto& primitive : primitives) {
    const auto ids = numbers_of(glb, primitive["attributes"]["_FACE_ID"]);
    seen.emplace_back();
    for (const double i : numbers_of(glb, primitive["indices"])) seen.back().insert(ids[static_cast<std::size_t>(i)]);
  }
  EXPECT_EQ(seen[0], (std::set<double>{0, 1, 4, 5}));
  EXPECT_EQ(seen[1], (std::set<double>{2, 3})) << "the coloured faces";
}

TEST_F(WriteMesh, ANodeWithoutNormalGetsThatOfItsTriangles) {
  Sample s = sample();
  s.mesh.parts[0].nodes[0].normal = Vec3(0.0);
  write("a.ply", s);
  const PlyFile ply = read_ply_file(path("a.ply"));
  EXPECT_EQ(ply.normals[0], ply.normals[1]);
}

TEST_F(WriteMesh, AModelWithoutTrianglesGivesFilesThatCanBeRead) {
  Sample s = sample();
  s.mesh.parts[0] = PartMesh{};
  s.mesh.parts[0].first_node.assign(7, 0);
  s.mesh.parts[0].first_triangle.assign(7, 0);
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.glb"}) ASSERT_TRUE(write_mesh(path(name), s.model, s.mesh)) << name;
  EXPECT_TRUE(read_stl_file(path("a.stl")).triangles.empty());
  EXPECT_TRUE(read_obj_file(path("a.obj")).triangles.empty());
  EXPECT_TRUE(read_ply_file(path("a.ply")).triangles.empty());
  EXPECT_TRUE(read_glb_file(path("a.glb")).complaints.empty());
}

TEST_F(WriteMesh, AnUnknownEndingIsAnErrorThatNamesTheFour) {
  for (const char* name : {"a.step", "a", "a.stl.gz", "stl"}) {
    const auto written = write_mesh(path(name), sample().model, sample().mesh);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, Exit::bad_command_line);
    for (const char* ending : {".stl", ".obj", ".ply", ".glb"}) EXPECT_NE(written.error().message.find(ending), std::string::npos);
  }
  EXPECT_EQ(files(), 0u);
}

TEST_F(WriteMesh, AFullDiskOrAMissingFolderIsToldWithTheNameAndLeavesNothing) {
  const Sample s = sample();
  for (const std::string ending : {".stl", ".obj", ".ply", ".glb"}) {
    const auto missing = write_mesh(path("none/a" + ending), s.model, s.mesh);
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, Exit::read_write);
    EXPECT_EQ(missing.error().file, path("none/a" + ending));

    // A limit on the size of files stands for a full disk; what was there stays.
    std::ofstream(path("a" + ending)) << "old";
    ChildLimits limits;
    limits.file_bytes = 2000;
    const ChildResult child = run_in_child(
        [&] {
          ::signal(SIGXFSZ, SIG_IGN);
          const auto full = write_mesh(path("a" + ending), s.model, s.mesh);
          return full ? 100 : static_cast<int>(full.error().kind);
        },
        {}, limits);
    EXPECT_EQ(child.code, static_cast<int>(Exit::read_write)) << ending << ": " << child.summary();
    EXPECT_EQ(fs::file_size(path("a" + ending)), 3u);
    fs::remove(path("a" + ending));
    EXPECT_EQ(files(), 0u) << ending;
  }
}

TEST_F(WriteMesh, NumbersThatAreNotFiniteAreABrokenPromise) {
  Sample s = sample();
  s.mesh.parts[0].points[5].y = std::nan("");
  EXPECT_DEATH((void)write_mesh(path("a.stl"), s.model, s.mesh), "finite");
  s = sample();
  s.model.instances[1].to_model.linear = Mat3(0.0);
  EXPECT_DEATH((void)write_mesh(path("a.obj"), s.model, s.mesh), "does not hold");
}

// The path of a program, or empty.
std::string program(const std::string& name) {
  const std::string path = "/usr/bin/" + name;
  return fs::exists(path) ? path : std::string();
}
long number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == std::string::npos ? -1 : std::atol(text.c_str() + at + words.size());
}

TEST_F(WriteMesh, AdmeshFindsNothingToMendInStl) {
  ASSERT_FALSE(program("admesh").empty()) << "admesh is not installed";
  write("a.stl", sample());
  const ChildResult told = run_child({program("admesh"), path("a.stl")});
  ASSERT_EQ(told.code, 0) << told.summary();
  EXPECT_EQ(number_after(told.out, "Number of facets                 :"), long(3 * kOne)) << told.out;
  EXPECT_EQ(number_after(told.out, "Total disconnected facets        :"), 0);
  EXPECT_EQ(number_after(told.out, "Number of parts       :"), 3);
  EXPECT_NEAR(std::stod(told.out.substr(told.out.find("Volume   :") + 10)), kVolume, 1e-4 * kVolume);
  for (const char* mended : {"Degenerate facets     :", "Edges fixed           :", "Facets removed        :", "Facets added          :",
                             "Facets reversed       :", "Backwards edges       :", "Normals fixed         :"})
    EXPECT_EQ(number_after(told.out, mended), 0) << mended;
}

TEST_F(WriteMesh, AssimpReadsAllFourWithTheSameNumberOfTriangles) {
  ASSERT_FALSE(program("assimp").empty()) << "assimp is not installed";
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.glb"}) {
    ASSERT_TRUE(write_mesh(path(name), sample().model, sample().mesh));
    const ChildResult told = run_child({program("assimp"), "info", path(name)});
    ASSERT_EQ(told.code, 0) << name << ": " << told.summary();
    EXPECT_EQ(number_after(told.out, "\nFaces:"), long(3 * kOne)) << name << ":\n" << told.out;
  }
}

}  // namespace
}  // namespace iso::test
