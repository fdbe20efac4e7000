// Gaps, normal jumps and curvature jumps along edges, against truths in closed form; and whole files.
#include "tess/continuity.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/load.h"
#include "tests/support/loose_faces.h"
#include "tests/support/solid_parts.h"

namespace iso::test {
namespace {

constexpr double kDegree = kPi / 180;

int count(const Continuity& c, EdgeKind kind) {
  return static_cast<int>(std::count_if(c.edges.begin(), c.edges.end(), [&](const EdgeContinuity& e) { return e.kind == kind; }));
}

// The one edge of a kind.
EdgeContinuity only(const Continuity& c, EdgeKind kind = EdgeKind::shared) {
  EXPECT_EQ(count(c, kind), 1);
  for (const EdgeContinuity& edge : c.edges)
    if (edge.kind == kind) return edge;
  return {};
}

EdgeContinuity measured_edge(const Part& part, double sew = 0) { return only(measure_continuity(part, {sew})); }

double largest(const Continuity& c, Measure m) {
  double most = 0;
  for (const EdgeContinuity& e : c.edges)
    if (e[m].known()) most = std::max(most, e[m].max);
  return most;
}

// [0, 2] x [-1, 0] in the plane z = 0, times a size.
void add_floor(LooseFaces& faces, double size = 1) { faces.add_rectangle({0, -size}, {2 * size, 0}); }

// A cylinder that leaves the floor at y = 0, toward +y, upward if r > 0: it starts tangent to it.
Face& add_ramp(LooseFaces& faces, double r, double size = 1) {
  const double side = r > 0 ? 1 : -1;
  const Frame frame{{0, 0, r}, {0, 0, -side}, {0, 1, 0}, {1, 0, 0}};
  return faces.add_face(Cylinder{frame, std::abs(r)}, {}, {{0, 0}, {1, 2 * size}});
}

// A triangle on the side y = 0 of the floor that turns up from it by an angle.
Face& add_flap(LooseFaces& faces, double angle, double size = 1, const Vec3& moved = Vec3(0.0)) {
  const Vec3 Y{0, std::cos(angle), std::sin(angle)};
  const Plane plane{{moved, {1, 0, 0}, Y, glm::cross(Vec3(1, 0, 0), Y)}};
  return faces.add_polygon({{0, 0}, {2 * size, 0}, {size, size}}, plane);
}

TEST(Continuity, TheNormalJumpOfTwoPlanesIsTheirAngle) {
  for (const double degrees : {0.0, 1e-6, 1e-3, 0.5, 30.0, 90.0, 137.0, 179.5, 180.0}) {
    LooseFaces faces;
    add_floor(faces);
    add_flap(faces, degrees * kDegree);
    const EdgeContinuity edge = measured_edge(faces.part);
    EXPECT_NEAR(edge[Measure::normal].max, degrees * kDegree, 1e-14) << degrees;
    EXPECT_NEAR(edge[Measure::normal].rms, degrees * kDegree, 1e-14) << degrees;
    EXPECT_EQ(edge[Measure::curvature].max, 0);
    EXPECT_LT(edge[Measure::gap].max, 1e-15);
    EXPECT_NEAR(edge.length, 2, 1e-14);
    EXPECT_TRUE(edge.sewn);
  }
}

TEST(Continuity, WhichWayNormalsLookIsOfNoAccount) {
  int checked = 0;
  for (const bool turn_floor : {false, true})
    for (const bool turn_flap : {false, true})
      for (const bool mirrored : {false, true})
        for (const double angle : {0.0, 0.1, 1.5, 3.0}) {
          LooseFaces faces;
          add_floor(faces);
          faces.part.faces[0].reversed = turn_floor;
          Face& flap = add_flap(faces, angle);
          flap.reversed = turn_flap;
          // The same triangle with its u axis the other way.
          if (mirrored) {
            Frame& frame = std::get<Plane>(flap.surface).frame;
            frame.O += 2.0 * frame.X;
            frame.X = -frame.X;
          }
          const EdgeContinuity edge = measured_edge(faces.part);
          EXPECT_NEAR(edge[Measure::normal].max, angle, 1e-14);
          EXPECT_EQ(edge.misoriented, turn_floor != (turn_flap != mirrored));
          ++checked;
        }
  EXPECT_EQ(checked, 32);
}

TEST(Continuity, APlaneTangentToACylinderJumpsInCurvatureOnly) {
  for (const double r : {0.5, 3.0, -2.0, 1e3})
    for (const bool reversed : {false, true}) {
      LooseFaces faces;
      add_floor(faces);
      add_ramp(faces, r).reversed = reversed;
      const EdgeContinuity edge = measured_edge(faces.part);
      EXPECT_LT(edge[Measure::normal].max, 1e-15);
      EXPECT_NEAR(edge[Measure::curvature].max * std::abs(r), 1, 1e-13);
      EXPECT_NEAR(edge[Measure::curvature].rms * std::abs(r), 1, 1e-13);
      EXPECT_LT(edge[Measure::gap].max, 1e-13);
    }
}

TEST(Continuity, TangentCylindersJumpByTheDifferenceOfTheirCurvatures) {
  for (const auto& [r1, r2] : {std::pair{1.0, 2.0}, {0.3, 0.3}, {1.0, -4.0}, {-5.0, -0.7}}) {
    LooseFaces faces;
    add_ramp(faces, r1);
    add_ramp(faces, r2).domain = {{-1, 0}, {0, 2}};
    const EdgeContinuity edge = measured_edge(faces.part);
    EXPECT_LT(edge[Measure::normal].max, 1e-15);
    EXPECT_NEAR(edge[Measure::curvature].max, std::abs(1 / r1 - 1 / r2), 1e-13);
  }
}

TEST(Continuity, OctantsOfASphereMeetSmoothly) {
  LooseFaces faces;
  for (int i = 0; i < 4; ++i)
    for (const double v : {-kPi / 2, 0.0}) faces.add_face(Sphere{{}, 2}, {}, {{i * kPi / 2, v}, {(i + 1) * kPi / 2, v + kPi / 2}});
  const Continuity c = measure_continuity(faces.part);
  EXPECT_EQ(count(c, EdgeKind::shared), 12);
  EXPECT_EQ(count(c, EdgeKind::degenerate), 8);
  EXPECT_EQ(c.edges.size(), 20u);
  EXPECT_LT(largest(c, Measure::gap), 1e-14);
  EXPECT_LT(largest(c, Measure::normal), 1e-14);
  EXPECT_LT(largest(c, Measure::curvature), 1e-12);
}

// (u, v) -> (u, v, z) with z = a u^2 for u < 0 and b u^2 for u > 0, on [-1, 1] x [0, 1], times a size: a B-spline whose knot at 0 is C1.
NurbsSurface two_parabolas(double a, double b, double size = 1) {
  NurbsSurface s;
  s.degree_u = 2, s.degree_v = 1;
  s.count_u = 4, s.count_v = 2;
  s.knots_u = {-1, -1, -1, 0, 1, 1, 1};
  s.knots_v = {0, 0, 1, 1};
  // Blossoms of u at knot pairs: x is their mean; z = a u1 u2 of each piece.
  const Vec2 places[] = {{-1, a}, {-0.5, 0}, {0.5, 0}, {1, b}};
  for (const Vec2& p : places)
    for (const double v : {0.0, 1.0}) s.poles.push_back(homogeneous(size * Vec3(p.x, v, p.y), 1));
  return s;
}

TEST(Continuity, AKnotOfAnyOrderIsSeenFromInsideEachFace) {
  // At the knot the first derivatives of the parabolas are 0, so that their curvatures are 2 a and 2 b.
  for (const auto& [a, b] : {std::pair{0.5, 2.0}, {-1.0, 1.0}, {0.7, 0.7}}) {
    const NurbsSurface s = two_parabolas(a, b);
    for (const bool left_first : {true, false}) {
      LooseFaces faces;
      for (const bool left : {left_first, !left_first}) faces.add_face(s, {}, left ? Box2{{-1, 0}, {0, 1}} : Box2{{0, 0}, {1, 1}});
      const EdgeContinuity edge = measured_edge(faces.part);
      EXPECT_LT(edge[Measure::normal].max, 1e-15);
      EXPECT_NEAR(edge[Measure::curvature].max, 2 * std::abs(a - b), 1e-13);
      EXPECT_NEAR(edge[Measure::curvature].rms, 2 * std::abs(a - b), 1e-13);
    }
  }
}

// The Bezier patches, each with its own poles, of a bicubic graph over [0, 2] x [0, 1] that is C2 at u = 1.
NurbsSurface half_of_spline(Random& random, bool first, double size) {
  NurbsSurface s;
  s.degree_u = s.degree_v = 3;
  s.count_u = s.count_v = 4;
  s.knots_u = s.knots_v = {0, 0, 0, 0, 1, 1, 1, 1};
  s.poles.resize(16);
  for (std::size_t j = 0; j < 4; ++j) {
    // A cubic spline with the knots 0, 1, 2 has five poles d; knot insertion gives those of its halves [Farin 2002, ch. 8].
    double d[5];
    for (double& x : d) x = between(random, -1, 1);
    const double b2 = 0.5 * (d[1] + d[2]), b4 = 0.5 * (d[2] + d[3]), b3 = 0.5 * (b2 + b4);
    const double z[2][4] = {{d[0], d[1], b2, b3}, {b3, b4, d[3], d[4]}};
    for (std::size_t i = 0; i < 4; ++i)
      s.poles[i * 4 + j] = homogeneous(size * Vec3((first ? 0 : 1) + double(i) / 3, double(j) / 3, z[first ? 0 : 1][i]), 1);
  }
  return s;
}

TEST(Continuity, BezierPatchesOfASmoothSplineJumpByRounding) {
  for (int seed = 0; seed < 10; ++seed) {
    LooseFaces faces;
    for (const bool first : {true, false}) {
      Random random(static_cast<std::uint64_t>(seed));
      faces.add_face(half_of_spline(random, first, 1), {}, {{0, 0}, {1, 1}});
    }
    const EdgeContinuity edge = measured_edge(faces.part);
    EXPECT_LT(edge[Measure::gap].max, 1e-14);
    EXPECT_LT(edge[Measure::normal].max, 1e-6 * kDegree);
    EXPECT_LT(edge[Measure::normal].max, 1e-13);
    EXPECT_LT(edge[Measure::curvature].max, 1e-11);
  }
}

// Both halves of a box in (u, v), cut from corner to corner or across the middle; the cut is the edge of the file that they share.
Part cut_surface(const AnySurface& surface, const Box2& box, bool obliquely, bool turned) {
  const double middle = 0.5 * (box.lo.x + box.hi.x);
  const UV a = obliquely ? box.lo : UV(middle, box.lo.y), b = obliquely ? box.hi : UV(middle, box.hi.y);
  const std::vector<UV> right = obliquely ? std::vector<UV>{{box.hi.x, box.lo.y}} : std::vector<UV>{box.hi, {box.hi.x, box.lo.y}};
  const std::vector<UV> left = obliquely ? std::vector<UV>{{box.lo.x, box.hi.y}} : std::vector<UV>{{box.lo.x, box.hi.y}, box.lo};
  LooseFaces faces;
  for (const bool first : {true, false}) {
    std::vector<UV> corners = first ? right : left;
    corners.push_back(a);
    TrimLoop loop;
    faces.add_line(loop, a, b);
    UV from = b;
    for (const UV& to : corners) {
      faces.add_line(loop, from, to);
      from = to;
    }
    loop.curves[0].edge = 0;
    faces.add_face(surface, {loop}, box).reversed = turned && first;
  }
  faces.part.edges[0].uses = 2;
  return faces.part;
}

TEST(Continuity, ACutThroughASmoothSurfaceOfAnyKindIsSmooth) {
  Random random(20261122);
  int checked = 0;
  for (int round = 0; round < 4; ++round)
    for (const SurfaceCase& of : random_surfaces(random)) {
      // A box between knots and away from poles and apexes.
      Box2 box;
      for (const int axis : {0, 1}) {
        std::vector<double> at = breaks(of.surface, axis);
        std::erase_if(at, [&](double t) { return t <= of.uv.lo[axis] || t >= of.uv.hi[axis]; });
        const double lo = of.uv.lo[axis], hi = at.empty() ? of.uv.hi[axis] : at[0];
        box.lo[axis] = lo + 0.2 * (hi - lo);
        box.hi[axis] = lo + 0.8 * (hi - lo);
      }
      const bool obliquely = round % 2 == 0, turned = round / 2 == 0;
      const Part part = cut_surface(of.surface, box, obliquely, turned);
      const Continuity c = measure_continuity(part, {-1});
      const EdgeContinuity edge = only(c);
      EXPECT_LT(edge[Measure::gap].max, 1e-12 * part.box.diagonal()) << of.name;
      EXPECT_LT(edge[Measure::normal].max, 1e-12) << of.name;
      EXPECT_EQ(edge.misoriented, turned) << of.name;
      if (edge[Measure::curvature].known()) {
        EXPECT_LT(edge[Measure::curvature].max * part.box.diagonal(), 1e-6) << of.name;
      }
      ++checked;
    }
  EXPECT_EQ(checked, 4 * static_cast<int>(kSurfaceCases));
}

TEST(Continuity, AnEdgeThatCrossesKnotsIsSmoothOnThem) {
  // A cut square to the crease of two parabolas with unlike second derivatives, and one that crosses it obliquely, with samples on it.
  const NurbsSurface s = two_parabolas(0.5, 2);
  NurbsSurface turned = s;
  std::swap(turned.degree_u, turned.degree_v);
  std::swap(turned.count_u, turned.count_v);
  std::swap(turned.knots_u, turned.knots_v);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 4; ++j) turned.poles[static_cast<std::size_t>(i * 4 + j)] = s.poles[static_cast<std::size_t>(j * 2 + i)];
  for (const bool obliquely : {false, true}) {
    const EdgeContinuity edge = only(measure_continuity(cut_surface(turned, {{0, -1}, {1, 1}}, obliquely, false), {-1}));
    int on_the_crease = 0;
    for (const ContinuitySample& sample : edge.samples) on_the_crease += std::abs(sample.place.x) < 1e-12;
    EXPECT_GT(on_the_crease, 0);
    EXPECT_LT(edge[Measure::normal].max, 1e-14);
    EXPECT_LT(edge[Measure::curvature].max, 1e-12);
  }
}

TEST(Continuity, AMovedFaceLeavesAGapOfThatLength) {
  const double d = 1e-3;
  const struct {
    Vec3 moved;
    double gap, off;
  } cases[] = {{{0, 0, d}, d, d}, {{0, d, 0}, d, 0}, {{0, -d, 0}, d, 0}, {{0, d, d}, std::sqrt(2) * d, d}};
  for (const auto& [moved, gap, off] : cases) {
    LooseFaces faces;
    add_floor(faces);
    add_flap(faces, 0, 1, moved);
    EXPECT_EQ(count(measure_continuity(faces.part), EdgeKind::free), 7) << "farther apart than any tolerance";
    const EdgeContinuity edge = measured_edge(faces.part, 2 * d);
    EXPECT_NEAR(edge[Measure::gap].max, gap, 1e-15);
    EXPECT_NEAR(edge[Measure::gap].rms, gap, 1e-15);
    EXPECT_NEAR(edge[Measure::off].max, off, 1e-15);
  }
}

TEST(Continuity, TheLargestGapIsClimbedToBetweenSamples) {
  // The far face begins along z = h 3 t (1 - t)^2, at most 4/9 h, at t = 1/3.
  const double h = 1e-4;
  NurbsSurface s;
  s.degree_u = 3, s.degree_v = 1;
  s.count_u = 4, s.count_v = 2;
  s.knots_u = {0, 0, 0, 0, 1, 1, 1, 1};
  s.knots_v = {0, 0, 1, 1};
  for (int i = 0; i < 4; ++i)
    for (const double y : {0.0, 1.0}) s.poles.push_back(homogeneous(Vec3(2 * i / 3.0, y, i == 1 ? h : 0), 1));
  LooseFaces faces;
  add_floor(faces);
  faces.add_face(s, {}, {{0, 0}, {1, 1}});
  const EdgeContinuity edge = measured_edge(faces.part, 1e-3);
  EXPECT_NEAR(edge[Measure::gap].max / h, 4.0 / 9, 1e-6);
  EXPECT_NEAR(edge[Measure::gap].place.x, 2.0 / 3, 1e-3);
  // The mean square of 3 t (1 - t)^2 is 9 B(3, 5) = 9 / 105.
  EXPECT_NEAR(edge[Measure::gap].rms / h, std::sqrt(9.0 / 105), 1e-3);
  EXPECT_GT(edge.evaluations, 33);
  for (const ContinuitySample& sample : edge.samples) EXPECT_LE(sample.value[0], edge[Measure::gap].max);
}

TEST(Continuity, LengthsScaleWithTheModelAndAnglesDoNot) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    LooseFaces faces;
    add_floor(faces, size);
    add_ramp(faces, 0.5 * size, size);
    const EdgeContinuity ramp = measured_edge(faces.part);
    EXPECT_NEAR(ramp[Measure::curvature].max * size, 2, 1e-12);

    LooseFaces loose;
    add_floor(loose, size);
    add_flap(loose, 0.3, size, {0, 0, 1e-5 * size});
    const EdgeContinuity flap = measured_edge(loose.part, 1e-4 * size);
    EXPECT_NEAR(flap[Measure::gap].max / size, 1e-5, 1e-15);
    EXPECT_NEAR(flap[Measure::normal].max, 0.3, 1e-12);

    LooseFaces parabolas;
    for (const bool left : {true, false})
      parabolas.add_face(two_parabolas(1, 2, size), {}, left ? Box2{{-1, 0}, {0, 1}} : Box2{{0, 0}, {1, 1}});
    EXPECT_NEAR(measured_edge(parabolas.part)[Measure::curvature].max * size, 2, 1e-12);
  }
}

TEST(Continuity, TheSeamOfACylinderIsSmoothAndItsRimsAreSharp) {
  Random random(7);
  for (int i = 0; i < 8; ++i) {
    const SolidPart solid = solid_cylinder(i == 0 ? Frame{} : random_frame(random), 2);
    const Continuity c = measure_continuity(solid.part);
    ASSERT_EQ(c.edges.size(), 3u);
    const EdgeContinuity seam = only(c, EdgeKind::seam);
    EXPECT_FALSE(seam.sewn);
    EXPECT_FALSE(seam.misoriented);
    EXPECT_LT(seam[Measure::gap].max, 1e-14);
    EXPECT_LT(seam[Measure::normal].max, 1e-14);
    EXPECT_LT(seam[Measure::curvature].max, 1e-13);
    for (const EdgeContinuity& edge : c.edges) {
      if (edge.kind == EdgeKind::seam) continue;
      EXPECT_FALSE(edge.misoriented);
      EXPECT_NEAR(edge[Measure::normal].max, kPi / 2, 1e-13);
      EXPECT_NEAR(edge[Measure::normal].rms, kPi / 2, 1e-13);
    }
  }
}

TEST(Continuity, TheApexOfAConeIsCountedAndItsSeamIsSmoothUpToIt) {
  const Continuity c = measure_continuity(solid_cone({}, 2).part);
  EXPECT_EQ(count(c, EdgeKind::degenerate), 1);
  const EdgeContinuity seam = only(c, EdgeKind::seam);
  EXPECT_LT(seam[Measure::normal].max, 1e-13);
  EXPECT_EQ(only(c).kind, EdgeKind::shared);
  EXPECT_NEAR(only(c)[Measure::normal].max, kPi - std::atan(2.0), 1e-13);
}

TEST(Continuity, ABoxIsSquareEverywhere) {
  const Continuity c = measure_continuity(solid_box({}, 2).part);
  ASSERT_EQ(c.edges.size(), 12u);
  for (const EdgeContinuity& edge : c.edges) {
    EXPECT_EQ(edge.kind, EdgeKind::shared);
    EXPECT_FALSE(edge.misoriented);
    EXPECT_NEAR(edge[Measure::normal].max, kPi / 2, 1e-14);
    EXPECT_EQ(edge[Measure::curvature].max, 0);
  }
}

TEST(Continuity, AnEdgeMayBeSharedWithTwoFacesInTurn) {
  LooseFaces faces;
  faces.add_rectangle({0, 0}, {2, 1});
  const double angles[] = {0.2, 0.9}, from[] = {0, 0.7}, to[] = {0.7, 2};
  for (const int k : {0, 1}) {
    const Vec3 Y{0, std::cos(angles[k]), std::sin(angles[k])};
    const Plane plane{{{0, 1, 0}, {1, 0, 0}, Y, glm::cross(Vec3(1, 0, 0), Y)}};
    faces.add_polygon({{from[k], 0}, {to[k], 0}, {0.5 * (from[k] + to[k]), 1}}, plane);
  }
  const Continuity c = measure_continuity(faces.part);
  EXPECT_EQ(count(c, EdgeKind::shared), 2);
  for (const EdgeContinuity& edge : c.edges) {
    if (edge.kind != EdgeKind::shared) continue;
    const bool is_first = edge.length < 1;
    EXPECT_NEAR(edge.length, is_first ? 0.7 : 1.3, 1e-12);
    EXPECT_NEAR(edge[Measure::normal].max, angles[is_first ? 0 : 1], 1e-13);
  }
}

TEST(Continuity, OfAnEdgeOfThreeSheetsOnlyTheGapIsTold) {
  LooseFaces faces;
  for (const double angle : {0.0, 2.0, 4.0}) add_flap(faces, angle, 1, {0, 0, angle == 4 ? 1e-6 : 0});
  for (Face& face : faces.part.faces) face.loops[0].curves[0].edge = 0;
  faces.part.edges[0].uses = 3;
  const Continuity c = measure_continuity(faces.part);
  const EdgeContinuity edge = only(c, EdgeKind::non_manifold);
  EXPECT_EQ(edge.sides.size(), 3u);
  EXPECT_NEAR(edge[Measure::gap].max, 1e-6, 1e-15);
  EXPECT_FALSE(edge[Measure::normal].known());
  EXPECT_FALSE(edge[Measure::curvature].known());
}

// The curvature at the begin of a plane cubic Bezier curve.  [Farin 2002, 11.1]
double end_curvature(const Vec2& b0, const Vec2& b1, const Vec2& b2) {
  const Vec2 d1 = b1 - b0, d2 = b2 - b1;
  return 2.0 / 3 * (d1.x * d2.y - d1.y * d2.x) / std::pow(glm::length(d1), 3);
}

TEST(Continuity, BordersOfTheTeapotAreTangentWhereItsPatchesMeet) {
  const auto model = load(data("patches/teapot.bpt"));
  ASSERT_TRUE(model);
  const Continuity c = measure_continuity(model->parts[0]);
  // Handle, spout and body run through each other, and the lid lies on the rim: they share no edges.
  EXPECT_EQ(count(c, EdgeKind::shared), 52);
  EXPECT_EQ(count(c, EdgeKind::free), 16);
  EXPECT_EQ(count(c, EdgeKind::degenerate), 8);
  EXPECT_LT(largest(c, Measure::gap), 1e-14);
  EXPECT_LT(largest(c, Measure::normal), 1e-6 * kDegree);

  // The rim (patches 1 to 4) ends where the body (5 to 8) begins, as it were turned about the axis: at the four corners the jump is that of
  // the meridian's two cubics, of which the body's begins straight.
  const double rim = end_curvature({1.5, 2.4}, {1.4375, 2.53125}, {1.3375, 2.53125});
  int corners = 0;
  for (const EdgeContinuity& edge : c.edges) {
    if (edge.kind != EdgeKind::shared || std::minmax(edge.sides[0].face, edge.sides[1].face).second > 7) continue;
    const ContinuitySample& first = edge.samples.front();
    const Point3 p = model->instances[0].to_model.point(first.place);
    if (edge.sides[0].face / 4 == edge.sides[1].face / 4 || std::abs(p.z - 2.4) > 1e-12) continue;
    EXPECT_NEAR(std::hypot(p.x, p.y), 1.5, 1e-12);
    EXPECT_NEAR(first.value[static_cast<std::size_t>(Measure::curvature)], std::abs(rim), 1e-10);
    ++corners;
  }
  EXPECT_EQ(corners, 4);
}

TEST(Continuity, SewingMayBeOff) {
  LooseFaces faces;
  add_floor(faces);
  add_flap(faces, 0.1);
  EXPECT_EQ(count(measure_continuity(faces.part, {-1}), EdgeKind::free), 7);
}

}  // namespace
}  // namespace iso::test
