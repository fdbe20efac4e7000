// The camera and the lights of a scene, with what it leaves open filled in.
#pragma once

#include "raytracer/camera.h"
#include "raytracer/scene_file.h"
#include "raytracer/shading.h"
#include "raytracer/tracer.h"

namespace iso {

Camera camera_for(const CameraEntry& entry, const Tracer& tracer, const ImageSize& size);

// Those that are not given go with the camera.
Lights lights_for(const LightsEntry& entry, const Camera& camera);

// What makes the scene's colours. The arguments have to live as long as it does.
Integrator integrator_for(const SceneEntry& scene, const Tracer& tracer, const Camera& camera, const Sampler& sampler);

}  // namespace iso
