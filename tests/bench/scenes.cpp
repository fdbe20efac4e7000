#include "tests/bench/scenes.h"

#include "patches/io/read_model.h"
#include "tests/bench/occt_plate.h"
#include "tests/bench/uniform_mesh.h"
#include "tests/support/occt_mesh.h"
#include "tests/support/paths.h"
#include "tests/support/smooth_tori.h"

namespace iso::bench {
namespace {

Result<TraceScene> load_file(const std::string& path) {
  auto model = read_model(path);
  if (!model) return model.error();
  TraceScene scene;
  add_model(scene, std::make_shared<const Model>(std::move(*model)), Affine3{});
  return scene;
}

// Open CASCADE's mesh. It is asked for the tolerance as a deflection, with the library's default angle, so that the deflection decides; the
// mesher does not always keep it, so the mesh may be coarser than the tolerance, never much finer.
TriangleMesh mesh_cad_file(const std::string& path, const TraceScene& scene, double tolerance) {
  constexpr double kDefaultAngle = 0.5;
  test::OcctMesh occt = test::mesh_with_occt(path, {tolerance / scene.box().diagonal(), kDefaultAngle});
  TriangleMesh mesh;
  mesh.seconds = occt.seconds;
  mesh.points = std::move(occt.points);
  std::vector<float> deviations;
  for (const test::MeshTriangle& triangle : occt.triangles) {
    mesh.triangles.push_back(triangle.corners);
    deviations.push_back(triangle.deviation);
  }
  std::sort(deviations.begin(), deviations.end());
  mesh.error = deviations.back();
  mesh.usual_error = deviations[(deviations.size() - 1) * 99 / 100];
  return mesh;
}

constexpr double kCoarse = 1e-4, kFineCad = 1e-5, kFine = 1e-6;

BenchScene cad(const std::string& name, const std::string& what, const std::string& path, std::vector<std::string> rays) {
  return {name,
          what,
          std::move(rays),
          {kCoarse, kFineCad},
          [=] { return load_file(path); },
          [=](const TraceScene& scene, double tolerance) { return mesh_cad_file(path, scene, tolerance); },
          path};
}

BenchScene smooth(const std::string& name, const std::string& what, std::vector<std::string> rays,
                  const std::function<NurbsSurface()>& make) {
  return {name,
          what,
          std::move(rays),
          {kCoarse, kFine},
          [=] {
            const NurbsSurface surface = make();
            return Result<TraceScene>(test::one_face(surface, natural_domain(surface)));
          },
          mesh_uniformly,
          {}};
}

BenchScene teapot() {
  const std::string path = test::data("patches/teapot.bpt");
  return {"teapot",
          "Newell's teapot, 32 bicubic Bezier patches, some with a side in a point",
          {"primary", "bounce"},
          {kCoarse},
          [=] { return load_file(path); },
          mesh_uniformly,
          path};
}

// The plate's file lives as long as the scene.
BenchScene plate() {
  const auto dir = std::make_shared<test::TemporaryDir>();
  const std::string path = (dir->path() / "plate.brep").string();
  return {"plate",
          "a plate with 25 blind holes and pins: planes, cylinders, cones, spheres, trimmed",
          {"primary", "bounce", "room", "occlusion"},
          {kCoarse},
          [=]() -> Result<TraceScene> {
            write_plate_with_pins(path);
            return load_file(path);
          },
          [=, keep = dir](const TraceScene& scene, double tolerance) { return mesh_cad_file(path, scene, tolerance); },
          {}};
}

}  // namespace

std::vector<BenchScene> bench_scenes() {
  const std::string occt = "/usr/share/opencascade/data/";
  std::vector<std::string> all = kRaySets;
  all.erase(std::find(all.begin(), all.end(), "first-image"));
  const std::vector<std::string> rays{"primary", "bounce", "room"}, with_image{"primary", "bounce", "room", "occlusion", "first-image"};
  return {
      smooth("wavy-torus", "2048 bicubic patches, closed, curvature continuous", all, [] { return test::wavy_torus(64, 32); }),
      smooth("small-torus", "32 bicubic patches, closed, curvature continuous", {"primary", "bounce", "room", "occlusion"},
             [] { return test::wavy_torus(8, 4); }),
      smooth("rational-torus", "torus of 16 rational biquadratic patches", rays, test::rational_torus),
      teapot(),
      plate(),
      cad("linkrods", "occt-misc step/linkrods.step, trimmed, up to degree 6 x 10", occt + "step/linkrods.step", with_image),
      cad("motor-c", "occt-misc occ/Motor-c.brep, trimmed, mostly planes and cylinders", occt + "occ/Motor-c.brep", with_image),
      cad("hammer", "occt-misc iges/hammer.iges, trimmed", occt + "iges/hammer.iges", rays),
      cad("propeller", "occt-misc occ/Propeller.rle, trimmed", occt + "occ/Propeller.rle", rays),
  };
}

}  // namespace iso::bench
