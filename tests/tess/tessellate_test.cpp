// Meshes of shapes whose truth is a formula: where their points lie, how far their triangles are, how many there are.
#include "tess/tessellate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <bit>

#include "tess/verify.h"
#include "tests/support/mesh_distance.h"
#include "tests/support/solid_parts.h"
#include "tests/support/tessellation_check.h"

namespace iso::test {
namespace {

const Frame kSkew{{0.3, -0.2, 0.7}, {0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}};

// Calls see(p) with the points of a fine grid on a triangle, corners and sides included.
template <class See>
void over_triangle(const PartMesh& mesh, const Triangle& t, int n, const See& see) {
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      see((double(i) * mesh.corner(t, 0) + double(j) * mesh.corner(t, 1) + double(n - i - j) * mesh.corner(t, 2)) / double(n));
}

double deviation(const PartMesh& mesh, std::size_t face, const std::function<double(const Point3&)>& distance) {
  constexpr int kGrid = 12;
  double worst = 0;
  for (std::uint32_t t = mesh.first_triangle[face]; t < mesh.first_triangle[face + 1]; ++t)
    over_triangle(mesh, mesh.triangles[t], kGrid, [&](const Point3& p) { worst = std::max(worst, distance(p)); });
  return worst;
}

// How far rounding moves a point.
constexpr double kRounding = 16 * kEps;

const std::vector<MakeSolid> kAnalytic{solid_cylinder, solid_cone, solid_sphere, solid_torus, solid_box};

TEST(Tessellate, PointsLieOnTheSurfaceAndTrianglesWithinTheBound) {
  std::size_t checked = 0;
  for (const MakeSolid make : kAnalytic)
    for (const double share : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
      const SolidPart s = finished(make(kSkew, 2));
      if (share < 1e-4 && (make == solid_sphere || make == solid_torus)) continue;  // millions of triangles
      const double tolerance = share * s.size;
      const PartTessellation made = tessellated(s, tolerance);
      for (std::size_t f = 0; f < s.part.faces.size(); ++f) {
        for (std::uint32_t n = made.mesh.first_node[f]; n < made.mesh.first_node[f + 1]; ++n, ++checked)
          ASSERT_LE(s.distance[f](made.mesh.points[made.mesh.nodes[n].point]), kRounding * s.size) << s.name << " " << share;
        const double worst = deviation(made.mesh, f, s.distance[f]);
        EXPECT_LE(worst, made.faces[f].bound + kRounding * s.size) << s.name << " face " << f << " at " << share;
        EXPECT_LE(made.faces[f].bound, tolerance) << s.name << " face " << f << " at " << share;
      }
    }
  EXPECT_GT(checked, 50000u);
}

// Points of a part's circle around the frame's axis at height z.
int points_at_height(const SolidPart& s, const PartMesh& mesh, std::size_t plane) {
  int n = 0;
  for (const Point3& p : mesh.points) n += s.distance[plane](p) <= kRounding * s.size && s.distance[0](p) <= kRounding * s.size;
  return n;
}

TEST(Tessellate, ACircleTakesAsManySegmentsAsItsSagittaAsksFor) {
  constexpr double kOfEdges = 0.8;  // edges may use this share of the tolerance
  constexpr double kMore = 1.2;     // what the proof adds to the sagitta, and steps: measured 1.19
  constexpr int kSteps = 3;         // a closed edge is cut in three at first
  for (const MakeSolid make : {solid_cylinder, solid_cone})
    for (const double share : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
      const SolidPart s = finished(make(kSkew, 2));
      const double tolerance = share * s.size, r = 0.5 * s.size;
      const PartTessellation made = tessellate(s.part, {tolerance});
      const int found = points_at_height(s, made.mesh, 1);
      EXPECT_GE(found, std::ceil(kPi / std::acos(1 - tolerance / r))) << s.name << " " << share;
      EXPECT_LE(found, kMore * kPi / std::acos(1 - kOfEdges * tolerance / r) + kSteps) << s.name << " " << share;
    }
}

TEST(Tessellate, ACylinderIsNotSplitAlongItsAxis) {
  for (const double share : {1e-1, 1e-2, 1e-3}) {
    const SolidPart s = finished(solid_cylinder(kSkew, 2));
    const PartTessellation made = tessellate(s.part, {share * s.size});
    const int below = points_at_height(s, made.mesh, 1), above = points_at_height(s, made.mesh, 2);
    EXPECT_EQ(static_cast<std::size_t>(below + above), made.mesh.points.size()) << share;
    EXPECT_EQ(made.faces[0].triangles, below + above) << share;
  }
}

TEST(Tessellate, ABoxTakesTwelveTriangles) {
  const SolidPart s = finished(solid_box(kSkew, 2));
  EXPECT_EQ(tessellated(s, 1e-3).mesh.triangles.size(), 12u);
}

// A polynomial patch over the unit square from its Bezier heights.
SolidPart graph(std::string name, int degree, const std::vector<double>& heights, std::function<double(const Point3&)> distance) {
  NurbsSurface s;
  s.degree_u = s.degree_v = degree;
  s.count_u = s.count_v = degree + 1;
  s.knots_u.assign(static_cast<std::size_t>(degree) + 1, 0.0);
  s.knots_u.insert(s.knots_u.end(), static_cast<std::size_t>(degree) + 1, 1.0);
  s.knots_v = s.knots_u;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j <= degree; ++j)
      s.poles.emplace_back(double(i) / degree, double(j) / degree, heights[static_cast<std::size_t>(i * (degree + 1) + j)], 1.0);
  return finished(untrimmed(std::move(name), s, {Vec2(0), Vec2(1)}, 1, std::move(distance)));
}

// The distance from z = f(x, y) is less than the height over it, and near it where it is small.
template <class F>
std::function<double(const Point3&)> over_graph(const F& f) {
  return [f](const Point3& p) {
    constexpr double h = 1e-6;
    const double fx = (f(p.x + h, p.y) - f(p.x - h, p.y)) / (2 * h), fy = (f(p.x, p.y + h) - f(p.x, p.y - h)) / (2 * h);
    return std::abs(p.z - f(p.x, p.y)) / std::sqrt(1 + fx * fx + fy * fy);
  };
}

TEST(Tessellate, TheBoundIsAttainedOnSaddlesAndParaboloids) {
  constexpr double kAttained = 0.7;
  const SolidPart saddle = graph("saddle", 1, {0, 0, 0, 1}, over_graph([](double x, double y) { return x * y; }));
  const SolidPart bowl = graph("paraboloid", 2, {0, 0, 1, 0, 0, 1, 1, 1, 2}, over_graph([](double x, double y) { return x * x + y * y; }));
  for (const SolidPart* s : {&saddle, &bowl})
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
      const PartTessellation made = tessellated(*s, tolerance);
      const double worst = deviation(made.mesh, 0, s->distance[0]), slack = 10 * tolerance * tolerance;  // of over_graph
      EXPECT_LE(worst, made.faces[0].bound + slack) << s->name << " " << tolerance;
      EXPECT_GE(worst, kAttained * made.faces[0].bound) << s->name << " " << tolerance;
    }
}

TEST(Tessellate, TrianglesDoubleWhenTheToleranceHalves) {
  // Grids have whole numbers of rows, so that a step may take more or less than its share, but not all of them together.
  constexpr double kLeast = 1.6, kMost = 2.6, kFollows = 0.5, kLeastInAll = 22, kMostInAll = 45;
  for (const MakeSolid make : {solid_torus, solid_sphere, solid_bicubic}) {
    const SolidPart s = finished(make(kSkew, 2));
    double before = 0, first = 0;
    for (int i = 0; i <= 5; ++i) {
      const double tolerance = 4e-3 * s.size / (1 << i);
      const PartTessellation made = tessellated(s, tolerance);
      const auto count = static_cast<double>(made.mesh.triangles.size());
      if (before > 0) {
        EXPECT_TRUE(count >= kLeast * before && count <= kMost * before) << s.name << " " << i << ": " << count / before;
      }
      if (i == 0) first = count;
      before = count;
      Random random(7);
      const DistanceSearch found = search_distances(s.part, made.mesh, {tolerance}, 2000, random);
      EXPECT_TRUE(found.worst_share > kFollows && found.worst_share <= 1) << s.name << " " << i << ": " << found.worst_share;
    }
    EXPECT_TRUE(before >= kLeastInAll * first && before <= kMostInAll * first) << s.name << ": " << before / first;
  }
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same_mesh(const PartMesh& a, const PartMesh& b) {
  bool same = a.points.size() == b.points.size() && a.nodes.size() == b.nodes.size() && a.triangles == b.triangles &&
              a.first_node == b.first_node && a.first_triangle == b.first_triangle;
  for (std::size_t i = 0; same && i < a.points.size(); ++i)
    for (int k = 0; k < 3; ++k) same = same && same_bits(a.points[i][k], b.points[i][k]);
  for (std::size_t i = 0; same && i < a.nodes.size(); ++i)
    same = a.nodes[i].point == b.nodes[i].point && a.nodes[i].uv == b.nodes[i].uv && a.nodes[i].normal == b.nodes[i].normal;
  return same;
}

TEST(Tessellate, OneAndTwoThreadsMakeTheSameMesh) {
  const auto with = [](int threads, const Part& part, double tolerance) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    return tessellate(part, {tolerance}).mesh;
  };
  for (const MakeSolid make : kSolids) {
    const SolidPart s = finished(make(kSkew, 2));
    EXPECT_TRUE(same_mesh(with(1, s.part, 2e-3), with(2, s.part, 2e-3))) << s.name;
  }
}

std::string counts_of(const PartMesh& m) {
  return fmt::format("{} points, {} nodes, {} triangles", m.points.size(), m.nodes.size(), m.triangles.size());
}

TEST(Tessellate, PlacesAndSizesDoNotMatter) {
  const Frame straight_up;
  const Frame mirror{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, far{{3e6, -2e6, 1e6}, kSkew.X, kSkew.Y, kSkew.Z};
  const struct {
    const char* name;
    Frame frame;
    double scale;
  } cases[] = {
      {"turned", kSkew, 1}, {"larger", straight_up, 1e3}, {"smaller", straight_up, 1e-3}, {"mirrored", mirror, 1}, {"far", far, 1}};
  constexpr double kShare = 1e-3, kSize = 2, kWithin = 0.02;
  for (const MakeSolid make : kSolids) {
    const SolidPart plain = finished(make(straight_up, kSize));
    const PartTessellation expected = tessellated(plain, kShare * kSize);
    for (const auto& c : cases) {
      const SolidPart s = finished(make(c.frame, c.scale * kSize));
      const PartTessellation made = tessellated(s, kShare * kSize * c.scale);
      EXPECT_EQ(counts_of(made.mesh), counts_of(expected.mesh)) << plain.name << " " << c.name;
      for (std::size_t f = 0; f < made.faces.size(); ++f)
        EXPECT_NEAR(made.faces[f].bound / c.scale, expected.faces[f].bound, kWithin * kShare * kSize) << plain.name << " " << c.name;
    }
  }
}

TEST(Tessellate, ReversedFacesAreTheSameTrianglesTurned) {
  for (const MakeSolid make : kSolids) {
    SolidPart s = finished(make(kSkew, 2));
    const PartTessellation plain = tessellate(s.part, {2e-3});
    for (Face& face : s.part.faces) face.reversed = !face.reversed;
    const PartTessellation turned = tessellated(s, 2e-3);
    ASSERT_EQ(counts_of(turned.mesh), counts_of(plain.mesh)) << s.name;
    for (std::size_t t = 0; t < plain.mesh.triangles.size(); ++t) {
      const Triangle &a = plain.mesh.triangles[t], &b = turned.mesh.triangles[t];
      EXPECT_EQ(a, (Triangle{b[0], b[2], b[1]})) << s.name;
    }
  }
}

}  // namespace
}  // namespace iso::test
