#include "raytracer/chart_root.h"

namespace iso {

namespace {

constexpr int kMostSteps = 12;
// By mean value coordinates a chart is like a cone at its corner, where its spline is a plane: the first steps are as long as the way to
// the corner, and only when the direction is found they shrink. Those that do not are halved, and go no farther than twice the way to the
// corner.
constexpr double kAboutCorner = 0.01, kMostAboutCorner = 0.7;
constexpr int kMostStepsAboutCorner = 40;
// Behind it the formulas do not go on: of a root so near to it, about as much as the leaves of neighbours overlap, the corner is left.
constexpr double kAtCorner = 4e-12;
// Of the way from the spline to the chart: where a root cannot be followed so far, the ray touches.
constexpr double kShortest = 1e-3;
// Of the chart: so far from the fold roots are looked for, and so near a fold is told.
constexpr double kMostFromFold = 0.1, kFoldStep = 1e-9;

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
// not converge at once, away from such corners, or leaves the chart.
bool moves_to(const PatchChart& chart, const LocalRay& ray, double share, bool turned, ChartRoot& root) {
  const double rounding = 4 * kEps * ray.scale;
  Vec2 st = root.st;
  double last = kBeyondChart / kChartContraction;
  const auto about_corner = [&] { return turns_about_corner(chart) && std::max(std::abs(st.x), std::abs(st.y)) < kAboutCorner; };
  const int most_steps = about_corner() ? kMostStepsAboutCorner : kMostSteps;
  for (int k = 0; k < most_steps; ++k) {
    const Tangents at = between(chart, st, share);
    ++root.steps;
    const Equations e = equations(ray, at);
    if (!(turned ? e.determinant < -1e-300 : e.determinant > 1e-300)) return false;
    const Vec2 step = Vec2(e.b * e.F.y - e.d * e.F.x, e.c * e.F.x - e.a * e.F.y) / e.determinant;
    const double size = std::max(std::abs(step.x), std::abs(step.y));
    const double smallest = kLastChartStep * scale_of_steps(chart, st.x, st.y);
    if (glm::length(e.F) <= rounding || size < smallest) {
      // The last step to first order.
      const Vec2 move = size < smallest ? step : Vec2(0.0);
      root.st = st + move;
      root.t = ray.t_of(at.S + move.x * at.Ss + move.y * at.St);
      return true;
    }
    double way = 1;
    if (!(size <= kChartContraction * last)) {
      if (!about_corner()) return false;
      const double from_corner = std::max(std::abs(st.x), std::abs(st.y));
      way = std::min(size <= kMostAboutCorner * last ? 1 : 0.5, 2 * (from_corner + kAtCorner) / size);
    }
    st += way * step;
    last = size;
    if (!Box2{Vec2(-kBeyondChart), Vec2(1 + kBeyondChart)}.contains(st)) return false;
  }
  return false;
}

// Where the Jacobian of the plane equations is singular and the ray passes straight beside: all that the ray sees of the tangents lies in
// one direction, in which the equations vanish. Across it they are `miss`, and move by `bend` times the square of a way `along`, the
// direction of (s, t) that the ray does not see.
struct Fold {
  Vec2 st, along;
  double miss, bend;
};
// Newton on both conditions.
std::optional<Fold> fold_near(const PatchChart& chart, const LocalRay& ray, Vec2 st) {
  for (int k = 0; k < kMostSteps; ++k) {
    const Jet2 jet = jet_of(chart, st);
    const auto seen = [&](const Vec3& v) { return Vec2(glm::dot(ray.n1, v), glm::dot(ray.n2, v)); };
    const Vec2 F = seen(jet.S) - Vec2(ray.d1, ray.d2), Fs = seen(jet.Su), Ft = seen(jet.Sv), Fss = seen(jet.Suu), Fst = seen(jet.Suv),
               Ftt = seen(jet.Svv);
    const Vec2 longer = glm::length(Fs) >= glm::length(Ft) ? Fs : Ft;
    const auto cross = [](const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; };
    if (!(glm::length(longer) > 0)) return {};
    const Vec2 m = glm::normalize(longer), across{-m.y, m.x}, row{glm::dot(m, Fs), glm::dot(m, Ft)};
    const Vec2 by{cross(Fss, Ft) + cross(Fs, Fst), cross(Fst, Ft) + cross(Fs, Ftt)};  // of the determinant
    const Vec2 G{glm::dot(m, F), cross(Fs, Ft)}, step = Vec2(row.y * G.y - by.y * G.x, by.x * G.x - row.x * G.y) / cross(row, by);
    if (!finite(step)) return {};
    if (std::max(std::abs(step.x), std::abs(step.y)) < kFoldStep) {
      const Vec2 along = glm::normalize(Vec2(-row.y, row.x));
      const Vec2 second = along.x * along.x * Fss + 2 * along.x * along.y * Fst + along.y * along.y * Ftt;
      return Fold{st, along, glm::dot(across, F), 0.5 * glm::dot(across, second)};
    }
    st += step;
    if (!Box2{Vec2(-kBeyondChart), Vec2(1 + kBeyondChart)}.contains(st)) return {};
  }
  return {};
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
      const bool at_corner = turns_about_corner(chart) && std::max(std::abs(start.x), std::abs(start.y)) <= kAtCorner;
      if (at_corner) root.st = Vec2(0.0);
      root.t = ray.t_of(point_of(chart, root.st));
      root.met = at_corner;
      break;
    }
  }
  return root;
}

std::optional<std::array<ChartRoot, 2>> roots_at_fold(const PatchChart& chart, const LocalRay& ray, const Vec2& near) {
  const std::optional<Fold> fold = fold_near(chart, ray, near);
  if (!fold || !(fold->miss * fold->bend < 0)) return {};
  const double away = std::sqrt(-fold->miss / fold->bend);
  if (!(away < kMostFromFold)) return {};
  std::array<ChartRoot, 2> roots;
  std::array<bool, 2> turned;
  for (const int k : {0, 1}) {
    roots[k].st = fold->st + (k == 0 ? away : -away) * fold->along;
    turned[k] = equations(ray, tangents_of(chart, roots[k].st)).determinant < 0;
    if (!moves_to(chart, ray, 1, turned[k], roots[k])) return {};
  }
  if (turned[0] == turned[1]) return {};
  return roots;
}

}  // namespace iso
