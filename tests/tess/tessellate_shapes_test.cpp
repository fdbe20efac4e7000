// Meshes of faces at the limits: loops that nearly touch, faces thinner than the tolerance, poles, apexes, collapsed sides, seams.
#include <gtest/gtest.h>

#include "tess/deviation.h"
#include "tess/verify.h"
#include "tests/support/closed_surfaces.h"
#include "tests/support/solid_parts.h"

namespace iso::test {
namespace {

constexpr double kTolerances[] = {1e-2, 1e-3, 1e-4};

// Builds a part of faces whose loops share edges by number.
class PartOf {
 public:
  explicit PartOf(std::string name) { solid_.name = std::move(name); }

  PartOf& face(AnySurface surface, std::vector<std::vector<TrimCurve>> loops) {
    Face face;
    face.surface = std::move(surface);
    for (auto& loop : loops) {
      for (const TrimCurve& c : loop) {
        constexpr int kSteps = 64;
        for (int i = 0; i <= kSteps; ++i) face.domain.include(jet(c.curve, c.t0 + (c.t1 - c.t0) * i / kSteps).C);
        if (c.edge >= static_cast<int>(solid_.part.edges.size())) solid_.part.edges.resize(static_cast<std::size_t>(c.edge) + 1);
        ++solid_.part.edges[static_cast<std::size_t>(c.edge)].uses;
      }
      face.loops.push_back({std::move(loop)});
    }
    solid_.part.faces.push_back(std::move(face));
    return *this;
  }
  PartOf& point_edge(int e) {
    solid_.part.edges[static_cast<std::size_t>(e)].degenerate = true;
    return *this;
  }
  SolidPart done() { return finished(std::move(solid_)); }

 private:
  SolidPart solid_;
};

std::vector<TrimCurve> polygon(const std::vector<UV>& corners, int first_edge) {
  std::vector<TrimCurve> loop;
  for (std::size_t i = 0; i < corners.size(); ++i)
    loop.push_back(straight(corners[i], corners[(i + 1) % corners.size()], first_edge + static_cast<int>(i)));
  return loop;
}
std::vector<TrimCurve> rectangle(UV lo, UV hi, int first_edge) { return polygon({lo, {hi.x, lo.y}, hi, {lo.x, hi.y}}, first_edge); }
TrimCurve arc(UV centre, double r, double from, double to, int edge) {
  TrimCurve c;
  c.curve = Ellipse<Vec2>{centre, Vec2(r, 0), Vec2(0, r)};
  c.t0 = from;
  c.t1 = to;
  c.edge = edge;
  return c;
}

double area(const PartMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += 0.5 * glm::length(glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
  return sum;
}

// Meshes a part within a tolerance; its area may be wrong by the tolerance along a border of this length.
PartTessellation expect_area(const SolidPart& s, double tolerance, double exact, double border) {
  const PartTessellation made = tessellated(s, tolerance);
  EXPECT_NEAR(area(made.mesh), exact, border * tolerance + 1e-12 * exact) << s.name << " " << tolerance;
  return made;
}

TEST(TessellateShapes, AFaceWithAHole) {
  for (const double T : kTolerances) {
    const auto s = PartOf("hole").face(Plane{}, {rectangle({0, 0}, {1, 1}, 0), {arc({0.5, 0.5}, 0.3, kTwoPi, 0, 4)}}).done();
    expect_area(s, T, 1 - kPi * 0.09, kTwoPi * 0.3);
    const auto around_it =
        PartOf("hole of a cylinder").face(Cylinder{{}, 1}, {rectangle({0, 0}, {1, 1}, 0), {arc({0.5, 0.5}, 0.3, kTwoPi, 0, 4)}}).done();
    expect_area(around_it, T, 1 - kPi * 0.09, 8);
  }
}

TEST(TessellateShapes, LoopsThatNearlyTouch) {
  for (const double T : kTolerances)
    for (const double gap : {0.1 * T, 0.01 * T}) {
      const double r = 0.3;
      const auto beside =
          PartOf("hole beside a side").face(Plane{}, {rectangle({0, 0}, {1, 1}, 0), {arc({0.5, r + gap}, r, kTwoPi, 0, 4)}}).done();
      expect_area(beside, T, 1 - kPi * r * r, kTwoPi * r);
      const double q = 0.2;
      const auto holes = PartOf("two holes")
                             .face(Cylinder{{}, 1}, {rectangle({0, 0}, {1, 1}, 0),
                                                     {arc({0.5 - q - 0.5 * gap, 0.5}, q, kTwoPi, 0, 4)},
                                                     {arc({0.5 + q + 0.5 * gap, 0.5}, q, kTwoPi, 0, 5)}})
                             .done();
      expect_area(holes, T, 1 - 2 * kPi * q * q, 8);
    }
}

TEST(TessellateShapes, ASlit) {
  for (const double T : kTolerances)
    for (const double width : {0.1 * T, 1e-3 * T}) {
      const std::vector<std::vector<TrimCurve>> loops{rectangle({0, 0}, {1, 1}, 0),
                                                      polygon({{0.2, 0.5}, {0.2, 0.5 + width}, {0.8, 0.5 + width}, {0.8, 0.5}}, 4)};
      expect_area(PartOf("slit").face(Plane{}, loops).done(), T, 1, 1.3);
      expect_area(PartOf("slit across a cylinder").face(Cylinder{{}, 1}, loops).done(), T, 1, 5);
    }
}

TEST(TessellateShapes, AFaceThinnerThanTheTolerance) {
  for (const double T : kTolerances)
    for (const double width : {0.3 * T, 1e-3 * T}) {
      expect_area(PartOf("thin plane").face(Plane{}, {rectangle({0, 0}, {1, width}, 0)}).done(), T, width, 0);
      expect_area(PartOf("thin band").face(Cylinder{{}, 1}, {rectangle({0, 0}, {2, width}, 0)}).done(), T, 2 * width, width);
      expect_area(PartOf("thin strip").face(Cylinder{{}, 1}, {rectangle({0, 0}, {width, 2}, 0)}).done(), T, 2 * width, 1e-3);
      const double r = 0.4;
      const auto ring = PartOf("thin ring").face(Plane{}, {{arc({0, 0}, r, 0, kTwoPi, 0)}, {arc({0, 0}, r - width, kTwoPi, 0, 1)}}).done();
      const PartTessellation made = tessellated(ring, T);
      EXPECT_NEAR(area(made.mesh) / (kTwoPi * r * width), 1, 0.5) << T << " " << width;
    }
}

TEST(TessellateShapes, TwoEdgesBetweenTheSameTwoVertices) {
  for (const double T : kTolerances)
    for (const double sagitta : {30 * T, 0.3 * T, 0.01 * T}) {
      // Arcs over a chord of length one, bulging both ways.
      const double r = (0.25 + sagitta * sagitta) / (2 * sagitta), half = std::asin(0.5 / r);
      const std::vector<TrimCurve> lens{arc({0, r - sagitta}, r, 1.5 * kPi - half, 1.5 * kPi + half, 0),
                                        arc({0, sagitta - r}, r, 0.5 * kPi - half, 0.5 * kPi + half, 1)};
      std::vector<TrimCurve> hole{lens[1], lens[0]};
      for (TrimCurve& c : hole) std::swap(c.t0, c.t1);
      const double inside = r * r * (2 * half - std::sin(2 * half));
      const auto s = PartOf("lens").face(Plane{}, {lens}).face(Plane{}, {rectangle({-1, -1}, {1, 1}, 2), hole}).done();
      const PartTessellation made = expect_area(s, T, 4, 1e-6);
      EXPECT_GE(made.faces[0].triangles, 2) << T << " " << sagitta;
      EXPECT_LE(inside, 4);
    }
}

TEST(TessellateShapes, ACircleOfOneEdgeIsNeverLessThanATriangle) {
  const auto disc = PartOf("disc").face(Plane{}, {{arc({0, 0}, 1, 0, kTwoPi, 0)}}).done();
  for (const double T : {10.0, 1.0, 0.1, 1e-3}) {
    const PartTessellation made = expect_area(disc, T, kPi, kTwoPi);
    EXPECT_GE(made.faces[0].triangles, 1);
  }
  for (const MakeSolid make : kSolids) tessellated(finished(make({}, 1)), 1);
}

TEST(TessellateShapes, PolesWithSeamsAndLoops) {
  for (const double T : kTolerances)
    for (const double top : {kPi / 2, 0.3}) {
      std::vector<TrimCurve> loop = rectangle({0, -kPi / 2}, {kTwoPi, top}, 0);
      loop[3].edge = 1;  // the seam
      loop[2].edge = 2;
      PartOf part("sphere with a seam");
      part.face(Sphere{{}, 1}, {loop}).point_edge(0);
      if (top > 1) part.point_edge(2);
      expect_area(part.done(), T, kTwoPi * (std::sin(top) + 1), 14);
    }
}

// Rounding may put the end of a file's domain just beyond a pole, where the derivative along the parallel points backward.
TEST(TessellateShapes, NormalsAtPolesLookOutward) {
  constexpr double kBeyond = 4 * kEps;
  const auto ball = finished(untrimmed("ball", Sphere{{}, 1}, {Vec2(0, -kPi / 2 - kBeyond), Vec2(kTwoPi, kPi / 2 + kBeyond)}, 2,
                                       [](const Point3& p) { return std::abs(glm::length(p) - 1); }));
  int poles = 0;
  for (const double T : kTolerances) {
    const PartTessellation made = tessellated(ball, T);
    for (const MeshNode& node : made.mesh.nodes) {
      const Point3& p = made.mesh.points[node.point];
      EXPECT_GT(glm::dot(node.normal, p), 0.999 * glm::length(p)) << node.uv.x << " " << node.uv.y;
      poles += std::abs(p.z) > 0.9999;
    }
  }
  EXPECT_GE(poles, 6);
}

TEST(TessellateShapes, AnApexInsideAndAtTheEnd) {
  for (const double T : kTolerances) {
    tessellated(finished(solid_cone({}, 1)), T);
    // A piece of a cone beside its apex.
    PartOf piece("piece of a cone");
    piece.face(Cone{{}, 1, -0.5}, {rectangle({1, 0}, {2, 1 / std::sin(0.5)}, 0)}).point_edge(2);
    expect_area(piece.done(), T, 0.5 / std::sin(0.5), 3);
  }
}

TEST(TessellateShapes, CollapsedSidesOfNurbs) {
  for (const double T : kTolerances) {
    // A bicubic triangle: the side u = 0 is a point.
    NurbsSurface s;
    s.degree_u = s.degree_v = 3;
    s.count_u = s.count_v = 4;
    s.knots_u = s.knots_v = {0, 0, 0, 0, 1, 1, 1, 1};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) s.poles.emplace_back(i / 3.0, i * (j - 1.5) / 9.0, 0.1 * i * (3 - i), 1.0);
    tessellated(finished(untrimmed("collapsed side", s, {Vec2(0), Vec2(1)}, 1, {})), T);
    const ClosedSurface ball = closed_surface(2);
    tessellated(finished(untrimmed(ball.name, ball.surface, ball.domain, 1, {})), T);
  }
}

// A plane's strip between two rows of poles, three for each span of `v` and one at the end; at any place.
SolidPart strip(const std::string& name, const std::vector<Vec2>& row, const std::vector<Vec2>& other, const Frame& frame) {
  NurbsSurface s;
  s.degree_u = 1;
  s.degree_v = 3;
  s.count_u = 2;
  s.count_v = static_cast<int>(row.size());
  s.knots_u = {0, 0, 1, 1};
  const std::size_t spans = row.size() / 3;
  s.knots_v = {0};
  for (std::size_t i = 0; i <= spans; ++i) s.knots_v.insert(s.knots_v.end(), 3, static_cast<double>(i));
  s.knots_v.push_back(static_cast<double>(spans));
  for (const auto* poles : {&row, &other})
    for (const Vec2& p : *poles) s.poles.push_back(homogeneous(frame.O + p.x * frame.X + p.y * frame.Y, 1));
  return finished(untrimmed(name, s, natural_domain(s), 4, [](const Point3&) { return 0.0; }));
}

const Frame kPlaces[] = {{}, {{0.3, -0.2, 0.7}, {0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}};

// Where a span starts with a pole twice, its derivative is nothing there, and its second derivative leads away from the span before.
TEST(TessellateShapes, NormalsWhereBothSidesStandStillForAMoment) {
  const std::vector<Vec2> side{{0, 1},     {0.3, 1},   {0.6, 1.1}, {1, 1.2}, {1.3, 1.3}, {1.6, 1.2}, {2, 1},
                               {2.3, 0.9}, {2.6, 0.8}, {3, 0.8},   {3, 0.8}, {3.5, 0.7}, {4, 0.5}};
  std::vector<Vec2> base = side;
  for (Vec2& p : base) p.y = 0;
  int there = 0;
  for (const Frame& frame : kPlaces)
    for (const double T : kTolerances) {
      const SolidPart s = strip("strip that halts", base, side, frame);
      const PartTessellation made = tessellated(s, T);
      for (const MeshNode& node : made.mesh.nodes) {
        EXPECT_LT(glm::dot(node.normal, frame.Z), -0.999) << node.uv.x << " " << node.uv.y;
        there += node.uv.y == 3;
      }
    }
  EXPECT_GE(there, 12);
}

// The end of the strip is a line: in a span all of whose poles stand still, and in one where one side runs to the other along that line.
TEST(TessellateShapes, SpansWithoutArea) {
  const Vec2 a{3, 0.2}, c{3.1, 0};
  const std::vector<Vec2> side{{0, 0.2}, {1, 0.5}, {2, 0.3}, a, a, a, a, a, a, c}, base{{0, 0}, {1, 0}, {2, 0}, c, c, c, c, c, c, c};
  int left_out = 0;
  for (const Frame& frame : kPlaces)
    for (const double T : {1e-1, 3e-2, 1e-2, 3e-3}) {
      const SolidPart s = strip("strip that ends as a line", base, side, frame);
      const PartTessellation made = tessellated(s, T);
      const MeshReport r = verify(s.part, made.mesh, notes_of(made));
      EXPECT_TRUE(r.sound()) << T << " " << text_of(r);
      left_out += made.faces[0].collapsed;
    }
  EXPECT_GT(left_out, 0);
}

TEST(TessellateShapes, ClosedNurbsWithoutLoopsAreClosedMeshes) {
  for (int i = 0; i < kClosedSurfaces; ++i) {
    const ClosedSurface closed = closed_surface(i);
    for (const double T : {1e-2, 1e-3}) {
      const SolidPart s = finished(untrimmed(closed.name, closed.surface, closed.domain, closed.size, {}));
      const PartTessellation made = tessellated(s, T * closed.size);
      const MeshReport r = verify(s.part, made.mesh, notes_of(made));
      EXPECT_TRUE(r.topology.closed()) << closed.name << " " << T << ": " << text_of(r.topology);
      const auto euler = static_cast<std::int64_t>(r.topology.points - r.topology.edges + r.topology.triangles);
      EXPECT_EQ(euler, i == 2 ? 2 : 0) << closed.name << " " << T;
    }
  }
}

TEST(TessellateShapes, ALoopThatRunsBackOverItself) {
  for (const double T : kTolerances) {
    const auto s = PartOf("spike").face(Plane{}, {polygon({{0, 0}, {2, 0}, {1, 0}, {1, 1}, {0, 1}}, 0)}).done();
    const PartTessellation made = expect_area(s, T, 1, 0);
    EXPECT_EQ(made.faces[0].crossings, 0);
    EXPECT_EQ(made.mesh.triangles.size(), 2u);
  }
}

TEST(TessellateShapes, LoopsThatTouchShareTheirVertex) {
  const std::vector<TrimCurve> hole = polygon({{0, 0}, {1, 2}, {2, 1}}, 4);
  std::vector<TrimCurve> lid;  // the same edges, the other way
  for (auto c = hole.rbegin(); c != hole.rend(); ++c) lid.push_back({c->curve, c->t1, c->t0, c->edge});
  const auto s = PartOf("hole at a corner").face(Plane{}, {rectangle({0, 0}, {3, 3}, 0), hole}).face(Plane{}, {lid}).done();
  const PartTessellation made = expect_area(s, 1e-2, 9, 0);
  const MeshReport r = verify(s.part, made.mesh, notes_of(made));
  EXPECT_EQ(r.topology.open_edges.count, 4u);
  EXPECT_EQ(r.cracks.count, 0u);
}

TEST(TessellateShapes, ATorusThatMeetsItselfInItsMiddle) {
  for (const double T : kTolerances) {
    const double width = 1.5;
    const auto s = PartOf("horn torus")
                       .face(Torus{{}, 1, 1}, {polygon({{0, 0}, {width, 0}, {width, kPi}, {width, kTwoPi}, {0, kTwoPi}, {0, kPi}}, 0)})
                       .done();
    const PartTessellation made = expect_area(s, T, width * kTwoPi, 2 * kTwoPi + width);
    const MeshReport r = verify(s.part, made.mesh, notes_of(made));
    EXPECT_EQ(r.folded.count, 0u);
    EXPECT_EQ(r.topology.zero_area.count, 0u);
    EXPECT_EQ(r.cracks.count, 0u);
  }
}

TEST(TessellateShapes, FacesAcrossTheSeam) {
  for (const double T : kTolerances) {
    expect_area(PartOf("cylinder across its seam").face(Cylinder{{}, 1}, {rectangle({5, 0}, {8, 1}, 0)}).done(), T, 3, 8);
    const double exact = 3 * (3 * 1.0 + 0.4 * (std::sin(9.0) - std::sin(6.0))) * 0.4;
    expect_area(PartOf("torus across its seams").face(Torus{{}, 1, 0.4}, {rectangle({5, 6}, {8, 9}, 0)}).done(), T, exact, 12);
    const auto turn = PartOf("more than a turn").face(Cylinder{{}, 1}, {{arc({6, 0.5}, 0.4, 0, kTwoPi, 0)}}).done();
    expect_area(turn, T, kPi * 0.16, 3);
  }
}

// A chamfer: beside its curved border triangles reach beyond the face in (u, v), where the cone leaves them along itself.
TEST(TessellateShapes, WhatIsMeasuredIsOfTheFaceWhereItsBorderIsCurved) {
  const double w = 0.52, top = 6;
  NurbsCurve<Vec2> border;
  border.degree = 2;
  border.knots = {0, 0, 0, 1, 1, 1};
  border.poles = {homogeneous(Vec2(-w, 0), 1), homogeneous(Vec2(0, 9), 1), homogeneous(Vec2(w, 0), 1)};
  const auto line = [](const Vec2& a, const Vec2& b, int edge) { return TrimCurve{Line<Vec2>{a, b - a}, 0, 1, edge}; };
  const auto s = PartOf("chamfer")
                     .face(Cone{{}, 30, -kPi / 3},
                           {{{border, 0, 1, 0}, line({w, 0}, {w, top}, 1), line({w, top}, {-w, top}, 2), line({-w, top}, {-w, 0}, 3)}})
                     .done();
  for (const double T : {0.5, 0.06, 0.006}) {
    const PartTessellation made = tessellated(s, T);
    const FaceDeviation found = measure(s.part, made.mesh, Sampling::quick).faces[0];
    EXPECT_LE(made.faces[0].bound, T);
    EXPECT_LE(found.worst, made.faces[0].bound + made.faces[0].offset + 1e-11 * s.size) << T;
    EXPECT_GT(found.worst, 0.2 * made.faces[0].bound) << T;
  }
}

}  // namespace
}  // namespace iso::test
