// The pictures of a comparison: the exact surface and a mesh, seen by one camera, with one light, one seed and equal samples.
//
// All are rendered without background, which is laid under them afterwards, so that silhouettes can be told. Same input, same bytes, for
// any number of threads.
#pragma once

#include <atomic>
#include <optional>

#include "raytracer/cmd/compare_paint.h"
#include "raytracer/cmd/compare_report.h"
#include "raytracer/render.h"

namespace iso {

// A mesh of others as it can be traced: one part with one face, in the world's coordinates; its normals are those of the triangles.
Placed placed_foreign(const ForeignMesh& mesh);

// One colour for everything: those of a model's file, which meshes of others do not have, would count as differences.
void paint_evenly(TraceScene& scene);

// What makes light of hits, for the tracer of the exact surface and that of the mesh alike; clay with lights that go with the camera.
using Look = std::function<Integrator(const Tracer&, const Camera&, const Sampler&)>;
Integrator clay_look(const Tracer& tracer, const Camera& camera, const Sampler& sampler);

struct PictureSettings {
  Camera camera;
  ImageSize size;
  int samples = 16;         // a pixel
  int painted_samples = 4;  // of the fields, which cost more than light does
  std::uint64_t seed = 0;
  Background background;
  Look look = clay_look;
  // The upper end of the scales, world units and radians; else the largest value in the picture.
  std::optional<double> deviation_scale, normal_scale;
  std::string version, unit;  // for the files; unit may be empty
  int threads = 1;            // of the encoder
};

// `done` hears shares of the work of one call, 0 to 1, from any thread; when `stop` becomes true the call ends with Exit::interrupted.
struct PictureProgress {
  const std::atomic<bool>& stop;
  std::function<void(double)> done;
};

// A picture and the bytes of its EXR, whose name is picture.file.
struct PictureFile {
  ReportPicture picture;
  std::string exr;
};

// Linear and premultiplied.
struct DirectPicture {
  Image bare;  // without background
  Image seen;  // over it
  PictureFile file;
};
Result<DirectPicture> picture_direct(const Tracer& exact, const PictureSettings& settings, const PictureProgress& progress);

// The exact surface's mean curvature, with a scale that leaves out one pixel of a hundred at each end.
Result<PictureFile> picture_curvature(const Tracer& exact, const PictureSettings& settings, const PictureProgress& progress);

struct MeshToShow {
  const Tracer* tracer = nullptr;        // of the scene with the mesh in the surfaces' place
  std::string name;                      // files are called NAME-deviation.exr
  bool smooth = true;                    // its normals are not the triangles' own; for the title
  SurfaceField deviation, normal_error;  // at exact hits: world units, radians; empty: not painted
  SurfaceField curvature = {};           // of the mesh, likewise; 1 / world unit
  std::optional<ReportLegend> curvature_scale = {};
};
struct MeshPictures {
  std::vector<PictureFile> files;  // tessellated, difference, silhouette, deviation, normals, curvature, facets
  ReportImages images;
};
Result<MeshPictures> pictures_of(const MeshToShow& mesh, const Tracer& exact, const DirectPicture& direct, const PictureSettings& settings,
                                 const PictureProgress& progress);

}  // namespace iso
