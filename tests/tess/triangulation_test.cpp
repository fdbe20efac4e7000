// The triangulation of points: sound, Delaunay, as cheap as promised. Constraints: triangulation_constrain_test.cpp.
#include "tess/triangulation.h"

#include "tests/support/cgal_oracle.h"
#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"
#include "tests/support/triangulation_checks.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20241003;
const Box2 kUnit{{0, 0}, {1, 1}};

std::vector<Vec2> random_points(Random& random, int count, const Box2& box = kUnit) {
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) points.push_back(point_in(random, box));
  return points;
}

// Place along Hilbert's curve through a grid of 2^16 x 2^16.
std::uint64_t along_hilbert(const Vec2& p) {
  std::uint32_t x = static_cast<std::uint32_t>(p.x * 65535), y = static_cast<std::uint32_t>(p.y * 65535);
  std::uint64_t place = 0;
  for (std::uint32_t s = 1u << 15; s > 0; s >>= 1) {
    const std::uint32_t right = (x & s) != 0, up = (y & s) != 0;
    place += std::uint64_t(s) * s * ((3 * right) ^ up);
    if (up) continue;
    if (right) x = 65535 - x, y = 65535 - y;
    std::swap(x, y);
  }
  return place;
}

// A grid in rows, every other one backwards; the hint is the point before.
Triangulation snake(int n, double size) {
  Triangulation all({{0, 0}, Vec2(size)});
  Vertex last = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) last = all.insert(size / (n - 1) * Vec2(j % 2 ? n - 1 - i : i, j), last);
  return all;
}

TEST(Triangulation, RandomPointsGiveCgalsTriangulation) {
  Random random(kSeed);
  Tally tally("random points against CGAL", kSeed);
  for (int round = 0; round < 20; ++round) {
    Triangulation all(kUnit);
    for (const Vec2& p : random_points(random, 50 << (round % 5))) all.insert(p);
    tally.check(unsound(all).empty(), [&] { return unsound(all); });
    tally.check(edges_of(all) == cgal_triangulation(all.points(), {}), [&] { return fmt::format("other edges in round {}", round); });
  }
  tally.finish(40);
}

TEST(Triangulation, GridsAreDelaunayExactly) {
  for (const int n : {2, 3, 10, 65}) {
    const Triangulation all = snake(n, n - 1);
    EXPECT_EQ(unsound(all), "") << n;
    EXPECT_EQ(not_delaunay(all, Delaunay::Exactly), "") << n;
    EXPECT_EQ(all.points().size(), std::size_t(n * n + 4));
  }
  // Places that are rounded: a few roundings from Delaunay.
  const Triangulation rounded = snake(100, 0.7);
  EXPECT_EQ(unsound(rounded), "");
  EXPECT_EQ(not_delaunay(rounded, Delaunay::ButForRounding), "");
}

TEST(Triangulation, EqualPointsAreOneVertex) {
  Random random(kSeed);
  Triangulation all({{-1, -1}, {1, 1}});
  const auto points = random_points(random, 200);
  std::vector<Vertex> vertices;
  for (const Vec2& p : points) vertices.push_back(all.insert(p));
  EXPECT_FALSE(all.changed().empty());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(all.insert(points[i], vertices[(7 * i) % vertices.size()]), vertices[i]);
    EXPECT_TRUE(all.changed().empty());
  }
  EXPECT_EQ(all.insert({0.0, 0.5}), all.insert({-0.0, 0.5}));
  EXPECT_EQ(all.insert({1e-300, 0.5}), all.insert({0, 0.5})) << "dust is 0";
  EXPECT_EQ(all.points().size(), points.size() + 5);
  EXPECT_EQ(unsound(all), "");
}

TEST(Triangulation, LocateTellsTheTriangleTheEdgeOrTheVertex) {
  Random random(kSeed);
  Triangulation all({{0, 0}, {32, 32}});
  for (int i = 0; i < 200; ++i) all.insert({whole(random, 0, 32), whole(random, 0, 32)});
  int places[4] = {};
  for (int i = 0; i < 20000; ++i) {
    const Vec2 p{0.5 * whole(random, -100, 164), 0.5 * whole(random, -100, 164)};
    const auto at = all.locate(p, static_cast<Vertex>(whole(random, 0, int(all.points().size()) - 1)));
    ++places[int(at.place)];
    const bool outside = !Box2{{-32, -32}, {64, 64}}.contains(p);
    ASSERT_EQ(at.place == Triangulation::Place::Outside, outside) << p.x << " " << p.y;
    if (outside) continue;
    const auto& v = all.triangles()[at.triangle].v;
    int zeros = 0;
    for (int k = 0; k < 3; ++k) {
      const int o = orientation(all.points()[v[(k + 1) % 3]], all.points()[v[(k + 2) % 3]], p);
      ASSERT_GE(o, 0);
      zeros += o == 0;
      if (at.place == Triangulation::Place::Edge) {
        ASSERT_EQ(o == 0, k == at.k);
      }
    }
    ASSERT_EQ(zeros, int(at.place));
    if (at.place == Triangulation::Place::Vertex) {
      ASSERT_EQ(all.points()[v[at.k]], p);
    }
  }
  for (const int count : places) EXPECT_GT(count, 30);
}

TEST(Triangulation, CollinearPointsInAnyOrder) {
  Random random(kSeed);
  for (const Vec2 along : {Vec2(1, 0), Vec2(0, 1), Vec2(3, 2), Vec2(-1, 4)}) {
    Triangulation all({{-1000, -1000}, {1000, 1000}});
    std::vector<int> order(200);
    for (int i = 0; i < 200; ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    for (const int i : order) all.insert(double(i) * along);
    EXPECT_EQ(unsound(all), "");
    EXPECT_EQ(not_delaunay(all, Delaunay::Exactly), "");
  }
}

// A slanted line's points are off it by rounding, which makes triangles of no height; a swap removes those whose edge is not needed.
TEST(Triangulation, PointsBesideALineByRoundingLeaveNoSliverThatASwapRemoves) {
  Random random(kSeed);
  Tally tally("points beside lines", kSeed);
  for (int round = 0; round < 50; ++round) {
    Triangulation all({{-2, -2}, {2, 2}});
    const Vec2 a = point_in(random, kUnit), b = point_in(random, kUnit);
    for (int i = 0; i < 100; ++i) all.insert(a + between(random, 0, 1) * (b - a));
    for (int i = 0; i < round; ++i) all.insert(point_in(random, kUnit));
    tally.check(unsound(all).empty(), [&] { return unsound(all); });
    const std::string wrong = not_delaunay(all, Delaunay::ButForRounding);
    tally.check(wrong.empty(), [&] { return wrong; });
  }
  tally.finish(100);
}

TEST(Triangulation, ScalingByPowersOfTwoChangesNothing) {
  Random random(kSeed);
  const auto points = random_points(random, 500);
  const auto at_scale = [&](double scale) {
    Triangulation all({{0, 0}, Vec2(scale)});
    for (const Vec2& p : points) all.insert(scale * p);
    return edges_of(all);
  };
  const auto one = at_scale(1);
  for (const int power : {-80, -27, 27, 200}) EXPECT_EQ(at_scale(std::ldexp(1.0, power)), one) << power;
}

TEST(Triangulation, SmallAndFarBoxesAreSound) {
  Random random(kSeed);
  for (const auto& [corner, size] : {std::pair(0.0, 1e-8), std::pair(1e8, 1.0), std::pair(1e8, 1e-6), std::pair(-1e8, 1e8)}) {
    const Box2 box{Vec2(corner), Vec2(corner + size)};
    Triangulation all(box);
    for (int i = 0; i < 500; ++i) all.insert(point_in(random, box));
    EXPECT_EQ(unsound(all), "") << corner << " " << size;
    EXPECT_EQ(not_delaunay(all, Delaunay::ButForRounding), "") << corner << " " << size;
  }
  for (const Box2& box : {Box2{{3, 4}, {3, 4}}, Box2{{0, 0}, {0, 0}}, Box2{{1e6, 0}, {1e6, 1}}}) {
    Triangulation all(box);
    for (const double t : {0.0, 0.25, 1.0}) all.insert(box.lo + t * box.size());
    EXPECT_EQ(unsound(all), "");
  }
}

TEST(Triangulation, ALegalSwapIsUndoneByMakeDelaunay) {
  Random random(kSeed);
  Triangulation all(kUnit);
  for (const Vec2& p : random_points(random, 300)) all.insert(p);
  const auto before = edges_of(all);
  int swapped = 0, refused = 0;
  std::vector<Vertex> changed;
  for (int i = 0; i < 300; ++i) {
    const Vertex t = static_cast<Vertex>(whole(random, 0, int(all.triangles().size()) - 1));
    const auto old = all.triangles()[t];
    if (!all.swap_if_legal(t, i % 3)) {
      ++refused;
      continue;
    }
    ++swapped;
    const Vertex p = old.v[i % 3], b = old.v[(i + 1) % 3], c = old.v[(i + 2) % 3], other = old.next[i % 3];
    const auto &now = all.triangles()[t].v, &beyond = all.triangles()[other].v;
    EXPECT_EQ(now, (std::array<Vertex, 3>{p, b, now[2]}));
    EXPECT_EQ(beyond, (std::array<Vertex, 3>{p, now[2], c}));
    changed.insert(changed.end(), all.changed().begin(), all.changed().end());
  }
  EXPECT_GT(swapped, 100);
  EXPECT_GT(refused, 20);
  EXPECT_EQ(unsound(all), "");
  EXPECT_NE(edges_of(all), before);
  all.make_delaunay(changed);
  EXPECT_EQ(edges_of(all), before);
}

TEST(Triangulation, ChangedNamesAllTrianglesThatChanged) {
  Random random(kSeed);
  Triangulation all(kUnit);
  Tally tally("triangles compared", kSeed);
  for (const Vec2& p : random_points(random, 300)) {
    const std::vector<Triangulation::Triangle> before(all.triangles().begin(), all.triangles().end());
    all.insert(p);
    std::vector<bool> named(all.triangles().size(), false);
    for (const Vertex t : all.changed()) named[t] = true;
    for (Vertex t = 0; t < named.size(); ++t)
      tally.check(named[t] || (t < before.size() && before[t].v == all.triangles()[t].v), [&] { return fmt::format("triangle {}", t); });
  }
  tally.finish_at_least(80000);
}

// Counted in steps and swaps, which do not depend on the machine.
TEST(Triangulation, TheCostPerPointDoesNotGrow) {
  Random random(kSeed);
  std::array<double, 2> steps, swaps;
  for (int large = 0; large < 2; ++large) {
    auto points = random_points(random, large ? 80000 : 5000);
    std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) { return along_hilbert(a) < along_hilbert(b); });
    Triangulation all(kUnit);
    Vertex last = 0;
    for (const Vec2& p : points) last = all.insert(p, last);
    steps[large] = double(all.walk_steps()) / double(points.size());
    swaps[large] = double(all.swaps()) / double(points.size());
  }
  fmt::print("[ counted  ] per point, of 5000 and of 80000: {:.2f}, {:.2f} steps; {:.2f}, {:.2f} swaps\n", steps[0], steps[1], swaps[0],
             swaps[1]);
  EXPECT_LT(steps[1], 4);
  EXPECT_LT(steps[1], 1.2 * steps[0]);
  EXPECT_LT(swaps[1], 6);
  EXPECT_LT(swaps[1], 1.2 * swaps[0]);
}

// Row by row each point sees about the square root of the row before it: growth with the fourth root of the number of points.
TEST(Triangulation, RowByRowTheCostGrowsWithTheFourthRoot) {
  const Triangulation small = snake(60, 1), large = snake(240, 1);
  const double few = double(small.swaps()) / 3600, many = double(large.swaps()) / 57600;
  fmt::print("[ counted  ] swaps per point of grids, row by row: {:.1f} of 60 x 60, {:.1f} of 240 x 240\n", few, many);
  EXPECT_LT(many, 2.2 * few);
}

}  // namespace
}  // namespace iso::test
