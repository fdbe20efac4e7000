// Constraints: chains that stay, refusals that change nothing, and what loops enclose.
#include "tests/support/cgal_oracle.h"
#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"
#include "tests/support/triangulation_checks.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20241004;
const Box2 kUnit{{0, 0}, {1, 1}};
using Segment = std::array<Vertex, 2>;

// A triangulation and the segments that it accepted.
struct Drawing {
  Triangulation all;
  std::vector<Segment> segments{};

  bool draw(Vertex a, Vertex b) {
    if (all.constrain(a, b)) return false;
    segments.push_back({a, b});
    return true;
  }
  std::vector<Vertex> insert(const std::vector<Vec2>& points) {
    std::vector<Vertex> vertices;
    for (const Vec2& p : points) vertices.push_back(all.insert(p));
    return vertices;
  }
  void draw_loop(const std::vector<Vec2>& points) {
    const auto v = insert(points);
    for (std::size_t i = 0; i < v.size(); ++i) EXPECT_TRUE(draw(v[i], v[(i + 1) % v.size()]));
  }
  std::string wrong(Delaunay delaunay) const {
    std::string text = unsound(all);
    if (text.empty()) text = not_constrained(all, segments);
    return text.empty() ? not_delaunay(all, delaunay) : text;
  }
};

std::vector<Vec2> circle(const Vec2& centre, double radius, int corners, double phase = 0) {
  std::vector<Vec2> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = phase + kTwoPi * i / corners;
    points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return points;
}

double area_of(const std::vector<Vec2>& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * std::abs(twice);
}

TEST(TriangulationConstrain, RandomSegmentsGiveCgalsTriangulation) {
  Random random(kSeed);
  Tally tally("random segments against CGAL", kSeed);
  int drawn = 0, refused = 0;
  for (int round = 0; round < 30; ++round) {
    Drawing d{Triangulation(kUnit)};
    const int points = 50 + 20 * round;
    for (int i = 0; i < points; ++i) d.all.insert(point_in(random, kUnit));
    for (int i = 0; i < points / 4; ++i) {
      const Vertex a = static_cast<Vertex>(whole(random, 4, points + 3)), b = static_cast<Vertex>(whole(random, 4, points + 3));
      if (a != b) ++(d.draw(a, b) ? drawn : refused);
    }
    for (int i = 0; i < points / 2; ++i) d.all.insert(point_in(random, kUnit));
    tally.check(d.wrong(Delaunay::Exactly).empty(), [&] { return d.wrong(Delaunay::Exactly); });
    tally.check(edges_of(d.all) == cgal_triangulation(d.all.points(), d.segments), [&] { return fmt::format("round {}", round); });
  }
  tally.finish(60);
  EXPECT_GT(drawn, 200);
  EXPECT_GT(refused, 200);
}

TEST(TriangulationConstrain, GridsWithManySegmentsThroughVertices) {
  Random random(kSeed);
  Tally tally("segments on grids", kSeed);
  for (int round = 0; round < 20; ++round) {
    Drawing d{Triangulation({{0, 0}, {12, 12}})};
    for (int i = 0; i < 169; ++i) d.all.insert({i % 13, i / 13});
    for (int i = 0; i < 60; ++i) d.draw(static_cast<Vertex>(whole(random, 4, 172)), static_cast<Vertex>(whole(random, 4, 172)));
    tally.check(d.wrong(Delaunay::Exactly).empty(), [&] { return d.wrong(Delaunay::Exactly); });
  }
  tally.finish(20);
}

TEST(TriangulationConstrain, PointsOnAConstraintSplitIt) {
  Random random(kSeed);
  Drawing d{Triangulation({{0, 0}, {64, 64}})};
  const auto v = d.insert({{0, 0}, {64, 48}, {0, 48}, {64, 0}});
  ASSERT_TRUE(d.draw(v[0], v[1]));
  for (int i = 0; i < 100; ++i) d.all.insert({whole(random, 0, 64), whole(random, 0, 64)});
  for (int i = 1; i < 64; ++i) d.all.insert({i, 0.75 * i}, v[2]);
  EXPECT_EQ(d.wrong(Delaunay::Exactly), "");
  EXPECT_TRUE(d.draw(v[2], v[3])) << "they meet in a vertex by now";
  EXPECT_EQ(d.wrong(Delaunay::Exactly), "");
}

TEST(TriangulationConstrain, ACrossingIsRefusedAndNothingChanges) {
  Drawing d{Triangulation({{0, 0}, {10, 10}})};
  const auto v = d.insert({{1, 1}, {9, 9}, {1, 9}, {9, 2}, {5, 8}, {4, 1}});
  ASSERT_TRUE(d.draw(v[0], v[1]));
  const auto before = edges_of(d.all);
  for (const auto& [a, b] : {Segment{v[2], v[3]}, Segment{v[3], v[2]}, Segment{v[4], v[5]}}) {
    const auto wall = d.all.constrain(a, b);
    ASSERT_TRUE(wall);
    EXPECT_EQ(std::minmax((*wall)[0], (*wall)[1]), std::minmax(v[0], v[1]));
    EXPECT_EQ(edges_of(d.all), before);
    EXPECT_TRUE(d.all.changed().empty());
  }
  // Through a vertex of the other constraint is no crossing of an edge.
  const Vertex middle = d.all.insert({5, 5});
  const auto across = d.insert({{2, 8}, {8, 2}});
  EXPECT_TRUE(d.draw(across[0], across[1]));
  EXPECT_EQ(d.wrong(Delaunay::Exactly), "");
  EXPECT_TRUE(d.draw(middle, middle)) << "no length, no edge";
  EXPECT_EQ(d.wrong(Delaunay::Exactly), "");
}

TEST(TriangulationConstrain, LoopsWithHolesEncloseTheirArea) {
  Drawing d{Triangulation({{-1, -1}, {1, 1}})};
  const auto rim = circle({0, 0}, 1, 97), hole = circle({0.3, 0}, 0.4, 41, 0.1), island = circle({0.3, 0}, 0.2, 7);
  for (const auto& loop : {rim, hole, island}) d.draw_loop(loop);
  d.all.mark_inside();
  const double area = area_of(rim) - area_of(hole) + area_of(island);
  EXPECT_NEAR(inside_area(d.all), area, 1e-14);

  // What is inserted later is as inside as where it falls; on the border it is split between the sides.
  Random random(kSeed);
  for (int i = 0; i < 2000; ++i) d.all.insert(point_in(random, {{-1, -1}, {1, 1}}));
  for (std::size_t i = 0; i + 1 < rim.size(); ++i) d.all.insert(0.5 * (rim[i] + rim[i + 1]));
  EXPECT_EQ(unsound(d.all), "");
  EXPECT_EQ(not_delaunay(d.all, Delaunay::ButForRounding), "");
  EXPECT_NEAR(inside_area(d.all), area, 1e-13);
  std::vector<bool> before;
  for (const auto& t : d.all.triangles()) before.push_back(t.inside);
  d.all.mark_inside();
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i], d.all.triangles()[i].inside) << i;
}

TEST(TriangulationConstrain, ASeamRunThroughTwiceIsNoWall) {
  Drawing d{Triangulation({{0, 0}, {4, 4}})};
  d.draw_loop({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  const auto hole = d.insert({{1, 1}, {2, 1}, {2, 2}, {1, 2}});
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(d.draw(hole[i], hole[(i + 1) % 4]));
  // The bridge from the rim to the hole, there and back, with a vertex in between that came in later.
  const Vertex corner = d.all.insert({0, 0});
  ASSERT_TRUE(d.draw(corner, hole[0]));
  d.all.insert({0.5, 0.5});
  ASSERT_TRUE(d.draw(hole[0], corner));
  d.all.mark_inside();
  EXPECT_EQ(inside_area(d.all), 15);
  EXPECT_EQ(d.wrong(Delaunay::Exactly), "") << "and it still is an edge";
  // A third time it is one; but it closes no loop, so it separates nothing.
  ASSERT_TRUE(d.draw(corner, hole[0]));
  d.all.mark_inside();
  EXPECT_EQ(inside_area(d.all), 15);
}

// Points on a slanted border are off it by rounding. Chains between them stay, and no swap folds a triangle.
TEST(TriangulationConstrain, BordersOffTheirLineByRounding) {
  Random random(kSeed);
  Tally tally("borders off their line", kSeed);
  for (int round = 0; round < 40; ++round) {
    Drawing d{Triangulation({{-1, -1}, {2, 2}})};
    const Vec2 a = point_in(random, kUnit), b = point_in(random, kUnit);
    std::vector<double> places;
    for (int i = 0; i < 60; ++i) places.push_back(between(random, 0, 1));
    std::sort(places.begin(), places.end());
    Vertex last = d.all.insert(a);
    for (const double t : places) {
      const Vertex v = d.all.insert(a + t * (b - a), last);
      d.draw(last, v);
      last = v;
    }
    for (int i = 0; i < 100; ++i) d.all.insert(point_in(random, kUnit));
    // From end to end it is another segment, crossing those chains or not.
    d.draw(4, last);
    tally.check(unsound(d.all).empty(), [&] { return unsound(d.all); });
    const std::string wrong = not_delaunay(d.all, Delaunay::ButForRounding);
    tally.check(wrong.empty(), [&] { return wrong; });
  }
  tally.finish(80);
}

TEST(TriangulationConstrain, ALongConstraintNeedsFewSwaps) {
  const int n = 200;
  Triangulation all({{0, 0}, {1, 1}});
  Vertex last = 0;
  for (int i = 0; i < n * n; ++i) last = all.insert(Vec2((i / n) % 2 ? n - 1 - i % n : i % n, i / n) / double(n - 1), last);
  const Vertex a = all.insert({0.0001, 0.00013}), b = all.insert({0.9998, 0.9734});
  const auto before = all.swaps();
  ASSERT_FALSE(all.constrain(a, b));
  fmt::print("[ counted  ] {} swaps for a constraint across a grid of {} x {}\n", all.swaps() - before, n, n);
  EXPECT_LT(all.swaps() - before, std::uint64_t(20 * n));
  EXPECT_EQ(unsound(all), "");
  EXPECT_EQ(not_constrained(all, std::vector<Segment>{{a, b}}), "");
}

TEST(TriangulationConstrain, ConstrainedEdgesAreNotSwapped) {
  Drawing d{Triangulation({{0, 0}, {10, 10}})};
  const auto v = d.insert({{0, 5}, {10, 5}, {5, 4}, {5, 6}});
  ASSERT_TRUE(d.draw(v[0], v[1]));
  int refused = 0;
  for (Vertex t = 0; t < d.all.triangles().size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (d.all.triangles()[t].constrained >> k & 1) {
        ++refused;
        EXPECT_FALSE(d.all.swap_if_legal(t, k));
        EXPECT_TRUE(d.all.changed().empty());
      }
  EXPECT_EQ(refused, 2);
}

}  // namespace
}  // namespace iso::test
