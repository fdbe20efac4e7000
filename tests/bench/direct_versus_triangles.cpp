#include "tests/bench/direct_versus_triangles.h"

#include <optional>
#include <stdexcept>

#include "tests/support/instruction_set.h"

namespace iso::bench {
namespace {

// Builds are repeated as long as they are short.
constexpr int kMostBuilds = 3;
constexpr double kLongBuild = 1;  // seconds

template <class Make>
Timing repeated(const Make& seconds_of_one) {
  std::vector<double> seconds;
  double sum = 0;
  do {
    seconds.push_back(seconds_of_one());
    sum += seconds.back();
  } while (seconds.size() < kMostBuilds && sum < kLongBuild);
  return timing_of(seconds);
}

// One scene, traced directly and as triangles of one tolerance after the other.
class SceneRun {
 public:
  SceneRun(const BenchScene& scene, const MeasureOptions& options, const std::function<bool(const std::string&)>& wanted)
      : scene_(scene), options_(options), wanted_(wanted) {}

  Result<SceneResult> run() {
    const double start = thread_seconds();
    Result<TraceScene> loaded = scene_.load();
    if (!loaded) return loaded.error();
    load_seconds_ = thread_seconds() - start;
    diagonal_ = loaded->box().diagonal();
    direct_seconds_ = repeated([&] {
      TraceScene copy = *loaded;
      return seconds_of([&] { tracer_.emplace(std::move(copy)); });
    });
    primary_ = primary_rays(*tracer_, options_.rays);
    if (measured("two-threads")) {
      Row row = two_threads_against_one(primary_, *tracer_, options_.rounds);
      row.scene = scene_.name;
      result_.rows.push_back(row);
    }
    for (std::size_t i = 0; i < (options_.quick ? 1 : scene_.tolerances.size()); ++i) against_triangles(scene_.tolerances[i]);
    return std::move(result_);
  }

 private:
  bool measured(const std::string& rays) const {
    return wanted_(rays) && std::find(scene_.rays.begin(), scene_.rays.end(), rays) != scene_.rays.end();
  }

  void against_triangles(double tolerance) {
    tolerance_ = tolerance;
    mesh_ = scene_.mesh(tracer_->scene(), tolerance * diagonal_);
    std::vector<EmbreeTriangles> triangles = built(true, {});
    const SecondaryRays secondary(*tracer_, triangles.front(), mesh_, primary_);
    const bool pictures = measured("build-grid") || measured("build-high") || measured("first-image");
    if (measured("primary") || pictures) {
      const Row primary = contest(primary_, *tracer_, triangles, options_.rounds);
      if (measured("primary")) add(primary);
      add_builds(primary);
    }
    if (measured("memory")) add_memory();
    for (const auto& [name, make] : {std::pair{"bounce", &SecondaryRays::bounce},
                                     {"room", &SecondaryRays::room},
                                     {"scattered", &SecondaryRays::scattered},
                                     {"occlusion", &SecondaryRays::occlusion}})
      if (measured(name))
        if (const RaySet set = (secondary.*make)(); !set.direct.empty()) add(contest(set, *tracer_, triangles, options_.rounds));
    if (!measured("primary-avx2") && !measured("bounce-avx2")) return;
    triangles.clear();
    on_avx2(secondary.bounce());
  }

  // All builds of the mesh; their cost goes into the result, if it is `told`.
  std::vector<EmbreeTriangles> built(bool told, const std::string& device) {
    std::vector<EmbreeTriangles> triangles;
    BuildRow row{scene_.name,
                 scene_.what,
                 load_seconds_,
                 direct_seconds_,
                 tracer_->build_stats(),
                 tolerance_,
                 mesh_.error / diagonal_,
                 mesh_.usual_error / diagonal_,
                 mesh_.triangles.size(),
                 mesh_.seconds,
                 {}};
    for (const Build build : {Build::medium, Build::high, Build::grid}) {
      if (build == Build::grid && mesh_.grids.empty()) continue;
      std::optional<EmbreeTriangles> made;
      const auto make = [&] {
        made.reset();
        return made.emplace(mesh_, build, device).build_seconds();
      };
      const Timing seconds = told ? repeated(make) : Timing{make(), 0};
      row.triangles.push_back({build, seconds, made->bytes()});
      triangles.push_back(std::move(*made));
    }
    if (told) result_.builds.push_back(row);
    return triangles;
  }

  void add(Row row) {
    row.scene = scene_.name;
    row.tolerance = tolerance_;
    row.triangles_error = mesh_.error / diagonal_;
    row.usual_error = mesh_.usual_error / diagonal_;
    result_.rows.push_back(std::move(row));
  }

  // A build and a picture: the speed of the primary rays tells what 2^20 of them take.
  void add_builds(const Row& primary) {
    constexpr double kNano = 1e9, kPicture = 1 << 20;
    const BuildRow& builds = result_.builds.back();
    const auto in_all = [&](double seconds, const Timing& ns_per_ray) {
      return Timing{kNano * seconds + kPicture * ns_per_ray.median, kPicture * ns_per_ray.deviation};
    };
    Row row;
    row.unit = Unit::ns;
    row.direct = in_all(direct_seconds_.median, primary.direct);
    Row image = row;
    image.rays = "first-image";
    image.triangles.median = kInf;
    for (std::size_t k = 0; k < builds.triangles.size(); ++k) {
      const TriangleBuild& triangles = builds.triangles[k];
      row.triangles = in_all(triangles.seconds.median, primary.opponents[k].figure);
      row.triangles_build = name_of(triangles.build);
      row.rays = triangles.build == Build::grid ? "build-grid" : "build-high";
      if (triangles.build != Build::medium && measured(row.rays)) add(row);
      const Timing meshed = in_all(mesh_.seconds + triangles.seconds.median, primary.opponents[k].figure);
      if (meshed.median >= image.triangles.median) continue;
      image.triangles = meshed;
      image.triangles_build = name_of(triangles.build);
    }
    if (measured("first-image")) add(image);
  }

  void add_memory() {
    Row row;
    row.rays = "memory";
    row.unit = Unit::bytes;
    row.direct.median = static_cast<double>(tracer_->build_stats().bytes);
    for (const TriangleBuild& triangles : result_.builds.back().triangles)
      if (triangles.build == Build::grid) {
        row.triangles.median = static_cast<double>(triangles.bytes);
        row.triangles_build = name_of(triangles.build);
        add(row);
      }
  }

  void on_avx2(const RaySet& bounce) {
    // The whole program as on a machine that has no more: better targets of Highway have lower bits.
    constexpr const char* kAvx2Device = "isa=avx2";
    const test::KernelsFor kernels(hwy::SupportedTargets() & ~(HWY_AVX2 - 1));
    const Tracer tracer(tracer_->scene(), kAvx2Device);
    const std::vector<EmbreeTriangles> triangles = built(false, kAvx2Device);
    for (const RaySet* set : {&std::as_const(primary_), &bounce}) {
      const std::string name = set->name + "-avx2";
      if (!measured(name) || set->direct.empty()) continue;
      Row row = contest(*set, tracer, triangles, options_.rounds);
      row.rays = name;
      add(std::move(row));
    }
  }

  const BenchScene& scene_;
  const MeasureOptions& options_;
  const std::function<bool(const std::string&)>& wanted_;
  SceneResult result_;
  std::optional<Tracer> tracer_;
  RaySet primary_;
  TriangleMesh mesh_;
  double load_seconds_ = 0, diagonal_ = 0, tolerance_ = 0;
  Timing direct_seconds_;
};

}  // namespace

Result<SceneResult> measure(const BenchScene& scene, const MeasureOptions& options, const std::function<bool(const std::string&)>& wanted) {
  try {
    return SceneRun(scene, options, wanted).run();
  } catch (const std::runtime_error& failure) {
    return bad_input(scene.name, {}, failure.what());
  }
}

}  // namespace iso::bench
