#include "raytracer/cmd/report.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace iso {
namespace {

std::vector<std::pair<const char*, std::uint64_t>> counters(const SolverStats& s) {
  return {{"rays", s.rays},
          {"leaf_visits", s.leaf_visits},
          {"slab_rejects", s.slab_rejects},
          {"solves", s.solves},
          {"newton_steps", s.newton_steps},
          {"analytic", s.analytic},
          {"trim_queries", s.trim_queries},
          {"fallbacks", s.fallbacks},
          {"fallback_cells", s.fallback_cells},
          {"fallback_out_of_budget", s.fallback_out_of_budget},
          {"tangent", s.tangent},
          {"by_tolerance", s.by_tolerance}};
}

std::vector<std::pair<const char*, std::uint64_t>> counters(const BuildStats& b) {
  return {{"bezier_patches", b.bezier_patches},
          {"leaves", b.leaves},
          {"analytic_faces", b.analytic_faces},
          {"triangles", b.triangles},
          {"bytes", b.bytes}};
}

}  // namespace

std::uint64_t peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

std::string rare_branches(const SolverStats& s) {
  return fmt::format("{} fallbacks, {} tangent, {} by tolerance, {} out of budget", s.fallbacks, s.tangent, s.by_tolerance,
                     s.fallback_out_of_budget);
}

std::string full_statistics(const BuildStats& build, const SolverStats& stats) {
  std::string text = fmt::format("build\n  {:<24}{:>16.3f}\n", "seconds", build.seconds);
  for (const auto& [name, value] : counters(build)) text += fmt::format("  {:<24}{:>16}\n", name, value);
  text += "solver\n";
  for (const auto& [name, value] : counters(stats)) text += fmt::format("  {:<24}{:>16}\n", name, value);
  if (stats.solves > 0) text += fmt::format("  {:<24}{:>16.2f}\n", "steps per solve", double(stats.newton_steps) / double(stats.solves));
  return text;
}

std::string statistics_json(const BuildStats& build, const SolverStats& stats) {
  nlohmann::json json;
  json["build"]["seconds"] = build.seconds;
  for (const auto& [name, value] : counters(build)) json["build"][name] = value;
  for (const auto& [name, value] : counters(stats)) json["solver"][name] = value;
  return json.dump();
}

}  // namespace iso
