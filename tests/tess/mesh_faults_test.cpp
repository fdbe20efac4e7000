// What is wrong with a mesh, by name: sound meshes of real models have no faults, and each damage done to one is caught at its place.
#include "tess/mesh_faults.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/foreign_meshes.h"
#include "tests/support/load.h"

namespace iso::test {
namespace {

ForeignMesh foreign(const ExactFaces& faces) {
  ForeignMesh mesh;
  mesh.points = faces.points();
  mesh.triangles = faces.triangles();
  return mesh;
}

// A model with its own proven mesh.
struct Sound {
  std::shared_ptr<const Model> model;
  std::vector<PlacedPart> placed;
  double size = 0;
  std::unique_ptr<ExactFaces> faces;
  ForeignMesh mesh;

  Sound(std::shared_ptr<const Model> read, double share) : model(std::move(read)), placed(placed_parts(*model)) {
    size = box_of(*model).diagonal();
    faces = std::make_unique<ExactFaces>(placed, share * size);
    mesh = foreign(*faces);
  }
  Sound(const std::string& file, double share) : Sound(load(data("cad/" + file)), share) {}

  MeshComparison compared(const ForeignMesh& other) const {
    return compare_mesh(placed, other, {model->unit, 0}, [](double) {});
  }
  std::vector<FaultFound> faults(const ForeignMesh& other) const { return compared(other).faults; }
  Point3 middle(std::size_t t) const {
    return (mesh.points[mesh.triangles[t][0]] + mesh.points[mesh.triangles[t][1]] + mesh.points[mesh.triangles[t][2]]) / 3.0;
  }
  double area(std::size_t t) const {
    const auto& [a, b, c] = mesh.triangles[t];
    return 0.5 * glm::length(glm::cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]));
  }
  // The triangle with the largest area.
  std::size_t largest() const {
    std::size_t at = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (area(t) > area(at)) at = t;
    return at;
  }
};

const FaultFound* find(const std::vector<FaultFound>& faults, MeshFault fault) {
  for (const FaultFound& f : faults)
    if (f.fault == fault) return &f;
  return nullptr;
}

std::string texts(const std::vector<FaultFound>& faults) {
  std::string all;
  for (const FaultFound& f : faults) all += fmt::format("{}: {}\n", name_of(f.fault), f.text);
  return all;
}

const std::vector<std::string> kModels{"axom-sliced-cylinder.step", "cadquery-red-cube-blue-cylinder.step",
                                       "occt-screw.step",           "occtjs-conical-surface.step",
                                       "occtjs-cube-mm.step",       "mayo-issue-332.stp",
                                       "axom-revolved-sphere.step", "nist-mbe-pmi-11.stp",
                                       "bladex-blade-tip.iges",     "occt-wing.brep"};

void expect_no_faults(const std::vector<double>& shares) {
  std::size_t checked = 0;
  for (const std::string& file : kModels)
    for (const double share : shares) {
      const Sound sound(file, share);
      const MeshComparison c = sound.compared(sound.mesh);
      EXPECT_TRUE(c.faults.empty()) << file << " at " << share << "\n" << texts(c.faults);
      // And the distances are those that were promised.
      EXPECT_LE(c.all.to_surface.max, sound.faces->bound() + 1e-14 * sound.size) << file << " at " << share;
      EXPECT_LE(c.all.to_mesh.max, sound.faces->bound() + 1e-14 * sound.size) << file << " at " << share;
      EXPECT_GE(c.all.to_surface.bound, c.all.to_surface.max);
      EXPECT_GE(c.all.to_mesh.bound, c.all.to_mesh.max);
      EXPECT_LT(c.all.worst_angle, kPi / 2) << file << " at " << share << " on face " << c.worst_angle_face;
      ++checked;
    }
  EXPECT_EQ(checked, kModels.size() * shares.size());
}

TEST(MeshFaults, OurOwnMeshesHaveNone) { expect_no_faults({1e-2, 1e-3}); }
TEST(MeshFaultsSlow, OurOwnFineMeshesHaveNone) { expect_no_faults({1e-4}); }

ForeignMesh without(const Sound& sound, std::uint32_t first, std::uint32_t end) {
  ForeignMesh mesh = sound.mesh;
  mesh.triangles.erase(mesh.triangles.begin() + first, mesh.triangles.begin() + end);
  return mesh;
}

void expect_missing_faces_named(const std::vector<std::string>& files, int least, int most_small) {
  int checked = 0, small = 0;
  for (const std::string& file : files) {
    const Sound sound(file, 1e-3);
    for (const ExactFaces::Known& face : sound.faces->faces()) {
      const MeshComparison c = sound.compared(without(sound, face.first, face.end));
      const auto& faults = c.faults;
      const FaultFound* fault = find(faults, MeshFault::missing_face);
      const auto i = static_cast<std::size_t>(&face - sound.faces->faces().data());
      const std::string what =
          fmt::format("{} face {}.{}, {} from the mesh\n{}", file, face.placed, face.face, c.faces[i].to_mesh.max, texts(faults));
      EXPECT_TRUE(find(faults, MeshFault::open_edges)) << what;
      // A face no wider than what is usual for the mesh is near to its neighbours' mesh everywhere, and so is one that lies on a face of
      // another part: they show as open edges alone.
      if (!fault && c.faces[i].to_mesh.max < 4e-3 * sound.size) {
        ++small;
        continue;
      }
      EXPECT_TRUE(fault) << what;
      if (!fault) continue;
      EXPECT_EQ(fault->face, face.face) << what;
      EXPECT_EQ(fault->placed, face.placed) << what;
      ++checked;
    }
  }
  EXPECT_GE(checked, least);
  EXPECT_LE(small, most_small);
}

TEST(MeshFaults, AMissingFaceIsNamed) {
  expect_missing_faces_named({"axom-sliced-cylinder.step", "occtjs-conical-surface.step", "occtjs-cube-mm.step"}, 15, 0);
}
TEST(MeshFaultsSlow, AMissingFaceOfAnAssemblyIsNamed) {
  expect_missing_faces_named({"mayo-issue-332.stp", "cadquery-red-cube-blue-cylinder.step"}, 10, 2);
}

TEST(MeshFaults, AMovedPointIsFar) {
  for (const char* file : {"axom-sliced-cylinder.step", "occt-screw.step", "axom-revolved-sphere.step", "occtjs-cube-mm.step"}) {
    const double share = 1e-3;
    const Sound sound(file, share);
    ForeignMesh mesh = sound.mesh;
    // A corner that has nothing else to lie on where it goes.
    std::uint32_t a = TriangleTree::kNone;
    for (std::size_t t = sound.mesh.triangles.size() / 2; t < sound.mesh.triangles.size() && a == TriangleTree::kNone; ++t) {
      const auto& [p, q, r] = mesh.triangles[t];
      const Vec3 n = glm::cross(mesh.points[q] - mesh.points[p], mesh.points[r] - mesh.points[p]);
      const Point3 to = mesh.points[p] + 10 * share * sound.size * glm::normalize(n);
      if (!(sound.faces->nearest(to).distance > 9.9 * share * sound.size)) continue;
      a = p;
      mesh.points[p] = to;
    }
    ASSERT_NE(a, TriangleTree::kNone) << file;
    const MeshComparison found = sound.compared(mesh);
    const FaultFound* fault = find(found.faults, MeshFault::far_points);
    ASSERT_TRUE(fault) << file << "\n" << texts(found.faults);
    EXPECT_EQ(fault->count, 1u) << file;
    EXPECT_NEAR(glm::length(fault->at - mesh.points[a]), 0, 1e-12 * sound.size);
    // At a corner of a solid the nearest face may be a neighbour's.
    EXPECT_NEAR(found.all.to_surface.max, 10 * share * sound.size, share * sound.size) << file;
    EXPECT_NEAR(glm::length(found.all.to_surface.at - mesh.points[a]), 0, 1e-12 * sound.size);
    EXPECT_EQ(names_of(found.faults), std::vector<std::string>{"far-points"}) << file << "\n" << texts(found.faults);
  }
}

TEST(MeshFaults, TurnedTrianglesAreNamedByHowManyThereAre) {
  for (const char* file : {"axom-sliced-cylinder.step", "occt-screw.step", "occtjs-conical-surface.step", "occtjs-cube-mm.step"}) {
    const Sound sound(file, 1e-3);
    ForeignMesh all = sound.mesh;
    for (PointTriangle& t : all.triangles) std::swap(t[0], t[1]);
    EXPECT_EQ(names_of(sound.faults(all)), std::vector<std::string>{"inside-out"}) << file << "\n" << texts(sound.faults(all));

    double area = 0;
    for (const ExactFaces::Known& known : sound.faces->faces()) area += known.area;
    for (std::size_t f = 0; f < std::min<std::size_t>(sound.faces->faces().size(), 2); ++f) {
      const ExactFaces::Known& known = sound.faces->faces()[f];
      if (known.area > 0.8 * area) continue;
      ForeignMesh face = sound.mesh;
      for (std::uint32_t t = known.first; t < known.end; ++t) std::swap(face.triangles[t][0], face.triangles[t][1]);
      const auto faults = sound.faults(face);
      EXPECT_EQ(names_of(faults), std::vector<std::string>{"turned-face"}) << file << " " << f << "\n" << texts(faults);
      if (faults.size() != 1) continue;
      EXPECT_EQ(faults[0].face, known.face);
      EXPECT_EQ(faults[0].count, known.end - known.first);
    }

    ForeignMesh one = sound.mesh;
    const std::size_t t = sound.largest();
    const std::uint32_t face = sound.faces->face_of(static_cast<std::uint32_t>(t));
    const ExactFaces::Known& known = sound.faces->faces()[face];
    std::swap(one.triangles[t][0], one.triangles[t][1]);
    const auto faults = sound.faults(one);
    ASSERT_EQ(faults.size(), 1u) << file << "\n" << texts(faults);
    EXPECT_EQ(faults[0].fault, MeshFault::turned_triangles) << texts(faults);
    EXPECT_EQ(faults[0].count, 1u);
    EXPECT_EQ(faults[0].face, known.face);
    EXPECT_NEAR(glm::length(faults[0].at - sound.middle(t)), 0, 1e-12 * sound.size);
  }
}

TEST(MeshFaults, DoubledAndDeletedTrianglesAreNamed) {
  for (const char* file : {"axom-sliced-cylinder.step", "occt-screw.step", "occtjs-conical-surface.step"}) {
    const Sound sound(file, 1e-3);
    const std::size_t t = sound.mesh.triangles.size() / 2;
    ForeignMesh doubled = sound.mesh;
    doubled.triangles.push_back(doubled.triangles[t]);
    const auto twice = sound.faults(doubled);
    const FaultFound* fault = find(twice, MeshFault::doubled_triangles);
    ASSERT_TRUE(fault) << file << "\n" << texts(twice);
    EXPECT_EQ(fault->count, 1u);
    EXPECT_NEAR(glm::length(fault->at - sound.middle(t)), 0, 1e-9 * sound.size) << texts(twice);

    // A hole of three sides.
    const std::size_t wide = sound.largest();
    const auto hole = sound.compared(without(sound, static_cast<std::uint32_t>(wide), static_cast<std::uint32_t>(wide) + 1));
    fault = find(hole.faults, MeshFault::open_edges);
    ASSERT_TRUE(fault) << file << "\n" << texts(hole.faults);
    EXPECT_EQ(fault->count, 3u);
    const auto& corners = sound.mesh.triangles[wide];
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, glm::length(sound.mesh.points[corners[k]] - sound.mesh.points[corners[(k + 1) % 3]]));
    EXPECT_LE(glm::length(fault->at - sound.middle(wide)), longest) << file;
    EXPECT_GT(hole.widest_gap, 0) << file;
    EXPECT_LE(hole.widest_gap, longest) << file;
  }
}

TEST(MeshFaults, SizeUnitAndPlaceAreNamed) {
  for (const char* file : {"axom-sliced-cylinder.step", "occt-screw.step"}) {
    const Sound sound(file, 1e-3);
    ASSERT_EQ(sound.model->unit, "mm");
    const auto only = [&](const Affine3& by) {
      const auto faults = sound.faults(moved(sound.mesh, by));
      EXPECT_EQ(faults.size(), 1u) << file << "\n" << texts(faults);
      return faults.empty() ? FaultFound{} : faults[0];
    };
    const FaultFound inches = only({Mat3(1 / 25.4), Vec3(0.0)});
    EXPECT_EQ(inches.fault, MeshFault::unit) << inches.text;
    EXPECT_EQ(inches.unit, "in");
    EXPECT_NEAR(inches.ratio, 1 / 25.4, 1e-3 / 25.4);
    const FaultFound twice = only({Mat3(25.4), Vec3(0.0)});
    EXPECT_EQ(twice.fault, MeshFault::unit) << twice.text;
    EXPECT_NEAR(twice.ratio, 25.4, 0.0254);
    const FaultFound metres = only({Mat3(1e-3), Vec3(0.0)});
    EXPECT_EQ(metres.unit, "m") << metres.text;
    const FaultFound other = only({Mat3(1.7), Vec3(0.0)});
    EXPECT_EQ(other.fault, MeshFault::size) << other.text;
    EXPECT_NEAR(other.ratio, 1.7, 1.7e-3);
    EXPECT_EQ(only({Mat3(1.0), Vec3(0.1 * sound.size, 0, 0)}).fault, MeshFault::placement);
    EXPECT_EQ(only({Mat3(1, 0, 0, 0, 0, -1, 0, 1, 0), Vec3(0.0)}).fault, MeshFault::placement) << file;
  }
}

TEST(MeshFaults, AFarTriangleIsForeign) {
  for (const char* file : {"axom-sliced-cylinder.step", "occt-screw.step"}) {
    const Sound sound(file, 1e-3);
    ForeignMesh mesh = sound.mesh;
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    const Point3 far = box_of(*sound.model).middle() + Vec3(0.01, 0, 0) * sound.size;
    // Inside of the solid, so that the mesh keeps its size.
    for (const Vec3& d : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}) mesh.points.push_back(far + 1e-3 * sound.size * d);
    mesh.triangles.push_back({first, first + 1, first + 2});
    const auto faults = sound.faults(mesh);
    const FaultFound* fault = find(faults, MeshFault::foreign_triangles);
    ASSERT_TRUE(fault) << file << "\n" << texts(faults);
    EXPECT_EQ(fault->count, 1u);
    EXPECT_LE(glm::length(fault->at - far), 2e-3 * sound.size);
  }
}

TEST(MeshFaults, UnweldedPointsAreOpenEdges) {
  const Sound sound("axom-sliced-cylinder.step", 1e-2);
  ForeignMesh mesh;
  for (const PointTriangle& t : sound.mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (const std::uint32_t p : t) mesh.points.push_back(sound.mesh.points[p]);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshComparison c = sound.compared(mesh);
  EXPECT_EQ(names_of(c.faults), std::vector<std::string>{"open-edges"}) << texts(c.faults);
  EXPECT_EQ(c.topology.open_edges.count, 3 * mesh.triangles.size());
  // The edges lie on each other: the cracks have no width.
  EXPECT_LE(c.widest_gap, 1e-12 * sound.size);
}

}  // namespace
}  // namespace iso::test
