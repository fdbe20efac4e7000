// Charts of n-sided patches and the splines beside them: the proven distance holds and is not far off, borders are shared, corners are what
// the formulas have there.
#include "patches/surface/patch_chart.h"

#include <gtest/gtest.h>

#include "patches/surface/bezier_triangle.h"
#include "patches/surface/chart_spline.h"
#include "patches/surface/surface.h"
#include "tests/support/n_sided.h"
#include "tests/support/patch_meshes.h"
#include "tests/support/paths.h"
#include "tests/support/random_patches.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr double kRounding = 1e-13;  // sizes of one

// With 3 to 8 sides, degrees up to 4 or 5; by mean value, whose splines take a second or more each, with 4 and 7 sides.
std::vector<PatchBasis> blended_bases() {
  std::vector<PatchBasis> all;
  for (const PatchBasis& basis : every_basis())
    if (basis.kind != PatchKind::bezier_triangle && basis.sides <= 8 && basis.degree <= (basis.sides <= 5 ? 5 : 4) &&
        (basis.parameters != SideParameters::mean_value || basis.sides == 4 || basis.sides == 7))
      all.push_back(basis);
  return all;
}

NSidedPatch random_patch(const PatchBasis& basis, Random& random) {
  return basis.degree == 3 ? random_patch_over(basis, random) : random_net(basis, random, false);
}

Vec3 on_spline(const PatchChart& chart, const Vec2& st) { return point(AnySurface(*chart.near), st); }

// Where the distance is largest is not known: a grid, dense toward the corner.
void spline_is_nowhere_farther_than_proven() {
  Tally tally("distance from the spline");
  double tightest = 0, loosest = kInf;
  std::string loose;
  for (const PatchBasis& basis : blended_bases()) {
    Random random(basis.sides);
    const PatchChart chart = chart_of(random_patch(basis, random), 0);
    EXPECT_TRUE(finite(chart.error)) << told(basis);
    const AnySurface spline(*chart.near);
    double most = 0;
    for (int i = 0; i <= 120; ++i)
      for (int j = 0; j <= 120; ++j) {
        const Vec2 st(std::pow(i / 120.0, 1.5), std::pow(j / 120.0, 1.5));
        const double apart = glm::length(point_of(chart, st) - point(spline, st));
        most = std::max(most, apart);
        tally.within(apart, chart.error + kRounding, [&] { return fmt::format("{}: st {} {}", told(basis), st.x, st.y); });
      }
    tightest = std::max(tightest, most / chart.error);
    // Exact ones aside, where the error is what rounding may come to.
    if (chart.error > 1e-10 && most / chart.error < loosest) {
      loosest = most / chart.error;
      loose = told(basis);
    }
  }
  fmt::print("[ measured ] of the proven distance is reached: {:.2g} at most, {:.2g} at least ({})\n", tightest, loosest, loose);
  EXPECT_GT(loosest, 0.002);
  tally.finish_at_least(30u * 121 * 121);
}

// Of the weights alone: each spline against its weight, and of pairs by sum and half difference.
void splines_of_weights_are_nowhere_farther_than_proven() {
  Tally tally("weights");
  for (const PatchBasis& basis : blended_bases()) {
    const std::shared_ptr<const WeightSplines> splines = weight_splines(basis, {});
    const auto points = static_cast<std::size_t>(point_count(basis));
    std::vector<double> worst(points);  // of all cells
    for (std::size_t k = 0; k < splines->error.size(); ++k) worst[k % points] = std::max(worst[k % points], splines->error[k]);
    // One surface for three weights at a time.
    for (std::size_t m = 0; m < points; m += 3) {
      NurbsSurface s;
      s.degree_u = s.degree_v = 5;
      s.count_u = s.count_v = splines->count;
      s.knots_u = s.knots_v = splines->knots;
      for (std::size_t k = 0; k < splines->poles[m].size(); ++k) {
        Vec4 pole(0, 0, 0, 1);
        for (std::size_t c = 0; c < 3 && m + c < points; ++c) pole[static_cast<int>(c)] = splines->poles[m + c][k];
        s.poles.push_back(pole);
      }
      const AnySurface surface(s);
      for (int i = 0; i <= 20; ++i)
        for (int j = 0; j <= 20; ++j) {
          const Vec2 st(std::pow(i / 20.0, 2), std::pow(j / 20.0, 2));
          const std::vector<double> W = weights(basis, st);
          const Vec3 near = point(surface, st);
          for (std::size_t c = 0; c < 3 && m + c < points; ++c)
            tally.check(std::abs(W[m + c] - near[static_cast<int>(c)]) <= worst[m + c],
                        [&] { return fmt::format("{}: weight {} at {} {}", told(basis), m + c, st.x, st.y); });
        }
    }
  }
  tally.finish_at_least(30u * 15 * 21 * 21);
}

// Along t = 0 the curve of side 1 from corner 0, along s = 0 that of side 0 back to the corner.
void spline_meets_the_boundary_curves() {
  Tally tally("boundary");
  for (const PatchBasis& basis : blended_bases()) {
    Random random(7);
    const NSidedPatch patch = random_patch(basis, random);
    const PatchChart chart = chart_of(patch, 0);
    const std::vector<Vec3> next = chosen(patch.points, points_of_side(basis, 1)), back = chosen(patch.points, points_of_side(basis, 0));
    for (int i = 0; i <= 40; ++i) {
      const double u = i / 40.0;
      tally.within(glm::length(on_spline(chart, {u, 0}) - curve_at(next, 0.5 * u)), kRounding, [&] { return told(basis); });
      tally.within(glm::length(on_spline(chart, {0, u}) - curve_at(back, 1 - 0.5 * u)), kRounding, [&] { return told(basis); });
    }
  }
  tally.finish_at_least(30u * 41 * 2);
}

// s = 1 of a chart is t = 1 of the next: (1, t) there is (t, 1) here. Both for the formulas and the splines, and where one corner alone is
// drawn out so far that its chart needs a finer spline.
void neighbours_share_their_borders() {
  Tally tally("borders of charts");
  for (const PatchBasis& basis : blended_bases())
    for (const double drawn : {0.0, 3.0}) {
      Random random(8);
      NSidedPatch patch = random_patch(basis, random);
      patch.points[0].z += drawn;
      std::vector<PatchChart> charts;
      for (int k = 0; k < basis.sides; ++k) charts.push_back(chart_of(patch, k));
      for (int k = 0; k < basis.sides; ++k) {
        const PatchChart &own = charts[k], &next = charts[(k + 1) % basis.sides];
        EXPECT_EQ(own.corner, k);
        for (int i = 0; i <= 40; ++i) {
          const double u = i / 40.0;
          const auto text = [&] { return fmt::format("{}, drawn out by {}", told(basis), drawn); };
          tally.within(glm::length(on_spline(own, {1, u}) - on_spline(next, {u, 1})), kRounding * (1 + drawn), text);
          tally.within(glm::length(point_of(own, {1, u}) - point_of(next, {u, 1})), kRounding * (1 + drawn), text);
          // And across patches: the end of side k + 1 in the one chart is its beginning in the other.
          if (i == 40) tally.within(glm::length(on_spline(own, {1, 0}) - on_spline(next, {0, 1})), kRounding * (1 + drawn), text);
        }
      }
    }
  tally.finish_at_least(30u * 2 * 3 * 83);
}

// Two patches with the same curve along a side, whatever their numbers of sides.
void patches_share_their_borders() {
  Tally tally("borders of patches");
  for (const auto& [sides, others] : {std::pair{4, 3}, {5, 4}, {6, 7}, {3, 8}})
    for (const int degree : {3, 5, 6, 8}) {
      Random random(degree);
      std::vector<Vec3> curve;
      for (int j = 0; j <= degree; ++j) curve.emplace_back(j, between(random, -1, 1), between(random, -1, 1));
      std::vector<PatchChart> charts;
      for (const int n : {sides, others}) {
        const PatchBasis basis{PatchKind::generalised_bezier, n, degree};
        NSidedPatch patch = random_net(basis, random, false);
        const std::vector<int> side = points_of_side(basis, 1);
        for (std::size_t j = 0; j < side.size(); ++j) patch.points[static_cast<std::size_t>(side[j])] = curve[j];
        charts.push_back(chart_of(patch, 0));
      }
      for (int i = 0; i <= 200; ++i) {
        const Vec2 st(i / 200.0, 0);
        tally.within(glm::length(on_spline(charts[0], st) - on_spline(charts[1], st)), 10 * kRounding,
                     [&] { return fmt::format("{} and {} sides, degree {}, s {}", sides, others, degree, st.x); });
      }
    }
  tally.finish_at_least(4u * 4 * 201);
}

// At the corner: the control point, half the first legs of both boundaries, and the spline's own first derivatives.
void corner_has_the_legs_of_the_boundaries() {
  Tally tally("corners");
  for (const PatchBasis& basis : blended_bases()) {
    Random random(10);
    const NSidedPatch patch = random_patch(basis, random);
    for (int k = 0; k < basis.sides; ++k) {
      const PatchChart chart = chart_of(patch, k);
      const std::vector<Vec3> next = chosen(patch.points, points_of_side(basis, (k + 1) % basis.sides)),
                              back = chosen(patch.points, points_of_side(basis, k));
      const double d = basis.degree;
      const Vec3 legs[2] = {0.5 * d * (next[1] - next[0]), 0.5 * d * (back[back.size() - 2] - back.back())};
      const Jet2 j = jet_of(chart, Vec2(0.0)), spline = jet2(*chart.near, Vec2(0.0));
      const Tangents t = tangents_of(chart, Vec2(0.0));
      const auto text = [&] { return fmt::format("{}, corner {}", told(basis), k); };
      tally.within(glm::length(j.S - next[0]), kRounding, text);
      // Of the spline they are differences of poles over its first cell, which divides what those round to.
      const double of_poles = 4e-14 / chart.near->knots_u[6];
      for (const auto& [u, v, most] :
           {std::tuple{j.Su, j.Sv, 1e-12}, std::tuple{t.Ss, t.St, 1e-12}, std::tuple{spline.Su, spline.Sv, of_poles}}) {
        tally.within(glm::length(u - legs[0]), most, text);
        tally.within(glm::length(v - legs[1]), most, text);
      }
    }
  }
  tally.finish_at_least(30u * 3 * 7);
}

// On the chart and as far beyond it as Newton goes, at the corner and next to nothing beside it, on both sides.
void everything_is_finite() {
  Tally tally("finite");
  const double places[] = {-0.02, -1e-3, -1e-8, -1e-15, -1e-100, 0, 1e-100, 1e-15, 1e-8, 1e-3, 0.3, 1 - 1e-15, 1, 1.02};
  for (const PatchBasis& basis : blended_bases()) {
    Random random(11);
    const PatchChart chart = chart_of(random_patch(basis, random), 0);
    for (const double s : places)
      for (const double t : places) {
        const Jet2 j = jet_of(chart, {s, t});
        const bool holds =
            finite(point_of(chart, {s, t})) && finite(j.S) && finite(j.Su) && finite(j.Sv) && finite(on_spline(chart, {s, t}));
        tally.check(holds, [&] { return fmt::format("{}: st {} {}", told(basis), s, t); });
      }
  }
  tally.finish_at_least(30u * 14 * 14);
}

// Beyond the borders formulas go on: no place near the corner is far from it, and no normal turns over, in any direction; by mean value, in
// directions up to a tenth beyond the borders.
void nothing_breaks_beside_the_corner() {
  Tally tally("beside the corner");
  for (const PatchBasis& basis : blended_bases()) {
    if (basis.degree > 3) continue;
    Random random(12);
    const PatchChart chart = chart_of(random_patch(basis, random), 0);
    const Jet2 corner = jet_of(chart, Vec2(0.0));
    const Vec3 n = glm::normalize(glm::cross(corner.Su, corner.Sv));
    for (const double radius : {1e-15, 1e-12, 1e-9, 1e-6, 1e-4})
      for (int i = 0; i < 256; ++i) {
        const bool about = basis.parameters != SideParameters::mean_value;
        const double angle = about ? kTwoPi * i / 256 : -0.1 + (kPi / 2 + 0.2) * i / 255;
        const Vec2 st = radius * Vec2(std::cos(angle), std::sin(angle));
        const Jet2 j = jet_of(chart, st);
        const Vec3 m = glm::normalize(glm::cross(j.Su, j.Sv));
        const Tangents tangents = tangents_of(chart, st);
        const Vec3 k = glm::normalize(glm::cross(tangents.Ss, tangents.St));
        const auto text = [&] { return fmt::format("{}: st {} {}", told(basis), st.x, st.y); };
        tally.within(glm::length(point_of(chart, st) - corner.S), 16 * radius + kRounding, text);
        // Second derivatives of some tens; rounding.
        tally.within(glm::length(m - n), 1e3 * radius + 1e-9, text);
        tally.within(glm::length(k - n), 1e3 * radius + 1e-9, text);
      }
  }
  tally.finish_at_least(15u * 5 * 256 * 3);
}

// In one test, since each is a process of its own and the splines of all bases take seconds to make.
TEST(PatchChart, SplinesKeepTheirDistanceBordersAreSharedAndCornersHaveLimits) {
  spline_is_nowhere_farther_than_proven();
  splines_of_weights_are_nowhere_farther_than_proven();
  spline_meets_the_boundary_curves();
  neighbours_share_their_borders();
  patches_share_their_borders();
  corner_has_the_legs_of_the_boundaries();
  everything_is_finite();
  nothing_breaks_beside_the_corner();
}

// Over a mesh that bends sharply patches fold beside their corners: the tangents all but along each other, the normal turns over within a
// hundredth of the chart. Coarse cells at the corner would turn it by up to 1.7 elsewhere than the chart does, by what one in fifty is off
// by a tenth. Dense toward the corner; where the tangents are along each other to a hundredth, the normals are what little is left.
TEST(PatchChart, SplinesTurnWithTheirChartsWherePatchesFold) {
  constexpr double kMostTurn = 0.03, kApart = 1e-2;
  Tally tally("normals of splines");
  int fine = 0;
  for (const NSidedPatch& patch : patches_over(read_polygons(data("meshes/spot-control-mesh.obj")), MeshKind::gregory))
    for (int k = 0; k < patch.basis.sides; ++k) {
      const PatchChart chart = chart_of(patch, k);
      fine += chart.near->knots_u[6] < 0.001;
      for (double r = 1; r > 1e-5; r *= 0.75)
        for (const Vec2& way : {Vec2(1, 0), Vec2(1, 0.25), Vec2(1, 1), Vec2(0.25, 1), Vec2(0, 1)}) {
          const Tangents at = tangents_of(chart, r * way);
          const Jet2 spline = jet2(*chart.near, r * way);
          const Vec3 n = glm::cross(at.Ss, at.St), beside = glm::cross(spline.Su, spline.Sv);
          if (glm::length(n) < kApart * glm::length(at.Ss) * glm::length(at.St)) continue;
          const double turn = std::atan2(glm::length(glm::cross(n, beside)), glm::dot(n, beside));
          tally.within(turn, kMostTurn,
                       [&] { return fmt::format("patch of {} sides, st {} {}", patch.basis.sides, r * way.x, r * way.y); });
        }
    }
  fmt::print("[ measured ] {} charts with fine cells at the corner\n", fine);
  EXPECT_GE(fine, 100);
  tally.finish_at_least(700u * 5 * 35);
}

TEST(PatchChart, TranslationMovesChartAndSpline) {
  const Vec3 by(3, -7, 11);
  int checked = 0;
  for (const PatchBasis& basis : {PatchBasis{PatchKind::generalised_gregory, 5, 3}, PatchBasis{PatchKind::bezier_triangle, 3, 3}}) {
    Random random(9);
    const PatchChart chart =
        chart_of(basis.kind == PatchKind::bezier_triangle ? random_net(basis, random, true) : random_patch(basis, random), 1);
    PatchChart moved = chart;
    translate(moved, by);
    EXPECT_EQ(moved.error, chart.error);
    for (int i = 0; i < 100; ++i, ++checked) {
      const Vec2 st = point_in(random, {Vec2(0.0), Vec2(1.0)});
      EXPECT_LT(glm::length(point_of(moved, st) - point_of(chart, st) - by), 1e-14 * 16);
      EXPECT_LT(glm::length(on_spline(moved, st) - on_spline(chart, st) - by), 1e-14 * 16);
      const Jet2 a = jet_of(moved, st), b = jet_of(chart, st);
      EXPECT_LT(glm::length(a.Su - b.Su) + glm::length(a.Sv - b.Sv), 1e-12);
    }
  }
  EXPECT_EQ(checked, 200);
}

TEST(PatchChart, ChartOfABezierTriangleIsItsTensorProduct) {
  Tally tally("Bezier triangles");
  for (int degree = 1; degree <= 8; ++degree)
    for (const bool rational : {false, true}) {
      Random random(degree);
      const NSidedPatch patch = random_net({PatchKind::bezier_triangle, 3, degree}, random, rational);
      for (int k = 0; k < 3; ++k) {
        const PatchChart chart = chart_of(patch, k);
        EXPECT_EQ(chart.error, 0.0);
        for (int i = 0; i < 50; ++i) {
          const Vec2 st = point_in(random, {Vec2(0.0), Vec2(1.0)});
          tally.within(glm::length(point_of(chart, st) - on_spline(chart, st)), 1e-14, [&] { return fmt::format("degree {}", degree); });
        }
      }
    }
  tally.finish(8 * 2 * 3 * 50);
}

// The octant is on the sphere, all of it.
TEST(PatchChart, SphereOctantIsOnTheSphere) {
  Tally tally("octant");
  for (int k = 0; k < 3; ++k) {
    const PatchChart chart = chart_of(sphere_octant(), k);
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; j <= 20; ++j)
        tally.within(std::abs(glm::length(jet_of(chart, Vec2(i, j) / 20.0).S) - 1), 1e-14, [&] { return fmt::format("{} {}", i, j); });
  }
  tally.finish(3 * 21 * 21);
}

}  // namespace
}  // namespace iso::test
