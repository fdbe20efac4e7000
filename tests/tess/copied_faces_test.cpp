// A face that a part holds twice is meshed once and told; faces that only look like copies are all meshed.
#include "tess/copied_faces.h"

#include <gtest/gtest.h>

#include "tess/tessellate.h"
#include "tests/support/loose_faces.h"
#include "tests/support/solids.h"

namespace iso::test {
namespace {

const std::vector<UV> kCorners{{0, 0}, {2, 0}, {2, 1}, {0, 1}};

// The rectangle of the corners with u and v exchanged, its borders divided elsewhere and run through the other way.
Face& add_exchanged(LooseFaces& faces) {
  Plane plane;
  std::swap(plane.frame.X, plane.frame.Y);
  Face& face = faces.add_polygon({{0, 0}, {1, 0}, {1, 0.7}, {1, 2}, {0, 2}}, plane, false);
  face.reversed = true;  // (u, v, normal) is left-handed now
  return face;
}

TEST(CopiedFaces, ACopyIsMeshedOnceHoweverItIsWritten) {
  for (const bool exchanged : {false, true}) {
    LooseFaces faces;
    faces.add_polygon(kCorners);
    faces.add_rectangle({2, 0}, {3, 1});
    exchanged ? add_exchanged(faces) : faces.add_polygon(kCorners);
    EXPECT_EQ(copied_faces(faces.part), (std::vector<int>{-1, -1, 0}));

    const PartTessellation once = tessellate(faces.part, {1e-3});
    const MeshReport r = verify(faces.part, once.mesh, notes_of(once));
    EXPECT_EQ(once.faces[2].copy_of, 0);
    EXPECT_EQ(once.faces[2].triangles, 0);
    EXPECT_EQ(once.faces[2].failure, "");
    EXPECT_EQ(once.joins.joined, 1);
    EXPECT_TRUE(r.sound()) << text_of(r);
    EXPECT_EQ(r.topology.open_edges.count, 6u);

    TessellationOptions all{1e-3};
    all.copies = Copies::MeshAll;
    const PartTessellation twice = tessellate(faces.part, all);
    EXPECT_EQ(twice.faces[2].copy_of, -1);
    EXPECT_GT(twice.faces[2].triangles, 0);
  }
}

TEST(CopiedFaces, ACopyOnAnotherKindOfSurface) {
  const Cylinder cylinder{{}, 1};
  const Box2 domain{{0.2, 0}, {1.7, 1}};
  LooseFaces faces;
  faces.add_face(cylinder, {}, domain);
  const NurbsSurface same = as_nurbs(cylinder, domain);
  faces.add_face(same, {}, natural_domain(same));
  EXPECT_EQ(copied_faces(faces.part), (std::vector<int>{-1, 0}));
}

TEST(CopiedFaces, FacesThatOnlyLookAlikeAreNone) {
  const auto none = [](const LooseFaces& faces) {
    const std::vector<int> copies = copied_faces(faces.part);
    return std::all_of(copies.begin(), copies.end(), [](int c) { return c < 0; });
  };
  LooseFaces two_solids, two_sides, two_halves, apart, hole;
  two_solids.add_polygon(kCorners).solid = 0;
  two_solids.add_polygon(kCorners).solid = 1;
  EXPECT_TRUE(none(two_solids));
  two_sides.add_polygon(kCorners);
  two_sides.add_polygon(kCorners).reversed = true;
  EXPECT_TRUE(none(two_sides));
  // Half spheres have the same border.
  two_halves.add_face(Sphere{{}, 1}, {}, {{0, 0}, {kTwoPi, 0.5 * kPi}});
  two_halves.add_face(Sphere{{}, 1}, {}, {{0, -0.5 * kPi}, {kTwoPi, 0}});
  EXPECT_TRUE(none(two_halves));
  Plane above;
  above.frame.O.z = 1e-7;
  apart.add_polygon(kCorners);
  apart.add_polygon(kCorners, above);
  EXPECT_TRUE(none(apart));
  TrimLoop outer, inner;
  for (std::size_t i = 0; i < 4; ++i) hole.add_line(outer, kCorners[i], kCorners[(i + 1) % 4]);
  hole.add_edge(inner, Ellipse<Vec2>{UV(1, 0.5), UV(0.2, 0), UV(0, 0.2)}, kTwoPi, 0);
  hole.add_face(Plane{}, {outer, inner}, {kCorners[0], kCorners[2]});
  hole.add_polygon(kCorners);
  EXPECT_TRUE(none(hole));
}

}  // namespace
}  // namespace iso::test
