// Patches over polygons with normals: edges, smooth joins between neighbours of any number of sides, and what is made from Bezier nets.
#include "patches/surface/patch_construct.h"

#include <gtest/gtest.h>

#include "patches/surface/bezier_triangle.h"
#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

Vec3 unit(const Vec3& v) { return v / glm::length(v); }
double angle(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }
constexpr double kDegree = kPi / 180;

// ---- Edges -------------------------------------------------------------------------------------------------------------------

TEST(PatchConstruct, BoundaryCurvesAreTheSameFromBothEnds) {
  Numbers random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random.vector(), q = random.vector(), m = unit(random.vector()), n = unit(random.vector());
    const CubicPoints there = boundary_cubic(p, m, q, n), back = boundary_cubic(q, n, p, m);
    for (int j = 0; j < 4; ++j) ASSERT_EQ(there[j], back[3 - j]);
    ASSERT_NEAR(glm::dot(there[1] - there[0], m), 0, 1e-15);
    ASSERT_NEAR(glm::dot(there[3] - there[2], n), 0, 1e-15);
  }
  // No tangent: the end has two points in one place.
  const CubicPoints bare = boundary_cubic({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(bare[0], bare[1]);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = random.vector(), normal = unit(random.vector());
    const CubicPoints curve = boundary_cubic(p, normal, p + 3.0 * normal, unit(random.vector()));
    ASSERT_EQ(curve[0], curve[1]);
    ASSERT_NE(curve[2], curve[3]);
  }
}

// Arcs of circles up to sixth order of their angle.
TEST(PatchConstruct, BoundaryCurvesOfCirclesAreNearlyArcs) {
  double error[2];
  for (int step = 0; step < 2; ++step) {
    const double half = step == 0 ? 0.4 : 0.2;
    const Vec3 p(-std::sin(half), std::cos(half), 0), q(std::sin(half), std::cos(half), 0);
    const CubicPoints curve = boundary_cubic(p, p, q, q);
    error[step] = 0;
    for (int i = 0; i <= 100; ++i)
      error[step] = std::max(error[step], std::abs(glm::length(curve_at({curve.begin(), curve.end()}, i / 100.0)) - 1));
  }
  EXPECT_LT(error[0], 1e-4);
  EXPECT_NEAR(error[0] / error[1], 64, 4);
}

// ---- Joins -------------------------------------------------------------------------------------------------------------------

// The kinds that join exactly, over polygons of so many sides.
std::vector<PatchBasis> joining(int n) {
  std::vector<PatchBasis> all = {{PatchKind::generalised_gregory, n, 3},
                                 {PatchKind::generalised_gregory, n, 3, SideParameters::mean_value},
                                 {PatchKind::charrot_gregory, n, 3},
                                 {PatchKind::charrot_gregory, n, 3, SideParameters::mean_value},
                                 {PatchKind::charrot_gregory, n, 3, SideParameters::distance}};
  if (n <= 4) all.push_back(gregory_basis(n));
  return all;
}

// Two polygons in the plane on both sides of the edge from (0, 0) to (1, 0), lifted and tilted at random.
struct Neighbours {
  std::vector<PatchCorner> left, right;  // corners 0 and 1 are the edge's: from one end, and from the other
};
Neighbours random_neighbours(Numbers& random, int n_left, int n_right, double tilt) {
  const auto corner = [&](double x, double y) {
    return PatchCorner{Vec3(x, y, random(-0.15, 0.15)), unit(Vec3(0, 0, 1) + tilt * random.vector())};
  };
  const auto polygon = [&](const PatchCorner& from, const PatchCorner& to, int n, double side) {
    std::vector<PatchCorner> corners{from, to};
    // On the circle through both ends that a regular polygon has, a little off.
    const double radius = 0.5 / std::sin(kPi / n), height = radius * std::cos(kPi / n);
    for (int k = 2; k < n; ++k) {
      const double at = kTwoPi * (k - 0.5 + random(-0.1, 0.1)) / n - kPi / 2;
      corners.push_back(corner(0.5 + side * radius * std::cos(at), side * (height + radius * std::sin(at))));
    }
    return corners;
  };
  const PatchCorner a = corner(0, 0), b = corner(1, 0);
  return {polygon(a, b, n_left, 1), polygon(b, a, n_right, -1)};
}

// The unit normal at a fraction of side 1, on which the charts of corners 0 and 1 lie.
Vec3 normal_on_side(const NSidedPatch& patch, double along) {
  const bool first = along <= 0.5;
  const Vec2 st = first ? Vec2(2 * along, 0) : Vec2(0, 2 * (1 - along));
  const Jet2 jet = jet_at(patch.basis, first ? patch.points : turned(patch.basis, patch.points), st);
  return unit(glm::cross(jet.Su, jet.Sv));
}
double largest_jump(const NSidedPatch& left, const NSidedPatch& right, double margin) {
  double worst = 0;
  for (int i = 0; i <= 40; ++i) {
    const double along = margin + (1 - 2 * margin) * i / 40;
    worst = std::max(worst, angle(normal_on_side(left, along), normal_on_side(right, 1 - along)));
  }
  return worst / kDegree;
}

TEST(PatchConstruct, NeighboursOfAllKindsHaveOneTangentPlaneAlongTheirEdge) {
  Numbers random(2);
  double worst[2] = {0, 0};  // without mean value coordinates, and with
  int checked = 0;
  for (int n = 3; n <= 8; ++n)
    for (int m = 3; m <= 8; ++m) {
      const Neighbours pair = random_neighbours(random, n, m, 0.8);
      for (const PatchBasis& a : joining(n))
        for (const PatchBasis& b : joining(m)) {
          const NSidedPatch left = *patch_over(a, pair.left), right = *patch_over(b, pair.right);
          for (int j = 0; j < 4; ++j)
            ASSERT_EQ(left.points[points_of_side(a, 1)[j]], right.points[points_of_side(b, 1)[3 - j]]) << told(a) << told(b);
          const bool no_corner = a.parameters == SideParameters::mean_value || b.parameters == SideParameters::mean_value;
          const double jump = largest_jump(left, right, no_corner ? 1e-6 : 0);
          ASSERT_LT(jump, 1e-6) << told(a) << " and " << told(b);
          worst[no_corner] = std::max(worst[no_corner], jump);
          ++checked;
        }
    }
  EXPECT_GT(checked, 900);
  EXPECT_LT(worst[0], 1e-10);
}

// The corners' normals are the given ones.
TEST(PatchConstruct, CornersHaveTheirNormals) {
  Numbers random(3);
  int checked = 0;
  for (int n = 3; n <= 8; ++n) {
    const std::vector<PatchCorner> corners = random_neighbours(random, n, 3, 0.3).left;
    std::vector<PatchBasis> all = joining(n);
    all.push_back({PatchKind::generalised_bezier, n, 3});
    for (const PatchBasis& basis : all) {
      if (basis.parameters == SideParameters::mean_value) continue;
      std::vector<Vec3> points = patch_over(basis, corners)->points;
      for (const PatchCorner& corner : corners) {
        const Jet2 jet = jet_at(basis, points, Vec2(0.0));
        ASSERT_LT(glm::length(jet.S - corner.point), 1e-14);
        ASSERT_LT(angle(glm::cross(jet.Su, jet.Sv), corner.normal), 1e-13) << told(basis);
        points = turned(basis, points);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100);
}

// A polygon on the unit sphere beside the edge from one place to the other.
std::vector<PatchCorner> on_sphere(const Vec3& from, const Vec3& to, int n) {
  const Vec3 along = to - from, up = unit(from + to), inward = unit(glm::cross(up, along));
  const double radius = 0.5 / std::sin(kPi / n), height = radius * std::cos(kPi / n), length = glm::length(along);
  std::vector<PatchCorner> corners;
  for (int k = 0; k < n; ++k) {
    const double at = kTwoPi * (k - 0.5) / n - kPi / 2;
    const Vec3 place = unit(0.5 * (from + to) + along * (radius * std::cos(at)) + inward * (length * (height + radius * std::sin(at))));
    corners.push_back({place, place});
  }
  corners[0] = {from, from};
  corners[1] = {to, to};
  return corners;
}

// One twist point for two sides cannot serve both: neighbours of generalised Bezier patches have one tangent plane at the corners only.
// Measured: up to 4.2 degrees between polygons of 3 to 8 sides over an edge of 11 degrees of a sphere, 20 on random ones; 0.03 between
// quadrilaterals on spheres.
TEST(PatchConstruct, GeneralisedBezierPatchesJoinOnlyNearly) {
  Numbers random(4);
  double on_random = 0, on_spheres = 0, at_corners = 0, of_quads = 1;
  for (int n = 3; n <= 8; ++n)
    for (int m = 3; m <= 8; ++m) {
      const PatchBasis a{PatchKind::generalised_bezier, n, 3}, b{PatchKind::generalised_bezier, m, 3};
      const Neighbours pair = random_neighbours(random, n, m, 0.3);
      const NSidedPatch left = *patch_over(a, pair.left), right = *patch_over(b, pair.right);
      on_random = std::max(on_random, largest_jump(left, right, 0));
      at_corners = std::max(at_corners, angle(normal_on_side(left, 0), normal_on_side(right, 1)) / kDegree);
      const Vec3 p = unit({-0.1, 0, 1}), q = unit({0.1, 0, 1});
      const double jump = largest_jump(*patch_over(a, on_sphere(p, q, n)), *patch_over(b, on_sphere(q, p, m)), 0);
      on_spheres = std::max(on_spheres, jump);
      if (n == 4 && m == 4) of_quads = jump;
    }
  EXPECT_LT(at_corners, 1e-6);
  EXPECT_GT(on_random, 1);
  EXPECT_LT(on_random, 25);
  EXPECT_GT(on_spheres, 1);
  EXPECT_LT(on_spheres, 5);
  EXPECT_LT(of_quads, 0.05);
}

// The field itself: at right angles, all along, to what neighbours share.
TEST(PatchConstruct, JoinFieldsLieInTheSharedTangentPlane) {
  Numbers random(5);
  for (int i = 0; i < 500; ++i) {
    const PatchCorner p{{0, 0, random(-0.2, 0.2)}, unit(Vec3(0, 0, 1) + random.vector())};
    const PatchCorner q{{1, 0, random(-0.2, 0.2)}, unit(Vec3(0, 0, 1) + random.vector())};
    const CubicPoints curve = boundary_cubic(p.point, p.normal, q.point, q.normal);
    const auto field = [&](const CubicPoints& c, const Vec3& n0, const Vec3& n1) {
      const Vec3 a0 = glm::cross(n0, random.vector()), a3 = glm::cross(n1, random.vector());
      const CrossField a = join_field(c, a0, a3, n0, n1);
      return std::vector<Vec3>{a0, a.a1, a.a2, a3};
    };
    const std::vector<Vec3> left = field(curve, p.normal, q.normal);
    const std::vector<Vec3> right = field({curve[3], curve[2], curve[1], curve[0]}, q.normal, p.normal);
    const std::vector<Vec3> tangents = legs({curve.begin(), curve.end()});
    for (int j = 0; j <= 20; ++j) {
      const double u = j / 20.0;
      const Vec3 a = curve_at(left, u), b = curve_at(right, 1 - u), c = curve_at(tangents, u);
      ASSERT_NEAR(glm::dot(glm::cross(a, b), c), 0, 1e-14) << i << " at " << u;
    }
  }
  // No tangent at an end: linear.
  const CrossField bare = join_field({Vec3(0.0), Vec3(0.0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, {0, 3, 0}, {0, 6, 0}, {0, 0, 1}, {0, 0, 1});
  EXPECT_EQ(bare.a1, Vec3(0, 4, 0));
  EXPECT_EQ(bare.a2, Vec3(0, 5, 0));
}

// ---- Shapes ------------------------------------------------------------------------------------------------------------------

TEST(PatchConstruct, FlatPolygonsGiveFlatPatches) {
  Numbers random(6);
  int checked = 0;
  for (int n = 3; n <= 16; ++n) {
    std::vector<PatchBasis> all = joining(n);
    all.push_back({PatchKind::generalised_bezier, n, 3});
    const Vec3 normal = unit(random.vector()), x = any_perpendicular(normal), y = glm::cross(normal, x);
    std::vector<PatchCorner> corners;
    for (int k = 0; k < n; ++k) {
      const double at = kTwoPi * (k + random(-0.2, 0.2)) / n;
      corners.push_back({normal + std::cos(at) * x + std::sin(at) * y, normal});
    }
    for (const PatchBasis& basis : all) {
      const NSidedPatch patch = *patch_over(basis, corners);
      for (int i = 0; i < 20; ++i, ++checked)
        ASSERT_NEAR(glm::dot(point_at(basis, patch.points, random.in_chart()), normal), 1, 1e-14) << told(basis);
    }
  }
  EXPECT_GT(checked, 1500);
}

// The whole patch over a small regular polygon on a sphere leaves it by the fourth order of its size.
TEST(PatchConstruct, RibbonPatchesKeepSpheresToFourthOrder) {
  for (int n : {3, 4, 5, 6, 7, 8, 10, 16})
    for (PatchKind kind : {PatchKind::generalised_gregory, PatchKind::generalised_bezier}) {
      const PatchBasis basis{kind, n, 3};
      double error[2] = {0, 0};
      for (int step = 0; step < 2; ++step) {
        const double size = step == 0 ? 0.2 : 0.1;
        std::vector<PatchCorner> corners;
        for (int k = 0; k < n; ++k) {
          const Vec2 at = size * domain_corner(n, k);
          const Vec3 place(at, std::sqrt(1 - glm::dot(at, at)));
          corners.push_back({place, place});
        }
        const Vec3 centre = point_at(basis, patch_over(basis, corners)->points, Vec2(1.0));
        error[step] = std::abs(glm::length(centre) - 1);
      }
      EXPECT_LT(error[0], 1e-3) << told(basis);
      EXPECT_GT(error[0] / error[1], 14) << told(basis);
    }
}

TEST(PatchConstruct, WhatDoesNotFitIsAnError) {
  Numbers random(7);
  const std::vector<PatchCorner> five = random_neighbours(random, 5, 3, 0.3).left;
  const PatchBasis basis = gregory_basis(5);
  ASSERT_TRUE(patch_over(basis, five));
  EXPECT_FALSE(patch_over(gregory_basis(6), five));
  EXPECT_FALSE(patch_over(gregory_basis(4), five));
  EXPECT_FALSE(patch_over({PatchKind::gregory_triangle, 5, 3}, five));
  EXPECT_FALSE(patch_over({PatchKind::generalised_bezier, 5, 4}, five));
  const std::vector<PatchCorner> three = random_neighbours(random, 3, 3, 0.3).left;
  EXPECT_FALSE(patch_over({PatchKind::bezier_triangle, 3, 3}, three));
  const auto spoilt = [&](auto&& spoil) {
    std::vector<PatchCorner> corners = five;
    spoil(corners);
    return !patch_over(basis, corners);
  };
  EXPECT_TRUE(spoilt([](auto& c) { c[2].point = c[1].point; }));
  EXPECT_TRUE(spoilt([](auto& c) { c[2].point.y = kInf; }));
  EXPECT_TRUE(spoilt([](auto& c) { c[3].normal = Vec3(0.0); }));
  EXPECT_TRUE(spoilt([](auto& c) { c[3].normal *= 2; }));
  std::vector<CubicPoints> curves(5);
  EXPECT_FALSE(patch_within(basis, five, curves));
  EXPECT_FALSE(patch_within(basis, five, std::span(curves).first(4)));
}

// ---- Bezier triangles --------------------------------------------------------------------------------------------------------

// The rational point.
Vec3 triangle_at(const NSidedPatch& patch, const Vec2& st) {
  const std::vector<double> W = weights(patch.basis, st);
  Vec3 sum(0.0);
  double whole = 0;
  for (std::size_t m = 0; m < W.size(); ++m) {
    const double w = W[m] * (patch.weights.empty() ? 1 : patch.weights[m]);
    sum += w * patch.points[m];
    whole += w;
  }
  return sum / whole;
}
// (s, t) in the chart of corner 0 of the place with the given barycentric coordinates; that must lie in it.
Vec2 chart_of_place(const Vec3& abc) {
  // A mean of corner, middles and centre: a - c and a - b grow with the distance from the far sides; Newton steps find the rest.
  Vec2 st(0.5, 0.5), target(0.0);
  for (int k = 0; k < 3; ++k) target += abc[k] * domain_corner(3, k);
  for (int i = 0; i < 50; ++i) {
    const DomainFrame frame = domain_frame(3, st);
    st -= glm::inverse(glm::dmat2(frame.by_s, frame.by_t)) * (domain_point(3, st) - target);
  }
  return st;
}
NSidedPatch random_triangle(Numbers& random, int degree, bool rational) {
  NSidedPatch patch{.basis = {PatchKind::bezier_triangle, 3, degree}, .points = {}, .weights = {}};
  patch.points = random.points(patch.basis);
  if (rational)
    for (std::size_t m = 0; m < patch.points.size(); ++m) patch.weights.push_back(random(0.5, 2));
  return patch;
}

TEST(BezierTriangle, RaisedIsTheSameSurface) {
  Numbers random(8);
  for (int degree = 1; degree < 9; ++degree)
    for (bool rational : {false, true}) {
      const NSidedPatch patch = random_triangle(random, degree, rational), raised = raised_triangle(patch);
      ASSERT_EQ(raised.basis.degree, degree + 1);
      ASSERT_EQ(raised.weights.size(), rational ? raised.points.size() : 0);
      for (int i = 0; i < 20; ++i) {
        const Vec2 st = random.in_chart();
        ASSERT_LT(glm::length(triangle_at(patch, st) - triangle_at(raised, st)), 1e-14);
      }
    }
}

TEST(BezierTriangle, PartsAreTheSameSurface) {
  Numbers random(9);
  int checked = 0;
  for (int degree = 1; degree < 9; ++degree)
    for (bool rational : {false, true})
      for (const Vec3& at : {Vec3(0.2, 0.5, 0.3), Vec3(0, 0.4, 0.6), Vec3(0.7, 0, 0.3), Vec3(0.5, 0.5, 0), Vec3(0, 0, 1)}) {
        const NSidedPatch patch = random_triangle(random, degree, rational);
        const std::vector<NSidedPatch> parts = cut_triangle(patch, at);
        std::vector<int> corners;
        for (int k = 0; k < 3; ++k)
          if (at[k] > 0) corners.push_back(k);
        ASSERT_EQ(parts.size(), corners.size());
        for (std::size_t i = 0; i < parts.size(); ++i)
          for (int repeat = 0; repeat < 10; ++repeat, ++checked) {
            // A place near corner 0 of the part, and where it is in the whole.
            const Vec3 inner = [&] {
              const double b = random(0, 0.33), c = random(0, 0.33);
              return Vec3(1 - b - c, b, c);
            }();
            Vec3 outer = inner;
            outer[corners[i]] = 0;
            outer += inner[corners[i]] * at;
            // The chart of the corner that the place is nearest to.
            NSidedPatch whole = patch;
            while (outer.x < outer.y || outer.x < outer.z) {
              whole.points = turned(whole.basis, whole.points);
              if (rational) {
                std::vector<double> w;
                for (int m : points_from_next_corner(whole.basis)) w.push_back(whole.weights[m]);
                whole.weights = w;
              }
              outer = {outer.y, outer.z, outer.x};
            }
            ASSERT_LT(glm::length(triangle_at(parts[i], chart_of_place(inner)) - triangle_at(whole, chart_of_place(outer))), 1e-12)
                << degree;
          }
      }
  EXPECT_GT(checked, 1000);
}

TEST(BezierTriangle, SphereOctantIsExact) {
  Numbers random(10);
  const NSidedPatch octant = sphere_octant();
  EXPECT_EQ(octant.points.front(), Vec3(1, 0, 0));
  EXPECT_EQ(octant.points[4], Vec3(0, 1, 0));
  EXPECT_EQ(octant.points.back(), Vec3(0, 0, 1));
  double worst = 0;
  Vec3 least(1.0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = triangle_at(octant, random.in_chart());
    worst = std::max(worst, std::abs(glm::length(p) - 1));
    least = glm::min(least, p);
  }
  EXPECT_LT(worst, 1e-14);
  EXPECT_GE(std::min({least.x, least.y, least.z}), 0);
}

}  // namespace
}  // namespace iso::test
