// From primary hits to colours. An integrator is handed the primary rays of a batch with their hits and gives radiance; the clay look,
// the inspection shades and those of smoothness (smoothness.h) are three of them, light transport will be another.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "raytracer/sampling.h"
#include "raytracer/tracer.h"

namespace iso {

enum class Shade {
  clay,
  normals,
  uv,
  faces,
  kinds,
  curvature,
  depth,
  solver,
  zebra,
  reflection_lines,
  isophotes,
  mean_curvature,
  gauss_curvature
};
inline constexpr std::array<const char*, 13> kShadeNames{
    "clay",  "normals",          "uv",        "faces",          "kinds",          "curvature", "depth", "solver",
    "zebra", "reflection-lines", "isophotes", "mean-curvature", "gauss-curvature"};
std::optional<Shade> shade_named(std::string_view name);

// Primary rays of one batch; the three arrays have equal length.
struct PrimaryHits {
  std::span<const SampleId> samples;
  std::span<const Ray> rays;
  std::span<const Hit> hits;
};

// Writes premultiplied colour and coverage of each ray that hits; `out` comes filled with the background. Called from many threads at once.
using Integrator = std::function<void(const PrimaryHits&, std::span<glm::vec4> out, SolverStats&)>;

// A sky whose radiance goes linearly from `ground` (along -up) to `zenith` (along up), so that its irradiance is closed-form.
struct Sky {
  Vec3 up{0, 0, 1};
  Colour zenith{0.74f, 0.78f, 0.84f}, ground{0.26f, 0.245f, 0.23f};
};

// A distant light, a disc in the sky.
struct KeyLight {
  Vec3 from{0, 0, 1};            // unit vector toward the light
  Colour irradiance{1.0f};       // on a surface that faces it, over pi: a white surface shows this radiance
  double angle = 4 * kPi / 180;  // diameter, radians
};

struct Lights {
  Sky sky;
  KeyLight key;
};

// Sky and key light that go with the camera: from above, the key from the upper left.
Lights default_lights(const Vec3& right, const Vec3& up, const Vec3& back);

// Diffuse with a slight gloss, sky occlusion and soft shadows, both sides alike.
Integrator clay(const Tracer& tracer, const Lights& lights, const Sampler& sampler);

// What an inspection shade needs to know of the view.
struct InspectionView {
  Vec3 forward{0, 0, -1};
  Vec3 eye{0.0};
  Range depth;
};
Integrator inspection(const Tracer& tracer, Shade shade, const InspectionView& view);

// The colour given to a hit by the scene, its file, or the default clay.
Colour base_colour(const Tracer& tracer, const Hit& hit);

}  // namespace iso
