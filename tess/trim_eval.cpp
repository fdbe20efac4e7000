#include "tess/trim_eval.h"

#include <algorithm>
#include <array>

#include "tess/surface_eval.h"

namespace iso {

namespace {

bool is_polynomial(const NurbsCurve<Vec2>& curve) {
  return std::all_of(curve.poles.begin(), curve.poles.end(), [&](const Vec3& h) { return h.z == curve.poles.front().z; });
}

// The largest share that the inner control points of a span have in a point of the curve: 1 - 2^(1 - degree) where all weights are one.
double inner_share(const std::vector<Vec3>& points) {
  double inner = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) inner = std::max(inner, weight(points[i]));
  const double ends = std::min(weight(points.front()), weight(points.back()));
  const double of_ends = std::exp2(2.0 - static_cast<double>(points.size())), of_inner = 1 - of_ends;
  return inner * of_inner / (inner * of_inner + ends * of_ends);
}

// By the control points of the Bezier spans.
double sliver_of_spans(const Curve2& curve, double t0, double t1, const Vec2& a, const Vec2& b, const Vec2& speed) {
  const Vec2 line = (b - a) * speed;
  const double length2 = glm::dot(line, line);
  const auto off_line = [&](const Vec3& h) {
    const Vec2 p = (project(h) - a) * speed;
    const double s = length2 > 0 ? std::clamp(glm::dot(p, line) / length2, 0.0, 1.0) : 0.0;
    const Vec2 off = p - s * line;
    return std::abs(off.x) + std::abs(off.y);
  };
  double worst = 0;
  for (const auto& span : bezier_spans(curve, std::min(t0, t1), std::max(t0, t1))) {
    const auto& h = span.points;
    const double ends = std::max(off_line(h.front()), off_line(h.back()));
    double inner = 0;
    for (std::size_t i = 1; i + 1 < h.size(); ++i) inner = std::max(inner, off_line(h[i]));
    worst = std::max(worst, ends + inner_share(h) * std::max(0.0, inner - ends));
  }
  return worst;
}

}  // namespace

TrimEval::TrimEval(const Curve2& curve) : curve_(&curve) {
  const auto* nurbs = std::get_if<NurbsCurve<Vec2>>(&curve);
  if (!nurbs || nurbs->degree > BasisPowers::kMostDegree || !is_polynomial(*nurbs)) return;
  degree_ = nurbs->degree;
  const BasisPowers basis(nurbs->knots, degree_);
  const auto n = static_cast<std::size_t>(degree_) + 1;
  for (std::size_t i = 0; i < basis.spans().size(); ++i) {
    const BasisPowers::Span& from = basis.spans()[i];
    spans_.push_back({from.begin, from.middle, 1 / from.per_half});
    for (std::size_t k = 0; k < n; ++k) {
      Vec2 sum(0.0);
      const double* row = basis.powers_of(i, static_cast<int>(k));
      for (std::size_t j = 0; j < n; ++j) {
        const Vec3& h = nurbs->poles[static_cast<std::size_t>(from.first) + j];
        sum += row[j] * project(h);
      }
      powers_.push_back(sum);
    }
    if (i == 0) continue;
    // The slope at the end before and at the begin after, at (t - middle) / half = 1 and -1.
    Vec2 before(0.0), after(0.0);
    for (std::size_t k = 1; k < n; ++k) {
      before += static_cast<double>(k) * powers_[(i - 1) * n + k];
      after += (k % 2 ? 1.0 : -1.0) * static_cast<double>(k) * powers_[i * n + k];
    }
    spans_[i].jump = glm::abs(after / spans_[i].half - before / spans_[i - 1].half);
  }
}

std::size_t TrimEval::span_at(double t) const {
  const auto above = std::upper_bound(spans_.begin() + 1, spans_.end(), t, [](double x, const Span& s) { return x < s.begin; });
  return static_cast<std::size_t>(above - spans_.begin()) - 1;
}

namespace {

// Of no displacement nothing counts, not even an infinite speed.
double measured(const Vec2& moved, const Vec2& speed) {
  return (moved.x == 0 ? 0.0 : moved.x * speed.x) + (moved.y == 0 ? 0.0 : moved.y * speed.y);
}

}  // namespace

Vec2 TrimEval::at(double t) const {
  if (degree_ < 0) return jet(*curve_, t).C;
  const std::size_t i = span_at(t), n = static_cast<std::size_t>(degree_) + 1;
  const double x = (t - spans_[i].middle) / spans_[i].half;
  const Vec2* c = &powers_[i * n];
  Vec2 sum = c[n - 1];
  for (std::size_t k = n - 1; k-- > 0;) sum = sum * x + c[k];
  return sum;
}

// The magnitudes of its coordinates, at most, over a part of a span: all derivatives at the middle of the part, and what they sum up to at
// its ends.
Vec2 TrimEval::second_derivative(std::size_t span, double t0, double t1) const {
  const Span& s = spans_[span];
  const auto n = static_cast<std::size_t>(degree_) + 1;
  std::array<Vec2, BasisPowers::kMostDegree + 1> c;
  std::copy_n(&powers_[span * n], n, c.begin());
  const double x = (0.5 * (t0 + t1) - s.middle) / s.half, reach = 0.5 * (t1 - t0) / s.half;
  for (std::size_t k = 0; k + 1 < n; ++k)
    for (std::size_t j = n - 1; j-- > k;) c[j] += x * c[j + 1];
  Vec2 sum(0.0);
  for (std::size_t k = n; k-- > 2;) sum = sum * reach + static_cast<double>(k * (k - 1)) * glm::abs(c[k]);
  return sum / (s.half * s.half);
}

double TrimEval::sliver(double t0, double t1, const Vec2& a, const Vec2& b, const Vec2& moved, const Vec2& speed) const {
  if (t0 == t1) return measured(moved, speed);
  if (std::holds_alternative<Line<Vec2>>(*curve_)) return measured(moved, speed);
  if (t0 > t1) std::swap(t0, t1);
  const double width = t1 - t0;
  if (const auto* ellipse = std::get_if<Ellipse<Vec2>>(curve_)) {
    const Vec2 most = glm::sqrt(ellipse->X * ellipse->X + ellipse->Y * ellipse->Y);
    return measured(moved + width * width / 8 * most, speed);
  }
  if (degree_ < 0) return sliver_of_spans(*curve_, t0, t1, a, b, speed);
  const std::size_t first = span_at(t0), last = span_at(t1);
  Vec2 most(0.0), jumps(0.0);
  for (std::size_t i = first; i <= last; ++i) {
    const double from = i == first ? t0 : spans_[i].begin, to = i == last ? t1 : spans_[i + 1].begin;
    most = glm::max(most, second_derivative(i, from, to));
    if (i > first) jumps += spans_[i].jump;
  }
  return measured(moved + width * width / 8 * most + width / 4 * jumps, speed);
}

}  // namespace iso
