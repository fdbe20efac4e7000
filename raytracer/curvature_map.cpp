// Curvature in false colours, and the range that fits a picture.
#include "raytracer/smoothness.h"

namespace iso {
namespace {

constexpr ImageSize kGrid{128, 96};  // rays
constexpr double kShare = 0.95;      // of the curved places
// Mean curvature in 1 / diagonal of the scene, or its square for the Gaussian: flatter places do not count.
constexpr double kFlat = 1e-6;

std::vector<Hit> hits_of_grid(const Tracer& tracer, const Camera& camera, const ImageSize& size) {
  std::vector<Ray> rays;
  for (int y = 0; y < kGrid.height; ++y)
    for (int x = 0; x < kGrid.width; ++x)
      rays.push_back(camera_ray(camera, size, (x + 0.5) * size.width / kGrid.width, (y + 0.5) * size.height / kGrid.height));
  std::vector<Hit> hits(rays.size());
  SolverStats stats;  // not part of the picture's own statistics
  tracer.nearest(rays, hits, Tracer::Order::coherent, stats);
  return hits;
}

}  // namespace

double curvature_value(Shade shade, const Curvatures& k) {
  ISO_CHECK(has_scale(shade));
  return shade == Shade::mean_curvature ? -0.5 * (k.k1 + k.k2) : k.k1 * k.k2;
}

Integrator curvature_map(const Tracer& tracer, Shade shade, const ColourScale& scale) {
  return [&tracer, shade, scale](const PrimaryHits& batch, std::span<glm::vec4> out, SolverStats&) {
    for (std::size_t i = 0; i < batch.hits.size(); ++i)
      if (batch.hits[i]) out[i] = glm::vec4(scale.colour(curvature_value(shade, tracer.curvatures(batch.hits[i]))), 1.0f);
  };
}

Range automatic_range(const Tracer& tracer, const Camera& camera, const ImageSize& size, Shade shade) {
  const double diagonal = tracer.scene().box().diagonal();
  const double of_size = diagonal > 0 ? 2 / diagonal : 1;
  const double unit = shade == Shade::mean_curvature ? of_size : of_size * of_size;
  const double flat = shade == Shade::mean_curvature ? kFlat : kFlat * kFlat;
  std::vector<double> values;
  for (const Hit& hit : hits_of_grid(tracer, camera, size)) {
    if (!hit) continue;
    const double value = std::abs(curvature_value(shade, tracer.curvatures(hit)));
    if (std::isfinite(value) && value > flat * unit) values.push_back(value);
  }
  double end = unit;
  if (!values.empty()) {
    const auto rank = values.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), rank, values.end());
    end = *rank;
  }
  end = round_up(end);
  return {-end, end};
}

}  // namespace iso
