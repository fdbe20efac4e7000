// Patches with any number of sides by uniform patterns: watertight, proven, measured; levels from tolerances; discrete mean curvature.
#include "tess/patch_mesh.h"

#include <gtest/gtest.h>

#include "patches/io/read_model.h"
#include "patches/n_sided_part.h"
#include "patches/surface/bezier_triangle.h"
#include "patches/surface/patch_construct.h"
#include "tess/deviation.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

constexpr const char *kCuboctahedron = "meshes/truncated-cuboctahedron.obj", *kSpot = "meshes/spot-control-mesh.obj";

Part part_of(const char* file, MeshPatches kind = MeshPatches::gregory) {
  auto model = read_model(data(file), {.patches = kind});
  EXPECT_TRUE(model && model->parts.size() == 1) << file;
  return std::move(model->parts[0]);
}

// All octants of the unit sphere, turned about the axes.
Part sphere() {
  std::vector<PatchEntry> octants;
  const NSidedPatch first = sphere_octant();
  for (int k = 0; k < 8; ++k) {
    PatchEntry entry{.patch = first, .corners = {}, .colour = {}, .name = {}};
    for (Vec3& p : entry.patch.points) {
      for (int turn = 0; turn < k % 4; ++turn) p = {-p.y, p.x, p.z};
      if (k >= 4) p = {p.x, -p.y, -p.z};
    }
    octants.push_back(entry);
  }
  Model model;
  model.parts.push_back(part_of_patches("sphere", octants));
  model.instances.push_back({0, {}, {}, {}});
  finish(model);
  return std::move(model.parts[0]);
}

// One patch over a saddle or a cap with n corners; normals are those of the surface z = x^2 + a y^2.
Part bowl(int n, double a) {
  std::vector<PatchCorner> corners;
  for (int k = 0; k < n; ++k) {
    const double x = std::cos(kTwoPi * k / n), y = std::sin(kTwoPi * k / n);
    corners.push_back({{x, y, 0.5 * (x * x + a * y * y)}, glm::normalize(Vec3(-x, -a * y, 1))});
  }
  const auto patch = patch_over(gregory_basis(n), corners);
  EXPECT_TRUE(patch);
  Model model;
  model.parts.push_back(part_of_patches("bowl", {PatchEntry{.patch = *patch, .corners = {}, .colour = {}, .name = {}}}));
  model.instances.push_back({0, {}, {}, {}});
  finish(model);
  return std::move(model.parts[0]);
}

std::string told(const PatchMeshOptions& options) {
  return std::string(name_of(options.strategy)) + ", level " + std::to_string(options.level) + ", distance " +
         std::to_string(options.distance);
}

double largest_bound(const PatchMesh& mesh) {
  double bound = 0;
  for (const FaceReport& face : mesh.made.faces) bound = std::max(bound, face.bound);
  return bound;
}
double largest_offset(const PatchMesh& mesh) {
  double offset = 0;
  for (const FaceReport& face : mesh.made.faces) offset = std::max(offset, face.offset);
  return offset;
}

// Watertight, without area 0, folds or overlaps, and no farther than what is proven. Returns the measured distance.
double expect_sound(const Part& part, const PatchMesh& mesh, bool closed, bool may_fold = false) {
  MeshReport check = verify(part, mesh);
  // Few triangles of a patch that is bent sharply stand against its normals: that is told, and no fault of the pattern.
  if (may_fold) check.folded = {};
  EXPECT_TRUE(check.sound()) << text_of(check);
  EXPECT_EQ(check.topology.open_edges.count == 0, closed);
  const Deviation deviation = measure(part, mesh.cut, Sampling::fine);
  const double rounding = 1e-11 * part.box.diagonal();
  for (std::size_t f = 0; f < part.faces.size(); ++f)
    EXPECT_LE(deviation.faces[f].worst, mesh.made.faces[f].bound + mesh.made.faces[f].offset + rounding) << "face " << f;
  return deviation.all.worst;
}

TEST(PatchMesh, ModelsAreWatertightByEveryStrategy) {
  int checked = 0;
  for (const MeshPatches kind :
       {MeshPatches::gregory, MeshPatches::generalised_bezier, MeshPatches::charrot_gregory, MeshPatches::gregory_mean_value})
    for (const char* file : {kCuboctahedron, kSpot}) {
      if (file == kSpot && kind != MeshPatches::gregory) continue;
      const Part part = part_of(file, kind);
      const auto patches = patches_of(part);
      ASSERT_TRUE(patches);
      for (const Strategy strategy : kStrategies)
        for (const int level : {1, 3, 4}) {
          if (file == kSpot && strategy != Strategy::symmetric_quads) continue;
          if (level != 3 && (file == kSpot || kind != MeshPatches::gregory)) continue;
          const PatchMeshOptions options{.strategy = strategy, .level = level};
          SCOPED_TRACE(std::string(file) + ", " + told(options));
          const PatchMesh mesh = mesh_patches(part, options);
          std::size_t triangles = 0;
          for (const NSidedPatch& patch : patches->patches)
            triangles += domain_pattern(strategy, patch.basis.sides, {level, {}}).triangles.size();
          EXPECT_EQ(mesh.made.mesh.triangles.size(), triangles);
          EXPECT_LT(largest_offset(mesh), 1e-13 * part.box.diagonal());
          const double measured = expect_sound(part, mesh, true, file == kSpot);
          EXPECT_LE(largest_bound(mesh), 6 * measured);
          ++checked;
        }
    }
  EXPECT_EQ(checked, 4 * (3 + 1 + 1 + 1) + 1);
}

TEST(PatchMesh, SharedSidesAreTheSamePoints) {
  const Part part = part_of(kCuboctahedron);
  const PatchMesh mesh = mesh_patches(part, {.strategy = Strategy::symmetric_quads, .level = 5});
  // Points of faces of different patches: 72 edges with 4 points between their ends, and 48 corners.
  std::vector<int> first(mesh.made.mesh.points.size(), -1);
  std::vector<bool> shared(first.size(), false);
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const int patch = std::get<PatchChart>(part.faces[f].surface).patch;
    for (std::uint32_t i = mesh.made.mesh.first_node[f]; i < mesh.made.mesh.first_node[f + 1]; ++i) {
      const std::uint32_t point = mesh.made.mesh.nodes[i].point;
      if (first[point] >= 0 && first[point] != patch) shared[point] = true;
      first[point] = patch;
    }
  }
  EXPECT_EQ(std::count(shared.begin(), shared.end(), true), 72 * 4 + 48);
}

TEST(PatchMesh, AToleranceIsKeptWithLevelsThatNeighboursAgreeOn) {
  int uneven = 0, checked = 0;
  for (const Strategy strategy : kStrategies)
    for (const double share : {1e-2}) {
      const Part part = part_of(kCuboctahedron);
      const PatchMeshOptions options{.strategy = strategy, .distance = share * part.box.diagonal()};
      SCOPED_TRACE(told(options));
      const PatchMesh mesh = mesh_patches(part, options);
      EXPECT_LE(largest_bound(mesh), options.distance);
      const double measured = expect_sound(part, mesh, true);
      EXPECT_GT(measured, 0.1 * options.distance);
      for (const PatternLevels& levels : mesh.levels)
        for (const int level : levels.of_side) {
          EXPECT_GE(level, levels.inner);
          uneven += level != levels.inner;
        }
      for (const FaceReport& face : mesh.made.faces) EXPECT_EQ(face.unresolved, 0);
      ++checked;
    }
  EXPECT_EQ(checked, 4);
  EXPECT_GT(uneven, 0);
}

TEST(PatchMesh, AnOpenPatchIsOpenAlongItsSidesOnly) {
  for (const int n : {3, 4, 5, 8}) {
    const Part part = bowl(n, -1);
    for (const Strategy strategy : kStrategies) {
      const PatchMesh mesh = mesh_patches(part, {.strategy = strategy, .level = 6});
      expect_sound(part, mesh, false);
      EXPECT_EQ(mesh.made.free_sides.size(), static_cast<std::size_t>(6 * n));
    }
  }
}

TEST(PatchMesh, DamageShows) {
  const Part part = part_of(kCuboctahedron);
  PatchMesh mesh = mesh_patches(part, {.strategy = Strategy::fan_quads, .level = 3});
  ASSERT_TRUE(verify(part, mesh).sound());
  // A node gets a point of its own: a crack.
  PatchMesh cracked = mesh;
  cracked.made.mesh.points.push_back(cracked.made.mesh.points[cracked.made.mesh.nodes[7].point]);
  cracked.made.mesh.nodes[7].point = static_cast<std::uint32_t>(cracked.made.mesh.points.size() - 1);
  EXPECT_GT(verify(part, cracked).cracks.count, 0u);
  std::swap(mesh.cut.triangles[5][0], mesh.cut.triangles[5][1]);
  EXPECT_EQ(verify(part, mesh).turned.count, 1u);
}

TEST(PatchMesh, ErrorsFallWithTheSquareOfTheLevel) {
  int checked = 0;
  for (const int n : {5, 8})
    for (const Strategy strategy : kStrategies) {
      const Part part = bowl(n, 0.6);
      std::vector<double> rms;
      for (const int level : {8, 32}) {
        const PatchMesh mesh = mesh_patches(part, {.strategy = strategy, .level = level});
        rms.push_back(measure(part, mesh.cut, Sampling::quick).all.to_surface.rms());
      }
      SCOPED_TRACE(std::string(name_of(strategy)) + ", " + std::to_string(n) + " sides");
      EXPECT_NEAR(std::log(rms[0] / rms[1]) / std::log(4.0), 2, 0.2);
      ++checked;
    }
  EXPECT_EQ(checked, 8);
}

// Where no spline stands beside the charts: its own distance is in every bound.
TEST(PatchMesh, BoundsFallWithTheSquareOfTheLevel) {
  const Part part = sphere();
  for (const Strategy strategy : kStrategies) {
    std::vector<double> measured, bound;
    for (const int level : {8, 32}) {
      const PatchMesh mesh = mesh_patches(part, {.strategy = strategy, .level = level});
      measured.push_back(expect_sound(part, mesh, true));
      bound.push_back(largest_bound(mesh));
    }
    SCOPED_TRACE(name_of(strategy));
    EXPECT_NEAR(std::log(measured[0] / measured[1]) / std::log(4.0), 2, 0.2);
    EXPECT_NEAR(std::log(bound[0] / bound[1]) / std::log(4.0), 2, 0.2);
  }
}

TEST(PatchMesh, DiscreteMeanCurvatureOfASphereIsItsOwn) {
  const Part part = sphere();
  int checked = 0;
  for (const Strategy strategy : kStrategies) {
    double before = kInf;
    for (const int level : {8, 16, 32}) {
      const PatchMesh mesh = mesh_patches(part, {.strategy = strategy, .level = level});
      const std::vector<double> H = discrete_mean_curvature(mesh.made.mesh);
      const CurvatureError error = curvature_error(part, H, mesh.places);
      SCOPED_TRACE(std::string(name_of(strategy)) + ", level " + std::to_string(level));
      EXPECT_NEAR(error.largest, 1, 1e-9);
      EXPECT_EQ(error.points, std::count_if(mesh.places.begin(), mesh.places.end(), [](const SurfacePlace& p) { return p.inside; }));
      EXPECT_LT(error.rms, 0.6 * before);
      before = error.rms;
      ++checked;
    }
    EXPECT_LT(before, 3e-2);
  }
  EXPECT_EQ(checked, 12);
}

// [Hettinga 2021, figure 5.20]
TEST(PatchMesh, FansMisleadTheDiscreteCurvatureOfAnOctagonMoreThanSymmetricPatternsDo) {
  const Part part = bowl(8, -0.5);
  std::array<double, 4> rms{};
  for (std::size_t s = 0; s < 4; ++s) {
    const PatchMesh mesh = mesh_patches(part, {.strategy = kStrategies[s], .level = 16});
    rms[s] = curvature_error(part, discrete_mean_curvature(mesh.made.mesh), mesh.places).rms;
    std::cout << name_of(kStrategies[s]) << ": " << rms[s] << "\n";
  }
  EXPECT_LT(std::max(rms[2], rms[3]), std::min(rms[0], rms[1]));
}

TEST(PatchMesh, TablesAreSharedByPatchesOfOneKind) {
  const Part part = part_of(kCuboctahedron);
  const PatchMesh mesh = mesh_patches(part, {.strategy = Strategy::symmetric_triangles, .level = 8});
  EXPECT_EQ(mesh.tables, 3u);  // 4, 6 and 8 sides
  EXPECT_GT(mesh.table_bytes, 0u);
}

TEST(PatchMesh, OtherFacesAreRefused) {
  auto model = read_model(data("patches/teapot.bpt"));
  ASSERT_TRUE(model);
  const auto patches = patches_of(model->parts[0]);
  ASSERT_FALSE(patches);
  EXPECT_EQ(patches.error().place, "face 0");
  Part part = part_of(kCuboctahedron);
  std::swap(part.faces[1], part.faces[2]);
  EXPECT_FALSE(patches_of(part));
}

}  // namespace
}  // namespace iso::test
