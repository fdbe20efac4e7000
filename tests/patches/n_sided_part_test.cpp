// Parts of n-sided patches: which edges their charts share, and control meshes made of patches.
#include "patches/n_sided_part.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "patches/control_mesh.h"

namespace iso::test {
namespace {

// A prism over a regular polygon of n sides: its two ends, and n quadrilaterals.
ControlMesh prism(int n) {
  ControlMesh mesh;
  for (const double z : {-1.0, 1.0})
    for (int k = 0; k < n; ++k) mesh.points.push_back({std::cos(kTwoPi * k / n), std::sin(kTwoPi * k / n), z});
  ControlPolygon top{.corners = {}, .normals = {}, .place = "line 2", .name = {}},
      bottom{.corners = {}, .normals = {}, .place = "line 1", .name = {}};
  for (int k = 0; k < n; ++k) {
    bottom.corners.push_back(n - 1 - k);
    top.corners.push_back(n + k);
  }
  mesh.polygons = {bottom, top};
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    mesh.polygons.push_back({{k, next, n + next, n + k}, {}, "line " + std::to_string(3 + k), {}});
  }
  return mesh;
}

std::vector<PatchEntry> patches_over(const ControlMesh& mesh, MeshPatches kind = MeshPatches::gregory) {
  return patches_of_mesh(mesh, kind).patches;
}

std::map<int, int> uses_of(const PatchEdges& edges) {
  std::map<int, int> counts;
  for (const Edge& e : edges.edges) ++counts[e.uses];
  return counts;
}

// The place in space of an edge's two ends, as one chart sees it, from share 0 to 1.
Point3 chart_point(const NSidedPatch& patch, int corner, const Vec2& st) {
  std::vector<int> order(patch.points.size());
  for (std::size_t m = 0; m < order.size(); ++m) order[m] = static_cast<int>(m);
  const std::vector<int> turn = points_from_next_corner(patch.basis);
  for (int k = 0; k < corner; ++k)
    for (int& m : order) m = turn[static_cast<std::size_t>(m)];
  std::vector<double> W(order.size());
  weights_at(patch.basis, st, W);
  Point3 p(0.0);
  for (std::size_t m = 0; m < W.size(); ++m) p += W[m] * patch.points[static_cast<std::size_t>(order[m])];
  return p;
}

// The largest distance between the uses of an edge, at equal parameters; edges run from (0, 0) or toward (1, 1).
double largest_gap(const std::vector<PatchEntry>& patches, const PatchEdges& edges) {
  constexpr int kSteps = 8;
  std::map<int, std::vector<Point3>> first;
  double gap = 0;
  for (std::size_t p = 0; p < patches.size(); ++p)
    for (int k = 0; k < patches[p].patch.basis.sides; ++k)
      for (std::size_t side = 0; side < 4; ++side) {
        std::vector<Point3> points;
        for (int i = 0; i <= kSteps; ++i) {
          const double x = static_cast<double>(i) / kSteps;
          const Vec2 st[4] = {{x, 0}, {1, x}, {x, 1}, {0, x}};
          points.push_back(chart_point(patches[p].patch, k, st[side]));
        }
        const auto [at, is_new] = first.try_emplace(edges.of_chart[edges.first_chart[p] + static_cast<std::size_t>(k)][side], points);
        if (!is_new)
          for (std::size_t i = 0; i < points.size(); ++i) gap = std::max(gap, glm::length(points[i] - at->second[i]));
      }
  return gap;
}

TEST(NSidedPart, PrismsAreClosedAndTheirEdgesRunOneWay) {
  for (int n = 3; n <= kMostSides; ++n)
    for (const MeshPatches kind : {MeshPatches::gregory, MeshPatches::generalised_bezier, MeshPatches::charrot_gregory}) {
      const std::vector<PatchEntry> patches = patches_over(prism(n), kind);
      ASSERT_EQ(patches.size(), static_cast<std::size_t>(n + 2));
      const PatchEdges edges = edges_of_patches(patches);
      // 3 n sides, two halves each; a spoke for every side of every polygon.
      EXPECT_EQ(edges.edges.size(), static_cast<std::size_t>(6 * n + 6 * n)) << n;
      EXPECT_EQ(edges.of_chart.size(), static_cast<std::size_t>(6 * n)) << n;
      EXPECT_EQ(uses_of(edges), (std::map<int, int>{{2, 12 * n}})) << n;
      EXPECT_EQ(edges.solids, 1) << n;
      EXPECT_LE(largest_gap(patches, edges), 32 * kEps) << n;
    }
}

// Which patches a name stands for: the two polygons of a prism, and its squares.
TEST(NSidedPart, NamesStandForKindsAndSideParameters) {
  using enum PatchKind;
  using enum SideParameters;
  const std::map<std::string, std::pair<PatchBasis, PatchBasis>> truth{
      {"gregory", {{generalised_gregory, 5, 3, wachspress}, {gregory_quad, 4, 3, wachspress}}},
      {"generalised-bezier", {{generalised_bezier, 5, 3, wachspress}, {generalised_bezier, 4, 3, wachspress}}},
      {"charrot-gregory", {{PatchKind::charrot_gregory, 5, 3, wachspress}, {PatchKind::charrot_gregory, 4, 3, wachspress}}},
      {"gregory-mean-value", {{generalised_gregory, 5, 3, mean_value}, {gregory_quad, 4, 3, wachspress}}},
      {"generalised-bezier-mean-value", {{generalised_bezier, 5, 3, mean_value}, {generalised_bezier, 4, 3, mean_value}}},
      {"charrot-gregory-mean-value", {{PatchKind::charrot_gregory, 5, 3, mean_value}, {PatchKind::charrot_gregory, 4, 3, mean_value}}},
      {"charrot-gregory-distance", {{PatchKind::charrot_gregory, 5, 3, distance}, {PatchKind::charrot_gregory, 4, 3, distance}}},
  };
  ASSERT_EQ(truth.size(), kMeshPatchNames.size());
  for (std::size_t k = 0; k < kMeshPatchNames.size(); ++k) {
    const auto& [polygon, square] = truth.at(kMeshPatchNames[k]);
    const std::vector<PatchEntry> patches = patches_over(prism(5), static_cast<MeshPatches>(k));
    ASSERT_EQ(patches.size(), 7u);
    int polygons = 0, squares = 0;
    for (const PatchEntry& entry : patches) {
      polygons += entry.patch.basis == polygon;
      squares += entry.patch.basis == square;
    }
    EXPECT_EQ(polygons, 2) << kMeshPatchNames[k];
    EXPECT_EQ(squares, 5) << kMeshPatchNames[k];
  }
}

TEST(NSidedPart, SidesAreFoundByPlaceWithoutVertices) {
  for (const int n : {3, 5, 8}) {
    std::vector<PatchEntry> patches = patches_over(prism(n));
    const PatchEdges by_vertices = edges_of_patches(patches);
    for (PatchEntry& entry : patches) entry.corners.clear();
    const PatchEdges by_place = edges_of_patches(patches);
    EXPECT_EQ(by_place.edges.size(), by_vertices.edges.size());
    EXPECT_EQ(uses_of(by_place), uses_of(by_vertices));
    EXPECT_EQ(by_place.solids, 1);
    EXPECT_LE(largest_gap(patches, by_place), 32 * kEps);

    // The same, moved by less and by more than what counts as one place.
    for (const double share : {0.2, 5.0}) {
      std::vector<PatchEntry> moved = patches;
      for (Vec3& p : moved[0].patch.points) p.x += share * kSameSide * std::sqrt(12.0);
      EXPECT_EQ(edges_of_patches(moved).solids, share < 1 ? 1 : 0) << share;
    }
  }
}

TEST(NSidedPart, SidesOfDifferentDegreeAreOneWhereTheirCurvesAre) {
  // Two triangles over the diagonal of a square, one of degree 1, one of degree 3.
  PatchEntry low, high;
  low.patch = {{PatchKind::bezier_triangle, 3, 1, SideParameters::wachspress}, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {}};
  high.patch.basis = {PatchKind::bezier_triangle, 3, 3, SideParameters::wachspress};
  const Vec3 a(0, 0, 0), b(1, 1, 0), c(0, 1, 0);
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; i + j <= 3; ++j) high.patch.points.push_back((double(3 - i - j) * a + double(j) * b + double(i) * c) / 3.0);
  const PatchEdges edges = edges_of_patches({low, high});
  EXPECT_EQ(uses_of(edges), (std::map<int, int>{{1, 8}, {2, 2 + 6}}));
  EXPECT_EQ(edges.solids, 0);
  high.patch.points[1].z = 0.1;
  EXPECT_EQ(uses_of(edges_of_patches({low, high})), (std::map<int, int>{{1, 12}, {2, 6}}));
}

TEST(NSidedPart, AnEdgeOfThreePolygonsHasThreeUses) {
  ControlMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.polygons = {{{0, 1, 2}, {}, "line 1", {}}, {{1, 0, 3}, {}, "line 2", {}}, {{0, 1, 4}, {}, "line 3", {}}};
  const MeshOfPatches made = patches_of_mesh(mesh, MeshPatches::gregory);
  ASSERT_EQ(made.patches.size(), 3u);
  const PatchEdges edges = edges_of_patches(made.patches);
  EXPECT_EQ(uses_of(edges), (std::map<int, int>{{1, 12}, {2, 9}, {3, 2}}));
  EXPECT_EQ(edges.solids, 0);
  ASSERT_EQ(made.problems.size(), 1u);
  EXPECT_EQ(made.problems[0].what, "used by more than two polygons");
  EXPECT_LE(largest_gap(made.patches, edges), 32 * kEps);
}

TEST(NSidedPart, ASideThatIsAPointIsNoOnesNeighbour) {
  PatchEntry entry;
  entry.patch.basis = {PatchKind::gregory_quad, 4, 3, SideParameters::wachspress};
  const Vec3 corners[4] = {{0, 0, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int k = 0; k < 4; ++k) {
    const Vec3 next = corners[(k + 1) % 4], before = corners[(k + 3) % 4], own = corners[k];
    entry.patch.points.insert(entry.patch.points.end(), {own, own + (next - own) / 3.0, own + (before - own) / 3.0, own, own});
  }
  const PatchEdges edges = edges_of_patches({entry});
  int points = 0;
  for (const Edge& e : edges.edges) points += e.degenerate;
  EXPECT_EQ(points, 2);
  EXPECT_EQ(uses_of(edges), (std::map<int, int>{{1, 8}, {2, 4}}));
}

// ---- control meshes --------------------------------------------------------------------------------------------------------

TEST(ControlMesh, WhatCannotBeAPatchIsLeftOutAndReported) {
  ControlMesh mesh = prism(17);
  mesh.points.push_back({5, 0, 0});
  const int last = static_cast<int>(mesh.points.size()) - 1;
  mesh.polygons.push_back({{0, 1, 0}, {}, "line 30", {}});
  mesh.polygons.push_back({{0, 1}, {}, "line 31", {}});
  mesh.points.push_back({6, 0, 0});
  mesh.points.push_back({7, 0, 0});
  mesh.polygons.push_back({{last, last + 1, last + 2}, {}, "line 32", {}});
  const MeshOfPatches made = patches_of_mesh(mesh, MeshPatches::charrot_gregory);
  EXPECT_EQ(made.patches.size(), 17u);
  std::map<std::string, std::pair<std::string, int>> told;
  for (const Problem& p : made.problems) {
    EXPECT_EQ(p.kind, Problem::Kind::dropped) << p.what;
    told[p.what] = {p.entity, p.count};
  }
  EXPECT_EQ(told, (std::map<std::string, std::pair<std::string, int>>{{"polygons of more than 16 sides", {"line 1", 2}},
                                                                      {"polygons with a vertex twice", {"line 30", 1}},
                                                                      {"polygons of fewer than 3 sides", {"line 31", 1}},
                                                                      {"polygons without area", {"line 32", 1}}}));
}

// Two triangles that share an edge from the origin along y and are bent there by `bend`; their corners at the origin take up 150 and 30
// degrees, so that the mean of their normals all but follows the first.
ControlMesh sharp_hinge(double bend) {
  const Vec3 up{std::sin(bend), 0, std::cos(bend)}, along = glm::cross(up, Vec3(0, 1, 0));  // of the second
  ControlMesh mesh;
  mesh.points = {{0, 0, 0}, {0.5, -std::sqrt(0.75), 0}, {0, 1, 0}, std::sqrt(0.75) * Vec3(0, 1, 0) + 0.5 * along};
  mesh.polygons = {{{0, 1, 2}, {}, "line 1", {}}, {{0, 2, 3}, {}, "line 2", {}}};
  return mesh;
}

// Of a patch at its first corner, where the boundary curves leave it.
Vec3 normal_at_start(const PatchEntry& entry) {
  const std::vector<Vec3>& p = entry.patch.points;
  return glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
}

TEST(ControlMesh, ASharpVertexTakesTheNormalThatSeesAllCorners) {
  for (const double degrees : {20.0, 130.0}) {
    const double bend = degrees * kTwoPi / 360;
    const MeshOfPatches made = patches_of_mesh(sharp_hinge(bend), MeshPatches::gregory);
    ASSERT_EQ(made.patches.size(), 2u);
    const Vec3 a = normal_at_start(made.patches[0]), b = normal_at_start(made.patches[1]);
    EXPECT_LT(glm::length(a - b), 1e-12) << degrees << " degrees: one patch leaves the vertex turned over";
    const bool sharp = degrees > 90;
    EXPECT_EQ(made.problems.size(), sharp ? 1u : 0u) << degrees;
    // The middle of both normals, else nearer to the first.
    if (sharp) {
      EXPECT_LT(glm::length(a - Vec3(std::sin(bend / 2), 0, std::cos(bend / 2))), 1e-9);
      EXPECT_NE(made.problems.at(0).what.find("sees all corners"), std::string::npos);
    } else {
      EXPECT_GT(a.z, std::cos(bend / 4));
    }
  }
}

TEST(ControlMesh, NormalsOfTheFileCountWhereAllPolygonsAgree) {
  ControlMesh mesh = prism(6);
  const Vec3 given = glm::normalize(Vec3(1, 2, 3));
  for (ControlPolygon& polygon : mesh.polygons)
    for (const int corner : polygon.corners) polygon.normals.push_back(corner == 7 ? 5.0 * given : Vec3(polygon.corners[0] + 1.0, 1, 0));
  const MeshOfPatches made = patches_of_mesh(mesh, MeshPatches::gregory);
  ASSERT_EQ(made.problems.size(), 1u);
  EXPECT_EQ(made.problems[0].count, 11) << made.problems[0].what;
  int legs = 0;
  for (const PatchEntry& entry : made.patches)
    for (int side = 0; side < entry.patch.basis.sides; ++side) {
      const std::vector<int> points = points_of_side(entry.patch.basis, side);
      if (entry.corners[static_cast<std::size_t>(side)] != 7) continue;
      const Vec3 leg = entry.patch.points[static_cast<std::size_t>(points[3])] - entry.patch.points[static_cast<std::size_t>(points[2])];
      EXPECT_LE(std::abs(glm::dot(leg, given)), 8 * kEps);
      ++legs;
    }
  EXPECT_EQ(legs, 3);
}

}  // namespace
}  // namespace iso::test
