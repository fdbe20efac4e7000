// Readers of meshes: tiny files made by hand, with known answers for each feature of the formats and each kind of damage.
#include "patches/io/read_mesh.h"

#include <gtest/gtest.h>

#include <bit>
#include <fstream>

#include "tests/support/mesh_bytes.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

// A tetrahedron of the origin and the three axes' unit points, turned outward.
const std::vector<Point3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<PointTriangle> kSides{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

class ReadMesh : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (dir_.path() / name).string(); }
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  ForeignMesh read(const std::string& name, const std::string& bytes) const {
    auto mesh = read_mesh(put(name, bytes));
    if (!mesh) throw std::runtime_error(mesh.error().text());
    EXPECT_EQ(mesh->file, path(name));
    return *mesh;
  }
  // The place and message of a refusal, without the path.
  std::string refused(const std::string& name, const std::string& bytes) const {
    const auto mesh = read_mesh(put(name, bytes));
    if (mesh) return "read: " + std::to_string(mesh->triangles.size()) + " triangles";
    EXPECT_EQ(mesh.error().kind, Exit::bad_input);
    return mesh.error().place + ": " + mesh.error().message;
  }
  static void expect_tetrahedron(const ForeignMesh& mesh) {
    ASSERT_EQ(mesh.points.size(), 4u);
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_NEAR(volume_of(mesh), 1.0 / 6, 1e-15);
    EXPECT_EQ(unpaired_edges(mesh), 0);
  }

 private:
  TemporaryDir dir_;
};

TEST_F(ReadMesh, StlOfBothKindsWhateverItStartsWith) {
  for (const char* header : {"", "solid but binary", "SOLID"}) expect_tetrahedron(read("a.stl", binary_stl(kCorners, kSides, header)));
  expect_tetrahedron(read("b.STL", text_stl(kCorners, kSides)));
  std::string loud = text_stl(kCorners, kSides);
  for (char& c : loud) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expect_tetrahedron(read("c.stl", loud));
  const ForeignMesh mesh = read("a.stl", binary_stl(kCorners, kSides));
  EXPECT_EQ(mesh.format, "STL");
  EXPECT_EQ(mesh.unit, "");
  EXPECT_DOUBLE_EQ(mesh.rounding, std::sqrt(3.0) * 0x1p-24) << "half a unit in the last place of 1 in float";
  EXPECT_TRUE(mesh.notes.empty());
}

TEST_F(ReadMesh, StlNotesWhatFollowsTheLastTriangleAndKeepsTrianglesWithACornerTwice) {
  const ForeignMesh mesh = read("a.stl", binary_stl(kCorners, {{0, 1, 2}, {0, 1, 1}}) + "more");
  EXPECT_EQ(mesh.triangles, (std::vector<PointTriangle>{{0, 1, 2}, {0, 1, 1}}));
  EXPECT_EQ(mesh.notes, (std::vector<std::string>{"bytes after the last triangle, left out: 4", "triangles with a corner twice: 1"}));
}

TEST_F(ReadMesh, EqualPlacesAreOnePointAndMinusZeroIsZero) {
  const ForeignMesh mesh =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 1 -0.0\nv 1 0 -0\nv 1 1e-300 0\nv 1 1 0\nf 1 2 3\nf 4 5 7\nf 3 6 7\n");
  EXPECT_EQ(mesh.triangles, (std::vector<PointTriangle>{{0, 1, 2}, {2, 1, 4}, {2, 3, 4}}));
  EXPECT_EQ(mesh.points.size(), 5u);
  for (const Point3& p : mesh.points)
    for (int c = 0; c < 3; ++c) EXPECT_FALSE(std::signbit(p[c]));
}

TEST_F(ReadMesh, ObjIndicesOfAllFormsAndContinuedLines) {
  const ForeignMesh mesh =
      read("a.obj",
           "# by hand\r\nmtllib x.mtl\r\no first\nv 0 0 0 1 0 0\nv 1 0 0 0.5\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
           "f 1/1 3/1 2/1\nf 1//1 2//1 4//1\nv 0 0 1 # the fourth\nf -4/-1/-1 -1/-1/-1 \\\n  -2/-1/-1\nusemtl y\ng a b\ns 1\n"
           "f 2 3 \\\n4\nl 1 2\nv 9 9 9\n");
  expect_tetrahedron(mesh);
  EXPECT_EQ(mesh.rounding, 0);
  EXPECT_EQ(mesh.notes, (std::vector<std::string>{"statements that are no polygons, left out: 1, the first (\"l\") in line 19",
                                                  "points of no triangle, left out: 1"}));
}

// Triangles of a plane polygon: their signed areas are positive and add up to the polygon's.
void expect_cut(const ForeignMesh& mesh, double area, std::size_t triangles) {
  double sum = 0;
  for (const PointTriangle& t : mesh.triangles) {
    const Vec3 cross = glm::cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
    EXPECT_GT(cross.z, 0) << t[0] << ' ' << t[1] << ' ' << t[2];
    sum += cross.z / 2;
  }
  EXPECT_NEAR(sum, area, 1e-12 * area);
  EXPECT_EQ(mesh.triangles.size(), triangles);
}

TEST_F(ReadMesh, ConcavePolygonsAreCutWithinThemselves) {
  expect_cut(read("arrow.obj", "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n"), 1.5, 2);
  expect_cut(read("L.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n"), 3, 4);
  // A comb, and a square with a hole by way of a bridge.
  std::string comb = "v 0 -1 0\nv 10 -1 0\n", list = "f 1 2";
  for (int i = 20; i >= 0; --i)
    comb += "v " + std::to_string(0.5 * i) + (i % 2 ? " 5 0\n" : " 0 0\n"), list += " " + std::to_string(23 - i);
  expect_cut(read("comb.obj", comb + list), 10 + 25, 21);
  const std::string hole = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\nf 1 2 3 4 1 5 6 7 8 5\n";
  const ForeignMesh ring = read("hole.obj", hole);
  expect_cut(ring, 12, 8);
  EXPECT_EQ(ring.notes, (std::vector<std::string>{"polygons of more than three corners: 1, cut into 8 triangles"}));
}

TEST_F(ReadMesh, PolygonsAreCutWellInAnyPlane) {
  // Straight corners stay corners of triangles with area; the shorter diagonal cuts a kite; any plane does.
  expect_cut(read("straight.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n"), 4, 4);
  expect_cut(read("triangle.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 2 0\nf 1 2 3 4 5\n"), 3, 3);
  const ForeignMesh kite = read("kite.obj", "v -5 0 0\nv 0 -1 0\nv 5 0 0\nv 0 1 0\nf 1 2 3 4\n");
  EXPECT_EQ(kite.triangles[0], (PointTriangle{3, 0, 1}));
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 2, -3)}) {
    const Vec3 n = glm::normalize(normal), X = any_perpendicular(n), Y = glm::cross(n, X);
    std::string text;
    for (const Vec2& p : {Vec2(0, 0), Vec2(2, 1), Vec2(0, 2), Vec2(0.5, 1)}) {
      const Vec3 v = Vec3(100) + p.x * X + p.y * Y;
      text += "v " + std::to_string(v.x) + ' ' + std::to_string(v.y) + ' ' + std::to_string(v.z) + '\n';
    }
    const ForeignMesh mesh = read("turned.obj", text + "f 1 2 3 4\n");
    double area = 0;
    for (const PointTriangle& t : mesh.triangles)
      area += glm::dot(n, glm::cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]])) / 2;
    EXPECT_NEAR(area, 1.5, 1e-5);
  }
}

TEST_F(ReadMesh, PolygonsWithoutInsideAreCutAsTheyAreAndNoted) {
  const ForeignMesh bow =
      read("bow.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 3 0 0\nf 1 2 3 4\nf 1 2\nf 1 3 3 2 2\nf 1 3 5 3\nf 1 1 2\n");
  EXPECT_EQ(bow.notes,
            (std::vector<std::string>{
                "polygons of more than three corners: 2, cut into 4 triangles",
                "corners of polygons that repeat the one before, left out: 2", "polygons of fewer than three corners, left out: 1",
                "polygons that cross or touch themselves and have no clear inside: 1", "triangles with a corner twice: 3"}));
  EXPECT_EQ(bow.triangles.size(), 2 + 1 + 2 + 1u);
}

TEST_F(ReadMesh, RoundingOfTextFollowsItsDigits) {
  const auto rounding = [&](const std::string& x) { return read("a.obj", "v " + x + " 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n").rounding; };
  EXPECT_EQ(rounding("2"), 0);
  EXPECT_EQ(rounding("1234"), 0);
  EXPECT_EQ(rounding("123456"), 0) << "taken as meant";
  EXPECT_NEAR(rounding("123.456"), std::sqrt(3.0) * 0.5e-3, 1e-12) << "six digits";
  EXPECT_NEAR(rounding("0.0123456e2"), std::sqrt(3.0) * 0.5e-5, 1e-12);
  EXPECT_NEAR(rounding("1.23456789"), std::sqrt(3.0) * 0x1p-24, 1e-12) << "nine digits may be a float";
  EXPECT_NEAR(rounding("1.234567890123"), std::sqrt(3.0) * 0.5e-12, 1e-18);
  EXPECT_EQ(rounding("1.2345678901234567"), 0);
}

TEST_F(ReadMesh, PlyOfAllOrdersAndTypes) {
  const struct {
    const char *coordinate, *length, *index;
  } kinds[] = {{"float", "uchar", "int"},     {"double", "uchar", "uint"},   {"float32", "int8", "uint16"},
               {"float64", "uint8", "int32"}, {"char", "int", "uchar"},      {"int16", "ushort", "short"},
               {"uint8", "int16", "int8"},    {"uint32", "uint32", "uint8"}, {"int32", "short", "uint32"}};
  for (const auto& k : kinds)
    for (const PlyBytes order : {PlyBytes::text, PlyBytes::little, PlyBytes::big})
      for (const char* list : {"vertex_indices", "vertex_index"}) {
        const ForeignMesh mesh = read("a.ply", tetrahedron_ply(order, k.coordinate, k.length, k.index, list));
        expect_tetrahedron(mesh);
        const bool in_float = std::string(k.coordinate).starts_with("float") && std::string(k.coordinate) != "float64";
        EXPECT_EQ(mesh.rounding > 0, in_float) << k.coordinate;
      }
}

TEST_F(ReadMesh, PlyStripsPolygonsOtherElementsAndCarriageReturns) {
  const std::string head =
      "ply\r\nformat ascii 1.0\r\ncomment by \\\r\nobj_info x\r\nelement camera 1\r\nproperty list uchar float k\r\n"
      "element none 7\r\nelement vertex 4\r\nproperty float nx\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n";
  const std::string points = "2 0.5 0.5\r\nnan 0 0 0\r\nnan 1 0 0\r\nnan 0 1 0\r\nnan 1 1 0\r\n";
  const ForeignMesh strips = read("a.ply", head + "element tristrips 1\r\nproperty list int int vertex_indices\r\nend_header\r\n" + points +
                                               "12 0 1 2 3 -1 0 2 2 -1 0 2 1\r\n");
  EXPECT_EQ(strips.triangles, (std::vector<PointTriangle>{{0, 1, 2}, {1, 3, 2}, {0, 2, 1}}));
  const ForeignMesh polygon =
      read("a.ply",
           head + "element face 1\r\nproperty int q\r\nproperty list int int vertex_index\r\nend_header\r\n" + points + "5 4 0 1 3 2\r\n");
  EXPECT_EQ(polygon.triangles.size(), 2u);
}

TEST_F(ReadMesh, GltfNodesPlaceMeshesAndZIsUpAgain) {
  // The tetrahedron in glTF's y up: (x, y, z) is (x, z, -y). Moved, turned, scaled, mirrored: volumes tell that triangles are turned along.
  const struct {
    const char* node;
    double volume;
    Point3 apex;  // where (0, 0, 1) of the model's coordinates goes
  } kinds[] = {{R"("name":"plain")", 1, {0, 0, 1}},
               {R"("translation":[1,2,3])", 1, {1, -3, 3}},
               {R"("scale":[1,2,-3])", 6, {0, 0, 2}},
               {R"("rotation":[0.7071067811865476,0,0,0.7071067811865476])", 1, {0, -1, 0}},
               {R"("matrix":[2,0,0,0, 0,3,0,0, 0,0,4,0, 5,6,7,1])", 24, {5, -7, 9}},
               {R"("translation":[1,0,0],"rotation":[0,0,1,0],"scale":[2,2,2])", 8, {1, 0, -2}}};
  for (const auto& k : kinds) {
    const ForeignMesh mesh = read("a.gltf", tetrahedron_gltf(k.node));
    ASSERT_EQ(mesh.points.size(), 4u);
    EXPECT_EQ(mesh.unit, "m");
    EXPECT_EQ(mesh.format, "glTF");
    EXPECT_NEAR(volume_of(mesh), k.volume / 6, 1e-14) << k.node;
    EXPECT_LT(glm::length(mesh.points[3] - k.apex), 1e-15) << k.node;
    EXPECT_EQ(unpaired_edges(mesh), 0);
    EXPECT_GE(mesh.rounding, 0x1p-24);
  }
  const ForeignMesh two = read("a.gltf", tetrahedron_gltf(R"("children":[1,2]},{"mesh":0},{"mesh":0,"translation":[4,0,0])", ""));
  EXPECT_EQ(two.points.size(), 8u) << "a mesh twice";
  EXPECT_NEAR(volume_of(two), 2.0 / 6, 1e-14);
  const ForeignMesh all = read("a.gltf", tetrahedron_gltf(R"("children":[1]},{"mesh":0)", "", GltfScene::none));
  expect_tetrahedron(all);
}

TEST_F(ReadMesh, GltfBuffersBesideTheFileInItAndInOneWithTheJson) {
  put("the numbers.bin", gltf_numbers());
  expect_tetrahedron(read("beside.gltf", tetrahedron_gltf("", R"("mesh":0)", GltfScene::first, "the%20numbers.bin")));
  expect_tetrahedron(read("in.gltf", tetrahedron_gltf("")));
  expect_tetrahedron(read("one.glb", glb_of(tetrahedron_gltf("", R"("mesh":0)", GltfScene::first, ""), gltf_numbers())));
  const auto missing = read_mesh(put("none.gltf", tetrahedron_gltf("", R"("mesh":0)", GltfScene::first, "none.bin")));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, Exit::read_write);
  EXPECT_NE(missing.error().file.find("none.bin"), std::string::npos);
}

TEST_F(ReadMesh, GltfPrimitivesOfAllModesIndexTypesAndAccessors) {
  const auto triangles = [&](const std::string& primitive) {
    ForeignMesh mesh = read("a.gltf", square_gltf(primitive));
    for (PointTriangle& t : mesh.triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return mesh.triangles;
  };
  const std::vector<PointTriangle> strip{{0, 1, 2}, {1, 3, 2}}, fan{{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(triangles(R"("attributes":{"POSITION":0},"mode":5)"), strip);
  EXPECT_EQ(triangles(R"("attributes":{"POSITION":0},"mode":6)"), fan);
  EXPECT_EQ(triangles(R"("attributes":{"POSITION":4},"mode":5)"), strip) << "stride of 16 bytes";
  EXPECT_EQ(triangles(R"("attributes":{"POSITION":6},"mode":5)"), strip) << "quantised";
  for (const char* indices : {"1", "2", "3"})
    EXPECT_EQ(triangles(R"("attributes":{"POSITION":0},"indices":)" + std::string(indices)), strip) << "u8, u16, u32: " << indices;
  const ForeignMesh sparse = read("a.gltf", square_gltf(R"("attributes":{"POSITION":5},"mode":5)"));
  EXPECT_EQ(sparse.points[3], Point3(9, -7, 8)) << "replaced";
  const ForeignMesh with_points =
      read("a.gltf", square_gltf(R"("attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":5)"));
  EXPECT_EQ(with_points.notes, (std::vector<std::string>{"primitives of points or lines, left out: 1"}));
}

void expect_place(const std::string& refusal, const std::string& start, const std::string& part) {
  EXPECT_EQ(refusal.substr(0, start.size()), start) << refusal;
  EXPECT_NE(refusal.find(part), std::string::npos) << refusal << "\nshould say: " << part;
}

TEST_F(ReadMesh, DamagedStlIsRefusedWithThePlace) {
  const std::string whole = binary_stl(kCorners, kSides);
  expect_place(refused("a.stl", whole.substr(0, 200)), "byte 200: ", "in triangle 3, expected 4 triangles");
  expect_place(refused("a.stl", whole.substr(0, 83)), "byte 83: ", "expected `solid`");
  expect_place(refused("a.stl", ""), "byte 0: ", "end of the file");
  std::string bad = whole;
  bad[84 + 50 + 15] = '\x7f', bad[84 + 50 + 14] = '\x80';
  expect_place(refused("a.stl", bad), "byte 146: ", "inf 0 0 of triangle 2");
  bad = whole;
  bad[83] = '\x7f';
  expect_place(refused("a.stl", bad), "byte 284: ", "expected 2130706436 triangles");
  const std::string text = text_stl(kCorners, kSides);
  expect_place(refused("a.stl", text.substr(0, 140)), "8: ", "end of the file, expected `endsolid`");
  const auto replaced = [&](const std::string& what, const std::string& by) {
    return std::string(text).replace(text.find(what), what.size(), by);
  };
  expect_place(refused("a.stl", replaced("vertex 0 0 0", "vertex 0 0")), "4: ", "vertex has 2 numbers");
  expect_place(refused("a.stl", replaced("vertex 0 1 0", "vertex 0 1e99 0")), "5: ", "\"1e99\"");
  expect_place(refused("a.stl", replaced("outer", "inner")), "3: ", "\"inner\"");
  expect_place(refused("a.stl", replaced("endloop", "vertex 1 1 1")), "7: ", "after three corners");
  expect_place(refused("a.stl", replaced("      vertex 0 0 0\n", "")), "7: ", "a facet of 2 corners");
  expect_place(refused("a.stl", "solid\nendsolid\n"), ": ", "no triangles");
}

TEST_F(ReadMesh, DamagedObjIsRefusedWithTheLine) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_place(refused("a.obj", points), ": ", "no triangles");
  expect_place(refused("a.obj", "v 0 0\n"), "1: ", "v has 2 numbers");
  expect_place(refused("a.obj", points + "v 0 nan 0"), "4: ", "\"nan\"");
  expect_place(refused("a.obj", points + "v 0 0x1 0"), "4: ", "\"0x1\"");
  expect_place(refused("a.obj", points + "f 1 2 0\n"), "4: ", "\"0\"");
  expect_place(refused("a.obj", points + "f 1 2 x\n"), "4: ", "\"x\"");
  expect_place(refused("a.obj", points + "f 1 2 4\nf 1 2 3\n"), "4: ", "the point 4, expected at most 3");
  expect_place(refused("a.obj", points + "f 1 2 -4\n"), "4: ", "there are 3 up to here");
  expect_place(refused("a.obj", points + "f 1 2 99999999999999999999\n"), "4: ", "number of a point");
  std::string many = points + "f";
  for (int i = 0; i < 20'001; ++i) many += " 1";
  expect_place(refused("a.obj", many), "4: ", "20001 corners");
}

TEST_F(ReadMesh, DamagedPlyIsRefusedWithLineOrByte) {
  const std::string text = tetrahedron_ply(PlyBytes::text, "float", "uchar", "int", "vertex_indices");
  const auto replaced = [&](const std::string& what, const std::string& by) {
    return refused("a.ply", std::string(text).replace(text.find(what), what.size(), by));
  };
  expect_place(replaced("ply", "pl"), "1: ", "expected `ply`");
  expect_place(replaced("ascii", "wide"), "2: ", "\"wide\", expected ascii");
  expect_place(replaced("float y", "half y"), "5: ", "\"half\"");
  expect_place(replaced("float y", "float w"), "10: ", "no property y");
  expect_place(replaced("vertex_indices", "corners"), "10: ", "expected vertex_indices");
  expect_place(replaced("element vertex", "element node"), "10: ", "no element `vertex`");
  expect_place(replaced("element vertex 4", "element vertex four"), "3: ", "\"four\"");
  expect_place(replaced("element vertex 4", "element vertex 4000000000"), "10: ", "expected 4000000000 rows");
  expect_place(replaced("end_header", "end"), "10: ", "a line of a PLY header");
  expect_place(replaced("element face 4", "element face 5"), "18: ", "face 5: found the end of the file, expected 5 rows");
  expect_place(replaced("3 0 2 1 \n", "3 0 2 \n"), "15: ", "face 1: found the end of the line");
  expect_place(replaced("3 0 2 1 \n", "3 0 2 1 7\n"), "15: ", "\"7\", expected the end of the line");
  expect_place(replaced("3 0 2 1 \n", "3 0 2 4 \n"), "15: ", "found 4, expected the index of one of 4 points");
  expect_place(replaced("3 0 2 1 \n", "3 0 2 -1 \n"), "15: ", "found -1");
  expect_place(replaced("0 0 0 0 \n", "0 inf 0 0 \n"), "11: ", "vertex 1: found the point 0 inf 0");
  const std::string binary = tetrahedron_ply(PlyBytes::big, "float", "uchar", "int", "vertex_indices");
  const std::size_t all = binary.size();
  expect_place(refused("b.ply", binary.substr(0, all - 3)), "byte " + std::to_string(all - 4), "face 4: found the end of the file");
  expect_place(refused("b.ply", std::string(binary).replace(binary.find("face 4"), 6, "face 999999999")), "byte ",
               "expected 999999999 rows");
}

TEST_F(ReadMesh, DamagedGltfIsRefusedWithThePathOrByte) {
  const std::string text = tetrahedron_gltf("");
  const auto replaced = [&](const std::string& what, const std::string& by) {
    return refused("a.gltf", std::string(text).replace(text.find(what), what.size(), by));
  };
  expect_place(replaced("2.0", "1.0"), "asset.version: ", "\"1.0\"");
  expect_place(replaced("\"mesh\":0", "\"mesh\":1"), "nodes[0].mesh: ", "one of 1 meshes");
  expect_place(replaced("\"mesh\":0", "\"mesh\":0,\"children\":[0]"), "nodes[0].children[0]: ", "the node 0 again");
  expect_place(replaced("\"mesh\":0", "\"mesh\":0,\"matrix\":[1]"), "nodes[0].matrix: ", "16 numbers");
  expect_place(replaced("\"mesh\":0", "\"mesh\":0,\"rotation\":[0,0,0,0]"), "nodes[0].rotation: ", "length 1");
  expect_place(replaced("\"mesh\":0", "\"mesh\":0,\"scale\":[1e20,1,1]"), "nodes[0]: ", "a point at");
  expect_place(replaced("\"POSITION\":0", "\"POSITION\":1"), "accessors[1].type: ", "expected VEC3");
  expect_place(replaced("\"count\":4", "\"count\":400000000000"), "accessors[0].count: ", "no more than the buffers' 60 bytes");
  expect_place(replaced("\"count\":4", "\"count\":5"), "accessors[0]: ", "5 elements from byte 0 on");
  expect_place(replaced("\"count\":4", "\"count\":2"), "meshes[0].primitives[0].indices: ", "the index 2, expected one of 2 points");
  expect_place(replaced("\"count\":12", "\"count\":11"), "meshes[0].primitives[0]: ", "11 corners");
  expect_place(replaced("5126", "5124"), "accessors[0].componentType: ", "5124");
  expect_place(replaced("\"byteOffset\":48", "\"byteOffset\":60"), "bufferViews[1]: ", "a part of a buffer of 60");
  expect_place(replaced("\"byteOffset\":48", "\"byteOffset\":-1"), "bufferViews[1].byteOffset: ", "whole number");
  expect_place(replaced("\"byteLength\":60", "\"byteLength\":61"), "buffers[0].byteLength: ", "at most the 60 bytes");
  expect_place(replaced("base64,", "base64,!"), "buffers[0].uri: ", "base64");
  expect_place(replaced("data:application", "http://x"), "buffers[0].uri: ", "a file");
  expect_place(replaced("}]}", "}]"), "byte ", "parse error");
  expect_place(replaced("\"asset\":", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\":"),
               "extensionsRequired[0]: ", "KHR_draco");
  expect_place(refused("a.gltf", std::string(1'000'000, '[')), "byte ", "parse error");
  const std::string whole = glb_of(tetrahedron_gltf("", R"("mesh":0)", GltfScene::first, ""), gltf_numbers());
  expect_place(refused("a.glb", whole.substr(0, whole.size() - 4)), "byte ", "expected " + std::to_string(whole.size()) + " bytes");
  expect_place(refused("a.glb", whole.substr(0, 10)), "byte 10: ", "expected 12 bytes");
  expect_place(refused("a.glb", std::string(whole).replace(4, 1, "\3")), "byte 4: ", "version 3");
  expect_place(refused("a.glb", std::string(whole).replace(15, 1, "\3")), "byte 12: ", "found a chunk of");
}

TEST_F(ReadMesh, UnknownEndingsAndMissingFilesAreTold) {
  for (const char* name : {"a.step", "a", "a.stl.gz"}) {
    const auto mesh = read_mesh(put(name, "x"));
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().kind, Exit::bad_command_line);
    EXPECT_NE(mesh.error().message.find(".gltf"), std::string::npos);
  }
  for (const std::string& name : {path("none.stl"), path("none/none.obj")}) {
    const auto mesh = read_mesh(name);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().kind, Exit::read_write);
  }
}

}  // namespace
}  // namespace iso::test
