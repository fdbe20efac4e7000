#include "tests/bench/contest.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace iso::bench {
namespace {

// What a round found: must be the same in every round.
struct Answer {
  std::size_t hits = 0;
  double sum_t = 0;
  bool operator==(const Answer&) const = default;
};

template <class AnyHit>
Answer answer_of(const std::vector<AnyHit>& hits) {
  Answer answer;
  for (const AnyHit& hit : hits)
    if (hit) {
      ++answer.hits;
      if constexpr (requires { hit.t; }) answer.sum_t += static_cast<double>(hit.t);
    }
  return answer;
}

// One contestant of the rounds: its times, and its answer from the warm-up.
struct Contestant {
  std::function<void()> trace;
  std::function<Answer()> answer;
  std::vector<double> seconds = {};
  Answer first = {};
};

void run_rounds(std::vector<Contestant>& contestants, int rounds) {
  for (Contestant& c : contestants) {
    c.trace();
    c.first = c.answer();
  }
  for (int round = 0; round < rounds; ++round)
    for (Contestant& c : contestants) {
      c.seconds.push_back(seconds_of(c.trace));
      ISO_CHECK(c.answer() == c.first);
    }
}

Timing nanoseconds_per_ray(const std::vector<double>& seconds, std::size_t rays) {
  return scaled(timing_of(seconds), 1e9 / static_cast<double>(rays));
}

double mean_newton_steps(const std::vector<Hit>& hits) {
  std::size_t count = 0, steps = 0;
  for (const Hit& hit : hits)
    if (hit && hit.status == HitStatus::converged && hit.steps > 0) {
      ++count;
      steps += hit.steps;
    }
  return count ? static_cast<double>(steps) / static_cast<double>(count) : 0;
}

std::vector<Mode> modes_of_triangles(const RaySet& set) {
  if (set.order == Tracer::Order::scattered) return {Mode::single};
  if (set.incoherent) return {Mode::packets, Mode::single};
  return {Mode::packets};
}

// `direct` and `meet` trace all rays of the set into an array of hits.
template <class DirectHit, class OtherHit, class Direct, class Meet>
Row run_contest(const RaySet& set, const std::vector<EmbreeTriangles>& triangles, int rounds, const Direct& direct, const Meet& meet) {
  std::vector<DirectHit> hits(set.direct.size());
  std::vector<OtherHit> others(set.triangles.size());
  Row row;
  row.rays = set.name;
  row.count = set.direct.size();

  std::vector<Contestant> contestants;
  contestants.push_back({[&] {
                           row.stats = {};
                           direct(hits, row.stats);
                         },
                         [&] { return answer_of(hits); }});
  for (const EmbreeTriangles& built : triangles)
    for (const Mode mode : modes_of_triangles(set)) {
      row.opponents.push_back({built.build(), mode, {}, 0});
      contestants.push_back({[&, mode] { meet(built, others, mode); }, [&] { return answer_of(others); }});
    }
  run_rounds(contestants, rounds);

  row.direct = nanoseconds_per_ray(contestants[0].seconds, row.count);
  row.direct_hits = contestants[0].first.hits;
  std::size_t best = 0;
  for (std::size_t k = 0; k < row.opponents.size(); ++k) {
    row.opponents[k].figure = nanoseconds_per_ray(contestants[k + 1].seconds, row.count);
    row.opponents[k].hits = contestants[k + 1].first.hits;
    if (row.opponents[k].figure.median < row.opponents[best].figure.median) best = k;
  }
  row.triangles = row.opponents[best].figure;
  row.triangles_build = name_of(row.opponents[best].build);
  row.triangles_mode = name_of(row.opponents[best].mode);
  row.triangle_hits = row.opponents[best].hits;
  contestants[best + 1].trace();
  for (std::size_t i = 0; i < hits.size(); ++i) row.only_one_hits += bool(hits[i]) != bool(others[i]) ? 1 : 0;
  if constexpr (std::is_same_v<DirectHit, Hit>) row.newton_per_hit = mean_newton_steps(hits);
  return row;
}

}  // namespace

Row contest(const RaySet& set, const Tracer& tracer, const std::vector<EmbreeTriangles>& triangles, int rounds) {
  if (set.occlusion)
    return run_contest<std::uint8_t, std::uint8_t>(
        set, triangles, rounds,
        [&](std::span<std::uint8_t> blocked, SolverStats& stats) { tracer.occluded(set.direct, blocked, set.order, stats); },
        [&](const EmbreeTriangles& built, std::span<std::uint8_t> blocked, Mode mode) { built.occluded(set.triangles, blocked, mode); });
  return run_contest<Hit, TriangleHit>(
      set, triangles, rounds, [&](std::span<Hit> hits, SolverStats& stats) { tracer.nearest(set.direct, hits, set.order, stats); },
      [&](const EmbreeTriangles& built, std::span<TriangleHit> hits, Mode mode) { built.nearest(set.triangles, hits, mode); });
}

Row two_threads_against_one(const RaySet& set, const Tracer& tracer, int rounds) {
  std::vector<Hit> hits(set.direct.size());
  const std::span<const Ray> rays(set.direct);
  const auto trace = [&](std::size_t first, std::size_t count) {
    SolverStats ignored;
    tracer.nearest(rays.subspan(first, count), std::span(hits).subspan(first, count), set.order, ignored);
  };
  // As a renderer shares its tiles: whoever is free takes the next piece.
  constexpr std::size_t kPiece = 1 << 14;
  const auto on_one = [&] { trace(0, rays.size()); };
  const auto on_two = [&] {
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
      for (std::size_t first; (first = next.fetch_add(kPiece)) < rays.size();) trace(first, std::min(kPiece, rays.size() - first));
    };
    std::thread other(run);
    run();
    other.join();
  };
  const auto wall_seconds_of = [](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  on_one();
  const Answer first = answer_of(hits);
  std::vector<double> one, two;
  for (int round = 0; round < rounds; ++round) {
    one.push_back(wall_seconds_of(on_one));
    two.push_back(wall_seconds_of(on_two));
    ISO_CHECK(answer_of(hits) == first);
  }
  Row row;
  row.rays = "two-threads";
  row.count = rays.size();
  row.direct = nanoseconds_per_ray(two, row.count);
  row.triangles = nanoseconds_per_ray(one, row.count);
  row.triangles_build = "direct, one thread";
  row.direct_hits = row.triangle_hits = first.hits;
  return row;
}

}  // namespace iso::bench
