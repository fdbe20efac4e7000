#include "patches/surface/patch_chart.h"

#include <algorithm>
#include <cmath>

#include "patches/base/check.h"
#include "patches/surface/chart_spline.h"
#include "patches/surface/patch_basis-inl.h"
#include "patches/surface/surface.h"

namespace iso {

namespace {

constexpr double kRounding = 32 * kEps;

// ---- Bezier triangles: a chart is a tensor-product patch, exactly ---------------------------------------------------------

// The polar form of a triangle's polynomial at degree points of the plane, given as barycentric coordinates.
Vec4 blossom(int degree, std::vector<Vec4> net, const std::vector<Vec3>& at) {
  for (int d = degree; d > 0; --d) {
    const Vec3& l = at[static_cast<std::size_t>(degree - d)];
    std::vector<Vec4> next;
    for (int i = 0; i < d; ++i)
      for (int j = 0; i + j < d; ++j) {
        const auto entry = [&](int b, int c) { return net[static_cast<std::size_t>(triangle_index(d, b, c))]; };
        next.push_back(l.x * entry(j, i) + l.y * entry(j + 1, i) + l.z * entry(j, i + 1));
      }
    net = std::move(next);
  }
  return net.front();
}

double choose(int n, int k) {
  double c = 1;
  for (int i = 0; i < k; ++i) c = c * (n - i) / (i + 1);
  return c;
}

// Coefficient (i, j) takes each way to give i of the d arguments to s and j to t: m of them to both [Goldman, Filip 1987].
Vec4 tensor_coefficient(int d, const std::vector<Vec4>& net, int i, int j) {
  const Vec3 corner{1, 0, 0}, next{0.5, 0.5, 0}, back{0.5, 0, 0.5}, centre{1.0 / 3, 1.0 / 3, 1.0 / 3};
  Vec4 sum{0.0};
  for (int m = std::max(0, i + j - d); m <= std::min(i, j); ++m) {
    std::vector<Vec3> at;
    at.insert(at.end(), static_cast<std::size_t>(m), centre);
    at.insert(at.end(), static_cast<std::size_t>(i - m), next);
    at.insert(at.end(), static_cast<std::size_t>(j - m), back);
    at.insert(at.end(), static_cast<std::size_t>(d - i - j + m), corner);
    sum += choose(i, m) * choose(d - i, j - m) / choose(d, j) * blossom(d, net, at);
  }
  return sum;
}

NurbsSurface tensor_of_triangle(const PatchChart& chart) {
  const int d = chart.basis.degree;
  std::vector<Vec4> net;
  for (std::size_t m = 0; m < chart.points.size(); ++m) {
    const double w = chart.weights.empty() ? 1.0 : chart.weights[m];
    net.push_back(Vec4(w * chart.points[m], w));
  }
  NurbsSurface out;
  out.degree_u = out.degree_v = d;
  out.count_u = out.count_v = d + 1;
  std::vector<double> knots(static_cast<std::size_t>(2 * d + 2), 0.0);
  std::fill(knots.begin() + d + 1, knots.end(), 1.0);
  out.knots_u = out.knots_v = knots;
  for (int i = 0; i <= d; ++i)
    for (int j = 0; j <= d; ++j) out.poles.push_back(tensor_coefficient(d, net, i, j));
  if (chart.weights.empty())
    for (Vec4& h : out.poles) h.w = 1;
  return out;
}

// ---- blended kinds -----------------------------------------------------------------------------------------------------------

NurbsSurface spline_of(const PatchChart& chart, const WeightSplines& splines) {
  NurbsSurface out;
  out.degree_u = out.degree_v = 5;
  out.count_u = out.count_v = splines.count;
  out.knots_u = out.knots_v = splines.knots;
  const std::size_t poles = static_cast<std::size_t>(splines.count) * static_cast<std::size_t>(splines.count);
  out.poles.assign(poles, Vec4(0, 0, 0, 1));
  for (std::size_t k = 0; k < poles; ++k) {
    Vec3 sum{0.0};
    for (std::size_t m = 0; m < chart.points.size(); ++m) sum += splines.poles[m][k] * chart.points[m];
    out.poles[k] = Vec4(sum, 1.0);
  }
  return out;
}

// About the middle of the points, since the weights sum to one; pairs by their middle and half of what they differ by. The worst cell.
double distance_from_spline(const std::vector<Vec3>& points, const WeightSplines& splines) {
  const std::size_t count = points.size(), pairs = splines.pairs.size();
  Vec3 about{0.0};
  for (const Vec3& p : points) about += p / static_cast<double>(count);
  std::vector<double> size(count), middle(pairs), apart(pairs);
  for (std::size_t m = 0; m < count; ++m) size[m] = glm::length(points[m] - about);
  for (std::size_t p = 0; p < pairs; ++p) {
    const auto a = static_cast<std::size_t>(splines.pairs[p].first), b = static_cast<std::size_t>(splines.pairs[p].second);
    middle[p] = glm::length(0.5 * (points[a] + points[b]) - about);
    apart[p] = glm::length(points[a] - points[b]);
    size[a] = size[b] = 0;
  }
  double worst = 0;
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(splines.cells); ++cell) {
    double error = 0;
    for (std::size_t m = 0; m < count; ++m)
      if (size[m] > 0) error += size[m] * splines.error[cell * count + m];
    for (std::size_t p = 0; p < pairs; ++p)
      error += middle[p] * splines.error_of_sum[cell * pairs + p] + apart[p] * splines.error_of_difference[cell * pairs + p];
    worst = std::max(worst, error);
  }
  return worst;
}

// What the spline that rays are sorted by may be off, as a share of the chart's control points' extent: far below a pixel. By mean value
// coordinates finer splines have many cells at the corner, which take seconds to prove.
constexpr double kMostError = 1e-5, kMostErrorByMeanValue = 3e-5;
// Radians between the normals of chart and spline: rays that meet a chart more steeply meet its spline as often. Where a patch folds beside
// a corner, its tangents all but along each other, normals turn over within a hundredth of the chart.
constexpr double kMostTurn = 0.01;

// Whether a spline's normals turn away from the chart's. What is no area to rounding has no normals.
bool turns_away(const std::vector<Vec3>& points, const WeightSplines& splines, double size) {
  for (const SampledSlopes& slopes : splines.slopes) {
    const auto tangent = [&](const std::vector<double>& by) {
      Vec3 sum{0.0};
      for (std::size_t m = 0; m < points.size(); ++m) sum += by[m] * points[m];
      return sum;
    };
    const Vec3 n = glm::cross(tangent(slopes.s), tangent(slopes.t)),
               beside = glm::cross(tangent(slopes.spline_s), tangent(slopes.spline_t));
    if (!(glm::length(n) > kRounding * size * size)) continue;
    if (glm::length(glm::cross(n, beside)) > kMostTurn * glm::dot(n, beside)) return true;
  }
  return false;
}

// Entry m of the result is the entry that takes its place.
template <class T>
std::vector<T> taken(const std::vector<T>& from, const std::vector<int>& places) {
  std::vector<T> to;
  to.reserve(from.size());
  if (!from.empty())
    for (const int m : places) to.push_back(from[static_cast<std::size_t>(m)]);
  return to;
}

// One grid for all charts of a patch: along the border of two of them their splines are the same curve only where they have the same
// nodes. What lies between two curves no ray would meet, or meet twice.
SplineGrid grid_of_patch(const PatchChart& chart, const std::vector<int>& turn, double size, double most) {
  // The same for all patches, since neighbours share what it makes of a border curve that no quintic reproduces.
  if (chart.basis.degree > kSplineDegree) return {.level = 1};
  std::vector<std::vector<Vec3>> corners{chart.points};
  while (corners.size() < static_cast<std::size_t>(chart.basis.sides)) corners.push_back(taken(corners.back(), turn));
  SplineGrid grid;
  const std::shared_ptr<const WeightSplines> first = weight_splines(chart.basis, grid);
  const auto keeps_sides = [&](const std::vector<Vec3>& points) { return !turns_away(points, *first, size); };
  // By mean value coordinates all cells at corners are finer than that.
  const bool finer = chart.basis.parameters == SideParameters::mean_value;
  if (!finer && !std::all_of(corners.begin(), corners.end(), keeps_sides)) grid.at_corner = AtCorner::fine;
  const auto is_near = [&] {
    const std::shared_ptr<const WeightSplines> splines = weight_splines(chart.basis, grid);
    return std::all_of(corners.begin(), corners.end(),
                       [&](const std::vector<Vec3>& points) { return distance_from_spline(points, *splines) <= most; });
  };
  while (!is_near() && grid.level + 1 < kSplineLevels) ++grid.level;
  return grid;
}

}  // namespace

std::string problem_of(const NSidedPatch& patch) {
  if (std::string p = problem_of(patch.basis); !p.empty()) return p;
  const auto count = static_cast<std::size_t>(point_count(patch.basis));
  if (patch.points.size() != count) return std::to_string(patch.points.size()) + " control points, expected " + std::to_string(count);
  for (const Vec3& p : patch.points)
    if (!finite(p) || glm::length(p) > 1e15) return "a control point that is not finite or larger than 1e15";
  if (patch.weights.empty()) return {};
  if (patch.basis.kind != PatchKind::bezier_triangle) return "weights, which only Bezier triangles have";
  if (patch.weights.size() != count) return std::to_string(patch.weights.size()) + " weights, expected " + std::to_string(count);
  for (const double w : patch.weights)
    if (!(w > 0 && w < 1e15)) return "a weight of " + std::to_string(w) + ", expected more than 0";
  return {};
}

PatchChart chart_of(const NSidedPatch& patch, int corner) {
  ISO_CHECK(problem_of(patch).empty() && corner >= 0 && corner < patch.basis.sides);
  PatchChart chart{.basis = patch.basis, .points = patch.points, .weights = patch.weights, .patch = 0, .corner = corner, .near = {}};
  const std::vector<int> turn = points_from_next_corner(patch.basis);
  for (int k = 0; k < corner; ++k) {
    chart.points = taken(chart.points, turn);
    chart.weights = taken(chart.weights, turn);
  }
  if (patch.basis.kind == PatchKind::bezier_triangle) {
    chart.near = std::make_shared<const NurbsSurface>(tensor_of_triangle(chart));
    return chart;
  }
  Box3 box;
  for (const Vec3& p : chart.points) box.include(p);
  // What all points have in common rounds: a patch that is a point needs no finer spline.
  const double coordinates = glm::length(glm::max(glm::abs(box.lo), glm::abs(box.hi)));
  const double share = patch.basis.parameters == SideParameters::mean_value ? kMostErrorByMeanValue : kMostError;
  const double most = share * box.diagonal() + kRounding * coordinates;
  const std::shared_ptr<const WeightSplines> splines =
      weight_splines(chart.basis, grid_of_patch(chart, turn, box.diagonal() + coordinates, most));
  chart.near = std::make_shared<const NurbsSurface>(spline_of(chart, *splines));
  chart.error = distance_from_spline(chart.points, *splines);
  return chart;
}

ChartSpline spline_beside(const PatchChart& chart, double most) {
  if (chart.basis.kind == PatchKind::bezier_triangle || (chart.near && chart.error <= most)) return {chart.near, chart.error};
  for (int level = 0;; ++level) {
    const std::shared_ptr<const WeightSplines> splines = weight_splines(chart.basis, {.level = level});
    const double error = distance_from_spline(chart.points, *splines);
    if (error <= most || level + 1 == kSplineLevels) return {std::make_shared<const NurbsSurface>(spline_of(chart, *splines)), error};
  }
}

Point3 point_of(const PatchChart& chart, const Vec2& st) {
  thread_local std::vector<double> W;
  W.resize(chart.points.size());
  weights_at(chart.basis, st, W);
  Vec3 sum{0.0};
  double weight = 1;
  if (!chart.weights.empty()) {
    weight = 0;
    for (std::size_t m = 0; m < W.size(); ++m) weight += W[m] *= chart.weights[m];
  }
  for (std::size_t m = 0; m < W.size(); ++m) sum += W[m] * chart.points[m];
  return sum / weight;
}

Jet2 jet_of(const PatchChart& chart, const Vec2& st) {
  if (chart.error == 0) return jet2(*chart.near, st);
  thread_local std::vector<Dual2> W;
  W.resize(chart.points.size());
  weights_at(chart.basis, st, W);
  Jet2 jet;
  for (std::size_t m = 0; m < W.size(); ++m) {
    const Vec3& p = chart.points[m];
    jet.S += W[m].f * p;
    jet.Su += W[m].u * p;
    jet.Sv += W[m].v * p;
    jet.Suu += W[m].uu * p;
    jet.Suv += W[m].uv * p;
    jet.Svv += W[m].vv * p;
  }
  return jet;
}

Tangents tangents_of(const PatchChart& chart, const Vec2& st) {
  if (chart.error == 0 || is_corner_by_mean_value(chart.basis, st)) {
    const Jet2 jet = jet_of(chart, st);
    return {jet.S, jet.Su, jet.Sv};
  }
  thread_local std::vector<Dual1<double>> W;
  W.resize(chart.points.size());
  patch_weights<Dual1<double>>(chart.basis, {st.x, 1.0, 0.0}, {st.y, 0.0, 1.0}, W.data());
  Tangents at;
  for (std::size_t m = 0; m < W.size(); ++m) {
    at.S += W[m].f * chart.points[m];
    at.Ss += W[m].u * chart.points[m];
    at.St += W[m].v * chart.points[m];
  }
  return at;
}

void translate(PatchChart& chart, const Vec3& by) {
  for (Vec3& p : chart.points) p += by;
  NurbsSurface moved = *chart.near;
  for (Vec4& h : moved.poles) h += Vec4(h.w * by, 0.0);
  chart.near = std::make_shared<const NurbsSurface>(std::move(moved));
}

}  // namespace iso
