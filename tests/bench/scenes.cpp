#include "tests/bench/scenes.h"

#include "patches/io/read_model.h"
#include "tests/bench/timing.h"
#include "tests/bench/uniform_mesh.h"
#include "tests/support/occt_mesh.h"
#include "tests/support/solids.h"

namespace iso::bench {
namespace {

Result<TraceScene> load_file(const std::string& path) {
  auto model = read_model(path);
  if (!model) return model.error();
  TraceScene scene;
  add_model(scene, std::make_shared<const Model>(std::move(*model)), Affine3{});
  return scene;
}

// Open CASCADE's mesh; its share of the box's diagonal is what it is asked for, its angle the library's default, so that the deflection
// decides.
TriangleMesh mesh_cad_file(const std::string& path, const TraceScene& scene, double tolerance) {
  constexpr double kDefaultAngle = 0.5;
  TriangleMesh mesh;
  test::OcctMesh occt;
  mesh.seconds = seconds_of([&] { occt = test::mesh_with_occt(path, {tolerance / scene.box().diagonal(), kDefaultAngle}); });
  mesh.points = std::move(occt.points);
  for (const test::MeshTriangle& triangle : occt.triangles) {
    mesh.triangles.push_back(triangle.corners);
    mesh.error = std::max(mesh.error, static_cast<double>(triangle.deviation));
  }
  return mesh;
}

// ---- the wavy torus ----------------------------------------------------------------------------------------------------

constexpr int kRound = 64, kAcross = 32;  // control points, and Bezier patches, in u and v

// Control points of the closed uniform cubic B-spline: a torus with waves on its tube.
Vec3 control_point(int i, int j) {
  const double u = kTwoPi * i / kRound, v = kTwoPi * j / kAcross;
  const double tube = 0.4 * (1 + 0.12 * std::sin(7 * u) * std::cos(5 * v) + 0.05 * std::sin(13 * u + 3 * v));
  const double reach = 1 + tube * std::cos(v);
  return {reach * std::cos(u), reach * std::sin(u), tube * std::sin(v)};
}

// The k-th Bezier point of a closed uniform cubic B-spline with control points P(0), P(1), ...
template <class P>
Vec3 bezier_point(int k, const P& at) {
  const int i = k / 3;
  if (k % 3 == 1) return (2.0 * at(i) + at(i + 1)) / 3.0;
  if (k % 3 == 2) return (at(i) + 2.0 * at(i + 1)) / 3.0;
  return (at(i - 1) + 4.0 * at(i) + at(i + 1)) / 6.0;
}

NurbsSurface wavy_torus() {
  NurbsSurface surface;
  surface.degree_u = surface.degree_v = 3;
  surface.count_u = 3 * kRound + 1;
  surface.count_v = 3 * kAcross + 1;
  surface.closed_u = surface.closed_v = true;
  const auto knots = [](int spans) {
    std::vector<double> k{0.0};
    for (int i = 0; i <= spans; ++i) k.insert(k.end(), 3, i);
    k.push_back(spans);
    return k;
  };
  surface.knots_u = knots(kRound);
  surface.knots_v = knots(kAcross);
  for (int i = 0; i < surface.count_u; ++i)
    for (int j = 0; j < surface.count_v; ++j) {
      // The last row is the first one again, bit for bit.
      const Vec3 p = bezier_point(i % (3 * kRound), [&](int a) {
        return bezier_point(j % (3 * kAcross), [&](int b) { return control_point((a + kRound) % kRound, (b + kAcross) % kAcross); });
      });
      surface.poles.emplace_back(p, 1.0);
    }
  return surface;
}

}  // namespace

std::vector<BenchScene> bench_scenes() {
  const std::string occt = "/usr/share/opencascade/data/";
  const std::string teapot = ISOPHOTE_TEST_DATA "/patches/teapot.bpt", linkrods = occt + "step/linkrods.step",
                    motor = occt + "occ/Motor-c.brep";
  const auto cad = [](const std::string& name, const std::string& what, const std::string& path) {
    return BenchScene{name, what, [=] { return load_file(path); },
                      [=](const TraceScene& scene, double tolerance) { return mesh_cad_file(path, scene, tolerance); }};
  };
  return {
      {"teapot", "Newell's teapot, bicubic Bezier patches, untrimmed", [=] { return load_file(teapot); }, mesh_uniformly},
      {"wavy-torus", "2048 bicubic patches, closed, curvature continuous",
       [] {
         return Result<TraceScene>(test::one_face(wavy_torus(), {{0, 0}, {kRound, kAcross}}));
       },
       mesh_uniformly},
      cad("linkrods", "occt-misc step/linkrods.step, trimmed, up to degree 6 x 10", linkrods),
      cad("motor-c", "occt-misc occ/Motor-c.brep, trimmed, mostly planes and cylinders", motor),
  };
}

}  // namespace iso::bench
