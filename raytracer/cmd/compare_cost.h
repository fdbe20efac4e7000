// What a scene costs to trace.
#pragma once

#include "raytracer/camera.h"
#include "raytracer/cmd/compare_report.h"

namespace iso {

// Rates on one thread, from rays through the middles of pixels and from their hits to the outside (cosine-distributed, a fixed sequence);
// medians of some rounds. `tessellate_seconds` stays 0.
ReportCost cost_of(const Tracer& tracer, const Camera& camera, const ImageSize& size);

// Where it was measured: "AMD EPYC, 2 threads"; the processor is left out where the system does not tell it.
std::string machine_text(int threads);

}  // namespace iso
