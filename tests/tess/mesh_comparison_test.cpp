// Meshes against exact faces: figures that have closed forms, and what must not change them.
#include "tess/mesh_comparison.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "tests/support/foreign_meshes.h"
#include "tests/support/load.h"
#include "tests/support/mesh_distance.h"

namespace iso::test {
namespace {

// Of the size.
constexpr double kRight = 1e-9;

// `max` is the truth, and the bound above it by no more than a few times what the reference allows.
void expect_truth(const OneSided& found, double truth, double size, double reference_bound, const std::string& what) {
  EXPECT_NEAR(found.max, truth, kRight * size) << what;
  EXPECT_GE(found.bound, truth - 1e-14 * size) << what;
  EXPECT_GE(found.bound, found.max) << what;
  EXPECT_LE(found.bound - found.max, 3 * reference_bound) << what;
  EXPECT_LE(found.mean, found.rms * (1 + 1e-6)) << what;
  EXPECT_LE(found.p999, found.max * (1 + 1e-6)) << what;
}

TEST(MeshComparison, PrismInACylinderIsOffByTheSagittaBothWays) {
  const Model model = model_of(solid_cylinder({}, 1).part);
  for (const int n : {3, 8, 40}) {
    const MeshComparison c = compared(model, prism_mesh(n, 0.5, 1));
    // The middle of a side is this deep, at any height; the nearest cap is farther from its middle.
    const double truth = 0.5 * (1 - std::cos(kPi / n));
    for (const FaceComparison* f : {&c.all, &c.faces[0]}) {
      expect_truth(f->to_surface, truth, 1, c.reference_bound, fmt::format("{} sides, to the surface", n));
      expect_truth(f->to_mesh, truth, 1, c.reference_bound, fmt::format("{} sides, to the mesh", n));
    }
    // Caps: the mesh is in them; their rims stand out over the prism's.
    for (const int f : {1, 2}) {
      EXPECT_NEAR(c.faces[f].to_surface.max, 0, kRight);
      EXPECT_NEAR(c.faces[f].to_mesh.max, truth, c.reference_bound) << n;
    }
    EXPECT_EQ(c.topology.triangles, 4u * n);
    EXPECT_TRUE(c.topology.closed());
  }
}

TEST(MeshComparison, IcosphereIsOffByItsDeepestCircumcentreBothWays) {
  constexpr double kRadius = 2;
  SolidPart ball = solid_sphere({}, 2 * kRadius);
  const Model model = model_of(std::move(ball.part));
  for (int level = 0; level <= 4; ++level) {
    const ForeignMesh mesh = icosphere(level, kRadius);
    ASSERT_EQ(mesh.triangles.size(), 20u << (2 * level));
    // All triangles are acute, so that their deepest point is below the circumcentre; the sphere's point over it has that for its nearest
    // one, since the polyhedron is convex.
    double deepest = 0;
    for (const auto& [i, j, k] : mesh.triangles) {
      const Point3 &a = mesh.points[i], &b = mesh.points[j], &c = mesh.points[k];
      const double x = glm::length(b - c), y = glm::length(c - a), z = glm::length(a - b), longest = std::max({x, y, z});
      ASSERT_GT(x * x + y * y + z * z, 2 * longest * longest);
      const double circle = x * y * z / (2 * glm::length(glm::cross(b - a, c - a)));
      deepest = std::max(deepest, circle * circle / (kRadius + std::sqrt(kRadius * kRadius - circle * circle)));
      if (level > 2) continue;
      const Vec3 n = glm::cross(b - a, c - a);
      for (const Point3& p : mesh.points) ASSERT_LE(glm::dot(p - a, n), 1e-12);
    }
    const MeshComparison c = compared(model, mesh);
    expect_truth(c.all.to_surface, deepest, 2 * kRadius, c.reference_bound, fmt::format("level {}, to the surface", level));
    expect_truth(c.all.to_mesh, deepest, 2 * kRadius, c.reference_bound, fmt::format("level {}, to the mesh", level));
    EXPECT_TRUE(c.topology.closed());
    EXPECT_NEAR(c.all.area, 4 * kPi * kRadius * kRadius, 1e-3 * c.all.area);
  }
}

// With an odd number of squares one is about the origin, with corners at (+-h, +-h, +-h^2). The middle of its diagonal, (0, 0, h^2), is
// h^2 off, and nothing is farther, since nothing is farther along z. From the origin the nearest point is on the planes of the two
// triangles, whose slope is sqrt(2) h; all other squares are steeper.
TEST(MeshComparison, GridOnASaddleIsOffBySquaresOfItsWidth) {
  const Model model = saddle_model();
  for (const int n : {1, 3, 5, 15}) {
    const double h = 1.0 / n, to_surface = h * h, to_mesh = h * h / std::sqrt(1 + 2 * h * h);
    const ForeignMesh mesh = saddle_mesh(n);
    const MeshComparison c = compared(model, mesh);
    expect_truth(c.all.to_surface, to_surface, 3, c.reference_bound, fmt::format("{} squares, to the surface", n));
    expect_truth(c.all.to_mesh, to_mesh, 3, c.reference_bound, fmt::format("{} squares, to the mesh", n));
    // Dense sampling knows nothing of the closed form.
    double most = 0;
    constexpr int kSamples = 150;
    for (int i = 0; i <= kSamples; ++i)
      for (int j = 0; j <= kSamples; ++j) {
        const double x = -1 + 2.0 * i / kSamples, y = -1 + 2.0 * j / kSamples;
        double nearest = kInf;
        for (const auto& [p, q, r] : mesh.triangles) {
          if (glm::length(Vec2(mesh.points[p]) - Vec2(x, y)) > 4 * h + 0.1) continue;
          nearest = std::min(nearest, distance_to_triangle({x, y, x * y}, mesh.points[p], mesh.points[q], mesh.points[r]));
        }
        most = std::max(most, nearest);
      }
    EXPECT_LE(most, to_mesh * (1 + 1e-12));
    EXPECT_GE(most, 0.9 * to_mesh);
    EXPECT_EQ(c.free_edges, 4u * n);
    EXPECT_TRUE(c.faults.empty());
  }
}

TEST(MeshComparison, APlaneIsNotOffItself) {
  SolidPart square = untrimmed("square", Plane{}, {{-1, -1}, {1, 1}}, 2, {});
  const Model model = model_of(std::move(square.part));
  const MeshComparison c = compared(model, grid_mesh(7, [](double, double) { return 0.0; }));
  EXPECT_NEAR(c.all.to_surface.max, 0, 1e-15);
  EXPECT_NEAR(c.all.to_mesh.max, 0, 1e-15);
  const double rounding = 64 * kEps * 2;  // of coordinates up to 1 in squares of side 2
  EXPECT_LE(c.all.to_surface.bound, 3 * c.reference_bound + rounding);
  EXPECT_LE(c.all.to_mesh.bound, 3 * c.reference_bound + rounding);
  EXPECT_EQ(c.all.worst_angle, 0);
  EXPECT_TRUE(c.faults.empty());
}

// All figures, as bits.
std::vector<double> figures(const MeshComparison& c) {
  std::vector<double> all;
  const auto add_side = [&](const OneSided& s) {
    all.insert(all.end(), {s.max, s.mean, s.rms, s.p999, s.bound, s.at.x, s.at.y, s.at.z, s.area});
  };
  const auto add = [&](const FaceComparison& f) {
    add_side(f.to_surface);
    add_side(f.to_mesh);
    all.insert(all.end(), {double(f.placed), double(f.face), double(f.triangles), f.area, f.covered, f.inward, f.worst_angle, f.mean_angle,
                           f.worst_angle_at.x, f.worst_angle_at.y, f.worst_angle_at.z, double(f.open_edges), f.shapes.smallest_angle});
  };
  for (const FaceComparison& f : c.faces) add(f);
  add(c.all);
  all.insert(all.end(), {double(c.worst_face), double(c.worst_angle_face), c.widest_gap, double(c.free_edges), c.reference_bound,
                         double(c.reference_triangles), double(c.topology.open_edges.count)});
  for (const FaultFound& f : c.faults) all.insert(all.end(), {double(f.fault), double(f.count), f.at.x, f.at.y, f.at.z, double(f.face)});
  return all;
}

// A real model with a mesh of it that is damaged a little.
struct Damaged {
  std::shared_ptr<const Model> model;
  ForeignMesh mesh;
  double size = 0;

  explicit Damaged(const std::string& file) : model(load(data("cad/" + file))) {
    size = box_of(*model).diagonal();
    const std::vector<PlacedPart> placed = placed_parts(*model);
    const ExactFaces faces(placed, 1e-3 * size);
    mesh.points = faces.points();
    mesh.triangles = faces.triangles();
    mesh.triangles.erase(mesh.triangles.begin() + 7);
    std::swap(mesh.triangles[30][0], mesh.triangles[30][1]);
    mesh.points[mesh.triangles[50][0]] += Vec3(0.003, 0.002, 0.001) * size;
  }
};

TEST(MeshComparison, DoesNotDependOnTheNumberOfThreads) {
  for (const char* file : {"occt-screw.step", "axom-sliced-cylinder.step"}) {
    const Damaged damaged(file);
    std::vector<std::vector<double>> found;
    std::vector<std::string> texts;
    for (const std::size_t threads : {1, 2, 2}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const MeshComparison c = compared(*damaged.model, damaged.mesh);
      found.push_back(figures(c));
      for (const FaultFound& f : c.faults) texts.push_back(f.text);
      EXPECT_GE(c.faults.size(), 2u);
    }
    for (std::size_t k = 1; k < 3; ++k) {
      ASSERT_EQ(found[k].size(), found[0].size());
      EXPECT_EQ(std::memcmp(found[k].data(), found[0].data(), found[0].size() * sizeof(double)), 0) << file;
    }
    EXPECT_GT(found[0].size(), 200u);
  }
}

TEST(MeshComparison, DoesNotDependOnPlaceTurnSideAndSize) {
  const Damaged damaged("occt-screw.step");
  // All are compared with references of the same fineness, so that they differ by rounding.
  const double reference = 1e-4 * damaged.size;
  const MeshComparison plain = compared(*damaged.model, damaged.mesh, {}, {"", reference});
  const double a = 0.7, b = 1.9;
  const Mat3 turn = Mat3(std::cos(a), std::sin(a), 0, -std::sin(a), std::cos(a), 0, 0, 0, 1) *
                    Mat3(1, 0, 0, 0, std::cos(b), std::sin(b), 0, -std::sin(b), std::cos(b));
  const Vec3 away = 1e4 * damaged.size * Vec3(0.6, -0.5, 0.62);
  struct Case {
    const char* name;
    Affine3 by;
    double scale, slack;  // slack: of the size
  };
  // What is 1e4 sizes away has lost four digits, and half of those that are left where a distance is flat at its largest.
  for (const auto& [name, by, scale, slack] :
       {Case{"far and turned", {turn, away}, 1, 1e-7}, Case{"turned", {turn, Vec3(0.0)}, 1, 1e-7},
        Case{"large", {Mat3(1e3), Vec3(0.0)}, 1e3, 1e-7}, Case{"small", {Mat3(1e-3), Vec3(0.0)}, 1e-3, 1e-7},
        Case{"mirrored", {Mat3(-1, 0, 0, 0, 1, 0, 0, 0, 1), Vec3(0.0)}, 1, 1e-7}}) {
    const MeshComparison c = compared(*damaged.model, moved(damaged.mesh, by), by, {"", reference * scale});
    EXPECT_EQ(names_of(c.faults), names_of(plain.faults)) << name;
    ASSERT_EQ(c.faces.size(), plain.faces.size());
    int other_way = 0;
    for (std::size_t f = 0; f <= c.faces.size(); ++f) {
      const FaceComparison &x = f < c.faces.size() ? c.faces[f] : c.all, &y = f < c.faces.size() ? plain.faces[f] : plain.all;
      const std::string what = fmt::format("{}, face {}", name, f);
      // Triangles as near to one face as to another may change sides by rounding.
      if (x.triangles != y.triangles) {
        ++other_way;
        continue;
      }
      const auto same = [&](const OneSided& p, const OneSided& q) {
        // At the borders of faces distances are right to what the reference's border may be off.
        const bool is_border = std::max(p.max / scale, q.max) <= plain.reference_bound;
        EXPECT_NEAR(p.max / scale, q.max, is_border ? plain.reference_bound : slack * damaged.size) << what;
        EXPECT_NEAR(p.mean / scale, q.mean, slack * damaged.size) << what;
        EXPECT_NEAR(p.rms / scale, q.rms, slack * damaged.size) << what;
        EXPECT_GE(p.bound, p.max) << what;
        EXPECT_LE(std::abs(p.bound / scale - q.bound), 3 * plain.reference_bound) << what;
      };
      same(x.to_surface, y.to_surface);
      same(x.to_mesh, y.to_mesh);
      EXPECT_NEAR(x.covered / (scale * scale), y.covered, 1e-6 * plain.all.area) << what;
      EXPECT_NEAR(x.inward / (scale * scale), y.inward, 1e-6 * plain.all.area) << what;
      EXPECT_NEAR(x.worst_angle, y.worst_angle, 1e-3) << what;
    }
    EXPECT_LE(other_way, 2) << name;
  }
}

TEST(MeshComparison, APlacedPartsFacesAreItsOwn) {
  Model model = model_of(solid_cylinder({}, 1).part);
  const Affine3 first = model.instances[0].to_model;
  model.instances.push_back(model.instances[0]);
  // The second one is turned over, mirrored and larger.
  const Affine3 second{Mat3(2, 0, 0, 0, 2, 0, 0, 0, -2), Vec3(5, 0, 1)};
  model.instances[1].to_model = second * first;
  ForeignMesh mesh = prism_mesh(40, 0.5, 1);
  const ForeignMesh other = moved(prism_mesh(8, 0.5, 1), second);
  const auto offset = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + offset, b + offset, c + offset});
  const MeshComparison c = compared(model, mesh);
  ASSERT_EQ(c.faces.size(), 6u);
  for (std::size_t f = 0; f < 6; ++f) {
    EXPECT_EQ(c.faces[f].placed, f < 3 ? 0 : 1);
    EXPECT_EQ(c.faces[f].face, static_cast<int>(f % 3));
    EXPECT_EQ(c.faces[f].inward, 0) << f;
    const std::uint64_t sides = f < 3 ? 40 : 8;
    EXPECT_EQ(c.faces[f].triangles, f % 3 == 0 ? 2 * sides : sides);
  }
  EXPECT_NEAR(c.faces[0].to_surface.max, 0.5 * (1 - std::cos(kPi / 40)), kRight);
  EXPECT_NEAR(c.faces[0].to_mesh.max, 0.5 * (1 - std::cos(kPi / 40)), kRight);
  EXPECT_NEAR(c.faces[3].to_surface.max, 1 - std::cos(kPi / 8), kRight);
  EXPECT_NEAR(c.faces[3].to_mesh.max, 1 - std::cos(kPi / 8), kRight);
  EXPECT_TRUE(c.faults.empty()) << c.faults[0].text;
}

// Samples and searches that share nothing with the comparison (mesh_distance.h) find nothing beyond it, and nearly all of it.
TEST(MeshComparison, SearchFindsNothingBeyond) {
  for (const char* file : {"axom-sliced-cylinder.step", "occt-wing.brep"}) {
    const auto model = load(data(std::string("cad/") + file));
    ASSERT_EQ(model->parts.size(), 1u);
    const Part& part = model->parts[0];
    const double size = box_of(*model).diagonal();
    const PartTessellation made = tessellate(part, {.distance = 2e-3 * size});
    ForeignMesh mesh;
    mesh.points = made.mesh.points;
    for (const Triangle& t : made.mesh.triangles)
      mesh.triangles.push_back({made.mesh.nodes[t[0]].point, made.mesh.nodes[t[1]].point, made.mesh.nodes[t[2]].point});
    const std::vector<PlacedPart> placed{{&part, {}}};
    const MeshComparison c = compare_mesh(placed, mesh, {}, [](double) {});
    // What is found to be less than half of the largest distance needs no search of the whole face.
    const double enough = 0.5 * std::min(c.all.to_surface.max, c.all.to_mesh.max);
    Random random(5);
    const DistanceSearch search = search_distances(part, made.mesh, std::vector<double>(part.faces.size(), enough), 3000, random);
    double to_surface = 0, to_mesh = 0;
    for (const FarSample& s : search.beyond) (s.to_mesh ? to_mesh : to_surface) = std::max(s.to_mesh ? to_mesh : to_surface, s.distance);
    EXPECT_LE(to_surface, c.all.to_surface.max + kRight * size) << file;
    EXPECT_LE(to_mesh, c.all.to_mesh.max + kRight * size) << file;
    EXPECT_GE(to_surface, 0.95 * c.all.to_surface.max) << file;
    EXPECT_GE(to_mesh, 0.95 * c.all.to_mesh.max) << file;
    EXPECT_GE(search.samples, 6000u);
  }
}

}  // namespace
}  // namespace iso::test
