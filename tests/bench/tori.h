// Closed surfaces of smooth patches, made by formula.
#pragma once

#include "raytracer/trace_scene.h"

namespace iso::bench {

// A torus with waves on its tube: round x across bicubic patches, curvature continuous.
TraceScene wavy_torus(int round, int across);

// A torus of 4 x 4 rational biquadratic patches.
TraceScene rational_torus();

}  // namespace iso::bench
