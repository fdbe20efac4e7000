// The camera and the lights of a scene, with what it leaves open filled in.
#pragma once

#include "raytracer/camera.h"
#include "raytracer/legend.h"
#include "raytracer/scene_file.h"
#include "raytracer/shading.h"
#include "raytracer/tracer.h"

namespace iso {

Camera camera_for(const CameraEntry& entry, const Tracer& tracer, const ImageSize& size);

// Those that are not given go with the camera.
Lights lights_for(const LightsEntry& entry, const Camera& camera);

RenderSettings settings_for(const SceneEntry& scene, unsigned aovs);

// What makes the scene's colours, and the legend to be drawn into the picture. The arguments have to live as long as the integrator does.
struct SceneLook {
  Integrator integrator;
  std::optional<ColourScale> scale;
  std::optional<Legend> legend;
};
// `unit`: of the coordinates, empty if unknown.
SceneLook look_for(const SceneEntry& scene, const Tracer& tracer, const Camera& camera, const Sampler& sampler, const std::string& unit);

}  // namespace iso
