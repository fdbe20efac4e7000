#include "tess/continuity.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "tess/border_place.h"
#include "tess/copied_faces.h"
#include "tess/edge_match.h"
#include "tess/face_side.h"

namespace iso {

namespace {

// The other border may run ahead of or behind the first by this share of the edge.
constexpr double kWithin = 0.25;

// A maximum that stands out from its neighbours by no more than this share of it is level.
constexpr double kLevel = 1e-9;

// Uses of a face that are one curve in (u, v), to this share of the domain, are a slit.
constexpr double kSlit = 1e-9;

constexpr std::size_t kMeasures = kMeasureNames.size();

std::size_t index(Measure m) { return static_cast<std::size_t>(m); }

// The first use of an edge with one of the others.
struct UsePair {
  const Face *a, *b;
  const EdgeUse *use_a, *use_b;
  bool left_a = true, left_b = false;
  double length = 0;  // of the edge
};

bool is_slit(const UsePair& pair) {
  if (pair.a != pair.b) return false;
  const Vec2 same = kSlit * pair.a->domain.size();
  for (const double s : {0.25, 0.5, 0.75})
    if (const Vec2 d = glm::abs(uv_at(*pair.use_a, s) - uv_at(*pair.use_b, s)); d.x > same.x || d.y > same.y) return false;
  return true;
}

// The share of the second use whose place is nearest to p.
double share_beside(const UsePair& pair, const Point3& p, double share) {
  const double from = pair.use_b->shares_parameter ? share : own_share(*pair.b, *pair.use_b, p, share);
  return slide_share(*pair.b, *pair.use_b, p, from, std::max(0.0, from - kWithin), std::min(1.0, from + kWithin));
}

// What is measured at a place of the edge. `limits`: normals are told of singular places too.
ContinuitySample measured(const UsePair& pair, double share, bool limits) {
  const int ahead = share < 1 ? 1 : -1;
  const BorderPlace a = border_place(*pair.a, *pair.use_a, share, {pair.left_a, ahead, pair.length});
  // The face goes on through the edge: what is left of it on one face is right of it on the other.
  BorderPlace b = border_place(*pair.b, *pair.use_b, share_beside(pair, a.S, share), {pair.left_b, ahead, pair.length});
  b.normal = -b.normal;
  b.curvature = -b.curvature;

  ContinuitySample sample{share, a.S};
  sample.value[index(Measure::gap)] = glm::length(a.S - b.S);
  sample.value[index(Measure::off)] = std::min(glm::length(a.S - b.S), distance_to_surface(pair.b->surface, b.uv, a.S));
  const bool known = (limits || (a.regular && b.regular)) && a.normal != Vec3(0.0) && b.normal != Vec3(0.0);
  if (known) sample.value[index(Measure::normal)] = std::atan2(glm::length(glm::cross(a.normal, b.normal)), glm::dot(a.normal, b.normal));
  sample.value[index(Measure::curvature)] = std::abs(a.curvature - b.curvature);
  return sample;
}

// A measure along one pair of uses: the samples, and the largest values found on the way.
class PairMeasurement {
 public:
  PairMeasurement(const UsePair& pair, int count) : pair_(pair) {
    for (const bool limits : {false, true}) {
      limits_ = limits;
      samples_.clear();
      for (int i = 0; i < count; ++i) samples_.push_back(evaluate(static_cast<double>(i) / (count - 1)));
      if (best_[index(Measure::normal)].known()) break;
    }
    for (std::size_t m = 0; m < kMeasures; ++m) climb(m);
    for (std::size_t m = 0; m < kMeasures; ++m) best_[m].rms = root_mean_square(m);
  }

  const std::vector<ContinuitySample>& samples() const { return samples_; }
  const std::array<Jump, 4>& jumps() const { return best_; }
  int evaluations() const { return evaluations_; }

 private:
  ContinuitySample evaluate(double share) {
    const ContinuitySample sample = measured(pair_, share, limits_);
    ++evaluations_;
    for (std::size_t m = 0; m < kMeasures; ++m)
      if (sample.value[m] > best_[m].max || (!best_[m].known() && finite(sample.value[m])))
        best_[m] = {sample.value[m], 0, share, uv_at(*pair_.use_a, share), sample.place};
    return sample;
  }

  // NaN counts as nothing.
  static double height(const ContinuitySample& sample, std::size_t m) { return finite(sample.value[m]) ? sample.value[m] : -kInf; }

  void climb(std::size_t m) {
    std::vector<std::size_t> peaks;
    const std::size_t n = samples_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double here = height(samples_[i], m);
      const double before = i > 0 ? height(samples_[i - 1], m) : -kInf, after = i + 1 < n ? height(samples_[i + 1], m) : -kInf;
      const double lower = std::min(i > 0 ? before : after, i + 1 < n ? after : before);
      if (here > 0 && here >= before && here >= after && here - lower > kLevel * here) peaks.push_back(i);
    }
    std::stable_sort(peaks.begin(), peaks.end(), [&](auto i, auto j) { return height(samples_[i], m) > height(samples_[j], m); });
    peaks.resize(std::min(peaks.size(), static_cast<std::size_t>(kClimbed)));
    for (const std::size_t i : peaks) golden_section(m, samples_[i > 0 ? i - 1 : i].share, samples_[std::min(i + 1, n - 1)].share);
  }

  void golden_section(std::size_t m, double lo, double hi) {
    constexpr double kGolden = 0.61803398874989484820;
    double x1 = hi - kGolden * (hi - lo), x2 = lo + kGolden * (hi - lo);
    double y1 = height(evaluate(x1), m), y2 = height(evaluate(x2), m);
    for (int i = 2; i < kClimbSteps; ++i) {
      if (y1 < y2) {
        lo = x1, x1 = x2, y1 = y2;
        y2 = height(evaluate(x2 = lo + kGolden * (hi - lo)), m);
      } else {
        hi = x2, x2 = x1, y2 = y1;
        y1 = height(evaluate(x1 = hi - kGolden * (hi - lo)), m);
      }
    }
  }

  // Samples weigh as much as half the way to their neighbours.
  double root_mean_square(std::size_t m) const {
    double sum = 0, length = 0;
    for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
      const double half = 0.5 * glm::length(samples_[i + 1].place - samples_[i].place);
      for (const double value : {samples_[i].value[m], samples_[i + 1].value[m]})
        if (finite(value)) sum += half * value * value, length += half;
    }
    return length > 0 ? std::sqrt(sum / length) : best_[m].max;
  }

  UsePair pair_;
  bool limits_ = false;
  std::vector<ContinuitySample> samples_;
  std::array<Jump, 4> best_{};
  int evaluations_ = 0;
};

// Whether the outward normal of a face is the one by which it lies left of its border.
bool outward_is_left(const Face& face, bool left) { return left != face.reversed; }

// One edge of a boundary.
class EdgeMeasurement {
 public:
  EdgeMeasurement(const Part& part, const Boundary& boundary, const std::vector<bool>& left, const ContinuityOptions& options)
      : part_(part), boundary_(boundary), left_(left), least_samples_(std::max(2, options.least_samples)) {}

  EdgeContinuity operator()(const BoundaryEdge& edge) const {
    EdgeContinuity result;
    for (const int u : edge.uses) {
      const EdgeUse& use = boundary_.uses[static_cast<std::size_t>(u)];
      result.sides.push_back({use.face, use.curve.edge, parameter_at(use, 0), parameter_at(use, 1)});
    }
    result.kind = kind_of(edge);
    if (result.kind == EdgeKind::degenerate) return result;
    const int count = sample_count(edge, result.length);
    if (result.kind == EdgeKind::free) {
      result.samples = bare_samples(edge.uses[0], count);
      return result;
    }
    for (std::size_t k = 1; k < edge.uses.size(); ++k) add_pair(pair_of(edge.uses[0], edge.uses[k], result.length), count, result);
    for (const EdgeContinuity::Side& side : result.sides)
      result.sewn =
          result.sewn || (side.part_edge != result.sides[0].part_edge) || (side.part_edge < 0 && side.face != result.sides[0].face);
    return result;
  }

 private:
  EdgeKind kind_of(const BoundaryEdge& edge) const {
    if (edge.degenerate) return EdgeKind::degenerate;
    if (edge.uses.size() != 2) return edge.uses.size() < 2 ? EdgeKind::free : EdgeKind::non_manifold;
    const auto face = [&](std::size_t k) { return boundary_.uses[static_cast<std::size_t>(edge.uses[k])].face; };
    return face(0) == face(1) ? EdgeKind::seam : EdgeKind::shared;
  }

  // As many as the use that asks for the most; and the length of the first one.
  int sample_count(const BoundaryEdge& edge, double& length) const {
    std::size_t count = static_cast<std::size_t>(least_samples_);
    for (std::size_t k = edge.uses.size(); k-- > 0;) {
      const EdgePiece piece = trace(part_, boundary_.uses, edge.uses[k], 0, 1);
      if (piece.at.size() > static_cast<std::size_t>(kTraced) + 1) count = std::max(count, piece.at.size());
      length = piece.length();
    }
    return static_cast<int>(count);
  }

  std::vector<ContinuitySample> bare_samples(int u, int count) const {
    const EdgeUse& use = boundary_.uses[static_cast<std::size_t>(u)];
    const Face& face = part_.faces[static_cast<std::size_t>(use.face)];
    std::vector<ContinuitySample> samples;
    for (int i = 0; i < count; ++i) {
      const double share = static_cast<double>(i) / (count - 1);
      samples.push_back({share, point(face.surface, uv_at(use, share))});
    }
    return samples;
  }

  UsePair pair_of(int first, int second, double length) const {
    const auto i = static_cast<std::size_t>(first), j = static_cast<std::size_t>(second);
    const EdgeUse &a = boundary_.uses[i], &b = boundary_.uses[j];
    UsePair pair{
        &part_.faces[static_cast<std::size_t>(a.face)], &part_.faces[static_cast<std::size_t>(b.face)], &a, &b, left_[i], left_[j], length};
    if (is_slit(pair)) pair.left_b = !pair.left_a;
    return pair;
  }

  // Of several pairs the largest gaps are kept, and nothing else: among three sheets no two go on in each other.
  static void add_pair(const UsePair& pair, int count, EdgeContinuity& result) {
    PairMeasurement measurement(pair, count);
    result.evaluations += measurement.evaluations();
    const bool is_first = result.samples.empty();
    if (is_first) result.samples = measurement.samples();
    for (std::size_t m = 0; m < kMeasures; ++m) {
      const bool defined = result.kind != EdgeKind::non_manifold || m == index(Measure::gap) || m == index(Measure::off);
      const Jump& jump = measurement.jumps()[m];
      if (defined && (is_first || jump.max > result.jumps[m].max)) result.jumps[m] = jump;
      for (std::size_t i = 0; i < result.samples.size(); ++i)
        result.samples[i].value[m] = defined ? std::fmax(result.samples[i].value[m], measurement.samples()[i].value[m]) : std::nan("");
    }
    if (result.kind != EdgeKind::non_manifold)
      result.misoriented = outward_is_left(*pair.a, pair.left_a) == outward_is_left(*pair.b, pair.left_b);
  }

  const Part& part_;
  const Boundary& boundary_;
  const std::vector<bool>& left_;
  int least_samples_;
};

}  // namespace

Continuity measure_continuity(const Part& part, const ContinuityOptions& options) {
  const std::vector<int> copy_of = copied_faces(part);
  const Boundary boundary(part, options.sew, copy_of);
  const std::vector<bool> left = lies_left(part, boundary);
  const EdgeMeasurement measure(part, boundary, left, options);
  Continuity result;
  result.joins = boundary.joins;
  result.copies = static_cast<int>(std::count_if(copy_of.begin(), copy_of.end(), [](int of) { return of >= 0; }));
  result.edges.resize(boundary.edges.size());
  tbb::parallel_for(std::size_t{0}, boundary.edges.size(), [&](std::size_t e) { result.edges[e] = measure(boundary.edges[e]); });
  return result;
}

}  // namespace iso
