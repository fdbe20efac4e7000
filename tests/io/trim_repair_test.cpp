// Trim curves that Open CASCADE makes up and gets wrong: they are mended, and only they. The truths are in closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "patches/io/collapsed_side.h"
#include "tests/support/load.h"
#include "tests/support/solids.h"

namespace iso::test {
namespace {

constexpr const char* kProjected = "the edge projected anew";
constexpr const char* kBorder = "the border followed";

int count_of(const Model& model, const std::string& what) {
  int count = 0;
  for (const Problem& problem : model.problems)
    if (problem.what.find(what) != std::string::npos) {
      EXPECT_EQ(problem.kind, Problem::Kind::repaired);
      count += problem.count;
    }
  return count;
}

// Rays along -z over a grid, none on a line of symmetry. `inside` is the distance of (x, y) from the outline, negative outside; rays
// nearer to it than `unsure` are not asked.
template <class Inside>
void expect_outline(const std::shared_ptr<const Model>& model, const Inside& inside, double unsure, int least) {
  constexpr int kGrid = 301;
  ASSERT_TRUE(model);
  const Box3 box = box_of(*model);
  std::vector<Ray> rays;
  std::vector<char> hit_expected;
  int in = 0, out = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const Vec2 share = 1.1 * Vec2(i + 0.53, j + 0.47) / double(kGrid) - 0.05;
      const Vec3 p = box.lo + Vec3(share, 0) * (box.hi - box.lo);
      const double d = inside(p.x, p.y);
      if (std::abs(d) <= unsure) continue;
      rays.push_back({{p.x, p.y, box.hi.z + box.diagonal()}, {0, 0, -1}});
      hit_expected.push_back(d > 0);
      ++(d > 0 ? in : out);
    }
  std::vector<Hit> hits(rays.size());
  SolverStats stats;
  tracer_of(model).nearest(rays, hits, Tracer::Order::coherent, stats);
  int wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (bool(hits[i]) != bool(hit_expected[i]) && wrong++ < 5)
      ADD_FAILURE() << fmt::format("the ray at ({:.17g}, {:.17g}) should {}hit", rays[i].o.x, rays[i].o.y, hit_expected[i] ? "" : "not ");
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(in, least);
  EXPECT_GE(out, least);
}

// The patch is the lens |y| < x (1 - x); its sides u = 0 and v = 0 are the point x = y = 0.
TEST(TrimRepair, TheLensWhoseTwoCollapsedSidesMeetInACornerIsWhole) {
  const auto model = load(data("cad/edge-cases/two-side-singular-corner.stp"));
  expect_outline(
      model, [](double x, double y) { return x * (1 - x) - std::abs(y); }, 1e-9, 20000);
  EXPECT_EQ(count_of(*model, kProjected), 1);
  EXPECT_EQ(count_of(*model, kBorder), 1);

  // The loop is the border of the unit square, and its collapsed part is a point.
  ASSERT_EQ(model->parts[0].faces.size(), 1u);
  const Face& face = model->parts[0].faces[0];
  ASSERT_EQ(face.loops.size(), 1u);
  int collapsed = 0, samples = 0;
  for (const TrimCurve& curve : face.loops[0].curves) {
    const bool point_expected = model->parts[0].edges[static_cast<std::size_t>(curve.edge)].degenerate;
    collapsed += point_expected;
    for (int i = 0; i <= 100; ++i, ++samples) {
      const UV uv = jet(curve.curve, curve.t0 + (curve.t1 - curve.t0) * i / 100).C;
      EXPECT_LE(std::min({std::abs(uv.x), std::abs(uv.y), std::abs(1 - uv.x), std::abs(1 - uv.y)}), 1e-12) << uv.x << ", " << uv.y;
      if (point_expected) {
        EXPECT_LE(glm::length(point(face.surface, uv) - point(face.surface, UV(0.0))), 1e-12) << uv.x << ", " << uv.y;
      }
    }
  }
  EXPECT_EQ(collapsed, 1);
  EXPECT_EQ(samples, 303);
}

// The patch differs from its triangle by 0.01 at the tip and bulges by 0.075; its file's edges are the triangle's sides.
TEST(TrimRepair, TheTriangleWithAnAlmostCollapsedSideIsWhole) {
  const auto model = load(data("cad/edge-cases/near-degenerate-nurbs-pole.stp"));
  expect_outline(
      model, [](double x, double y) { return std::min(y, 500 - y / 2 - std::abs(x)); }, 0.02, 20000);
  EXPECT_EQ(count_of(*model, kProjected), 2);
  EXPECT_EQ(count_of(*model, "leave the surface"), 0);
}

TEST(TrimRepair, ACurveThatSwingsBetweenItsSamplesIsProjectedAnew) {
  const auto model = load(data("cad/trim-curve-swings.brep"));
  expect_outline(
      model,
      [](double x, double y) {
        return std::min({x, y, 10 - x, 5 + 2 * std::sin(kPi * x / 10) - y});
      },
      2e-4, 20000);
  EXPECT_EQ(count_of(*model, kProjected), 1);
  EXPECT_EQ(count_of(*model, kBorder), 0);
}

TEST(TrimRepair, CurvesThatKeepToTheirEdgesStayAsTheyAre) {
  std::set<std::string> mended;
  int files = 0;
  for (const auto& path : files_in(data_dir() / "cad", {".step", ".stp", ".iges", ".igs", ".brep"})) {
    const auto model = load(path);
    ++files;
    if (model && count_of(*model, kProjected) + count_of(*model, kBorder) > 0) mended.insert(path.filename());
  }
  EXPECT_EQ(mended, (std::set<std::string>{"near-degenerate-nurbs-pole.stp", "trim-curve-swings.brep", "two-side-singular-corner.stp"}));
  EXPECT_GE(files, 56);
}

// Biquadratic over [0, 2] x [0, 3]; the sides u = 0 and v = 0 are one point if `collapsed`.
NurbsSurface patch(bool collapsed) {
  NurbsSurface s;
  s.degree_u = s.degree_v = 2;
  s.count_u = s.count_v = 3;
  s.knots_u = {0, 0, 0, 2, 2, 2};
  s.knots_v = {0, 0, 0, 3, 3, 3};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s.poles.push_back(homogeneous(collapsed && i * j == 0 ? Vec3(0.0) : Vec3(i, j, i * j), 1.0));
  return s;
}

TEST(TrimRepair, TheWayBetweenTwoCollapsedSidesGoesAroundTheirCornerAndNoOther) {
  const auto way = border_way(patch(true), {2, 0}, {0, 3}, 1e-7);
  ASSERT_TRUE(way);
  EXPECT_EQ(way->points, (std::vector<UV>{{2, 0}, {0, 0}, {0, 3}}));
  EXPECT_EQ(way->strays, 0);
  EXPECT_GT(way->straight, 0.5);
  const auto back = border_way(patch(true), {0, 1}, {0.5, 0}, 1e-7);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->points, (std::vector<UV>{{0, 1}, {0, 0}, {0.5, 0}}));

  EXPECT_FALSE(border_way(patch(false), {2, 0}, {0, 3}, 1e-7)) << "no side is collapsed";
  EXPECT_FALSE(border_way(patch(true), {2, 1}, {0, 1}, 1e-7)) << "one end is not on a collapsed side";
  EXPECT_FALSE(border_way(patch(true), {1, 1}, {0, 1}, 1e-7)) << "one end is not on the border";
  EXPECT_FALSE(border_way(patch(true), {0.5, 0}, {1.5, 0}, 1e-7)) << "both ends on one side: the straight line is the border";
  EXPECT_FALSE(border_way(patch(true), {2, 0}, {0, 3}, 100)) << "nothing is allowed to stray so far";
  EXPECT_FALSE(border_way(Sphere{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1}, {0, kPi / 2}, {kTwoPi, kPi / 2}, 1e-7)) << "a pole";
}

}  // namespace
}  // namespace iso::test
