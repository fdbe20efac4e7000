// Patches of n sides where they are something known: tensor products, Bezier triangles, each other.
#include <gtest/gtest.h>

#include <array>

#include "patches/surface/bezier_triangle.h"
#include "patches/surface/patch_basis.h"
#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

double bernstein(int d, int j, double u) {
  double c = 1;
  for (int i = 1; i <= j; ++i) c = c * (d - j + i) / i;
  return c * std::pow(u, j) * std::pow(1 - u, d - j);
}

TEST(PatchTruth, GregoryQuadWithEqualTwistsIsItsBezierPatch) {
  Numbers random(10);
  std::array<Vec3, 16> net;
  for (Vec3& p : net) p = random.vector();
  const NSidedPatch patch = gregory_of_bezier(net);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec2 st = random.in_chart();
    Vec3 truth(0.0);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) truth += bernstein(3, k, st.x / 2) * bernstein(3, j, st.y / 2) * net[4 * j + k];
    worst = std::max(worst, glm::length(point_at(patch.basis, patch.points, st) - truth));
  }
  EXPECT_LT(worst, 1e-14);
}

// With four sides of any degree the generalised Bezier patch is the tensor product: even degrees have the central point in the middle.
TEST(PatchTruth, FourSidedGeneralisedBezierIsTheTensorProduct) {
  Numbers random(11);
  for (int d = 3; d <= 8; ++d)
    for (SideParameters parameters : {SideParameters::wachspress}) {
      const PatchBasis basis{PatchKind::generalised_bezier, 4, d, parameters};
      // Point (j, r) of the side from corner c, in the net whose first index runs from corner 0 to 1.
      std::vector<std::array<int, 2>> place{{d / 2, d / 2}};
      for (int r = 0; r < (d + 1) / 2; ++r)
        for (int c = 0; c < 4; ++c)
          for (int j = r; j < d - r; ++j)
            place.push_back(c == 0   ? std::array<int, 2>{j, r}
                            : c == 1 ? std::array<int, 2>{d - r, j}
                            : c == 2 ? std::array<int, 2>{d - j, d - r}
                                     : std::array<int, 2>{r, d - j});
      ASSERT_EQ(static_cast<int>(place.size()), point_count(basis));
      for (int i = 0; i < 50; ++i) {
        const Vec2 st = random.in_chart();
        const std::vector<double> W = weights(basis, st);
        for (std::size_t m = 0; m < W.size(); ++m) {
          const double truth = bernstein(d, place[m][0], st.x / 2) * bernstein(d, place[m][1], st.y / 2);
          ASSERT_NEAR(W[m], m == 0 && d % 2 == 1 ? 0 : truth, 1e-14) << "degree " << d << " point " << m;
        }
      }
    }
}
TEST(PatchTruth, FourSidedGeneralisedGregoryIsTheGregoryQuad) {
  Numbers random(12);
  for (int i = 0; i < 200; ++i) {
    const Vec2 st = random.in_chart();
    const std::vector<double> W = weights({PatchKind::generalised_gregory, 4, 3}, st), quad = weights({PatchKind::gregory_quad, 4, 3}, st);
    for (int m = 0; m < 20; ++m) ASSERT_NEAR(W[m], quad[m], 1e-14);
    ASSERT_NEAR(W[20], 0, 1e-14);
  }
}

// With three sides phi are the barycentric coordinates (a, b, c), s = b / (a + b) and h = c on side 1: its row 0 has the Bernstein
// polynomials of the triangle's border, its row 1 those times d c / (a + b).
TEST(PatchTruth, ThreeSidedGeneralisedBezierInBarycentricCoordinates) {
  Numbers random(13);
  for (int d = 3; d <= 8; ++d) {
    const PatchBasis basis{PatchKind::generalised_bezier, 3, d};
    for (int i = 0; i < 100; ++i) {
      const Vec2 st = random.in_chart(), x = domain_point(3, st);
      const double b = (1 - x.x) / 3 + x.y / std::sqrt(3.0), c = (1 - x.x) / 3 - x.y / std::sqrt(3.0), a = 1 - b - c;
      const std::vector<double> W = weights(basis, st);
      const auto border = [&](int j, double p, double q) {
        return bernstein(d, j, 0.5) * std::pow(2, d) * std::pow(p, d - j) * std::pow(q, j);
      };
      ASSERT_NEAR(W[1], border(0, a, b), 1e-13);
      ASSERT_NEAR(W[2], (b * border(1, a, b) + c * d * b * std::pow(a, d) / (a + c)) / (b + c), 1e-13);
      if (d > 3) {
        ASSERT_NEAR(W[3], border(2, a, b), 1e-13);
      }
      const double twist = (b * border(1, a, b) * d * c / (a + b) + c * border(d - 1, c, a) * d * b / (a + c)) / (b + c);
      ASSERT_NEAR(W[1 + 3 * d], twist, 1e-13) << d;
    }
  }
}

TEST(PatchTruth, GregoryTriangleWithEqualPairsIsItsQuarticBezierTriangle) {
  Numbers random(14);
  const PatchBasis basis{PatchKind::gregory_triangle, 3, 3}, quartic{PatchKind::bezier_triangle, 3, 4};
  std::vector<Vec3> p = random.points(basis);
  for (int k = 0; k < 3; ++k) p[5 * k + 4] = p[5 * k + 3];
  // The cubic triangle with this border raised to degree four: its border is right whatever its middle is.
  NSidedPatch cubic{.basis = {PatchKind::bezier_triangle, 3, 3}, .points = std::vector<Vec3>(10), .weights = {}};
  for (int side = 0; side < 3; ++side)
    for (int j = 0; j < 4; ++j) cubic.points[points_of_side(cubic.basis, side)[j]] = p[points_of_side(basis, side)[j]];
  NSidedPatch raised = raised_triangle(cubic);
  raised.points[6] = p[3];    // powers (2, 1, 1)
  raised.points[7] = p[8];    // powers (1, 2, 1)
  raised.points[10] = p[13];  // powers (1, 1, 2)
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec2 st = random.in_chart();
    worst = std::max(worst, glm::length(point_at(basis, p, st) - point_at(quartic, raised.points, st)));
  }
  EXPECT_LT(worst, 1e-14);
}

}  // namespace
}  // namespace iso::test
