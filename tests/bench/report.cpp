#include "tests/bench/report.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

namespace iso::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kName = "direct-versus-triangles";
constexpr double kMega = 1e6;

std::string machine_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "unknown";
}

std::string commit_name() {
  std::string text;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen("git -C '" ISOPHOTE_SOURCE_DIR "' describe --always --dirty 2>/dev/null", "r"),
                                                       &pclose);
  if (!pipe) return "unknown";
  for (int c; (c = std::fgetc(pipe.get())) != EOF && c != '\n';) text += static_cast<char>(c);
  return text.empty() ? "unknown" : text;
}

double per_ray(std::uint64_t count, const RayRow& row) { return static_cast<double>(count) / static_cast<double>(row.count); }

// Columns as wide as their widest cell; the first `left` ones aligned to the left.
std::string aligned(const std::vector<std::vector<std::string>>& lines, std::size_t left) {
  std::vector<std::size_t> widths;
  for (const auto& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], line[k].size());
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t k = 0; k < line.size(); ++k)
      text += k < left ? fmt::format("{:<{}}  ", line[k], widths[k]) : fmt::format("{:>{}}  ", line[k], widths[k]);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

// "0.61 +-0.8%": million rays per second, with the deviation as a share.
std::vector<std::string> speed(const Timing& ns) {
  return {fmt::format("{:.3g}", 1e3 / ns.median), fmt::format("+-{:.1f}%", 100 * ns.deviation / ns.median)};
}

std::string ray_table(const std::vector<SceneResult>& results) {
  std::vector<std::vector<std::string>> lines{
      {"scene", "rays", "count", "hits", "direct Mray/s", "", "triangles Mray/s", "", "build", "ratio", "one side only"}};
  for (const SceneResult& result : results)
    for (const RayRow& row : result.rows) {
      std::vector<std::string> line{row.scene, row.rays, fmt::format("{}", row.count),
                                    fmt::format("{:.1f}%", 100 * per_ray(row.direct_hits, row))};
      for (const Timing& ns : {row.direct_ns, row.triangles_ns})
        for (const std::string& cell : speed(ns)) line.push_back(cell);
      line.insert(line.end(), {name_of(row.triangles_build), fmt::format("{:.3f}", row.ratio()), fmt::format("{}", row.only_one_hits)});
      lines.push_back(line);
    }
  return aligned(lines, 2);
}

std::string solver_table(const std::vector<SceneResult>& results) {
  std::vector<std::vector<std::string>> lines{{"scene", "rays", "leaves/ray", "rejected/ray", "Newton/ray", "Newton/hit", "closed form/ray",
                                               "trims/ray", "fallbacks/ray", "cells/fallback"}};
  for (const SceneResult& result : results)
    for (const RayRow& row : result.rows) {
      const auto& s = row.stats;
      const double cells = s.fallbacks ? static_cast<double>(s.fallback_cells) / static_cast<double>(s.fallbacks) : 0;
      std::vector<std::string> line{row.scene, row.rays};
      for (const double value :
           {per_ray(s.leaf_visits, row), per_ray(s.slab_rejects, row), per_ray(s.newton_steps, row), row.newton_per_hit,
            per_ray(s.analytic, row), per_ray(s.trim_queries, row), per_ray(s.fallbacks, row), cells})
        line.push_back(fmt::format("{:.3f}", value));
      lines.push_back(line);
    }
  return aligned(lines, 2);
}

std::string build_table(const std::vector<SceneResult>& results) {
  std::vector<std::vector<std::string>> lines{{"scene", "patches", "leaves", "analytic", "MB", "read ms", "build ms", "| triangles",
                                               "error", "mesh ms", "MEDIUM MB", "build ms", "HIGH MB", "build ms"}};
  for (const SceneResult& result : results) {
    const BuildRow& b = result.build;
    std::vector<std::string> line{b.scene,
                                  fmt::format("{}", b.direct.bezier_patches),
                                  fmt::format("{}", b.direct.leaves),
                                  fmt::format("{}", b.direct.analytic_faces),
                                  fmt::format("{:.2f}", static_cast<double>(b.direct.bytes) / kMega),
                                  fmt::format("{:.0f}", 1e3 * b.load_seconds),
                                  fmt::format("{:.1f}", 1e3 * b.direct_seconds),
                                  fmt::format("{}", b.triangle_count),
                                  fmt::format("{:.2g}", b.triangle_error),
                                  fmt::format("{:.0f}", 1e3 * b.mesh_seconds)};
    for (const TriangleBuild& t : b.triangles) {
      line.push_back(fmt::format("{:.2f}", static_cast<double>(t.bytes) / kMega));
      line.push_back(fmt::format("{:.1f}", 1e3 * t.seconds));
    }
    lines.push_back(line);
  }
  return aligned(lines, 1);
}

Json row_json(const RayRow& row, const MeasureOptions& options) {
  const auto& s = row.stats;
  return {{"name", kName},
          {"scene", row.scene},
          {"rays", row.rays},
          {"tolerance", options.tolerance},
          {"polished", true},
          {"direct_ns", row.direct_ns.median},
          {"triangles_ns", row.triangles_ns.median},
          {"triangles_build", name_of(row.triangles_build)},
          {"ratio", row.ratio()},
          {"direct_mad_ns", row.direct_ns.deviation},
          {"triangles_mad_ns", row.triangles_ns.deviation},
          {"ray_count", row.count},
          {"direct_hits", row.direct_hits},
          {"triangle_hits", row.triangle_hits},
          {"one_side_only", row.only_one_hits},
          {"leaf_visits_per_ray", per_ray(s.leaf_visits, row)},
          {"slab_rejects_per_ray", per_ray(s.slab_rejects, row)},
          {"solves_per_ray", per_ray(s.solves, row)},
          {"newton_steps_per_ray", per_ray(s.newton_steps, row)},
          {"newton_steps_per_hit", row.newton_per_hit},
          {"analytic_per_ray", per_ray(s.analytic, row)},
          {"trim_queries_per_ray", per_ray(s.trim_queries, row)},
          {"fallbacks_per_ray", per_ray(s.fallbacks, row)},
          {"fallback_cells_per_ray", per_ray(s.fallback_cells, row)},
          {"fallbacks_out_of_budget", s.fallback_out_of_budget}};
}

Json build_json(const BuildRow& b) {
  Json json{{"scene", b.scene},
            {"what", b.what},
            {"read_seconds", b.load_seconds},
            {"patches", b.direct.bezier_patches},
            {"leaves", b.direct.leaves},
            {"analytic_faces", b.direct.analytic_faces},
            {"direct_bytes", b.direct.bytes},
            {"direct_build_seconds", b.direct_seconds},
            {"triangles", b.triangle_count},
            {"triangles_error", b.triangle_error},
            {"mesh_seconds", b.mesh_seconds},
            {"triangle_builds", Json::array()}};
  for (const TriangleBuild& t : b.triangles)
    json["triangle_builds"].push_back({{"build", name_of(t.build)}, {"seconds", t.seconds}, {"bytes", t.bytes}});
  return json;
}

}  // namespace

Origin origin_of_run() { return {machine_name(), commit_name()}; }

std::string as_table(const std::vector<SceneResult>& results, const MeasureOptions& options, const Origin& origin) {
  std::string text = fmt::format(
      "{}: exact surfaces against Embree triangles of a tessellation at {:g} of the diagonal\n"
      "{}; commit {}; one thread, CPU time, median and median absolute deviation of {} rounds that take turns\n\n",
      kName, options.tolerance, origin.machine, origin.commit, options.rounds);
  text += ray_table(results);
  text +=
      "ratio: rays per second, direct over triangles, above 1 direct is faster; build: the faster one of MEDIUM and HIGH; one side only: "
      "rays that "
      "hit only the surface or only the triangles\n\n";
  text += solver_table(results);
  text +=
      "Newton/ray: all steps, of fallbacks too; Newton/hit: mean of the hits that Newton found; fallbacks: subdivision of a leaf where the "
      "linear "
      "model decides nothing\n\n";
  text += build_table(results);
  text +=
      "error: measured, share of the diagonal (distance of the surface from the triangles' planes); mesh ms: of CAD models with Open "
      "CASCADE's "
      "reading; MB: of what rays need, the model itself not counted\n";
  return text;
}

nlohmann::ordered_json as_json(const std::vector<SceneResult>& results, const MeasureOptions& options, const Origin& origin) {
  Json json{{"machine", origin.machine}, {"commit", origin.commit}, {"threads", 1},
            {"rounds", options.rounds},  {"rows", Json::array()},   {"builds", Json::array()}};
  for (const SceneResult& result : results) {
    for (const RayRow& row : result.rows) json["rows"].push_back(row_json(row, options));
    json["builds"].push_back(build_json(result.build));
  }
  return json;
}

}  // namespace iso::bench
