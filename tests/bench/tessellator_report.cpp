#include "tests/bench/tessellator_report.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>

namespace iso::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMostDeviation = 1, kFewestOnRough = 0.5, kTrianglesPerSecond = 500e3, kScaling = 1.7, kMostSlivers = 0.01,
                 kMostBytes = 500;
constexpr std::uint64_t kManyTriangles = 50'000;  // below, a process' pages say little about a triangle
constexpr const char* kRough[] = {"terrain.brep", "MAT.brep"};

// The three rows of a model and a tolerance.
struct Trio {
  const TessellatorRow &ours, &watson, &delabella;

  // The lesser value of the rivals that finished; infinite if none did.
  double rival(const std::function<double(const TessellatorRow&)>& value) const {
    double least = kInf;
    for (const TessellatorRow* row : {&watson, &delabella})
      if (row->failure.empty()) least = std::min(least, value(*row));
    return least;
  }
};

std::vector<Trio> trios_of(const TessellatorResults& results) {
  std::vector<Trio> trios;
  for (std::size_t i = 0; i + 2 < results.rows.size(); i += 3)
    if (results.rows[i].failure.empty()) trios.push_back({results.rows[i], results.rows[i + 1], results.rows[i + 2]});
  return trios;
}

std::string share(double of_diagonal) { return fmt::format("{:.2g}", of_diagonal); }
std::string place_of(const TessellatorRow& row) { return fmt::format("{} {}", row.model, share(row.tolerance)); }
bool is_rough(const TessellatorRow& row) { return std::find(std::begin(kRough), std::end(kRough), row.model) != std::end(kRough); }

void take(Must& must, bool holds, const std::string& where, double value) {
  ++must.cases;
  must.held += holds;
  if (!holds) must.not_held.push_back(fmt::format("{}: {:.3g}", where, value));
}

Must must_stay_near(const std::vector<Trio>& trios) {
  Must must{"ours: measured deviation at most 1.0 T and the face's own gap", 0, 0, {}};
  for (const Trio& t : trios) {
    const TessellatorRow& r = t.ours;
    take(must, r.beyond_gap <= kMostDeviation,
         fmt::format("{}, face {} ({}) at ({:.6g}, {:.6g})", place_of(r), r.worst_face, r.worst_kind, r.worst_uv.x, r.worst_uv.y),
         r.beyond_gap);
  }
  return must;
}

Must must_stay_below_bound(const std::vector<Trio>& trios) {
  Must must{"ours: measured deviation at most the proven bound", 0, 0, {}};
  for (const Trio& t : trios) take(must, t.ours.max <= t.ours.bound, place_of(t.ours), t.ours.max / t.ours.bound);
  return must;
}

Must must_be_monotone(const std::vector<Trio>& trios) {
  Must must{"ours: deviation falls with the tolerance", 0, 0, {}};
  for (std::size_t i = 1; i < trios.size(); ++i) {
    const TessellatorRow &coarse = trios[i - 1].ours, &fine = trios[i].ours;
    if (coarse.model != fine.model) continue;
    const double ratio = fine.max * fine.tolerance / (coarse.max * coarse.tolerance);
    take(must, !(ratio > 1), place_of(fine), ratio);
  }
  return must;
}

Must must_be_few(const std::vector<Trio>& trios, const char* about, double most, bool only_rough) {
  Must must{about, 0, 0, {}};
  for (const Trio& t : trios) {
    const double rival = t.rival([](const TessellatorRow& r) { return r.triangles_at_tolerance(); });
    if (!(rival > 0 && rival < kInf) || (only_rough && !is_rough(t.ours))) continue;
    const double ratio = t.ours.triangles_at_tolerance() / rival;
    take(must, ratio <= most, place_of(t.ours), ratio);
  }
  return must;
}

bool is_near(double tolerance, double other) { return std::abs(tolerance - other) <= 1e-6 * other; }

Must must_be_fast(const std::vector<Trio>& trios) {
  Must must{"time at 1e-3 and 1e-4 at most that of the faster of OCCT's two", 0, 0, {}};
  for (const Trio& t : trios) {
    if (!is_near(t.ours.tolerance, 1e-3) && !is_near(t.ours.tolerance, 1e-4)) continue;
    const double rival = t.rival([](const TessellatorRow& r) { return r.seconds; });
    if (rival < kInf) take(must, t.ours.seconds <= rival, place_of(t.ours), t.ours.seconds / rival);
  }
  return must;
}

Must must_be_quick(const std::vector<Trio>& trios) {
  Must must{"ours at 1e-5: at least 500 000 triangles/s", 0, 0, {}};
  for (const Trio& t : trios)
    if (is_near(t.ours.tolerance, 1e-5))
      take(must, t.ours.triangles_per_second() >= kTrianglesPerSecond, place_of(t.ours), t.ours.triangles_per_second());
  return must;
}

Must must_scale(const TessellatorResults& results) {
  Must must{"ours with 2 threads, more than 20 faces: at least 1.7 times as fast (wall clock)", 0, 0, {}};
  for (const ScalingRow& row : results.scaling)
    take(must, row.wall.one / row.wall.two >= kScaling, fmt::format("{} {}", row.model, share(row.tolerance)), row.wall.one / row.wall.two);
  return must;
}

Must must_be_compact(const std::vector<Trio>& trios) {
  Must must{"ours, from 50 000 triangles on: at most 500 bytes a triangle", 0, 0, {}};
  for (const Trio& t : trios)
    if (t.ours.triangles >= kManyTriangles)
      take(must, t.ours.bytes_per_triangle() <= kMostBytes, place_of(t.ours), t.ours.bytes_per_triangle());
  return must;
}

Must must_end(const TessellatorResults& results, Mesher mesher) {
  Must must{fmt::format("{}: a mesh within {} s of CPU time", name_of(mesher), kMostMeshSeconds), 0, 0, {}};
  for (const TessellatorRow& row : results.rows) {
    if (row.mesher != mesher || row.failure == kLeftOut) continue;
    ++must.cases;
    must.held += row.failure.empty();
    if (!row.failure.empty()) must.not_held.push_back(fmt::format("{}: {}", place_of(row), row.failure));
  }
  return must;
}

// The same for each mesher, so that they can be compared.
Must must_be(const TessellatorResults& results, Mesher mesher, const char* about, double most,
             const std::function<double(const TessellatorRow&)>& value) {
  Must must{fmt::format("{}: {}", name_of(mesher), about), 0, 0, {}};
  for (const TessellatorRow& row : results.rows)
    if (row.mesher == mesher && row.failure.empty()) take(must, value(row) <= most, place_of(row), value(row));
  return must;
}

std::string count_of(double triangles) {
  return triangles < 1e4   ? fmt::format("{:.0f}", triangles)
         : triangles < 1e6 ? fmt::format("{:.1f}k", 1e-3 * triangles)
                           : fmt::format("{:.2f}M", 1e-6 * triangles);
}

std::vector<std::string> line_of(const TessellatorRow& r) {
  std::vector<std::string> line{r.model, share(r.tolerance), name_of(r.mesher)};
  if (!r.failure.empty()) {
    line.push_back(r.failure);
    return line;
  }
  const bool ours = r.mesher == Mesher::ours;
  line.insert(line.end(), {count_of(static_cast<double>(r.triangles)), fmt::format("{:.3g}", r.seconds), count_of(r.triangles_per_second()),
                           fmt::format("{:.3f}", r.max), fmt::format("{:.3f}", r.p999), ours ? fmt::format("{:.3f}", r.bound) : "",
                           ours ? fmt::format("{:.3g}", r.gap) : "", ours ? fmt::format("{}", r.rounds) : "",
                           count_of(r.triangles_at_tolerance()), fmt::format("{}", r.open_edges), fmt::format("{}", r.non_manifold_edges),
                           fmt::format("{}", r.zero_area), fmt::format("{}", r.folded), fmt::format("{:.2f}", 100 * r.sliver_share()),
                           fmt::format("{:.0f}", r.bytes_per_triangle()), fmt::format("{} {}", r.worst_face, r.worst_kind)});
  return line;
}

std::string must_text(const Must& must) {
  std::string text = fmt::format("{:>4} of {:<4} {}\n", must.held, must.cases, must.about);
  constexpr std::size_t kMostTold = 20;
  for (std::size_t i = 0; i < std::min(kMostTold, must.not_held.size()); ++i)
    text += fmt::format("               not {}\n", must.not_held[i]);
  if (must.not_held.size() > kMostTold) text += fmt::format("               and {} more\n", must.not_held.size() - kMostTold);
  return text;
}

// Five digits.
double rounded(double value) { return value == 0 || !finite(value) ? value : std::stod(fmt::format("{:.5g}", value)); }

Json row_json(const TessellatorRow& r) {
  Json json{{"name", r.model}, {"faces", r.faces}, {"tolerance", r.tolerance}, {"mesher", name_of(r.mesher)}};
  if (!r.failure.empty()) {
    json["failure"] = r.failure;
    return json;
  }
  json.update({{"triangles", r.triangles},
               {"seconds", rounded(r.seconds)},
               {"runs", r.runs},
               {"triangles_per_second", rounded(r.triangles_per_second())},
               {"max", rounded(r.max)},
               {"p999", rounded(r.p999)},
               {"sampled", r.sampled_triangles},
               {"worst_face", r.worst_face},
               {"worst_kind", r.worst_kind},
               {"worst_uv", {rounded(r.worst_uv.x), rounded(r.worst_uv.y)}},
               {"open_edges", r.open_edges},
               {"non_manifold_edges", r.non_manifold_edges},
               {"misoriented_edges", r.misoriented_edges},
               {"zero_area", r.zero_area},
               {"folded", r.folded},
               {"sliver_share", rounded(r.sliver_share())},
               {"smallest_angle", rounded(r.smallest_angle)},
               {"failed_faces", r.failed_faces},
               {"bytes_per_triangle", rounded(r.bytes_per_triangle())}});
  if (r.mesher != Mesher::ours) return json;
  json.update({{"bound", rounded(r.bound)},
               {"gap", rounded(r.gap)},
               {"beyond_gap", rounded(r.beyond_gap)},
               {"rounds", r.rounds},
               {"unresolved", r.unresolved}});
  return json;
}

}  // namespace

std::vector<Must> musts_of(const TessellatorResults& results) {
  const std::vector<Trio> trios = trios_of(results);
  std::vector<Must> musts{must_stay_near(trios),
                          must_stay_below_bound(trios),
                          must_be_monotone(trios),
                          must_be_few(trios, "triangles * p99.9 / T at most the better of OCCT's two", 1, false),
                          must_be_few(trios, "half of that on rough surfaces (terrain, MAT)", kFewestOnRough, true),
                          must_be_fast(trios),
                          must_be_quick(trios),
                          must_scale(results),
                          must_be_compact(trios)};
  for (const Mesher mesher : kMeshers) {
    const auto add = [&](const char* about, double most, const std::function<double(const TessellatorRow&)>& value) {
      musts.push_back(must_be(results, mesher, about, most, value));
    };
    musts.push_back(must_end(results, mesher));
    add("less than 1 % of the triangles with an angle under 1 degree", kMostSlivers, [](auto& r) { return r.sliver_share(); });
    add("no non-manifold edges", 0, [](auto& r) { return static_cast<double>(r.non_manifold_edges); });
    add("no triangles without area", 0, [](auto& r) { return static_cast<double>(r.zero_area); });
    add("no folded triangles", 0, [](auto& r) { return static_cast<double>(r.folded); });
    add("no faces without triangles", 0, [](auto& r) { return static_cast<double>(r.failed_faces); });
    if (mesher != Mesher::ours) add("measured deviation at most 1.0 T", 1, [](auto& r) { return r.max; });
  }
  return musts;
}

std::string tessellator_table(const TessellatorResults& results, const TessellatorOptions& options, const Origin& origin) {
  std::string text = fmt::format(
      "tessellators: ours against Open CASCADE's\n{}; commit {}; one thread, CPU time of meshing, median of {} rounds that take turns (one "
      "run "
      "where it\ntakes long)\n\n",
      origin.machine, origin.commit, options.rounds);
  std::vector<std::vector<std::string>> lines{{"model", "T/diagonal", "mesher", "triangles", "seconds", "per s", "max/T", "p99.9/T",
                                               "bound/T", "gap/T", "rounds", "n p/T", "open", "non-man", "no area", "folded", "<1 deg %",
                                               "B/tri", "worst face"}};
  for (const TessellatorRow& row : results.rows) lines.push_back(line_of(row));
  text += aligned(lines, 3);
  text += fmt::format(
      "\nmax, p99.9: distance of surface points under the triangles ({} inside each, {} triangles at most) from the mesh; p99.9 without "
      "planes;\nbound: what is proven of ours, gaps included; gap: half of what the model's faces are apart; n p/T: triangles * p99.9 / T, "
      "which is\ntheir number at a p99.9 of 1 T, as error goes with one over their number; worst face: of ours after its gap is taken "
      "off;\n"
      "B/tri: peak memory of meshing\n\n",
      kSamplesPerTriangle, options.sampled_triangles);
  for (const ScalingRow& row : results.scaling)
    text += fmt::format("{}, {} faces, {:g}: {:.3f} s with one thread, {:.3f} s with two (wall clock): {:.2f}\n", row.model, row.faces,
                        row.tolerance, row.wall.one, row.wall.two, row.wall.one / row.wall.two);
  text += "\nmusts, and how often they hold:\n";
  for (const Must& must : musts_of(results)) text += must_text(must);
  for (const std::string& left_out : origin.left_out) text += "left out: " + left_out + "\n";
  return text;
}

nlohmann::ordered_json tessellator_json(const TessellatorResults& results, const TessellatorOptions& options, const Origin& origin) {
  Json json{{"machine", origin.machine}, {"commit", origin.commit},     {"threads", 1},
            {"rounds", options.rounds},  {"left_out", origin.left_out}, {"rows", Json::array()},
            {"scaling", Json::array()},  {"musts", Json::array()}};
  for (const TessellatorRow& row : results.rows) json["rows"].push_back(row_json(row));
  for (const ScalingRow& row : results.scaling)
    json["scaling"].push_back({{"name", row.model},
                               {"faces", row.faces},
                               {"tolerance", row.tolerance},
                               {"one_thread_seconds", rounded(row.wall.one)},
                               {"two_threads_seconds", rounded(row.wall.two)}});
  for (const Must& must : musts_of(results))
    json["musts"].push_back({{"about", must.about}, {"held", must.held}, {"cases", must.cases}, {"not_held", must.not_held}});
  return json;
}

}  // namespace iso::bench
