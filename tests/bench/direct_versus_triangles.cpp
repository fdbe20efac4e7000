#include "tests/bench/direct_versus_triangles.h"

#include <stdexcept>

#include "tests/bench/ray_sets.h"

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
      answer.sum_t += static_cast<double>(hit.t);
    }
  return answer;
}

// One contestant of the rounds: its times, and its answer from the warm-up.
struct Contestant {
  std::function<void()> trace;
  std::function<Answer()> answer;
  std::vector<double> seconds;
  Answer first;
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

Timing nanoseconds_per_ray(const Contestant& contestant, std::size_t rays) {
  const Timing seconds = timing_of(contestant.seconds);
  const double scale = 1e9 / static_cast<double>(rays);
  return {scale * seconds.median, scale * seconds.deviation};
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

RayRow measure_rays(const std::string& scene, const RaySet& set, const Tracer& tracer, const std::vector<EmbreeTriangles>& triangles,
                    int rounds) {
  std::vector<Hit> hits(set.direct.size());
  std::vector<std::vector<TriangleHit>> triangle_hits(triangles.size(), std::vector<TriangleHit>(set.triangles.size()));
  RayRow row;
  row.scene = scene;
  row.rays = set.name;
  row.count = set.direct.size();

  std::vector<Contestant> contestants;
  contestants.push_back({[&] {
                           row.stats = {};
                           tracer.nearest(set.direct, hits, set.order, row.stats);
                         },
                         [&] { return answer_of(hits); },
                         {},
                         {}});
  for (std::size_t k = 0; k < triangles.size(); ++k)
    contestants.push_back({[&, k] { triangles[k].nearest(set.triangles, triangle_hits[k], set.order); },
                           [&, k] { return answer_of(triangle_hits[k]); },
                           {},
                           {}});
  run_rounds(contestants, rounds);

  // The better build of the triangles counts.
  std::size_t best = 0;
  for (std::size_t k = 1; k < triangles.size(); ++k)
    if (median(contestants[k + 1].seconds) < median(contestants[best + 1].seconds)) best = k;
  row.triangles_build = kBuilds[best];
  row.direct_ns = nanoseconds_per_ray(contestants[0], row.count);
  row.triangles_ns = nanoseconds_per_ray(contestants[best + 1], row.count);
  row.direct_hits = contestants[0].first.hits;
  row.triangle_hits = contestants[best + 1].first.hits;
  for (std::size_t i = 0; i < hits.size(); ++i) row.only_one_hits += bool(hits[i]) != bool(triangle_hits[best][i]) ? 1 : 0;
  row.newton_per_hit = mean_newton_steps(hits);
  return row;
}

}  // namespace

Result<SceneResult> measure(const BenchScene& scene, const MeasureOptions& options, const std::function<bool(const std::string&)>& wanted) {
  SceneResult result;
  BuildRow& build = result.build;
  build.scene = scene.name;
  build.what = scene.what;

  double start = thread_seconds();
  Result<TraceScene> loaded = scene.load();
  if (!loaded) return loaded.error();
  build.load_seconds = thread_seconds() - start;
  const double diagonal = loaded->box().diagonal();

  TriangleMesh mesh;
  try {
    mesh = scene.mesh(*loaded, options.tolerance * diagonal);
  } catch (const std::runtime_error& failure) {
    return bad_input(scene.name, {}, failure.what());
  }
  build.triangle_count = mesh.triangles.size();
  build.triangle_error = mesh.error / diagonal;
  build.mesh_seconds = mesh.seconds;
  std::vector<EmbreeTriangles> triangles;
  for (const Build quality : kBuilds) {
    const EmbreeTriangles& made = triangles.emplace_back(mesh, quality);
    build.triangles.push_back({quality, made.build_seconds(), made.bytes()});
  }

  start = thread_seconds();
  const Tracer tracer(std::move(*loaded));
  build.direct_seconds = thread_seconds() - start;
  build.direct = tracer.build_stats();

  const RaySet primary = primary_rays(tracer, options.rays);
  if (wanted(primary.name)) result.rows.push_back(measure_rays(scene.name, primary, tracer, triangles, options.rounds));
  if (wanted("bounce")) {
    const RaySet bounce = bounce_rays(tracer, triangles.front(), mesh, primary);
    if (!bounce.direct.empty()) result.rows.push_back(measure_rays(scene.name, bounce, tracer, triangles, options.rounds));
  }
  return result;
}

}  // namespace iso::bench
