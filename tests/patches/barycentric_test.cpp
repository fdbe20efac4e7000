// Generalised barycentric coordinates: what defines them, on random polygons, convex and not.
#include "patches/base/barycentric.h"

#include <gtest/gtest.h>

#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

// Convex, on a circle; star-shaped with every other corner drawn in, when concave.
std::vector<Vec2> random_polygon(Numbers& random, int n, bool concave) {
  std::vector<Vec2> corners;
  const Vec2 centre(random(-3, 3), random(-3, 3));
  const double size = random(0.1, 10);
  for (int k = 0; k < n; ++k) {
    const double angle = kTwoPi * (k + random(-0.3, 0.3)) / n, radius = concave && k % 2 == 1 ? random(0.25, 0.4) : 1;
    corners.push_back(centre + size * radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return corners;
}
struct Case {
  BarycentricPolygon polygon;
  bool concave = false;
  double size = 1;
};
std::vector<Case> cases(unsigned seed) {
  Numbers random(seed);
  std::vector<Case> all;
  for (int n = 3; n <= 20; ++n)
    for (int form = 0; form < 3; ++form) {
      if (form == 2 && n < 6) continue;
      std::vector<Vec2> corners = random_polygon(random, n, form == 2);
      if (n % 2 == 0) std::reverse(corners.begin(), corners.end());
      Box2 box;
      for (const Vec2& v : corners) box.include(v);
      const auto kind = form == 0 ? BarycentricKind::wachspress : BarycentricKind::mean_value;
      all.push_back({*barycentric_polygon(kind, corners), form == 2, box.diagonal()});
    }
  return all;
}
// A mean of the corners, or for star-shaped polygons a place on the way to the middle.
Vec2 inside(Numbers& random, const Case& c) {
  const std::vector<Vec2>& v = c.polygon.corners;
  Vec2 middle(0.0);
  for (const Vec2& p : v) middle += p / static_cast<double>(v.size());
  const std::size_t k = static_cast<std::size_t>(random(0, 1) * v.size()) % v.size();
  const double along = random(0, 1), inward = random(0.05, 1);
  return glm::mix(glm::mix(v[k], v[(k + 1) % v.size()], along), middle, inward);
}

TEST(Barycentric, CoordinatesReproduceLinearFunctions) {
  Numbers random(1);
  int checked = 0;
  for (const Case& c : cases(2))
    for (int i = 0; i < 50; ++i, ++checked) {
      const Vec2 x = inside(random, c);
      Dual2 sum, px, py;
      const std::vector<Dual2> phi = coordinates_at(c.polygon, x);
      for (std::size_t k = 0; k < phi.size(); ++k) {
        sum = sum + phi[k];
        px = px + phi[k] * Dual2(c.polygon.corners[k].x - x.x);
        py = py + phi[k] * Dual2(c.polygon.corners[k].y - x.y);
        ASSERT_TRUE(c.concave || phi[k].f > 0);
      }
      ASSERT_NEAR(sum.f, 1, 1e-13);
      ASSERT_NEAR(px.f / c.size, 0, 1e-13);
      ASSERT_NEAR(py.f / c.size, 0, 1e-13);
      // Corners less x: gradients are those of the identity.
      for (const Dual2& s : {sum}) ASSERT_LT(c.size * std::max(std::abs(s.u), std::abs(s.v)), 1e-10);
      ASSERT_LT(std::max({std::abs(px.u - 1), std::abs(px.v), std::abs(py.u), std::abs(py.v - 1)}), 1e-10);
      ASSERT_LT(c.size * std::max({std::abs(px.uu), std::abs(px.uv), std::abs(px.vv), std::abs(py.uu), std::abs(py.uv), std::abs(py.vv)}),
                1e-7);
    }
  EXPECT_GT(checked, 1500);
}

TEST(Barycentric, LinearOnSidesAndOneAtTheirCorner) {
  int checked = 0;
  for (const Case& c : cases(3)) {
    const std::vector<Vec2>& v = c.polygon.corners;
    const std::size_t n = v.size();
    for (std::size_t k = 0; k < n; ++k) {
      for (double along : {0.0, 1e-12, 1e-6, 0.1, 0.5, 0.9, 1 - 1e-9, 1.0}) {
        const Vec2 x = along == 1 ? v[(k + 1) % n] : v[k] + along * (v[(k + 1) % n] - v[k]);
        const std::vector<Dual2> phi = coordinates_at(c.polygon, x);
        for (std::size_t j = 0; j < n; ++j, ++checked) {
          const double truth = j == k ? 1 - along : j == (k + 1) % n ? along : 0;
          ASSERT_NEAR(phi[j].f, truth, along == 0 || along == 1 ? 1e-15 : 1e-12) << n << " corners, side " << k << " at " << along;
          ASSERT_TRUE(std::isfinite(phi[j].u) && std::isfinite(phi[j].vv));
        }
      }
    }
  }
  EXPECT_GT(checked, 5000);
}

// Also on the sides, where mean value coordinates are smooth, and beyond.
TEST(Barycentric, DerivativesAreTheLimitOfDifferences) {
  Numbers random(4);
  int checked = 0;
  for (const Case& c : cases(5)) {
    const std::vector<Vec2>& v = c.polygon.corners;
    for (int i = 0; i < 10; ++i, ++checked) {
      const std::size_t k = i % v.size();
      const Vec2 x = i % 2 == 0 ? inside(random, c) : glm::mix(v[k], v[(k + 1) % v.size()], random(0.3, 0.7));
      const std::vector<Dual2> phi = coordinates_at(c.polygon, x);
      double error[2] = {0, 0};
      for (int step = 0; step < 2; ++step) {
        const double h = c.size * (step == 0 ? 2e-4 : 1e-4);
        const auto right = coordinates_at(c.polygon, x + Vec2(h, 0)), left = coordinates_at(c.polygon, x - Vec2(h, 0));
        const auto up = coordinates_at(c.polygon, x + Vec2(0, h)), down = coordinates_at(c.polygon, x - Vec2(0, h));
        for (std::size_t j = 0; j < v.size(); ++j) {
          const double parts[5] = {(right[j].f - left[j].f) / (2 * h) - phi[j].u, (up[j].f - down[j].f) / (2 * h) - phi[j].v,
                                   ((right[j].u - left[j].u) / (2 * h) - phi[j].uu) * c.size,
                                   ((up[j].u - down[j].u) / (2 * h) - phi[j].uv) * c.size,
                                   ((up[j].v - down[j].v) / (2 * h) - phi[j].vv) * c.size};
          for (double part : parts) error[step] = std::max(error[step], std::abs(part) * c.size);
        }
      }
      if (error[0] > 1e-5) {
        ASSERT_NEAR(error[0] / error[1], 4, 0.8) << v.size() << " corners";
      }
      ASSERT_LT(error[1], 1) << v.size();
    }
  }
  EXPECT_GT(checked, 300);
}

TEST(Barycentric, TrianglesSquaresAndMapsOfThem) {
  Numbers random(6);
  for (int i = 0; i < 200; ++i) {
    const std::vector<Vec2> triangle = {{0, 0}, {random(1, 2), random(-0.5, 0.5)}, {random(-0.5, 0.5), random(1, 2)}};
    const Vec2 x(random(0, 0.3), random(0, 0.3));
    const double whole = triangle[1].x * triangle[2].y - triangle[1].y * triangle[2].x;
    const double b = (x.x * triangle[2].y - x.y * triangle[2].x) / whole, c = (triangle[1].x * x.y - triangle[1].y * x.x) / whole;
    for (BarycentricKind kind : {BarycentricKind::wachspress, BarycentricKind::mean_value}) {
      const std::vector<Dual2> phi = coordinates_at(*barycentric_polygon(kind, triangle), x);
      EXPECT_NEAR(phi[0].f, 1 - b - c, 1e-14);
      EXPECT_NEAR(phi[1].f, b, 1e-14);
      EXPECT_NEAR(phi[2].f, c, 1e-14);
    }
    // Wachspress's are bilinear on a square, and do not mind affine maps.
    const Vec2 e(random(1, 2), random(-0.5, 0.5)), f(random(-0.5, 0.5), random(1, 2)), uv = random.in_chart();
    const std::vector<Dual2> phi =
        coordinates_at(*barycentric_polygon(BarycentricKind::wachspress, {Vec2(0.0), e, e + f, f}), uv.x * e + uv.y * f);
    EXPECT_NEAR(phi[0].f, (1 - uv.x) * (1 - uv.y), 1e-14);
    EXPECT_NEAR(phi[1].f, uv.x * (1 - uv.y), 1e-14);
    EXPECT_NEAR(phi[2].f, uv.x * uv.y, 1e-14);
  }
  // By hand: at the middle of the long side of an L the angles are right.
  const BarycentricPolygon ell = *barycentric_polygon(BarycentricKind::mean_value, {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  double sum = 0;
  for (const Dual2& phi : coordinates_at(ell, {0.3, 1.7})) sum += phi.f;
  EXPECT_NEAR(sum, 1, 1e-14);
  EXPECT_LT(coordinates_at(ell, {0.2, 1.9})[2].f, 0);  // behind the reflex corner
}

TEST(Barycentric, DegeneratePolygonsAreErrors) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<Vec2>> wrong = {{},
                                                {{0, 0}, {1, 0}},
                                                {{0, 0}, {1, 0}, {2, 0}},
                                                {{0, 0}, {1, 0}, {1, 0}, {0, 1}},
                                                {{0, 0}, {1, 0}, {nan, 1}},
                                                {{0, 0}, {1, 1}, {1, 0}, {0, 1}},
                                                {{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}},
                                                {{0, 0}, {2, 0}, {1, 0}, {1, 1}}};
  for (std::size_t i = 0; i < wrong.size(); ++i)
    for (BarycentricKind kind : {BarycentricKind::wachspress, BarycentricKind::mean_value})
      EXPECT_FALSE(barycentric_polygon(kind, wrong[i])) << i;
  const std::vector<Vec2> straight = {{0, 0}, {1, 0}, {2, 0}, {1, 1}}, concave = {{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}};
  for (const auto& polygon : {straight, concave}) {
    EXPECT_FALSE(barycentric_polygon(BarycentricKind::wachspress, polygon));
    EXPECT_TRUE(barycentric_polygon(BarycentricKind::mean_value, polygon));
  }
}

}  // namespace
}  // namespace iso::test
