#include "raytracer/cmd/scene_view.h"

#include "raytracer/framing.h"

namespace iso {

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

Integrator integrator_for(const SceneEntry& scene, const Tracer& tracer, const Camera& camera, const Sampler& sampler) {
  if (scene.shade == Shade::clay) return clay(tracer, lights_for(scene.lights, camera), sampler);
  return inspection(tracer, scene.shade, {-camera.back, camera.position, depth_range(camera, tracer.scene().box())});
}

}  // namespace iso
