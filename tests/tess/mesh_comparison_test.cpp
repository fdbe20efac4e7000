// Meshes against exact faces: figures that have closed forms, and what must not change them.
#include "tess/mesh_comparison.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/foreign_meshes.h"
#include "tests/support/mesh_distance.h"

namespace iso::test {
namespace {

// Of the size.
constexpr double kRight = 1e-9;

// `max` is the truth, and the bound above it by no more than a few times what the reference allows.
void expect_truth(const OneSided& found, double truth, double size, double reference_bound, const std::string& what) {
  EXPECT_NEAR(found.max, truth, kRight * size) << what;
  EXPECT_GE(found.bound, truth - 1e-14 * size) << what;
  EXPECT_GE(found.bound, found.max) << what;
  EXPECT_LE(found.bound - found.max, 3 * reference_bound) << what;
  EXPECT_LE(found.mean, found.rms * (1 + 1e-6)) << what;
  EXPECT_LE(found.p999, found.max * (1 + 1e-6)) << what;
}

TEST(MeshComparison, PrismInACylinderIsOffByTheSagittaBothWays) {
  const Model model = model_of(solid_cylinder({}, 1).part);
  for (const int n : {3, 8, 40}) {
    const MeshComparison c = compared(model, prism_mesh(n, 0.5, 1));
    // The middle of a side is this deep, at any height; the nearest cap is farther from its middle.
    const double truth = 0.5 * (1 - std::cos(kPi / n));
    for (const FaceComparison* f : {&c.all, &c.faces[0]}) {
      expect_truth(f->to_surface, truth, 1, c.reference_bound, fmt::format("{} sides, to the surface", n));
      expect_truth(f->to_mesh, truth, 1, c.reference_bound, fmt::format("{} sides, to the mesh", n));
    }
    // Caps: the mesh is in them; their rims stand out over the prism's.
    for (const int f : {1, 2}) {
      EXPECT_NEAR(c.faces[f].to_surface.max, 0, kRight);
      EXPECT_NEAR(c.faces[f].to_mesh.max, truth, c.reference_bound) << n;
    }
    EXPECT_EQ(c.topology.triangles, 4u * n);
    EXPECT_TRUE(c.topology.closed());
  }
}

TEST(MeshComparison, IcosphereIsOffByItsDeepestCircumcentreBothWays) {
  constexpr double kRadius = 2;
  SolidPart ball = solid_sphere({}, 2 * kRadius);
  const Model model = model_of(std::move(ball.part));
  for (int level = 0; level <= 4; ++level) {
    const ForeignMesh mesh = icosphere(level, kRadius);
    ASSERT_EQ(mesh.triangles.size(), 20u << (2 * level));
    // All triangles are acute, so that their deepest point is below the circumcentre; the sphere's point over it has that for its nearest
    // one, since the polyhedron is convex.
    double deepest = 0;
    for (const auto& [i, j, k] : mesh.triangles) {
      const Point3 &a = mesh.points[i], &b = mesh.points[j], &c = mesh.points[k];
      const double x = glm::length(b - c), y = glm::length(c - a), z = glm::length(a - b), longest = std::max({x, y, z});
      ASSERT_GT(x * x + y * y + z * z, 2 * longest * longest);
      const double circle = x * y * z / (2 * glm::length(glm::cross(b - a, c - a)));
      deepest = std::max(deepest, circle * circle / (kRadius + std::sqrt(kRadius * kRadius - circle * circle)));
      if (level > 2) continue;
      const Vec3 n = glm::cross(b - a, c - a);
      for (const Point3& p : mesh.points) ASSERT_LE(glm::dot(p - a, n), 1e-12);
    }
    const MeshComparison c = compared(model, mesh);
    expect_truth(c.all.to_surface, deepest, 2 * kRadius, c.reference_bound, fmt::format("level {}, to the surface", level));
    expect_truth(c.all.to_mesh, deepest, 2 * kRadius, c.reference_bound, fmt::format("level {}, to the mesh", level));
    EXPECT_TRUE(c.topology.closed());
    EXPECT_NEAR(c.all.area, 4 * kPi * kRadius * kRadius, 1e-3 * c.all.area);
  }
}

// With an odd number of squares one is about the origin, with corners at (+-h, +-h, +-h^2). The middle of its diagonal, (0, 0, h^2), is
// h^2 off, and nothing is farther, since nothing is farther along z. From the origin the nearest point is on the planes of the two
// triangles, whose slope is sqrt(2) h; all other squares are steeper.
TEST(MeshComparison, GridOnASaddleIsOffBySquaresOfItsWidth) {
  const Model model = saddle_model();
  for (const int n : {1, 3, 5, 15}) {
    const double h = 1.0 / n, to_surface = h * h, to_mesh = h * h / std::sqrt(1 + 2 * h * h);
    const ForeignMesh mesh = saddle_mesh(n);
    const MeshComparison c = compared(model, mesh);
    expect_truth(c.all.to_surface, to_surface, 3, c.reference_bound, fmt::format("{} squares, to the surface", n));
    expect_truth(c.all.to_mesh, to_mesh, 3, c.reference_bound, fmt::format("{} squares, to the mesh", n));
    // Dense sampling knows nothing of the closed form.
    double most = 0;
    constexpr int kSamples = 150;
    for (int i = 0; i <= kSamples; ++i)
      for (int j = 0; j <= kSamples; ++j) {
        const double x = -1 + 2.0 * i / kSamples, y = -1 + 2.0 * j / kSamples;
        double nearest = kInf;
        for (const auto& [p, q, r] : mesh.triangles) {
          if (glm::length(Vec2(mesh.points[p]) - Vec2(x, y)) > 4 * h + 0.1) continue;
          nearest = std::min(nearest, distance_to_triangle({x, y, x * y}, mesh.points[p], mesh.points[q], mesh.points[r]));
        }
        most = std::max(most, nearest);
      }
    EXPECT_LE(most, to_mesh * (1 + 1e-12));
    EXPECT_GE(most, 0.9 * to_mesh);
    EXPECT_EQ(c.free_edges, 4u * n);
    EXPECT_TRUE(c.faults.empty());
  }
}

TEST(MeshComparison, APlaneIsNotOffItself) {
  SolidPart square = untrimmed("square", Plane{}, {{-1, -1}, {1, 1}}, 2, {});
  const Model model = model_of(std::move(square.part));
  const MeshComparison c = compared(model, grid_mesh(7, [](double, double) { return 0.0; }));
  EXPECT_NEAR(c.all.to_surface.max, 0, 1e-15);
  EXPECT_NEAR(c.all.to_mesh.max, 0, 1e-15);
  EXPECT_LE(c.all.to_surface.bound, 3 * c.reference_bound + 1e-14);
  EXPECT_LE(c.all.to_mesh.bound, 3 * c.reference_bound + 1e-14);
  EXPECT_EQ(c.all.worst_angle, 0);
  EXPECT_TRUE(c.faults.empty());
}

}  // namespace
}  // namespace iso::test
