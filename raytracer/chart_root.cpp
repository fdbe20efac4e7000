#include "raytracer/chart_root.h"

namespace iso {

namespace {

constexpr int kMostSteps = 12;
// Of the way from the spline to the chart: where a root cannot be followed so far, the ray touches.
constexpr double kShortest = 1e-3;

Tangents spline_at(const PatchChart& chart, const Vec2& st) {
  const Jet2 jet = jet2(*chart.near, st);
  return {jet.S, jet.Su, jet.Sv};
}

// On the surface `share` of the way from the spline to the chart.
Tangents between(const PatchChart& chart, const Vec2& st, double share) {
  const Tangents exact = tangents_of(chart, st);
  if (share == 1) return exact;
  const Tangents spline = spline_at(chart, st);
  return {glm::mix(spline.S, exact.S, share), glm::mix(spline.Ss, exact.Ss, share), glm::mix(spline.St, exact.St, share)};
}

// The two plane equations of a ray on a surface: rows of their Jacobian (a b), (c d).
struct Equations {
  Vec2 F;
  double a, b, c, d, determinant;
};
Equations equations(const LocalRay& ray, const Tangents& at) {
  Equations e{.F = {glm::dot(ray.n1, at.S) - ray.d1, glm::dot(ray.n2, at.S) - ray.d2},
              .a = glm::dot(ray.n1, at.Ss),
              .b = glm::dot(ray.n1, at.St),
              .c = glm::dot(ray.n2, at.Ss),
              .d = glm::dot(ray.n2, at.St),
              .determinant = 0};
  e.determinant = e.a * e.d - e.b * e.c;
  return e;
}

// Newton from root.st on the surface between. False, and root left as it was but for the steps, where it does not stay on its side, does
// not converge at once, or leaves the chart.
bool moves_to(const PatchChart& chart, const LocalRay& ray, double share, bool turned, ChartRoot& root) {
  const double rounding = 4 * kEps * ray.scale;
  Vec2 st = root.st;
  double last = kBeyondChart / kChartContraction;
  for (int k = 0; k < kMostSteps; ++k) {
    const Tangents at = between(chart, st, share);
    ++root.steps;
    const Equations e = equations(ray, at);
    if (!(turned ? e.determinant < -1e-300 : e.determinant > 1e-300)) return false;
    const Vec2 step = Vec2(e.b * e.F.y - e.d * e.F.x, e.c * e.F.x - e.a * e.F.y) / e.determinant;
    const double size = std::max(std::abs(step.x), std::abs(step.y));
    if (glm::length(e.F) <= rounding || size < kLastChartStep) {
      // The last step to first order.
      const Vec2 move = size < kLastChartStep ? step : Vec2(0.0);
      root.st = st + move;
      root.t = ray.t_of(at.S + move.x * at.Ss + move.y * at.St);
      return true;
    }
    if (!(size <= kChartContraction * last)) return false;
    last = size;
    st += step;
    if (!Box2{Vec2(-kBeyondChart), Vec2(1 + kBeyondChart)}.contains(st)) return false;
  }
  return false;
}

}  // namespace

const PatchChart* blended_chart(const AnySurface& surface) {
  const auto* chart = std::get_if<PatchChart>(&surface);
  return chart && chart->error > 0 ? chart : nullptr;
}

ChartRoot root_on_chart(const PatchChart& chart, const LocalRay& ray, const Vec2& start) {
  ChartRoot root{.st = start};
  const bool turned = equations(ray, spline_at(chart, start)).determinant < 0;
  double share = 0, ahead = 1;
  while (share < 1) {
    const double next = std::min(1.0, share + ahead);
    if (moves_to(chart, ray, next, turned, root)) {
      share = next;
      ahead *= 4;
    } else if ((ahead *= 0.25) < kShortest) {
      root.t = ray.t_of(tangents_of(chart, root.st).S);
      root.met = false;
      break;
    }
  }
  return root;
}

}  // namespace iso
