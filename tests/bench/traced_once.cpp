#include "tests/bench/traced_once.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "tests/bench/ray_sets.h"

namespace iso::bench {

[[gnu::noinline]] void collected(const std::function<void()>& work) { work(); }

namespace {

// The scene as both sides see it, and the rays.
struct Stage {
  std::optional<Tracer> tracer;
  TriangleMesh mesh;
  RaySet set;
};

Result<Stage> stage_of(const BenchScene& scene, const OnceOptions& options) {
  Result<TraceScene> loaded = scene.load();
  if (!loaded) return loaded.error();
  Stage stage;
  const double diagonal = loaded->box().diagonal();
  stage.tracer.emplace(std::move(*loaded));
  stage.mesh = scene.mesh(stage.tracer->scene(), options.tolerance * diagonal);
  stage.set = primary_rays(*stage.tracer, options.count);
  if (options.rays == "primary") return stage;
  const EmbreeTriangles triangles(stage.mesh, Build::medium);
  const SecondaryRays secondary(*stage.tracer, triangles, stage.mesh, stage.set);
  for (const auto& [name, make] : {std::pair{"bounce", &SecondaryRays::bounce},
                                   {"room", &SecondaryRays::room},
                                   {"scattered", &SecondaryRays::scattered},
                                   {"occlusion", &SecondaryRays::occlusion}})
    if (options.rays == name) {
      stage.set = (secondary.*make)();
      return stage;
    }
  return bad_input(scene.name, {}, "no rays are called '" + options.rays + "'");
}

template <class AnyHit, class Trace>
Once traced(std::size_t count, const Trace& trace) {
  std::vector<AnyHit> hits(count);
  collected([&] { trace(hits); });
  const auto met = [](const AnyHit& hit) { return static_cast<bool>(hit); };
  return {count, static_cast<std::size_t>(std::count_if(hits.begin(), hits.end(), met))};
}

}  // namespace

Result<Once> trace_directly_once(const BenchScene& scene, const OnceOptions& options) {
  const Result<Stage> stage = stage_of(scene, options);
  if (!stage) return stage.error();
  const RaySet& set = stage->set;
  const Tracer& tracer = *stage->tracer;
  SolverStats stats;
  if (set.occlusion)
    return traced<std::uint8_t>(set.direct.size(),
                                [&](std::span<std::uint8_t> blocked) { tracer.occluded(set.direct, blocked, set.order, stats); });
  return traced<Hit>(set.direct.size(), [&](std::span<Hit> hits) { tracer.nearest(set.direct, hits, set.order, stats); });
}

Result<Once> trace_triangles_once(const BenchScene& scene, const OnceOptions& options, Build build) {
  const Result<Stage> stage = stage_of(scene, options);
  if (!stage) return stage.error();
  const RaySet& set = stage->set;
  if (build == Build::grid && stage->mesh.grids.empty()) return bad_input(scene.name, {}, "its mesh has no grids");
  const EmbreeTriangles triangles(stage->mesh, build);
  const Mode mode = set.incoherent || set.order == Tracer::Order::scattered ? Mode::single : Mode::packets;
  if (set.occlusion)
    return traced<std::uint8_t>(set.triangles.size(),
                                [&](std::span<std::uint8_t> blocked) { triangles.occluded(set.triangles, blocked, mode); });
  return traced<TriangleHit>(set.triangles.size(), [&](std::span<TriangleHit> hits) { triangles.nearest(set.triangles, hits, mode); });
}

}  // namespace iso::bench
