#include "raytracer/chart_root.h"

namespace iso {

namespace {

constexpr int kMostSteps = 12;

}  // namespace

const PatchChart* blended_chart(const AnySurface& surface) {
  const auto* chart = std::get_if<PatchChart>(&surface);
  return chart && chart->error > 0 ? chart : nullptr;
}

ChartRoot root_on_chart(const PatchChart& chart, const LocalRay& ray, const Vec2& start) {
  const double rounding = 4 * kEps * ray.scale;
  ChartRoot root{.st = start};
  double least = kInf;
  Vec2 st = start;
  while (root.steps < kMostSteps) {
    const Tangents at = tangents_of(chart, st);
    ++root.steps;
    const Vec2 F{glm::dot(ray.n1, at.S) - ray.d1, glm::dot(ray.n2, at.S) - ray.d2};
    const double off = glm::length(F);
    if (off < least) {
      least = off;
      root.st = st;
      root.t = ray.t_of(at.S);
    }
    const double a = glm::dot(ray.n1, at.Ss), b = glm::dot(ray.n1, at.St), c = glm::dot(ray.n2, at.Ss), d = glm::dot(ray.n2, at.St);
    const double det = a * d - b * c;
    if (!(std::abs(det) > 1e-300)) break;
    const Vec2 step{(b * F.y - d * F.x) / det, (c * F.x - a * F.y) / det};
    const double size = std::max(std::abs(step.x), std::abs(step.y));
    if (off <= rounding || size < kLastChartStep) {
      // The last step to first order.
      const Vec2 move = size < kLastChartStep ? step : Vec2(0.0);
      root.st = st + move;
      root.t = ray.t_of(at.S + move.x * at.Ss + move.y * at.St);
      return root;
    }
    if (!(size < 1)) break;
    st = glm::clamp(st + step, Vec2(-kBeyondChart), Vec2(1 + kBeyondChart));
  }
  root.met = false;
  return root;
}

}  // namespace iso
