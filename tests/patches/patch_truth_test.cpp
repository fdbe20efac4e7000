// Patches of n sides where they are something known: tensor products, Bezier triangles, each other.
#include <gtest/gtest.h>

#include <array>

#include "patches/base/barycentric.h"
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

// [Hettinga 2021, 2.3.4]: b_211 = ((1 - w) v b_uv + (1 - v) w b_uw) / ((1 - w) v + (1 - v) w), and so on round.
TEST(PatchTruth, PairsOfGregoryTrianglesAreBlendedAsPrinted) {
  Numbers random(17);
  for (int i = 0; i < 100; ++i) {
    const Vec2 st = random.in_chart(), x = domain_point(3, st);
    const double second = (1 - x.x) / 3 + x.y / std::sqrt(3.0), third = (1 - x.x) / 3 - x.y / std::sqrt(3.0);
    const double coordinates[3] = {1 - second - third, second, third};
    const std::vector<double> W = weights({PatchKind::gregory_triangle, 3, 3}, st);
    for (int k = 0; k < 3; ++k) {
      const double u = coordinates[k], v = coordinates[(k + 1) % 3], w = coordinates[(k + 2) % 3];
      const double quartic = 12 * u * u * v * w, whole = (1 - w) * v + (1 - v) * w;
      ASSERT_NEAR(W[5 * k + 3], quartic * (1 - w) * v / whole, 1e-14);
      ASSERT_NEAR(W[5 * k + 4], quartic * (1 - v) * w / whole, 1e-14);
    }
  }
}

// ---- The formulas as they are printed ----------------------------------------------------------------------------------------

// phi at a place of the chart, by the general formulas of polygons.
std::vector<double> coordinates(const PatchBasis& basis, const Vec2& st) {
  std::vector<Vec2> corners;
  for (int k = 0; k < basis.sides; ++k) corners.push_back(domain_corner(basis.sides, k));
  const auto kind = basis.parameters == SideParameters::mean_value ? BarycentricKind::mean_value : BarycentricKind::wachspress;
  std::vector<double> phi;
  for (const Dual2& c : coordinates_at(*barycentric_polygon(kind, corners), domain_point(basis.sides, st))) phi.push_back(c.f);
  return phi;
}

// [Varady, Salvi, Kariko 2016]: every ribbon with all its points, each side's copy with its own factor.
TEST(PatchTruth, GeneralisedBezierIsTheSumOfItsRibbons) {
  Numbers random(15);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.kind != PatchKind::generalised_bezier) continue;
    const int n = basis.sides, d = basis.degree, rows = (d + 1) / 2;
    const std::vector<Vec3> points = random.points(basis);
    // The points in the order of the files, each put where both sides find it. ribbon[side][j][r]
    std::vector<std::vector<std::vector<Vec3>>> ribbon(n, std::vector(d + 1, std::vector<Vec3>(d + 1)));
    std::size_t at = 1;
    for (int r = 0; r < rows; ++r)
      for (int i = 1; i <= n; ++i)
        for (int j = r; j < d - r; ++j, ++at) {
          ribbon[i % n][j][r] = points[at];
          ribbon[i - 1][d - r][j] = points[at];
          ribbon[(i + 1) % n][r][d - j] = points[at];
        }
    ASSERT_EQ(at, points.size());
    for (int repeat = 0; repeat < 10; ++repeat, ++checked) {
      const Vec2 st(random(0.02, 1), random(0.02, 1));
      const std::vector<double> phi = coordinates(basis, st);
      const auto h = [&](int i) { return 1 - phi[(i + n) % n] - phi[(i + n - 1) % n]; };
      Vec3 sum(0.0);
      double whole = 0;
      for (int i = 0; i < n; ++i)
        for (int r = 0; r < rows; ++r)
          for (int j = 0; j <= d; ++j) {
            double factor = 1;
            if (r < 2 && j < 2) {
              factor = h(i - 1) / (h(i - 1) + h(i));
            } else if (r < 2 && j > d - 2) {
              factor = h(i + 1) / (h(i + 1) + h(i));
            } else if (j == r || j == d - r) {
              factor = 0.5;
            } else if (j < r || j > d - r) {
              factor = 0;
            }
            const double s = phi[i] / (phi[i] + phi[(i + n - 1) % n]), w = factor * bernstein(d, j, s) * bernstein(d, r, h(i));
            sum += w * ribbon[i][j][r];
            whole += w;
          }
      sum += (1 - whole) * points[0];
      ASSERT_LT(glm::length(sum - point_at(basis, points, st)), 1e-12) << told(basis);
    }
  }
  EXPECT_GT(checked, 900);
}

// [Hettinga 2021, 8.2.5] with its erratum: curves, fields and their derivatives, corner by corner.
TEST(PatchTruth, CharrotGregoryIsTheSumOfItsCorners) {
  Numbers random(16);
  int checked = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.kind != PatchKind::charrot_gregory) continue;
    const int n = basis.sides;
    const std::vector<Vec3> points = random.points(basis);
    const auto around = [&](int k) { return (k + 2 * n) % n; };
    const auto curve = [&](int k) { return chosen(points, points_of_side(basis, around(k))); };
    const auto field = [&](int k) {
      const int from = 5 * around(k - 1), to = 5 * around(k);
      const std::vector<Vec3> row = chosen(points, {from + 2, from + 3, to + 4, to + 1}), side = curve(k);
      std::vector<Vec3> t;
      for (int j = 0; j < 4; ++j) t.push_back(3.0 * (row[j] - side[j]));
      return t;
    };
    for (int repeat = 0; repeat < 10; ++repeat, ++checked) {
      const Vec2 st(random(0.02, 1), random(0.02, 1)), x = domain_point(n, st);
      const std::vector<double> phi = coordinates(basis, st);
      const auto d = [&](int k) {
        const Vec2 a = domain_corner(n, k - 1), b = domain_corner(n, k), inward = Vec2(a.y - b.y, b.x - a.x) / glm::length(b - a);
        return basis.parameters == SideParameters::distance ? glm::dot(x - a, inward) : 1 - phi[around(k)] - phi[around(k - 1)];
      };
      Vec3 sum(0.0);
      double whole = 0;
      for (int i = 0; i < n; ++i) {
        const double u = d(i) / (d(i) + d(i + 2)), v = d(i + 1) / (d(i - 1) + d(i + 1));
        const std::vector<Vec3> p = curve(i), p1 = curve(i + 1), t = field(i), t1 = field(i + 1);
        const Vec3 twist = (-u * curve_at(legs(t), 1) + v * curve_at(legs(t1), 0)) * (u * v / (u + v));
        const Vec3 c =
            -p1[0] - v * t1[0] - u * t[3] + curve_at(p1, u) + v * curve_at(t1, u) + curve_at(p, 1 - v) + u * curve_at(t, 1 - v) - twist;
        double w = 1;
        for (int k = 0; k < n; ++k)
          if (k != i && k != around(i + 1)) w *= d(k) * d(k);
        sum += w * c;
        whole += w;
      }
      ASSERT_LT(glm::length(sum / whole - point_at(basis, points, st)), 1e-12) << told(basis);
    }
  }
  EXPECT_GT(checked, 200);
}

}  // namespace
}  // namespace iso::test
