// The bound of a triangle's distance from a mesh: never below what samples say, and near it where the mesh lies before the triangle.
#include "tess/prism_cover.h"

#include <gtest/gtest.h>

#include "tests/support/foreign_meshes.h"

namespace iso::test {
namespace {

struct Sampled {
  double largest = 0, near = 0;
};

// At points of a fine grid, corners and sides included; `near` from corners and middle, as the bound is to be called.
Sampled sampled(const TriangleTree& tree, const std::array<Point3, 3>& t, int parts) {
  Sampled s;
  const auto at = [&](double b, double c) { return tree.nearest((1 - b - c) * t[0] + b * t[1] + c * t[2]).distance; };
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) s.largest = std::max(s.largest, at(double(i) / parts, double(j) / parts));
  s.near = std::max({at(0, 0), at(1, 0), at(0, 1), at(1 / 3.0, 1 / 3.0)});
  return s;
}

// A closed box whose sides are grids with some squares left out.
ForeignMesh box_with_holes(Random& random, int n, double share) {
  ForeignMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {-1.0, 1.0}) {
      ForeignMesh side = grid_mesh(n, [](double, double) { return 0.0; });
      const auto first = static_cast<std::uint32_t>(mesh.points.size());
      for (const Point3& p : side.points) {
        Point3 q(at);
        q[(axis + 1) % 3] = p.x;
        q[(axis + 2) % 3] = p.y;
        mesh.points.push_back(q);
      }
      for (const auto& [a, b, c] : side.triangles)
        if (between(random, 0, 1) > share) mesh.triangles.push_back({first + a, first + b, first + c});
    }
  return mesh;
}

std::vector<std::pair<std::string, ForeignMesh>> meshes(Random& random) {
  std::vector<std::pair<std::string, ForeignMesh>> all;
  for (int level = 0; level <= 4; level += 2) all.emplace_back(fmt::format("sphere of level {}", level), icosphere(level, 1));
  all.emplace_back("bumpy grid", grid_mesh(20, [](double x, double y) { return 0.1 * std::sin(9 * x) * std::cos(7 * y); }));
  all.emplace_back("rough grid", grid_mesh(12, [&](double, double) { return between(random, -0.1, 0.1); }));
  all.emplace_back("box with holes", box_with_holes(random, 6, 0.2));
  all.emplace_back("box with many holes", box_with_holes(random, 5, 0.8));
  return all;
}

std::array<Point3, 3> random_triangle(Random& random) {
  const double size = std::pow(10.0, between(random, -2, 0.3));
  const Point3 o = random_vector<Vec3>(random, 1.2);
  std::array<Point3, 3> t{o, o + random_vector<Vec3>(random, size), o + random_vector<Vec3>(random, size)};
  switch (whole(random, 0, 9)) {
    case 0:
      t[2] = t[1];
      break;
    case 1:
      t[1] = t[2] = t[0];
      break;
    case 2:
      t[2] = t[0] + between(random, -1, 2) * (t[1] - t[0]);
      break;
    case 3:
      t[2] = t[0] + 0.4 * (t[1] - t[0]) + random_vector<Vec3>(random, 1e-9);
      break;
    default:
      break;
  }
  return t;
}

TEST(PrismCover, NoSampleIsBeyondTheBound) {
  Random random(21);
  int asked = 0;
  for (const auto& [name, mesh] : meshes(random)) {
    const TriangleTree tree(mesh.points, mesh.triangles);
    double loosest = 1;
    for (int k = 0; k < 120; ++k) {
      const auto t = random_triangle(random);
      const Sampled s = sampled(tree, t, 24);
      // Wrong guesses of what is near make it slower or looser, not wrong.
      const double near = s.near * (k % 4 == 0 ? 0.1 : k % 4 == 1 ? 10 : 1);
      const CoverBound found = cover_bound(tree, mesh.points, mesh.triangles, t, near, k % 2 ? 0 : s.largest);
      const double rounding = 1e-13;
      ASSERT_GE(found.bound, s.largest - rounding)
          << fmt::format("{} under, {}, case {}: ({}, {}, {}) ({}, {}, {}) ({}, {}, {})", s.largest - found.bound, name, k, t[0].x, t[0].y,
                         t[0].z, t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z);
      ASSERT_TRUE(std::isfinite(found.bound));
      if (near >= s.near) loosest = std::max(loosest, found.bound / std::max({s.largest, near, 1e-12}));
      ++asked;
    }
    GTEST_LOG_(INFO) << fmt::format("{}: up to {:.3f} times what was found or asked for", name, loosest);
  }
  EXPECT_EQ(asked, 7 * 120);
}

// A triangle beside a mesh that goes on beyond it, at several heights: to 2 % and the second order of what the mesh bends under it.
TEST(PrismCover, IsTightWhereTheMeshLiesBefore) {
  Random random(22);
  int asked = 0;
  for (const auto& [name, mesh] :
       {std::pair{"sphere", icosphere(4, 1)},
        {"bumpy grid", grid_mesh(40, [](double x, double y) { return 0.02 * std::sin(4 * x) * std::cos(3 * y); })}}) {
    const TriangleTree tree(mesh.points, mesh.triangles);
    const bool is_sphere = name == std::string("sphere");
    for (int k = 0; k < 200; ++k) {
      const double size = std::pow(10.0, between(random, -3, -0.7)), height = std::pow(10.0, between(random, -6, -2));
      std::array<Point3, 3> t;
      const Point3 middle = random_vector<Vec3>(random, 0.6);
      for (Point3& p : t) {
        p = middle + random_vector<Vec3>(random, size);
        p = is_sphere ? (1 + height) * glm::normalize(p) : Point3(p.x, p.y, 0.02 * std::sin(4 * p.x) * std::cos(3 * p.y) + height);
      }
      const Sampled s = sampled(tree, t, 40);
      const CoverBound found = cover_bound(tree, mesh.points, mesh.triangles, t, s.near, s.largest);
      double longest = 0;
      for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, glm::length(t[i] - t[(i + 1) % 3]));
      // Between the samples the distance from a flat triangle changes by less than their spacing times the slope between both.
      const double spacing = longest / 40, between_samples = spacing * (longest + 0.1);
      EXPECT_GE(found.bound, s.largest - 1e-13);
      EXPECT_LE(found.bound, 1.02 * s.largest + between_samples) << name << " " << k << " size " << size << " height " << height;
      ++asked;
    }
  }
  EXPECT_EQ(asked, 400);
}

TEST(PrismCover, OfAMeshInItsOwnPlaceIsRounding) {
  const ForeignMesh mesh = icosphere(3, 1);
  const TriangleTree tree(mesh.points, mesh.triangles);
  for (const auto& [a, b, c] : mesh.triangles)
    EXPECT_LE(cover_bound(tree, mesh.points, mesh.triangles, {mesh.points[a], mesh.points[b], mesh.points[c]}, 0, 0).bound, 1e-14);
}

}  // namespace
}  // namespace iso::test
