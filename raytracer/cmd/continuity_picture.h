// The picture of `isophote continuity`: the model in grey, with lines along its edges in false colours.
#pragma once

#include "raytracer/cmd/continuity_report.h"
#include "raytracer/render.h"

namespace iso {

// What colours mean: from `lo` to `hi`, evenly in the logarithm; values beyond are held. All colours are light (linear Rec. 709).
struct EdgeScale {
  std::string label;              // "normal jump, deg"
  double lo = 0, hi = 0;          // 0 < lo < hi, in the unit of the label
  double factor = 1;              // from the measure's own unit to that of the label
  std::vector<Colour> colours;    // evenly spaced; blended
  Colour at(double value) const;  // of a value of the measure
};

// A tenth of the tolerance and less has the first colour; the last stands for `settings.scale`, or the largest value, and never less than
// ten tolerances.
EdgeScale edge_scale(const ContinuityReport& report);

// Edges that are not on the scale: free, non-manifold, and sharp ones in a picture of curvature.
struct EdgePaint {
  Colour free{0.9f, 0.02f, 0.25f}, non_manifold{0.0f, 0.0f, 0.0f}, unknown{0.10f, 0.10f, 0.10f};
};

// The scale for people: "colours: normal jump from 0.01 deg (dark violet) to 90 deg (yellow), logarithmic; free edges red, ..."
std::string legend_text(const ContinuityReport& report, const EdgeScale& scale);

// Draws lines of kLineWidth pixels along every edge of every placed part, where a ray from the camera to the edge is not held up on the
// way. Each line runs through the samples of its edge. `tracer` holds the model's instances in their order.
inline constexpr double kLineWidth = 2.5;
void draw_edges(std::vector<glm::vec4>& rgba, const ContinuityReport& report, const Model& model, const EdgeScale& scale,
                const Tracer& tracer, const Camera& camera, const ImageSize& size);

}  // namespace iso
