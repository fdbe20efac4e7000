// isophote_bench: ./isophote bench [NAME...] [--quick] [--json] [--rounds N] [--rays N] [--tolerance X...]
//
// Every measurement is called direct-versus-triangles/SCENE/RAYS; a NAME selects those that have it as one of these three words, several
// NAMEs those that fit the NAMEs of each kind: `linkrods teapot bounce` are two scenes, bounces only. The other benchmarks, trim-queries,
// brl-cad, tessellators and patches, have no scenes.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "tests/bench/brl_cad.h"
#include "tests/bench/patch_rays.h"
#include "tests/bench/report.h"
#include "tests/bench/tessellator_report.h"
#include "tests/bench/traced_once.h"
#include "tests/bench/trim_queries.h"

namespace iso::bench {
namespace {

constexpr const char *kBenchmark = "direct-versus-triangles", *kTrimQueries = "trim-queries", *kBrlCad = "brl-cad",
                     *kTessellators = "tessellators", *kPatches = "patches";
constexpr Build kBuilds[] = {Build::medium, Build::high, Build::grid};
constexpr int kSegments[] = {10, 100, 1000};
constexpr int kQuickRounds = 3, kQuickRays = 1 << 18;
constexpr std::size_t kQuickTolerances = 2;
constexpr int kBrlCadRays = 1000000, kBrlCadQuickRays = 100000;

int fail(const Error& error) {
  std::cerr << "isophote bench: " << error.text() << '\n';
  return static_cast<int>(error.kind);
}

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// Of the known words those that are among the names; all if none is.
std::vector<std::string> chosen(const std::vector<std::string>& known, const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const std::string& word : known)
    if (contains(names, word)) found.push_back(word);
  return found.empty() ? known : found;
}

int run_trim_queries(bool json) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const int segments : kSegments) {
    const TrimTimes t = measure_trim_queries(segments);
    rows.push_back({{"segments", t.segments}, {"uniform_ns", t.uniform}, {"near_ns", t.near}, {"checked", t.checked}});
    if (!json)
      fmt::print("{:5} segments: {:5.1f} ns a query (+-{:.1f}), {:5.1f} ns near the loop (+-{:.1f}); {} answers as the winding test's\n",
                 t.segments, t.uniform, t.uniform_deviation, t.near, t.near_deviation, t.checked);
  }
  if (json) std::cout << rows.dump(2) << '\n';
  return static_cast<int>(Exit::done);
}

int run_patches(int rays, int rounds, bool json) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const PatchRays& r : measure_patch_rays(rays, rounds)) {
    rows.push_back({{"name", r.name},
                    {"patches", r.patches},
                    {"hits", r.hits},
                    {"ns", r.nanoseconds.median},
                    {"deviation", r.nanoseconds.deviation},
                    {"of_bicubic", r.of_bicubic},
                    {"proven", r.proven},
                    {"build_s", r.build},
                    {"megabytes", r.megabytes}});
    if (!json)
      fmt::print(
          "{:36} {:4} patches: {:6.1f} ns a ray (+-{:.1f}), {:4.2f} times the bicubic; spline within {:.1e}; build {:.2f} s, {:.0f} MB\n",
          r.name, r.patches, r.nanoseconds.median, r.nanoseconds.deviation, r.of_bicubic, r.proven, r.build, r.megabytes);
  }
  if (json) std::cout << rows.dump(2) << '\n';
  return static_cast<int>(Exit::done);
}

int run_brl_cad(const MeasureOptions& options, bool json) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Origin origin = origin_of_run();
  const BrlCadOptions wanted{options.rounds, static_cast<std::size_t>(options.rays)};
  std::vector<BrlCadRow> rows;
  for (const test::BrlCadModel& model : test::kBrlCadModels) {
    const auto path = test::path_of(model);
    if (!path) {
      origin.left_out.push_back(fmt::format("{}, because there is no file {}", model.name, model.file));
      std::cerr << "left out: " << origin.left_out.back() << '\n';
      continue;
    }
    std::cerr << "measuring " << model.name << " ...\n";
    auto row = measure_against_brl_cad(model, *path, wanted);
    if (!row) return fail(row.error());
    rows.push_back(std::move(*row));
  }
  std::cout << (json ? brl_cad_json(rows, wanted, origin).dump(2) + "\n" : brl_cad_table(rows, wanted, origin)) << std::flush;
  return static_cast<int>(std::cout ? Exit::done : Exit::read_write);
}

int run_tessellators(const TessellatorOptions& options, bool json) {
  for (const std::string& name : options.models)
    if (!contains(tessellator_models(), name))
      return fail(
          {Exit::bad_command_line, {}, {}, fmt::format("unknown model '{}'; expected {}", name, fmt::join(tessellator_models(), ", "))});
  const auto results = measure_tessellators(options);
  if (!results) return fail(results.error());
  Origin origin = origin_of_run();
  origin.left_out = results->left_out;
  std::cout << (json ? tessellator_json(*results, options, origin).dump(2) + "\n" : tessellator_table(*results, options, origin))
            << std::flush;
  return static_cast<int>(std::cout ? Exit::done : Exit::read_write);
}

// Scene and rays are the names; `side`: direct, or a build of triangles.
int run_once(const std::vector<BenchScene>& scenes, const std::vector<std::string>& names, const std::string& side,
             const OnceOptions& options) {
  const auto scene = std::find_if(scenes.begin(), scenes.end(), [&](const BenchScene& s) { return contains(names, s.name); });
  if (names.size() != 2 || scene == scenes.end())
    return fail({Exit::bad_command_line, {}, {}, "--once takes a scene and a set of rays: wavy-torus room, say"});
  OnceOptions wanted = options;
  wanted.rays = names[0] == scene->name ? names[1] : names[0];
  const auto build = std::find_if(std::begin(kBuilds), std::end(kBuilds), [&](Build b) { return side == name_of(b); });
  if (side != "direct" && build == std::end(kBuilds))
    return fail({Exit::bad_command_line, {}, {}, fmt::format("unknown side '{}'; expected direct, MEDIUM, HIGH or GRID", side)});
  const Result<Once> once = side == "direct" ? trace_directly_once(*scene, wanted) : trace_triangles_once(*scene, wanted, *build);
  if (!once) return fail(once.error());
  fmt::print("{} rays, {} hits\n", once->rays, once->hits);
  return static_cast<int>(Exit::done);
}

int run(int argc, char** argv) {
  std::vector<BenchScene> scenes = bench_scenes();
  std::vector<std::string> scene_names;
  for (const BenchScene& scene : scenes) scene_names.push_back(scene.name);

  CLI::App app("Measures Isophote: exact surfaces against Embree triangles of a fine tessellation.", "isophote bench");
  MeasureOptions options;
  std::vector<std::string> names;
  bool json = false;
  app.add_option("NAME", names,
                 fmt::format("what to measure: {}; scenes {}; rays {} [all]; or {}, {}, {} or {}, alone", kBenchmark,
                             fmt::join(scene_names, " "), fmt::join(kRaySets, " "), kTrimQueries, kBrlCad, kTessellators, kPatches));
  TessellatorOptions tessellators;
  app.add_option("--model", tessellators.models, "of tessellators: a file's name; may be repeated [all]");
  app.add_flag_callback(
      "--ours", [&] { tessellators.rivals = Rivals::left_out; }, "of tessellators: without Open CASCADE's");
  app.add_flag("--json", json, "print one JSON document instead of the table");
  auto* quick =
      app.add_flag("--quick", options.quick,
                   fmt::format("a first impression: the coarsest tessellations, --rounds {} --rays {}", kQuickRounds, kQuickRays));
  std::vector<double> tolerances;
  app.add_option("--tolerance,--tolerances", tolerances, "of the tessellations, shares of the diagonal, falling [each scene's own]")
      ->check(CLI::Range(1e-9, 0.1));
  auto* rounds = app.add_option("--rounds", options.rounds, fmt::format("measured rounds after the warm-up [{}]", options.rounds))
                     ->check(CLI::Range(1, 1000));
  auto* count = app.add_option("--rays", options.rays, fmt::format("primary rays [{}]", options.rays))->check(CLI::Range(16, 1 << 26));
  std::string side;
  auto* once = app.add_option("--once", side,
                              "trace the rays NAME (primary, bounce, room, scattered or occlusion) of the scene NAME once, for a profiler: "
                              "direct, MEDIUM, HIGH or GRID; "
                              "65536 primary rays and a tolerance of 1e-4 if not told otherwise");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error, std::cout, std::cerr) == 0 ? static_cast<int>(Exit::done) : static_cast<int>(Exit::bad_command_line);
  }
  if (*once) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    return run_once(scenes, names, side, {{}, tolerances.empty() ? 1e-4 : tolerances.front(), *count ? options.rays : OnceOptions{}.count});
  }
  if (names == std::vector<std::string>{kTrimQueries}) return run_trim_queries(json);
  if (*quick && !*rounds) options.rounds = kQuickRounds;
  if (names == std::vector<std::string>{kPatches}) return run_patches(*quick && !*count ? kQuickRays : options.rays, options.rounds, json);
  if (names == std::vector<std::string>{kBrlCad}) {
    if (!*count) options.rays = *quick ? kBrlCadQuickRays : kBrlCadRays;
    return run_brl_cad(options, json);
  }
  if (names == std::vector<std::string>{kTessellators}) {
    if (!tolerances.empty()) tessellators.tolerances = tolerances;
    while (*quick && tessellators.tolerances.size() > kQuickTolerances) tessellators.tolerances.pop_back();
    tessellators.rounds = options.rounds;
    return run_tessellators(tessellators, json);
  }
  if (*quick && !*count) options.rays = kQuickRays;
  for (const std::string& name : names)
    if (name != kBenchmark && !contains(scene_names, name) && !contains(kRaySets, name))
      return fail({Exit::bad_command_line,
                   {},
                   {},
                   fmt::format("unknown name '{}'; expected {}, {} or {}", name, kBenchmark, fmt::join(scene_names, ", "),
                               fmt::join(kRaySets, ", "))});

  if (!tolerances.empty())
    for (BenchScene& scene : scenes) scene.tolerances = tolerances;

  // One thread, builds included.
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto rays = chosen(kRaySets, names);
  Origin origin = origin_of_run();
  std::vector<SceneResult> results;
  for (const std::string& wanted : chosen(scene_names, names)) {
    const auto scene = std::find_if(scenes.begin(), scenes.end(), [&](const BenchScene& s) { return s.name == wanted; });
    if (!scene->file.empty() && !std::filesystem::exists(scene->file)) {
      origin.left_out.push_back(wanted + ", because there is no file " + scene->file);
      std::cerr << "left out: " << origin.left_out.back() << '\n';
      continue;
    }
    std::cerr << "measuring " << wanted << " ...\n";
    auto result = measure(*scene, options, [&](const std::string& set) { return contains(rays, set); });
    if (!result) return fail(result.error());
    results.push_back(std::move(*result));
  }
  std::cout << (json ? as_json(results, options, origin).dump(2) + "\n" : as_table(results, options, origin)) << std::flush;
  return static_cast<int>(std::cout ? Exit::done : Exit::read_write);
}

}  // namespace
}  // namespace iso::bench

int main(int argc, char** argv) {
  try {
    return iso::bench::run(argc, argv);
  } catch (const std::exception& e) {
    return iso::bench::fail(iso::bad_input({}, {}, std::string("unexpected trouble: ") + e.what()));
  }
}
