#include "raytracer/cmd/scene_view.h"

#include "raytracer/framing.h"

namespace iso {
namespace {

// "mean curvature 1/mm".
std::string legend_title(Shade shade, const std::string& unit) {
  const bool mean = shade == Shade::mean_curvature;
  const std::string title = mean ? "mean curvature" : "gauss curvature";
  return unit.empty() ? title : title + " 1/" + unit + (mean ? "" : "^2");
}

}  // namespace

Camera camera_for(const CameraEntry& entry, const Tracer& tracer, const ImageSize& size) {
  const Projection projection = entry.projection.value_or(Projection::perspective);
  const double fov = entry.fov.value_or(kDefaultFov);
  if (!entry.look_from) return frame_model(tracer, entry.view.value_or(View::iso), projection, fov, size);
  return *look_at(projection, *entry.look_from, *entry.look_at, entry.up, projection == Projection::perspective ? fov : *entry.height);
}

Lights lights_for(const LightsEntry& entry, const Camera& camera) {
  Lights lights = default_lights(camera.right, camera.up, camera.back);
  lights.sky.zenith = entry.zenith.value_or(lights.sky.zenith);
  lights.sky.ground = entry.ground.value_or(lights.sky.ground);
  lights.sky.up = entry.sky_up.value_or(lights.sky.up);
  lights.key.from = entry.key_from.value_or(lights.key.from);
  lights.key.irradiance = entry.key_colour.value_or(lights.key.irradiance) * static_cast<float>(entry.key_strength.value_or(1.0));
  lights.key.angle = entry.key_angle.value_or(lights.key.angle);
  return lights;
}

RenderSettings settings_for(const SceneEntry& scene, unsigned aovs) {
  const double spread = has_stripes(scene.shade) ? stripe_spread(scene.samples) : 1;
  return {scene.size, scene.samples, scene.seed, aovs, scene.background.value_or(Background{}), spread};
}

SceneLook look_for(const SceneEntry& scene, const Tracer& tracer, const Camera& camera, const Sampler& sampler, const std::string& unit) {
  const ShadeOptions& options = scene.shade_options;
  if (scene.shade == Shade::clay) return {.integrator = clay(tracer, lights_for(scene.lights, camera), sampler), .scale = {}, .legend = {}};
  if (has_stripes(scene.shade))
    return {.integrator = stripes(tracer, stripes_for(scene.shade, options, camera), {camera, scene.size, scene.samples}),
            .scale = {},
            .legend = {}};
  if (has_scale(scene.shade)) {
    const ColourScale scale{options.range ? *options.range : automatic_range(tracer, camera, scene.size, scene.shade)};
    SceneLook look{.integrator = curvature_map(tracer, scene.shade, scale), .scale = scale, .legend = {}};
    if (options.legend.value_or(true)) look.legend = Legend{legend_title(scene.shade, unit), scale};
    return look;
  }
  return {.integrator = inspection(tracer, scene.shade, {-camera.back, camera.position, depth_range(camera, tracer.scene().box())}),
          .scale = {},
          .legend = {}};
}

}  // namespace iso
