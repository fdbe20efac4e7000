#include "raytracer/cmd/compare_slope.h"

#include <algorithm>
#include <cmath>

#include "raytracer/cmd/compare_figures.h"

namespace iso {

double mean_width(const TraceScene& scene) {
  double area = 0, sum = 0;
  for (const Placed& placed : scene.placed) {
    const PartMesh& mesh = *placed.mesh;
    for (std::size_t f = 0; f < placed.part->faces.size(); ++f) {
      if (std::holds_alternative<Plane>(placed.part->faces[f].surface)) continue;
      for (std::uint32_t t = mesh.first_triangle[f]; t < mesh.first_triangle[f + 1]; ++t) {
        Point3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = placed.to_world.point(mesh.corner(mesh.triangles[t], k));
        const double twice = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
        const double longest = std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
        if (longest == 0) continue;
        area += twice;
        sum += twice * twice / longest;
      }
    }
  }
  return area > 0 ? sum / area : 0;
}

double slope_of(const CompareReport& report) {
  std::vector<std::pair<double, double>> points;
  double x_sum = 0, y_sum = 0;
  for (const ReportMesh& mesh : report.meshes) {
    const double rms = distance_of(report, mesh.comparison).rms;
    if (!mesh.ours || !(mesh.width > 0) || !(rms > 0)) continue;
    points.emplace_back(std::log(mesh.width), std::log(rms));
    x_sum += points.back().first, y_sum += points.back().second;
  }
  constexpr std::size_t kFewest = 3;
  if (points.size() < kFewest) return 0;
  const double n = static_cast<double>(points.size());
  double xx = 0, xy = 0;
  for (const auto& [x, y] : points) {
    xx += (x - x_sum / n) * (x - x_sum / n);
    xy += (x - x_sum / n) * (y - y_sum / n);
  }
  constexpr double kLeastSpread = 0.01;  // of the logarithm: widths that are nearly one tell no slope
  return xx > n * kLeastSpread ? xy / xx : 0;
}

}  // namespace iso
