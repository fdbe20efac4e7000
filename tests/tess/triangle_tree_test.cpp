// The tree of triangles against looking at all of them.
#include "tess/triangle_tree.h"

#include <gtest/gtest.h>

#include "tests/support/mesh_distance.h"

namespace iso::test {
namespace {

struct Soup {
  std::vector<Point3> points;
  std::vector<PointTriangle> triangles;
};

// Triangles about the origin, some of them of two or three equal points or on a line, some with their points in common, some twice.
Soup random_soup(Random& random, int count) {
  Soup soup;
  const double spread = between(random, 0, 1) < 0.3 ? 0.01 : 1;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    const Point3 a = random_vector<Vec3>(random, 1), b = a + random_vector<Vec3>(random, spread * 0.3),
                 c = a + random_vector<Vec3>(random, spread * 0.3);
    PointTriangle t{first, first + 1, first + 2};
    soup.points.insert(soup.points.end(), {a, b, c});
    switch (whole(random, 0, 9)) {
      case 0:
        soup.points[first + 2] = b;
        break;
      case 1:
        soup.points[first + 1] = a;
        break;
      case 2:
        soup.points[first + 2] = a;
        break;
      case 3:
        soup.points[first + 1] = soup.points[first + 2] = a;
        break;
      case 4:
        soup.points[first + 2] = a + between(random, -1, 2) * (b - a);
        break;
      case 5:
        soup.points[first + 2] = 0.3 * a + 0.7 * b + random_vector<Vec3>(random, 1e-15);
        break;
      case 6:
        if (i > 0) t = soup.triangles[static_cast<std::size_t>(whole(random, 0, i - 1))];
        break;
      default:
        break;
    }
    soup.triangles.push_back(t);
  }
  return soup;
}

Point3 random_query(Random& random, const Soup& soup) {
  const auto& t = soup.triangles[static_cast<std::size_t>(whole(random, 0, static_cast<int>(soup.triangles.size()) - 1))];
  switch (whole(random, 0, 4)) {
    case 0:
      return random_vector<Vec3>(random, 1000);
    case 1:
      return soup.points[t[0]];
    case 2:
      return (soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3.0;
    case 3:
      return soup.points[t[0]] + random_vector<Vec3>(random, 1e-6);
    default:
      return random_vector<Vec3>(random, 1.5);
  }
}

double distance_to(const Soup& soup, std::uint32_t i, const Point3& p) {
  const auto& [a, b, c] = soup.triangles[i];
  return distance_to_triangle(p, soup.points[a], soup.points[b], soup.points[c]);
}

// Of the larger of 1 and the distance: rounding of the coordinates, which are about 1.
constexpr double kRounding = 1e-13;

TEST(TriangleTree, NearestIsThatOfAllTriangles) {
  Random random(11);
  int asked = 0, ties = 0;
  for (const int count : {1, 2, 3, 4, 5, 8, 9, 17, 64, 65, 300, 2000})
    for (int round = 0; round < (count < 300 ? 8 : 2); ++round) {
      const Soup soup = random_soup(random, count);
      const iso::TriangleTree tree(soup.points, soup.triangles);
      for (int k = 0; k < 60; ++k) {
        const Point3 p = random_query(random, soup);
        double least = kInf, least_of_odd = kInf;
        for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
          least = std::min(least, distance_to(soup, i, p));
          if (i % 2) least_of_odd = std::min(least_of_odd, distance_to(soup, i, p));
        }
        const double slack = kRounding * std::max(1.0, least);
        const auto found = tree.nearest(p);
        ASSERT_LT(found.triangle, soup.triangles.size());
        ASSERT_NEAR(found.distance, least, slack) << fmt::format("{} triangles, at ({}, {}, {})", count, p.x, p.y, p.z);
        // Point and weights say the same.
        ASSERT_EQ(found.distance, glm::length(found.point - p));
        ASSERT_NEAR(distance_to(soup, found.triangle, found.point), 0, slack);
        ASSERT_NEAR(found.weights.x + found.weights.y + found.weights.z, 1, 1e-12);
        ASSERT_GE(std::min({found.weights.x, found.weights.y, found.weights.z}), -1e-12);
        // Of equally near ones the first.
        for (std::uint32_t i = 0; i < found.triangle; ++i) ASSERT_GT(tree.on(i, p).distance, found.distance - slack);
        for (std::uint32_t i = 0; i < found.triangle; ++i) ties += tree.on(i, p).distance <= found.distance;
        const auto hint = static_cast<std::uint32_t>(whole(random, 0, count - 1));
        const auto again = tree.nearest(p, hint);
        ASSERT_NEAR(again.distance, found.distance, slack);
        if (again.triangle != found.triangle) {
          ASSERT_NEAR(tree.on(again.triangle, p).distance, tree.on(found.triangle, p).distance, slack);
        }
        const auto odd = tree.nearest_where(p, iso::TriangleTree::kNone, [](std::uint32_t i) { return i % 2 == 1; });
        if (count == 1) {
          ASSERT_EQ(odd.triangle, iso::TriangleTree::kNone);
          ASSERT_EQ(odd.distance, kInf);
        } else {
          ASSERT_EQ(odd.triangle % 2, 1u);
          ASSERT_NEAR(odd.distance, least_of_odd, kRounding * std::max(1.0, least_of_odd));
        }
        ++asked;
      }
    }
  EXPECT_EQ(asked, 60 * (10 * 8 + 2 * 2));
  EXPECT_EQ(ties, 0);
}

// Needles so thin that rounding decides on which side of their sides a point lies, and where their planes are: a plane's angle is known to
// epsilon over their width, and without the plane the width is what is not known.
TEST(TriangleTree, NearestOfNeedlesIsRightToTheirWidthOrTheirPlane) {
  constexpr double kWorst = 4e-8;  // a few times the root of epsilon
  Random random(12);
  for (int k = 0; k < 20000; ++k) {
    Soup soup;
    const Point3 a = random_vector<Vec3>(random, 1), b = random_vector<Vec3>(random, 1);
    const double thin = std::pow(10.0, between(random, -18, -4));
    const Point3 c = a + between(random, -0.5, 1.5) * (b - a) + random_vector<Vec3>(random, thin);
    soup.points = {a, b, c};
    soup.triangles = {{0, 1, 2}};
    std::shuffle(soup.triangles[0].begin(), soup.triangles[0].end(), random);
    const iso::TriangleTree tree(soup.points, soup.triangles);
    const Point3 p =
        k % 2 ? random_vector<Vec3>(random, 1.5) : a + between(random, -0.5, 1.5) * (b - a) + random_vector<Vec3>(random, 1e-3);
    const double truth = distance_to(soup, 0, p);
    ASSERT_NEAR(tree.nearest(p).distance, truth, kWorst) << fmt::format("thin {}, case {}", thin, k);
  }
}

TEST(TriangleTree, WithoutTrianglesThereIsNone) {
  const Soup soup;
  const iso::TriangleTree tree(soup.points, soup.triangles);
  EXPECT_EQ(tree.nearest(Point3(1.0)).triangle, iso::TriangleTree::kNone);
  EXPECT_EQ(tree.nearest(Point3(1.0)).distance, kInf);
  tree.for_each_touching({Vec3(-kInf), Vec3(kInf)}, [](std::uint32_t) { FAIL(); });
}

TEST(TriangleTree, EachTouchingIsCalledOnce) {
  Random random(13);
  std::size_t called = 0;
  for (const int count : {1, 4, 5, 33, 500, 2000}) {
    const Soup soup = random_soup(random, count);
    const iso::TriangleTree tree(soup.points, soup.triangles);
    for (int k = 0; k < 40; ++k) {
      Box3 query;
      const Point3 at = random_query(random, soup);
      query.include(at);
      if (k % 3) query.include(at + random_vector<Vec3>(random, k % 2 ? 0.1 : 2));
      std::vector<int> calls(soup.triangles.size(), 0);
      tree.for_each_touching(query, [&](std::uint32_t i) { ++calls[i]; });
      for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        Box3 box;
        for (const std::uint32_t p : soup.triangles[i]) box.include(soup.points[p]);
        const Box3 common{glm::max(box.lo, query.lo), glm::min(box.hi, query.hi)};
        ASSERT_EQ(calls[i], common.empty() ? 0 : 1);
        called += static_cast<std::size_t>(calls[i]);
      }
    }
  }
  EXPECT_GT(called, 1000u);
}

}  // namespace
}  // namespace iso::test
