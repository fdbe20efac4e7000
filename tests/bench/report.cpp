#include "tests/bench/report.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "tests/bench/goals.h"

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

double per_ray(std::uint64_t count, const Row& row) { return static_cast<double>(count) / static_cast<double>(row.count); }

std::string share(double of_diagonal) { return of_diagonal > 0 ? fmt::format("{:.2g}", of_diagonal) : "-"; }

std::string ray_table(const std::vector<SceneResult>& results) {
  std::vector<std::vector<std::string>> lines{{"scene", "rays", "tolerance", "measured", "count", "hits", "direct ns", "", "triangles ns",
                                               "", "build", "mode", "ratio", "one side only"}};
  for (const SceneResult& result : results)
    for (const Row& row : result.rows) {
      if (row.unit != Unit::ns_per_ray) continue;
      std::vector<std::string> line{row.scene,
                                    row.rays,
                                    share(row.tolerance),
                                    share(row.usual_error),
                                    fmt::format("{}", row.count),
                                    fmt::format("{:.1f}%", 100 * per_ray(row.direct_hits, row))};
      for (const Timing& ns : {row.direct, row.triangles})
        line.insert(line.end(), {fmt::format("{:.1f}", ns.median), fmt::format("+-{:.1f}%", 100 * ns.deviation / ns.median)});
      line.insert(line.end(),
                  {row.triangles_build, row.triangles_mode, fmt::format("{:.3f}", row.ratio()), fmt::format("{}", row.only_one_hits)});
      lines.push_back(line);
    }
  return aligned(lines, 2);
}

std::string solver_table(const std::vector<SceneResult>& results) {
  std::vector<std::vector<std::string>> lines{{"scene", "rays", "leaves/ray", "rejected/ray", "Newton/ray", "Newton/hit", "closed form/ray",
                                               "trims/ray", "fallbacks/ray", "cells/fallback"}};
  for (const SceneResult& result : results)
    for (const Row& row : result.rows) {
      const auto& s = row.stats;
      if (s.rays == 0 || row.tolerance != result.rows.back().tolerance) continue;
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
  std::vector<std::vector<std::string>> lines{{"scene", "patches", "leaves", "analytic", "MB", "read ms", "build ms", "| tolerance",
                                               "largest", "99%", "triangles", "mesh ms", "MEDIUM MB", "build ms", "HIGH MB", "build ms",
                                               "GRID MB", "build ms"}};
  for (const SceneResult& result : results)
    for (const BuildRow& b : result.builds) {
      std::vector<std::string> line{b.scene,
                                    fmt::format("{}", b.direct.bezier_patches),
                                    fmt::format("{}", b.direct.leaves),
                                    fmt::format("{}", b.direct.analytic_faces),
                                    fmt::format("{:.2f}", static_cast<double>(b.direct.bytes) / kMega),
                                    fmt::format("{:.0f}", 1e3 * b.load_seconds),
                                    fmt::format("{:.1f}", 1e3 * b.direct_seconds.median),
                                    share(b.tolerance),
                                    share(b.triangle_error),
                                    share(b.usual_error),
                                    fmt::format("{}", b.triangle_count),
                                    fmt::format("{:.0f}", 1e3 * b.mesh_seconds)};
      for (const TriangleBuild& t : b.triangles) {
        line.push_back(fmt::format("{:.2f}", static_cast<double>(t.bytes) / kMega));
        line.push_back(fmt::format("{:.1f}", 1e3 * t.seconds.median));
      }
      lines.push_back(line);
    }
  return aligned(lines, 1);
}

// A figure for readers: nanoseconds of a ray, milliseconds of a picture, megabytes.
std::string figure(const Row& row, const Timing& value) {
  switch (row.unit) {
    case Unit::ns_per_ray:
      return fmt::format("{:.1f} ns", value.median);
    case Unit::ns:
      return fmt::format("{:.1f} ms", value.median / kMega);
    default:
      return fmt::format("{:.2f} MB", value.median / kMega);
  }
}

std::string goal_table(const std::vector<SceneResult>& results) {
  std::vector<std::vector<std::string>> lines{{"goal", "scene", "tolerance", "direct", "triangles", "ratio", "must", "holds"}};
  for (const SceneResult& result : results)
    for (const Row& row : result.rows)
      if (const auto goal = goal_of(row.scene, row.rays, row.tolerance))
        lines.push_back({goal->about, row.scene, share(row.tolerance), figure(row, row.direct), figure(row, row.triangles),
                         fmt::format("{:.3f}", row.ratio()), fmt::format("{:g}", goal->must), row.ratio() >= goal->must ? "yes" : "no"});
  return lines.size() > 1 ? aligned(lines, 2) : std::string();
}

Json solver_json(const Row& row) {
  const auto& s = row.stats;
  return {{"leaf_visits_per_ray", per_ray(s.leaf_visits, row)},   {"slab_rejects_per_ray", per_ray(s.slab_rejects, row)},
          {"newton_steps_per_ray", per_ray(s.newton_steps, row)}, {"newton_steps_per_hit", row.newton_per_hit},
          {"closed_forms_per_ray", per_ray(s.analytic, row)},     {"trim_queries_per_ray", per_ray(s.trim_queries, row)},
          {"fallbacks_per_ray", per_ray(s.fallbacks, row)},       {"fallback_cells", s.fallback_cells}};
}

// Figures in nanoseconds have _ns in their names: per ray where there is a ray_count, else in all.
Json row_json(const Row& row) {
  const auto goal = goal_of(row.scene, row.rays, row.tolerance);
  const bool timed = row.unit != Unit::bytes;
  Json json{{"name", kName},
            {"scene", row.scene},
            {"rays", row.rays},
            {"tolerance", row.tolerance > 0 ? Json(row.tolerance) : Json()},
            {"polished", true},
            {"direct_ns", timed ? Json(row.direct.median) : Json()},
            {"triangles_ns", timed ? Json(row.triangles.median) : Json()},
            {"triangles_build", row.triangles_build},
            {"ratio", row.ratio()},
            {"must", goal ? Json(goal->must) : Json()},
            {"goal", goal ? Json(goal->about) : Json()},
            {"holds", goal ? Json(row.ratio() >= goal->must) : Json()},
            {"triangles_error", row.tolerance > 0 ? Json(row.triangles_error) : Json()},
            {"triangles_error_99", row.tolerance > 0 ? Json(row.usual_error) : Json()}};
  if (!timed) {
    json["direct_bytes"] = row.direct.median;
    json["triangles_bytes"] = row.triangles.median;
    return json;
  }
  json["direct_mad_ns"] = row.direct.deviation;
  json["triangles_mad_ns"] = row.triangles.deviation;
  if (row.unit != Unit::ns_per_ray) return json;
  json["triangles_mode"] = row.triangles_mode;
  json["ray_count"] = row.count;
  json["direct_mrays_per_second"] = 1e3 / row.direct.median;
  json["triangles_mrays_per_second"] = 1e3 / row.triangles.median;
  json["direct_hits"] = row.direct_hits;
  json["triangle_hits"] = row.triangle_hits;
  json["one_side_only"] = row.only_one_hits;
  json["triangles_all"] = Json::array();
  for (const Opponent& o : row.opponents)
    json["triangles_all"].push_back({{"build", name_of(o.build)},
                                     {"mode", name_of(o.mode)},
                                     {"ns", o.figure.median},
                                     {"mad_ns", o.figure.deviation},
                                     {"hits", o.hits}});
  if (row.stats.rays > 0) json["solver"] = solver_json(row);
  return json;
}

Json build_json(const BuildRow& b) {
  Json json{{"scene", b.scene},
            {"what", b.what},
            {"load_seconds", b.load_seconds},
            {"bezier_patches", b.direct.bezier_patches},
            {"leaves", b.direct.leaves},
            {"analytic_faces", b.direct.analytic_faces},
            {"direct_bytes", b.direct.bytes},
            {"direct_build_seconds", b.direct_seconds.median},
            {"tolerance", b.tolerance},
            {"triangles", b.triangle_count},
            {"triangles_error", b.triangle_error},
            {"triangles_error_99", b.usual_error},
            {"mesh_seconds", b.mesh_seconds},
            {"triangle_builds", Json::array()}};
  for (const TriangleBuild& t : b.triangles)
    json["triangle_builds"].push_back({{"build", name_of(t.build)}, {"seconds", t.seconds.median}, {"bytes", t.bytes}});
  return json;
}

}  // namespace

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

Origin origin_of_run() { return {machine_name(), commit_name(), {}}; }

std::string as_table(const std::vector<SceneResult>& results, const MeasureOptions& options, const Origin& origin) {
  std::string text = fmt::format(
      "{}: exact surfaces against Embree triangles\n"
      "{}; commit {}; one thread, CPU time, median and median absolute deviation of {} rounds that take turns\n\n",
      kName, origin.machine, origin.commit, options.rounds);
  text += ray_table(results);
  text +=
      "measured: error of the tessellation, share of the diagonal, all but one triangle in a hundred; build: the fastest of MEDIUM, HIGH "
      "and\n"
      "(smooth scenes) GRID; mode: direct in packets of 16, scattered rays singly; triangles in packets, scattered rays singly, bounce "
      "and\n"
      "room in the better way; ratio: triangles' time over direct's, above 1 direct is faster; one side only: rays that hit only the "
      "surface\n"
      "or only the triangles; two-threads: wall clock, against direct on one\n\n";
  text += solver_table(results);
  text +=
      "Newton/ray: all steps, of fallbacks too; Newton/hit: mean of the hits that Newton found; fallbacks: subdivision of a leaf where "
      "the\n"
      "linear model decides nothing\n\n";
  text += build_table(results);
  text +=
      "largest, 99%: measured distance of the surface from the triangles' planes, share of the diagonal; mesh ms: without reading; MB: of\n"
      "what rays need, the model itself not counted\n\n";
  text += goal_table(results);
  for (const std::string& left_out : origin.left_out) text += "left out: " + left_out + "\n";
  return text;
}

nlohmann::ordered_json as_json(const std::vector<SceneResult>& results, const MeasureOptions& options, const Origin& origin) {
  Json json{{"machine", origin.machine}, {"commit", origin.commit},     {"threads", 1},          {"rounds", options.rounds},
            {"quick", options.quick},    {"left_out", origin.left_out}, {"rows", Json::array()}, {"builds", Json::array()}};
  for (const SceneResult& result : results) {
    for (const Row& row : result.rows) json["rows"].push_back(row_json(row));
    for (const BuildRow& build : result.builds) json["builds"].push_back(build_json(build));
  }
  return json;
}

}  // namespace iso::bench
