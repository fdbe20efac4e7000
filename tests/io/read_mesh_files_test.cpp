// Readers of meshes against other makers of files: our own writers, with meshes of real models, and assimp's conversions of these. Polygons
// at random, and damage at random.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <random>
#include <set>

#include "patches/io/read_mesh.h"
#include "patches/io/read_model.h"
#include "patches/io/write_mesh.h"
#include "tess/tessellate.h"
#include "tests/support/child.h"
#include "tests/support/mesh_bytes.h"

namespace iso::test {
namespace {

using Random = std::mt19937_64;
constexpr std::uint64_t kSeed = 20240521;

struct Meshed {
  Model model;
  ModelMesh mesh;
  double size = 0;                                 // of the box
  std::vector<std::array<Point3, 3>> triangles{};  // as placed
};
Meshed meshed(const std::string& name, double share) {
  auto model = read_model(data(name));
  if (!model) throw std::runtime_error(model.error().text());
  Meshed m{*model, {}};
  m.size = box_of(*model).diagonal();
  for (const Part& part : m.model.parts) m.mesh.parts.push_back(tessellate(part, {.distance = share * m.size}).mesh);
  for (const Instance& instance : m.model.instances) {
    const PartMesh& mesh = m.mesh.parts[static_cast<std::size_t>(instance.part)];
    for (const Triangle& t : mesh.triangles) {
      std::array<Point3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = instance.to_model.point(mesh.corner(t, static_cast<int>(k)));
      if (glm::determinant(instance.to_model.linear) < 0) std::swap(corners[1], corners[2]);
      m.triangles.push_back(corners);
    }
  }
  return m;
}

ForeignMesh must_read(const std::string& path) {
  auto mesh = read_mesh(path);
  if (!mesh) throw std::runtime_error(mesh.error().text());
  return *mesh;
}

// How far the farthest corner is from where `m` has it, triangle by triangle; files may begin a triangle with any of its corners.
double farthest(const ForeignMesh& mesh, const Meshed& m, double scale) {
  double most = mesh.triangles.size() == m.triangles.size() ? 0 : kInf;
  for (std::size_t i = 0; i < mesh.triangles.size() && most < kInf; ++i) {
    double least = kInf;
    for (std::size_t turn = 0; turn < 3; ++turn) {
      double here = 0;
      for (std::size_t k = 0; k < 3; ++k)
        here = std::max(here, glm::length(mesh.points[mesh.triangles[i][(k + turn) % 3]] - scale * m.triangles[i][k]));
      least = std::min(least, here);
    }
    most = std::max(most, least);
  }
  return most;
}

// How many places are left of a mesh's when they are rounded to float, those below the rounding to 0.
std::size_t places_in_float(const ForeignMesh& mesh) {
  double largest = 0;
  for (const Point3& p : mesh.points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double rounding = std::sqrt(3.0) * std::ldexp(1.0, std::ilogb(static_cast<float>(largest)) - 24);
  std::set<std::array<float, 3>> places;
  for (const Point3& p : mesh.points) {
    std::array<float, 3> place;
    for (int c = 0; c < 3; ++c) place[static_cast<std::size_t>(c)] = std::abs(p[c]) < rounding ? 0.0f : static_cast<float>(p[c]);
    places.insert(place);
  }
  return places.size();
}

TEST(ReadMeshFiles, OurOwnFilesOfModelsComeBackWithinTheirRounding) {
  const TemporaryDir dir;
  int files = 0;
  for (const char* name : {"cad/occt-screw.step", "cad/stepcode-as1-oc-214.stp", "cad/occt-crank-arm.brep"}) {
    Meshed m = meshed(name, 5e-4);
    for (Part& part : m.model.parts)
      for (Face& face : part.faces) face.colour.reset();  // .glb is in the order of colours
    ASSERT_GT(m.triangles.size(), 500u);
    std::size_t points = 0, as_floats = 0;
    for (const char* ending : {".obj", ".ply", ".stl", ".glb"}) {
      const std::string path = dir.path() / (std::string("a") + ending);
      ASSERT_TRUE(write_mesh(path, m.model, m.mesh));
      const ForeignMesh mesh = must_read(path);
      const double scale = mesh.unit == "m" && m.model.unit == "mm" ? 0.001 : 1;
      const bool in_double = std::string(ending) == ".obj" || std::string(ending) == ".ply";
      EXPECT_EQ(mesh.rounding > 0, !in_double) << path;
      EXPECT_LE(farthest(mesh, m, scale), mesh.rounding + (scale == 1 ? 0 : 4 * kEps * scale * m.size)) << name << ending;
      EXPECT_LE(mesh.rounding, 1e-6 * scale * m.size) << name << ending;
      // Where parts touch, float makes some places equal: as many as rounding the doubles does. About a part's own origin, as .glb has
      // them, some become different.
      if (points == 0) points = mesh.points.size(), as_floats = places_in_float(mesh);
      const bool is_glb = std::string(ending) == ".glb";
      const double expected = static_cast<double>(in_double || is_glb ? points : as_floats);
      EXPECT_NEAR(static_cast<double>(mesh.points.size()), expected, is_glb ? 0.05 * expected : 0) << name << ending;
      ++files;
    }
  }
  EXPECT_EQ(files, 12);
}

// What a conversion must not change, in coordinates that glTF files have as y up.
struct Figures {
  std::size_t triangles = 0;
  int unpaired = 0;
  double volume = 0;
  Box3 box;
};
Figures figures_of(const ForeignMesh& mesh, bool back_to_y_up) {
  Figures f{mesh.triangles.size(), unpaired_edges(mesh), volume_of(mesh), {}};
  for (const Point3& p : mesh.points) f.box.include(back_to_y_up ? Point3(p.x, p.z, -p.y) : p);
  return f;
}

TEST(ReadMeshFiles, AssimpsConversionsBetweenAllFormatsReadTheSame) {
  ASSERT_TRUE(std::filesystem::exists("/usr/bin/assimp")) << "assimp is not installed";
  const struct {
    const char *format, *ending;
  } kinds[] = {{"stl", ".stl"}, {"stlb", ".stl"}, {"obj", ".obj"}, {"ply", ".ply"}, {"plyb", ".ply"}, {"gltf2", ".gltf"}, {"glb2", ".glb"}};
  const Meshed m = meshed("cad/occt-screw.step", 3e-3);
  const TemporaryDir dir;
  int compared = 0;
  for (const std::string from : {".stl", ".obj", ".ply", ".glb"}) {
    const std::string ours = dir.path() / ("ours" + from);
    ASSERT_TRUE(write_mesh(ours, m.model, m.mesh));
    const Figures wanted = figures_of(must_read(ours), from == ".glb");
    EXPECT_EQ(wanted.triangles, m.triangles.size());
    EXPECT_EQ(wanted.unpaired, 0);
    for (const auto& to : kinds) {
      const std::string theirs = dir.path() / (std::string("theirs") + to.ending);
      const ChildResult told = run_child({"/usr/bin/assimp", "export", ours, theirs, std::string("-f") + to.format});
      ASSERT_EQ(told.code, 0) << from << " to " << to.format << ": " << told.summary() << told.out;
      const ForeignMesh mesh = must_read(theirs);
      const Figures got = figures_of(mesh, mesh.unit == "m");
      const double size = wanted.box.diagonal();
      EXPECT_EQ(got.triangles, wanted.triangles) << from << " to " << to.format;
      EXPECT_EQ(got.unpaired, 0) << from << " to " << to.format;
      EXPECT_NEAR(got.volume, wanted.volume, 1e-5 * wanted.volume) << from << " to " << to.format;
      for (const Vec3 d : {got.box.lo - wanted.box.lo, got.box.hi - wanted.box.hi})
        EXPECT_LE(glm::length(d), 1e-6 * size) << from << " to " << to.format;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 4 * 7);
}

// A polygon about the origin whose corners' angles rise, in a plane at random.
struct Star {
  Vec3 normal;
  double area = 0;
  std::string obj;
};
Star random_star(std::size_t corners, Random& random) {
  const auto uniform = [&](double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(random); };
  Star s;
  s.normal = glm::normalize(Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
  const Vec3 X = any_perpendicular(s.normal), Y = glm::cross(s.normal, X);
  std::vector<Vec2> flat;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = kTwoPi * (static_cast<double>(i) + uniform(0, 0.5)) / static_cast<double>(corners), r = uniform(0.1, 1);
    flat.emplace_back(r * std::cos(angle), r * std::sin(angle));
    const Vec3 p = flat.back().x * X + flat.back().y * Y;
    s.obj += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  }
  s.obj += "f";
  for (std::size_t i = 0; i < corners; ++i) {
    const Vec2 a = flat[i], b = flat[(i + 1) % corners];
    s.area += (a.x * b.y - a.y * b.x) / 2;
    s.obj += fmt::format(" {}", i + 1);
  }
  return s;
}

TEST(ReadMeshFiles, RandomPolygonsAreCutWithoutOverlap) {
  Random random(kSeed);
  const TemporaryDir dir;
  const std::string path = dir.path() / "a.obj";
  int triangles = 0;
  for (int round = 0; round < 300; ++round) {
    const std::size_t corners = 5 + random() % (round % 10 == 0 ? 400 : 20);
    const Star star = random_star(corners, random);
    std::ofstream(path) << star.obj;
    const ForeignMesh mesh = must_read(path);
    double sum = 0;
    for (const PointTriangle& t : mesh.triangles) {
      const Vec3 cross = glm::cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
      EXPECT_GT(glm::dot(cross, star.normal), -1e-9) << "seed " << kSeed << ", round " << round << '\n' << star.obj;
      sum += glm::length(cross) / 2;
    }
    EXPECT_NEAR(sum, star.area, 1e-9 * star.area) << "seed " << kSeed << ", round " << round;
    EXPECT_EQ(mesh.triangles.size(), corners - 2);
    EXPECT_EQ(mesh.notes.size(), 1u) << mesh.notes.back();
    triangles += static_cast<int>(mesh.triangles.size());
  }
  EXPECT_GT(triangles, 3000);
}

// One to four wounds: bytes changed, taken out, doubled, or all cut off from somewhere on.
std::string damaged(std::string bytes, Random& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t wounds = 1 + below(4); wounds > 0 && !bytes.empty(); --wounds) {
    const std::size_t at = below(bytes.size());
    switch (below(8)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(at, 1 + below(30));
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(60)));
        break;
      case 3:
        bytes[at] = "0123456789-.e ,[]{}\"/\n"[below(22)];
        break;
      case 4:
        if (const std::size_t digit = bytes.find_first_of("0123456789", at); digit != bytes.npos) bytes.replace(digit, 1, "99999999");
        break;
      default:
        bytes[at] = static_cast<char>(random());
    }
  }
  return bytes;
}

// What is wrong with a reading of a damaged file.
std::string objection(const Result<ForeignMesh>& mesh) {
  if (!mesh) {
    const Error& e = mesh.error();
    if (e.kind != Exit::bad_input && e.kind != Exit::read_write) return "refused in another way: " + e.text();
    const bool no_place_needed = e.message.find("no triangles") != e.message.npos || e.kind == Exit::read_write;
    if (e.message.empty() || e.file.empty() || (e.place.empty() && !no_place_needed)) return "no place: " + e.text();
    return e.text().find('\n') == std::string::npos ? "" : "more than a line: " + e.text();
  }
  for (const PointTriangle& t : mesh->triangles)
    for (const std::uint32_t i : t)
      if (i >= mesh->points.size()) return "an index without point";
  for (const Point3& p : mesh->points)
    if (!finite(p)) return "a number that is not finite";
  return mesh->triangles.empty() || !finite(mesh->rounding) ? "no mesh" : "";
}

std::vector<std::pair<const char*, std::string>> undamaged() {
  std::vector<Point3> points;
  std::vector<PointTriangle> triangles;
  for (std::uint32_t i = 0; i < 20; ++i) {
    for (int k = 0; k < 3; ++k) points.emplace_back(i * 0.1, k == 1, k == 2);
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  std::string obj;
  for (const Point3& p : points) obj += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (int i = 1; i < 40; ++i) obj += fmt::format("f {}/1/1 {} -{}//2 {}\n", i, i + 7, i, i + 19);
  return {{".stl", binary_stl(points, triangles)},
          {".stl", text_stl(points, triangles)},
          {".obj", obj},
          {".ply", tetrahedron_ply(PlyBytes::text, "float", "uchar", "int", "vertex_indices")},
          {".ply", tetrahedron_ply(PlyBytes::little, "double", "uint", "int", "vertex_index")},
          {".ply", tetrahedron_ply(PlyBytes::big, "float", "uchar", "short", "vertex_indices")},
          {".gltf", tetrahedron_gltf(R"("rotation":[0,0,1,0],"children":[1]},{"mesh":0)")},
          {".gltf", square_gltf(R"("attributes":{"POSITION":5},"indices":2},{"attributes":{"POSITION":4},"mode":5)")},
          {".glb", glb_of(tetrahedron_gltf("", R"("mesh":0)", GltfScene::first, ""), gltf_numbers())}};
}

// Reads damaged versions of a file and says what is wrong; the exit code of a child process.
int read_damaged(const std::string& path, const std::string& whole) {
  constexpr int kRounds = 1500;
  Random random(kSeed);
  int read = 0, failed = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::filesystem::remove(path);  // file systems wait for the disk where files are overwritten
    std::ofstream(path, std::ios::binary) << damaged(whole, random);
    const auto mesh = read_mesh(path);
    read += static_cast<bool>(mesh);
    if (const std::string wrong = objection(mesh); !wrong.empty()) {
      std::cout << "seed " << kSeed << ", round " << round << ": " << wrong << '\n';
      ++failed;
    }
  }
  std::cout << read << " of " << kRounds << " read" << std::endl;
  return failed > 0 || read == 0 || read == kRounds;
}

TEST(ReadMeshFiles, DamagedFilesAreReadOrRefusedWithOneLine) {
  const TemporaryDir dir;
  ChildLimits limits;
  limits.memory_bytes = 2l << 30;
  limits.seconds = 60;
  int kinds = 0;
  for (const auto& [ending, bytes] : undamaged()) {
    const std::string path = dir.path() / (std::string("a") + ending), &whole = bytes;
    std::ofstream(path, std::ios::binary) << whole;
    ASSERT_EQ(objection(read_mesh(path)), "");
    const ChildResult child = run_in_child([&] { return read_damaged(path, whole); }, {}, limits);
    EXPECT_EQ(child.code, 0) << ending << ": " << child.summary() << '\n' << child.out;
    std::cout << ending << ": " << child.out;
    ++kinds;
  }
  EXPECT_EQ(kinds, 9);
}

}  // namespace
}  // namespace iso::test
