#include "tests/bench/brl_cad.h"

#include <fmt/format.h>

#include "patches/io/read_model.h"

namespace iso::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kName = "brl-cad";
constexpr const char* kVersion = "7.32.6";
constexpr const char* kApart =
    "BRL-CAD did not run here: its rates were measured apart, on a machine of the same kind, one thread, 100,000 random rays through each "
    "model's box, CPU time, +-20 %";
constexpr const char *kAsItIs = "as downloaded", *kRewritten = "rewritten by Open CASCADE without surface curves",
                     *kDamaged = "with a later fix of its importer; 3 faces damaged";
constexpr std::array<BrlCadRecord, 7> kRecords{{
    {"nist-mbe-pmi-03", 22000, 1e-5, kAsItIs},
    {"netgen-frame", 5400, 7e-5, kAsItIs},
    {"linkrods", 7900, 6e-5, kRewritten},
    {"as1-oc-214", 27000, 2e-5, kRewritten},
    {"tigl-nacelle", 16000, 47e-5, kRewritten},
    {"goteborg-hull", 65000, 30e-5, kRewritten},
    {"screw", 126000, 0.21724, kDamaged},
}};

constexpr std::uint64_t kSeed = 20240711;
constexpr std::size_t kSampleStep = 1000;
constexpr test::MeshFineness kFineness{.deflection = 1e-5, .angle = 0.5};

const BrlCadRecord& record_of(const test::BrlCadModel& model) {
  const auto found =
      std::find_if(kRecords.begin(), kRecords.end(), [&](const BrlCadRecord& r) { return std::string(r.model) == model.name; });
  ISO_CHECK(found != kRecords.end());
  return *found;
}

// Nanoseconds of one ray, and the hits, which must be the same in every round.
Timing time_rays(const Tracer& tracer, const std::vector<Ray>& rays, int rounds, std::vector<Hit>& first) {
  std::vector<double> times;
  std::vector<Hit> hits(rays.size());
  for (int round = -1; round < rounds; ++round) {  // the first one warms up
    SolverStats stats;
    const double seconds = seconds_of([&] { tracer.nearest(rays, hits, Tracer::Order::scattered, stats); });
    if (round < 0) {
      first = hits;
      continue;
    }
    times.push_back(1e9 * seconds / static_cast<double>(rays.size()));
    for (std::size_t i = 0; i < hits.size(); ++i) ISO_CHECK(hits[i].t == first[i].t && hits[i].face == first[i].face);
  }
  return timing_of(times);
}

std::string yes(bool holds) { return holds ? "yes" : "no"; }

Json row_json(const BrlCadRow& row) {
  const auto& c = row.counts;
  return {{"name", kName},
          {"model", row.model.name},
          {"file", row.model.file},
          {"faces", row.faces},
          {"faces_in_file", row.mesh_faces},
          {"import_problems", row.problems},
          {"dropped", row.dropped},
          {"closed_solid", row.closed},
          {"valid", row.valid},
          {"ns_per_ray", row.ns_per_ray.median},
          {"mad_ns", row.ns_per_ray.deviation},
          {"rays_per_second", row.rays_per_second()},
          {"brl_cad_rays_per_second", row.theirs.rays_per_second},
          {"brl_cad_import", row.theirs.import},
          {"brl_cad_wrong_share", row.theirs.wrong},
          {"ratio", row.ratio()},
          {"must", kBrlCadRatio},
          {"holds", row.ratio() >= kBrlCadRatio},
          {"ray_count", c.rays},
          {"hits", c.hits},
          {"candidates", c.candidates},
          {"mesh_loose", c.loose},
          {"mesh_wrong", c.mesh_wrong},
          {"undecided", c.undecided},
          {"lost", c.lost},
          {"extra", c.extra},
          {"sampled", c.sampled},
          {"sample_wrong", c.sample_wrong},
          {"wrong_share", row.wrong()},
          {"wrong_must", row.closed ? Json(kMostWrong) : Json()},
          {"wrong_holds", row.closed ? Json(row.wrong() <= kMostWrong) : Json()},
          {"mesh_deflection", row.mesh_deflection},
          {"mesh_triangles", row.triangles},
          {"mesh_unmeshed_faces", row.unmeshed},
          {"told", c.told}};
}

}  // namespace

Result<BrlCadRow> measure_against_brl_cad(const test::BrlCadModel& model, const std::string& path, const BrlCadOptions& options) {
  auto read = read_model(path);
  if (!read) return read.error();
  BrlCadRow row;
  row.model = model;
  row.theirs = record_of(model);
  for (const Problem& problem : read->problems) {
    row.problems += static_cast<std::size_t>(problem.count);
    row.dropped += problem.kind == Problem::Kind::dropped;
  }
  for (const Instance& instance : read->instances)
    row.faces += static_cast<int>(read->parts[static_cast<std::size_t>(instance.part)].faces.size());
  TraceScene scene;
  add_model(scene, std::make_shared<const Model>(std::move(*read)), Affine3{});
  row.closed = test::is_closed(scene);
  row.valid = test::valid_for_occt(path);
  const Tracer tracer(std::move(scene));
  const std::vector<Ray> rays = test::rays_through(tracer.scene().box(), kSeed, options.rays);
  std::vector<Hit> hits;
  row.ns_per_ray = time_rays(tracer, rays, options.rounds, hits);
  const test::RayJudge judge(test::mesh_with_occt(path, kFineness), tracer);
  row.mesh_faces = judge.mesh().faces;
  row.triangles = judge.mesh().triangles.size();
  row.unmeshed = judge.mesh().unmeshed.size();
  row.mesh_deflection = kFineness.deflection;
  row.counts = judge.count(rays, hits, kSampleStep);
  return row;
}

std::string brl_cad_table(const std::vector<BrlCadRow>& rows, const BrlCadOptions& options, const Origin& origin) {
  std::string text =
      fmt::format("{}: random rays through the models' boxes, one thread, CPU time, median of {} rounds\n{}; commit {}\n{}; version {}\n\n",
                  kName, options.rounds, origin.machine, origin.commit, kApart, kVersion);
  text += fmt::format("{:16} {:>5} {:>8} {:>6} {:>6} {:>8} {:>9} {:>9} {:>7} {:>6}\n", "model", "faces", "problems", "closed", "valid",
                      "ns/ray", "rays/s", "BRL-CAD", "ratio", "holds");
  for (const BrlCadRow& r : rows)
    text += fmt::format("{:16} {:5} {:8} {:>6} {:>6} {:8.1f} {:9.3g} {:9.3g} {:7.1f} {:>6}\n", r.model.name, r.faces, r.problems,
                        yes(r.closed), yes(r.valid), r.ns_per_ray.median, r.rays_per_second(), r.theirs.rays_per_second, r.ratio(),
                        yes(r.ratio() >= kBrlCadRatio));
  text += fmt::format("\n{:16} {:>8} {:>8} {:>10} {:>6} {:>10} {:>9} {:>5} {:>5} {:>7} {:>12} {:>10}\n", "model", "rays", "hits",
                      "candidates", "loose", "mesh wrong", "undecided", "lost", "extra", "sampled", "sample wrong", "triangles");
  for (const BrlCadRow& r : rows) {
    const auto& c = r.counts;
    text += fmt::format("{:16} {:8} {:8} {:10} {:6} {:10} {:9} {:5} {:5} {:7} {:12} {:10}\n", r.model.name, c.rays, c.hits, c.candidates,
                        c.loose, c.mesh_wrong, c.undecided, c.lost, c.extra, c.sampled, c.sample_wrong, r.triangles);
  }
  text += fmt::format(
      "\ncandidates: rays where Open CASCADE's mesh ({:g} of the diagonal) shows something else; each is decided by subdivision of all\n"
      "faces: for the hit (mesh wrong), by the file's tolerance or rounding (undecided), or against it (lost, extra). Loose: the mesh is\n"
      "measured to be off by more than it was asked for, and by enough; sampled: rays decided though the mesh shows the same\n",
      kFineness.deflection);
  for (const BrlCadRow& r : rows)
    for (const std::string& told : r.counts.told) text += fmt::format("{}: {}\n", r.model.name, told);
  for (const std::string& left_out : origin.left_out) text += "left out: " + left_out + "\n";
  return text;
}

nlohmann::ordered_json brl_cad_json(const std::vector<BrlCadRow>& rows, const BrlCadOptions& options, const Origin& origin) {
  Json json{{"machine", origin.machine},   {"commit", origin.commit},     {"threads", 1},
            {"rounds", options.rounds},    {"brl_cad_version", kVersion}, {"brl_cad_figures", kApart},
            {"left_out", origin.left_out}, {"rows", Json::array()}};
  for (const BrlCadRow& row : rows) json["rows"].push_back(row_json(row));
  return json;
}

}  // namespace iso::bench
