// The verifier itself: a good mesh has no findings, and each kind of damage is found, or its silence means nothing.
#include "tess/verify.h"

#include <gtest/gtest.h>

#include <random>

#include "tess/box_tree.h"
#include "tess/domain_overlap.h"
#include "tests/support/grid_cube.h"

namespace iso::test {
namespace {

constexpr int kGrid = 4;
constexpr std::uint32_t kPerFace = 2 * kGrid * kGrid;

MeshReport report_of(const GridCube& cube) { return verify(cube.part, cube.mesh); }

// The node of face f at grid place (i, j).
std::uint32_t node(const GridCube& cube, std::size_t f, int i, int j) {
  return cube.mesh.first_node[f] + static_cast<std::uint32_t>(j * (kGrid + 1) + i);
}
// Removes a triangle of face f.
void remove_triangle(GridCube& cube, std::uint32_t t) {
  cube.mesh.triangles.erase(cube.mesh.triangles.begin() + t);
  for (std::uint32_t& first : cube.mesh.first_triangle) first -= first > t;
}
void add_triangle(GridCube& cube, std::size_t f, const Triangle& t) {
  cube.mesh.triangles.insert(cube.mesh.triangles.begin() + cube.mesh.first_triangle[f + 1], t);
  for (std::size_t k = f + 1; k < cube.mesh.first_triangle.size(); ++k) ++cube.mesh.first_triangle[k];
}
// Empties face f of triangles and nodes, as if the mesher had failed on it; or takes it out of the part as well.
void remove_mesh_of_face(GridCube& cube, std::size_t f) {
  const std::uint32_t begin = cube.mesh.first_triangle[f], end = cube.mesh.first_triangle[f + 1];
  cube.mesh.triangles.erase(cube.mesh.triangles.begin() + begin, cube.mesh.triangles.begin() + end);
  for (std::size_t k = f + 1; k < cube.mesh.first_triangle.size(); ++k) cube.mesh.first_triangle[k] -= end - begin;
}
void remove_last_face(GridCube& cube) {
  remove_mesh_of_face(cube, 5);
  cube.mesh.nodes.resize(cube.mesh.first_node[5]);
  cube.mesh.first_node.pop_back();
  cube.mesh.first_triangle.pop_back();
  for (const TrimLoop& loop : cube.part.faces[5].loops)
    for (const TrimCurve& trim : loop.curves) --cube.part.edges[static_cast<std::size_t>(trim.edge)].uses;
  cube.part.faces.pop_back();
}

// Counts of all kinds, so that a test can say which ones it expects and that there are no others.
std::map<std::string, std::uint64_t> counts(const MeshReport& r) {
  const TopologyReport& t = r.topology;
  std::map<std::string, std::uint64_t> all{{"free", r.free_edges.count},
                                           {"cracks", r.cracks.count},
                                           {"folded", r.folded.count},
                                           {"turned", r.turned.count},
                                           {"overlapping", r.overlapping.count},
                                           {"empty", r.empty_faces.count},
                                           {"non-manifold edges", t.non_manifold_edges.count},
                                           {"misoriented", t.misoriented_edges.count},
                                           {"non-manifold points", t.non_manifold_points.count},
                                           {"no area", t.zero_area.count},
                                           {"duplicates", t.duplicates.count},
                                           {"isolated", t.isolated_points.count},
                                           {"t-junctions", t.t_junctions.count}};
  std::erase_if(all, [](const auto& entry) { return entry.second == 0; });
  return all;
}
using Counts = std::map<std::string, std::uint64_t>;

TEST(Verify, ACleanMeshHasNoFindings) {
  const GridCube cube(kGrid);
  const MeshReport r = report_of(cube);
  EXPECT_EQ(counts(r), Counts{});
  EXPECT_TRUE(r.sound());
  EXPECT_TRUE(r.topology.closed());
  EXPECT_EQ(r.topology.triangles, 6 * kPerFace);
  EXPECT_EQ(r.topology.points - r.topology.edges + r.topology.triangles, 2u) << "Euler";
  EXPECT_NEAR(r.shapes.smallest_angle, 45, 1e-9);
  EXPECT_EQ(r.shapes.slivers, 0u);
  EXPECT_EQ(r.shapes_of_face.size(), 6u);
  EXPECT_NE(text_of(r).find("\nsound\n"), std::string::npos) << text_of(r);
}

TEST(Verify, AMissingFaceLeavesCracksWhereTheModelIsClosed) {
  GridCube cube(kGrid);
  remove_mesh_of_face(cube, 3);
  const MeshReport r = report_of(cube);
  EXPECT_EQ(counts(r), (Counts{{"empty", 1}, {"cracks", 4 * kGrid}, {"isolated", (kGrid - 1) * (kGrid - 1)}}));
  EXPECT_EQ(r.empty_faces.places[0].face, 3);
  EXPECT_EQ(r.cracks.places.size(), Finding::kPlaces);
  EXPECT_FALSE(r.sound());
}

TEST(Verify, AnOpenModelHasFreeEdgesAndIsSound) {
  GridCube cube(kGrid);
  remove_last_face(cube);
  const MeshReport r = report_of(cube);
  EXPECT_EQ(counts(r), (Counts{{"free", 4 * kGrid}, {"isolated", (kGrid - 1) * (kGrid - 1)}})) << text_of(r);
  EXPECT_TRUE(r.sound());
  EXPECT_FALSE(r.topology.closed());
}

TEST(Verify, AnEarCutOffAFreeBorderIsACrack) {
  GridCube cube(kGrid);
  remove_last_face(cube);

  // In a face beside the hole, a triangle with two nodes on the free border.
  std::int64_t ear = -1;
  for (const MeshPlace& place : report_of(cube).free_edges.places) ear = place.triangle;
  ASSERT_GE(ear, 0);
  remove_triangle(cube, static_cast<std::uint32_t>(ear));
  const Counts found = counts(report_of(cube));
  EXPECT_EQ(found.at("free"), 4 * kGrid - 1u);
  EXPECT_EQ(found.at("cracks"), 2u);
}

TEST(Verify, UntrimmedFacesAreFreeAtTheSidesOfTheirDomain) {
  GridCube cube(kGrid);
  for (Face& face : cube.part.faces) face.loops.clear();
  EXPECT_EQ(counts(report_of(cube)), Counts{});
  remove_mesh_of_face(cube, 0);
  EXPECT_EQ(counts(report_of(cube)).at("free"), 4u * kGrid);
}

TEST(Verify, FreeBordersAreFoundOnCurvedTrims) {
  // A disc of triangles about a centre, trimmed by a circle that starts at half past.
  constexpr int kCorners = 17;
  Part part;
  part.edges.push_back({1, false, 0, 0, 0});
  Face face;
  face.surface = Plane{};
  face.domain = {Vec2(-1), Vec2(1)};
  face.loops.push_back({{{Ellipse<Vec2>{Vec2(0), Vec2(0.7, 0.1), Vec2(-0.1, 0.9)}, 0, kTwoPi, 0}}});
  part.faces.push_back(face);
  PartMesh mesh;
  for (int i = 0; i <= kCorners; ++i) {
    const double a = kTwoPi * i / kCorners;
    const UV uv = i == kCorners ? UV(0.0) : std::cos(a) * UV(0.7, 0.1) + std::sin(a) * UV(-0.1, 0.9);
    mesh.points.emplace_back(uv, 0);
    mesh.nodes.push_back({static_cast<std::uint32_t>(i), uv, Vec3(0, 0, 1)});
    if (i < kCorners) mesh.triangles.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>((i + 1) % kCorners), kCorners});
  }
  mesh.first_node.push_back(kCorners + 1);
  mesh.first_triangle.push_back(kCorners);
  EXPECT_EQ(counts(verify(part, mesh)), (Counts{{"free", kCorners}})) << text_of(verify(part, mesh));

  // Away from the curve by a millionth: no longer on it, and so a crack on both sides.
  mesh.nodes[5].uv *= 1 - 1e-6;
  EXPECT_EQ(counts(verify(part, mesh)), (Counts{{"free", kCorners - 2}, {"cracks", 2}}));
}

TEST(Verify, AMissingTriangleIsACrackOfThreeEdges) {
  GridCube cube(kGrid);
  remove_triangle(cube, kPerFace + 9);
  EXPECT_EQ(counts(report_of(cube)), (Counts{{"cracks", 3}}));
}

TEST(Verify, AReversedTriangleIsMisorientedFoldedTurned) {
  GridCube cube(kGrid);
  std::swap(cube.mesh.triangles[40][0], cube.mesh.triangles[40][1]);
  const MeshReport r = report_of(cube);
  EXPECT_EQ(counts(r), (Counts{{"misoriented", 3}, {"folded", 1}, {"turned", 1}}));
  EXPECT_EQ(r.folded.places[0].triangle, 40);
  EXPECT_EQ(r.folded.places[0].face, 1);
  EXPECT_EQ(r.topology.misoriented_edges.places[0].face, 1);
}

TEST(Verify, ADoubledTriangleIsADuplicateOverlapsAndHasEdgesOfThree) {
  GridCube cube(kGrid);
  add_triangle(cube, 2, cube.mesh.triangles[2 * kPerFace + 12]);
  EXPECT_EQ(counts(report_of(cube)), (Counts{{"duplicates", 1}, {"non-manifold edges", 3}, {"overlapping", 1}}));
}

TEST(Verify, ACollapsedTriangleHasNoArea) {
  // A point twice: nothing else is wrong with it but its place in (u, v).
  GridCube cube(kGrid);
  add_triangle(cube, 0, {node(cube, 0, 1, 1), node(cube, 0, 1, 1), node(cube, 0, 2, 1)});
  EXPECT_EQ(counts(report_of(cube)), (Counts{{"no area", 1}, {"turned", 1}}));

  // Three points on a line, far from the origin: without area although rounding gives it some.
  const Vec3 d(0.1, 0.7, 0.3);
  const std::vector<Point3> points{Vec3(1e6) + 0.1 * d, Vec3(1e6) + 0.3 * d, Vec3(1e6) + 0.7 * d, Vec3(1e6) + Vec3(0, 0, 1e-6)};
  EXPECT_NE(glm::cross(points[1] - points[0], points[2] - points[0]), Vec3(0.0));
  EXPECT_TRUE(has_no_area(points[0], points[1], points[2]));
  EXPECT_FALSE(has_no_area(points[0], points[1], points[3]));
}

TEST(Verify, ABowTieIsANonManifoldPoint) {
  // Two tetrahedra that share a point.
  const std::vector<Point3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  std::vector<PointTriangle> triangles{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_EQ(check_topology(points, triangles).isolated_points.count, 3u);
  for (const PointTriangle& t : {PointTriangle{0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}}) triangles.push_back(t);
  const TopologyReport r = check_topology(points, triangles);
  EXPECT_EQ(r.non_manifold_points.count, 1u);
  EXPECT_EQ(r.non_manifold_points.places[0].at, Point3(0.0));
  EXPECT_EQ(r.open_edges.count + r.non_manifold_edges.count + r.misoriented_edges.count + r.isolated_points.count, 0u);
  EXPECT_FALSE(r.sound());
}

TEST(Verify, ATJunctionIsFoundWithinTheDistanceAskedFor) {
  // One triangle on a long edge against two on its halves; the middle point lies `off` beside it.
  const auto junctions = [](double off, double distance) {
    const std::vector<Point3> points{{0, 0, 0}, {1, 0.5, 0}, {0, 1, 0}, {0.5 + 0.5 * off, 0.25 - off, 0}, {1, -1, 0}};
    const std::vector<PointTriangle> triangles{{0, 1, 2}, {0, 4, 3}, {3, 4, 1}};
    TopologyOptions options;
    options.t_junction_distance = distance;
    const TopologyReport r = check_topology(points, triangles, options);
    EXPECT_EQ(r.open_edges.count, 7u);
    for (const MeshPlace& place : r.t_junctions.places) EXPECT_EQ(place.at, points[3]);
    return r.t_junctions.count;
  };
  EXPECT_EQ(junctions(0, 0), 1u);
  EXPECT_EQ(junctions(1e-6, 0), 0u);
  EXPECT_EQ(junctions(1e-6, 1e-5), 1u);
  EXPECT_EQ(junctions(1e-4, 1e-5), 0u);
}

TEST(Verify, AFoldIsFoundInSpaceAndAnOverlapInTheDomain) {
  // An inner node pulled over its neighbour, in both.
  GridCube cube(kGrid);
  MeshNode& moved = cube.mesh.nodes[node(cube, 1, 2, 2)];
  const double step = 10.0 / 3 / kGrid;
  moved.uv.x += 1.5 * step;
  const auto* plane = std::get_if<Plane>(&cube.part.faces[1].surface);
  cube.mesh.points[moved.point] += 1.5 * step * plane->frame.X;
  const MeshReport r = report_of(cube);
  EXPECT_GT(r.folded.count, 0u);
  EXPECT_EQ(r.folded.count, r.turned.count);
  EXPECT_GT(r.overlapping.count, 0u);
  EXPECT_EQ(r.overlapping.places[0].face, 1);
  EXPECT_TRUE(r.topology.sound()) << "the topology does not see it";
}

TEST(Verify, OnlyOverlapsOfInteriorsCount) {
  using T = std::array<UV, 3>;
  const T base{UV(0, 0), UV(1, 0), UV(0, 1)};
  const struct {
    T other;
    std::size_t pairs;
  } cases[] = {
      {{UV(1, 0), UV(1, 1), UV(0, 1)}, 0},                   // a side in common
      {{UV(0.5, 0.5), UV(1, 1), UV(0.2, 2)}, 0},             // a corner on the side
      {{UV(1, 0), UV(2, 0), UV(2, 1)}, 0},                   // a corner in common
      {{UV(0.1, 0.1), UV(0.2, 0.1), UV(0.1, 0.2)}, 1},       // inside
      {{UV(-1, -1), UV(5, -1), UV(-1, 5)}, 1},               // around
      {{UV(0.5, 0.5 - 1e-16), UV(1, 1), UV(0, 1)}, 1},       // by the last bit
      {{UV(-1, 0.2), UV(2, 0.2), UV(2, 0.3)}, 1},            // across, no corner inside
      {{UV(0.25, 0.25), UV(0.25, 0.25), UV(0.5, 0.25)}, 0},  // without area
  };
  for (const auto& c : cases)
    for (const bool swapped : {false, true}) {
      const std::vector<T> both = swapped ? std::vector<T>{c.other, base} : std::vector<T>{base, c.other};
      EXPECT_EQ(domain_overlap(both, 1).overlapping.size(), c.pairs) << c.other[0].x << " " << c.other[0].y;
    }
  EXPECT_EQ(domain_overlap(std::vector<T>{base}, -1).turned.size(), 1u);
}

TEST(Verify, SliversAreCounted) {
  GridCube cube(1);
  cube.mesh.points[cube.mesh.nodes[0].point] += Vec3(0, 0, 10.0 / 3 * 0.99);
  const MeshReport r = report_of(cube);
  EXPECT_GT(r.shapes.slivers, 0u);
  EXPECT_LT(r.shapes.smallest_angle, 1);
  EXPECT_GT(r.shapes.sliver_share(), 0);
}

TEST(Verify, ASoupIsClosedOnceEqualPlacesAreJoined) {
  const GridCube cube(kGrid);
  std::vector<Point3> points;
  std::vector<PointTriangle> triangles;
  for (const Triangle& t : cube.mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (int k = 0; k < 3; ++k) points.push_back(cube.mesh.corner(t, k));
    triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(check_topology(points, triangles).open_edges.count, points.size());
  const std::vector<std::uint32_t> joined = joined_points(points);
  for (PointTriangle& t : triangles)
    for (std::uint32_t& p : t) p = joined[p];
  const TopologyReport r = check_topology(points, triangles);
  EXPECT_TRUE(r.closed()) << text_of(r);
  EXPECT_EQ(r.isolated_points.count, points.size() - cube.mesh.points.size());
}

TEST(Verify, TheBoxTreeFindsWhatALoopFinds) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(0, 1), size(0, 0.2);
  std::vector<Box3> boxes;
  for (int i = 0; i < 500; ++i) {
    const Vec3 lo(place(random), place(random), place(random));
    boxes.push_back({lo, lo + Vec3(size(random), size(random), size(random))});
  }
  const BoxTree<Vec3> tree(boxes);
  std::size_t met = 0;
  for (const Box3& query : boxes) {
    std::vector<std::uint32_t> found, expected;
    tree.for_each_touching(query, [&](std::uint32_t i) { found.push_back(i); });
    std::sort(found.begin(), found.end());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const Vec3 gap = glm::max(boxes[i].lo - query.hi, query.lo - boxes[i].hi);
      if (std::max({gap.x, gap.y, gap.z}) <= 0) expected.push_back(i);
    }
    ASSERT_EQ(found, expected);
    met += found.size();
  }
  EXPECT_GT(met, 2 * boxes.size());
}

}  // namespace
}  // namespace iso::test
