// A camera that shows all of a model and little else.
#pragma once

#include "raytracer/camera.h"

namespace iso {

// Frames the placed parts from a named view: first by their boxes, then tightly by what is seen, from points of the trim curves and a
// coarse grid of rays. What reaches further than all of these stays within the margin.
Camera frame_model(const Tracer& tracer, View view, Projection projection, double fov_degrees, const ImageSize& size);

}  // namespace iso
