// One direction of a comparison: how far the points of many triangles, or of the exact surface over them, are from something. What the
// triangles are, and how a point's distance is found, is the caller's.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <tuple>
#include <vector>

#include "tess/mesh_comparison.h"
#include "tess/prism_cover.h"

namespace iso {

// A point of triangle `i` and how far it is.
struct Measured {
  Point3 at{0.0};
  double distance = 0;
  std::uint32_t hint = TriangleTree::kNone;  // the triangle it is nearest to, for the next question
};

// A Source has
//   std::size_t size() const;
//   std::uint32_t group(std::size_t i) const;               the face that a triangle is counted for
//   std::array<Point3, 3> corners(std::size_t i) const;
//   Measured measure(std::size_t i, const Vec3& weights, std::uint32_t hint) const;
//   void walk(std::size_t& i, Vec3& weights) const;         weights below zero: to the triangle beside, or clamped
//   double bound(std::size_t i, double near, double enough) const;
//                                                           no point over the triangle is farther; `near`: how far samples are; a bound up
//                                                           to `enough` need not be made tighter
//   bool side_matters(std::size_t i, int k) const;          whether the middle of the side opposite to corner k is worth a look
template <class Source>
class OneSidedMeter {
 public:
  OneSidedMeter(const Source& source, std::size_t groups, double spacing) : source_(source), groups_(groups), spacing_(spacing) {}

  // Results by group; the last one is that of all. `step` hears how many triangles more are done.
  std::vector<OneSided> measured(const std::function<void(std::size_t)>& step);

  // Shares of a group's area farther than a distance.
  double share_beyond(std::size_t group, double distance) const;
  // The distance that this share of the triangles does not exceed at any sample.
  double usual(double share) const;
  // The largest and the least distance of each triangle at its samples.
  const std::vector<float>& nearest_of_triangle() const { return nearest_; }
  const std::vector<float>& worst_of_triangle() const { return worst_; }

 private:
  struct Sample {
    std::uint32_t group;
    float distance, area;
  };
  struct Candidate {
    double distance = -1;
    std::size_t triangle = 0;
    Vec3 weights{0.0};
    Point3 at{0.0};
  };
  static constexpr std::size_t kChunk = 1024;    // triangles
  static constexpr int kMostParts = 12;          // of a side, between samples
  static constexpr std::size_t kCandidates = 8;  // places per group from which the largest distance is searched

  void measure_chunk(std::size_t begin, std::size_t end, std::vector<Sample>& samples);
  Candidate highest(Candidate from, double first_step, double smallest_step) const;
  OneSided figures(std::span<const Sample> samples) const;

  const Source& source_;
  std::size_t groups_;
  double spacing_;
  std::vector<Sample> samples_;  // by group, then by distance
  std::vector<std::size_t> first_;
  std::vector<float> worst_, nearest_;
  std::vector<std::array<float, 3>> worst_at_;
};

template <class Source>
void OneSidedMeter<Source>::measure_chunk(std::size_t begin, std::size_t end, std::vector<Sample>& samples) {
  std::uint32_t hint = TriangleTree::kNone;
  for (std::size_t i = begin; i < end; ++i) {
    const auto t = source_.corners(i);
    const double area = 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::length(t[k] - t[(k + 1) % 3]));
    const int parts = static_cast<int>(std::clamp(std::ceil(longest / spacing_), 1.0, double(kMostParts)));
    const float share = static_cast<float>(area / (parts * parts));
    double worst = -1, nearest = kInf;
    // The middles of parts^2 like triangles: those that point as the triangle does, and those turned about.
    for (int a = 0; a < parts; ++a)
      for (int b = 0; a + b < parts; ++b)
        for (int turned = 0; turned < (a + b + 1 < parts ? 2 : 1); ++turned) {
          const double third = (1 + turned) / 3.0;
          Vec3 l{0, (a + third) / parts, (b + third) / parts};
          l.x = 1 - l.y - l.z;
          const Measured m = source_.measure(i, l, hint);
          hint = m.hint;
          samples.push_back({source_.group(i), static_cast<float>(m.distance), share});
          nearest = std::min(nearest, m.distance);
          if (m.distance <= worst) continue;
          worst = m.distance;
          for (int k = 0; k < 3; ++k) worst_at_[i][static_cast<std::size_t>(k)] = static_cast<float>(l[k]);
        }
    // Corners and the middles of sides, where a mesh is off the border of its face; they stand for no area.
    for (int k = 0; k < 6; ++k) {
      if (k >= 3 && !source_.side_matters(i, k - 3)) continue;
      Vec3 l(k < 3 ? 0.0 : 0.5);
      l[k % 3] = k < 3 ? 1 : 0;
      const Measured m = source_.measure(i, l, hint);
      nearest = std::min(nearest, m.distance);
      if (m.distance <= worst) continue;
      worst = m.distance;
      worst_at_[i] = {static_cast<float>(l.x), static_cast<float>(l.y), static_cast<float>(l.z)};
    }
    worst_[i] = static_cast<float>(worst);
    nearest_[i] = static_cast<float>(nearest);
  }
}

// Climbs from a sample to a place where the distance is largest, by steps in eight directions that are halved when none leads up.
template <class Source>
typename OneSidedMeter<Source>::Candidate OneSidedMeter<Source>::highest(Candidate from, double first_step, double smallest_step) const {
  constexpr int kMostSteps = 4000;
  static constexpr std::array<std::array<int, 2>, 8> kWays{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}, {1, 1}, {-1, -1}}};
  std::uint32_t hint = TriangleTree::kNone;
  int steps = 0;
  for (double step = first_step; step > smallest_step && steps < kMostSteps;) {
    Candidate best = from;
    for (const auto& way : kWays) {
      Vec3 l = from.weights + step * Vec3(-way[0] - way[1], way[0], way[1]);
      std::size_t triangle = from.triangle;
      source_.walk(triangle, l);
      const Measured m = source_.measure(triangle, l, hint);
      hint = m.hint;
      ++steps;
      if (m.distance > best.distance) best = {m.distance, triangle, l, m.at};
    }
    if (best.distance > from.distance)
      from = best;
    else
      step *= 0.5;
  }
  return from;
}

template <class Source>
OneSided OneSidedMeter<Source>::figures(std::span<const Sample> samples) const {
  OneSided result;
  double sum = 0, squares = 0;
  for (const Sample& s : samples) {
    result.area += double(s.area);
    sum += double(s.area) * double(s.distance);
    squares += double(s.area) * double(s.distance) * double(s.distance);
  }
  if (!(result.area > 0)) return result;
  result.mean = sum / result.area;
  result.rms = std::sqrt(squares / result.area);
  double beyond = 0.001 * result.area;
  for (std::size_t i = samples.size(); i-- > 0;) {
    result.p999 = double(samples[i].distance);
    if ((beyond -= double(samples[i].area)) < 0) break;
  }
  return result;
}

template <class Source>
double OneSidedMeter<Source>::share_beyond(std::size_t group, double distance) const {
  double all = 0, beyond = 0;
  for (std::size_t i = first_[group]; i < first_[group + 1]; ++i) {
    all += double(samples_[i].area);
    if (double(samples_[i].distance) > distance) beyond += double(samples_[i].area);
  }
  return all > 0 ? beyond / all : 0.0;
}

template <class Source>
double OneSidedMeter<Source>::usual(double share) const {
  if (worst_.empty()) return 0;
  std::vector<float> sorted = worst_;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return double(sorted[static_cast<std::size_t>(at)]);
}

template <class Source>
std::vector<OneSided> OneSidedMeter<Source>::measured(const std::function<void(std::size_t)>& step) {
  const std::size_t n = source_.size(), chunks = (n + kChunk - 1) / kChunk;
  worst_.assign(n, 0);
  nearest_.assign(n, 0);
  worst_at_.assign(n, {});
  std::vector<std::vector<Sample>> parts(chunks);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
    const std::size_t end = std::min(n, (c + 1) * kChunk);
    measure_chunk(c * kChunk, end, parts[c]);
    step(end - c * kChunk);
  });
  for (std::vector<Sample>& part : parts) {
    samples_.insert(samples_.end(), part.begin(), part.end());
    part = {};
  }
  tbb::parallel_sort(samples_.begin(), samples_.end(), [](const Sample& a, const Sample& b) {
    return std::tie(a.group, a.distance, a.area) < std::tie(b.group, b.distance, b.area);
  });
  first_.assign(groups_ + 1, 0);
  for (const Sample& s : samples_) ++first_[s.group + 1];
  for (std::size_t g = 0; g < groups_; ++g) first_[g + 1] += first_[g];

  // The places with the largest distances of each group, from which the way up is searched.
  std::vector<std::vector<std::pair<float, std::uint32_t>>> far(groups_);
  std::vector<OneSided> result(groups_ + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t g = source_.group(i);
    auto& heap = far[g];
    heap.push_back({worst_[i], static_cast<std::uint32_t>(i)});
    if (heap.size() < 16 * kCandidates) continue;
    std::nth_element(heap.begin(), heap.begin() + kCandidates, heap.end(), std::greater<>());
    heap.resize(kCandidates);
  }
  tbb::parallel_for(std::size_t{0}, groups_, [&](std::size_t g) {
    auto& heap = far[g];
    std::sort(heap.begin(), heap.end(), std::greater<>());
    if (heap.size() > kCandidates) heap.resize(kCandidates);
    result[g] = figures(std::span(samples_).subspan(first_[g], first_[g + 1] - first_[g]));
    // All of them roughly, then those that are still among the largest.
    constexpr double kFirstStep = 0.25, kRough = 1e-3, kSmallestStep = 1e-9, kNearly = 1 - 1e-5;
    std::vector<Candidate> rough;
    Candidate best;
    for (const auto& [distance, i] : heap) {
      Candidate from;
      from.triangle = i;
      for (int k = 0; k < 3; ++k) from.weights[k] = double(worst_at_[i][static_cast<std::size_t>(k)]);
      from.weights.x = 1 - from.weights.y - from.weights.z;
      const Measured m = source_.measure(i, from.weights, TriangleTree::kNone);
      from.distance = m.distance;
      from.at = m.at;
      rough.push_back(highest(from, kFirstStep, kRough));
      if (rough.back().distance > best.distance) best = rough.back();
    }
    const double nearly = kNearly * best.distance;
    for (const Candidate& from : rough) {
      if (!(from.distance >= nearly)) continue;
      if (const Candidate to = highest(from, 2 * kRough, kSmallestStep); to.distance > best.distance) best = to;
    }
    if (best.distance >= 0) result[g].max = best.distance, result[g].at = best.at;
  });
  // Bounds, the tighter the nearer they come to what was found.
  std::vector<double> bounds(n);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
    const std::size_t end = std::min(n, (c + 1) * kChunk);
    for (std::size_t i = c * kChunk; i < end; ++i) bounds[i] = source_.bound(i, double(worst_[i]), result[source_.group(i)].max);
    step(end - c * kChunk);
  });
  for (std::size_t g = 0; g < groups_; ++g) result[g].bound = result[g].max;
  for (std::size_t i = 0; i < n; ++i) {
    double& bound = result[source_.group(i)].bound;
    bound = std::max(bound, bounds[i]);
  }
  // All together: percentiles are of all samples in one order.
  std::vector<Sample> all = samples_;
  tbb::parallel_sort(all.begin(), all.end(),
                     [](const Sample& a, const Sample& b) { return std::tie(a.distance, a.area) < std::tie(b.distance, b.area); });
  OneSided& total = result.back();
  total = figures(all);
  for (std::size_t g = 0; g < groups_; ++g) {
    total.bound = std::max(total.bound, result[g].bound);
    if (result[g].max > total.max) total.max = result[g].max, total.at = result[g].at;
  }
  return result;
}

}  // namespace iso
