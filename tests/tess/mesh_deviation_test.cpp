// The meter of the benchmark of tessellators, against closed forms and against damage done on purpose.
#include "tests/bench/mesh_deviation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "patches/surface/surface.h"

namespace iso::test {
namespace {

constexpr double kRadius = 2;
constexpr std::uint32_t kAround = 48, kUp = 24;

// A sphere over an even grid of its parameters, as one face; the seam's and the poles' points are single.
PartMesh sphere_mesh(const AnySurface& sphere) {
  PartMesh mesh;
  const auto point_of = [](std::uint32_t i, std::uint32_t j) {
    return j == 0 ? 0 : j == kUp ? 1 + (kUp - 1) * kAround : 1 + (j - 1) * kAround + i % kAround;
  };
  mesh.points.resize(2 + (kUp - 1) * kAround);
  for (std::uint32_t j = 0; j <= kUp; ++j)
    for (std::uint32_t i = 0; i <= kAround; ++i) {
      const UV uv(kTwoPi * i / kAround, kPi * j / kUp - kPi / 2);
      const Point3 p = point(sphere, uv);
      mesh.points[point_of(i, j)] = p;
      mesh.nodes.push_back({point_of(i, j), uv, p / kRadius});
    }
  const auto node_of = [](std::uint32_t i, std::uint32_t j) { return j * (kAround + 1) + i; };
  for (std::uint32_t j = 0; j < kUp; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      if (j > 0) mesh.triangles.push_back({node_of(i, j), node_of(i + 1, j), node_of(i + 1, j + 1)});
      if (j + 1 < kUp) mesh.triangles.push_back({node_of(i, j), node_of(i + 1, j + 1), node_of(i, j + 1)});
    }
  mesh.first_node.push_back(static_cast<std::uint32_t>(mesh.nodes.size()));
  mesh.first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
  return mesh;
}

struct MeshDeviationTest : testing::Test {
  AnySurface sphere = [] {
    Sphere s;
    s.r = kRadius;
    return AnySurface(s);
  }();
  PartMesh mesh = sphere_mesh(sphere);
  bench::MeasuredSurfaces surfaces{[this](int, const UV& uv) { return point(sphere, uv); }, {false}};
  bench::MeshDeviation measured() const { return bench::mesh_deviation(mesh, surfaces, {}); }
};

// The deepest place of a triangle on a sphere is below the centre of its circumscribed circle, or of a longest side outside which that
// lies.
double deepest(const PartMesh& mesh) {
  double most = 0;
  for (const Triangle& t : mesh.triangles) {
    const Point3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const double x = glm::length(b - c), y = glm::length(c - a), z = glm::length(a - b), long_side = std::max({x, y, z});
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    const bool blunt = x * x + y * y + z * z <= 2 * long_side * long_side;
    const double circle = blunt ? 0.5 * long_side : x * y * z / (4 * area);
    most = std::max(most, kRadius - std::sqrt(kRadius * kRadius - circle * circle));
  }
  return most;
}

TEST_F(MeshDeviationTest, AgreesWithTheClosedFormOfASphere) {
  const bench::MeshDeviation found = measured();
  EXPECT_EQ(found.triangles, 2 * kAround * (kUp - 1));
  EXPECT_EQ(found.samples, found.triangles * bench::kSamplesPerTriangle);
  const double truth = deepest(mesh);
  EXPECT_LE(found.max, truth * (1 + 1e-12));
  EXPECT_GE(found.max, truth * 0.95);
  EXPECT_LE(found.p999, found.max * (1 + 1e-6));
  const bench::MeshQuality quality = bench::mesh_quality(mesh);
  EXPECT_TRUE(quality.topology.closed());
  EXPECT_EQ(quality.folded, 0u);
  EXPECT_EQ(quality.shapes.slivers, 0u);
}

TEST_F(MeshDeviationTest, SeesAMovedPoint) {
  constexpr double kMoved = 0.1;
  const std::uint32_t point = mesh.nodes[mesh.triangles[mesh.triangles.size() / 2][0]].point;
  mesh.points[point] *= 1 + kMoved / kRadius;
  const bench::MeshDeviation found = measured();
  EXPECT_GT(found.max, 0.5 * kMoved);
  EXPECT_LT(found.max, kMoved);
  EXPECT_EQ(found.worst_face, 0);
}

TEST_F(MeshDeviationTest, SeesATriangleThatIsTooWide) {
  const double before = measured().max;
  Triangle& wide = mesh.triangles[mesh.triangles.size() / 2];
  *std::max_element(wide.begin(), wide.end()) += 3;
  EXPECT_GT(measured().max, 2 * before);
}

// No surface is sampled where there is no triangle.
TEST_F(MeshDeviationTest, ADroppedTriangleShowsAsOpenEdges) {
  mesh.triangles.pop_back();
  --mesh.first_triangle.back();
  EXPECT_EQ(bench::mesh_quality(mesh).topology.open_edges.count, 3u);
}

TEST_F(MeshDeviationTest, NearestPointIsThatOfTheWholeMesh) {
  // The surface runs ahead of its parameters by half a square, so that most samples lie over other triangles than their own.
  const double before = measured().max;
  const double ahead = kPi / kAround;
  surfaces.point = [this, ahead](int, const UV& uv) { return point(sphere, uv + UV(ahead, 0)); };
  const bench::MeshDeviation found = measured();
  EXPECT_LE(found.max, deepest(mesh) * (1 + 1e-12));
  EXPECT_GE(found.max, 0.9 * before);
}

TEST_F(MeshDeviationTest, CountsATurnedTriangle) {
  std::swap(mesh.triangles[100][0], mesh.triangles[100][1]);
  const bench::MeshQuality quality = bench::mesh_quality(mesh);
  EXPECT_EQ(quality.folded, 1u);
  EXPECT_EQ(quality.topology.misoriented_edges.count, 3u);
}

}  // namespace
}  // namespace iso::test
