#include "tests/bench/tessellators.h"

#include <fmt/format.h>

#include <iostream>

#include "tests/bench/timing.h"
#include "tests/support/paths.h"

namespace iso::bench {
namespace {

constexpr const char* kFiles[] = {"step/screw.step",        "step/linkrods.step",       "iges/bearing.iges",
                                  "iges/hammer.iges",       "occ/hammer.brep",          "occ/Motor-c.brep",
                                  "occ/Top.brep",           "occ/Bottom.brep",          "occ/wing.brep",
                                  "occ/bottle.brep",        "occ/Propeller.rle",        "occ/terrain.brep",
                                  "occ/MAT.brep",           "occ/Axis_of_bearing.brep", "occ/MODERN_Sink_1.brep",
                                  "occ/Pump_TopCover.brep", "occ/CrankArm.brep",        "occ/Ball.brep",
                                  "occ/shell1.brep"};

constexpr double kLongSeconds = 5;  // a first run of more is the only one
constexpr double kScalingTolerance = 1e-4;
constexpr int kScalingFaces = 21;
constexpr int kScalingRuns = 3;

std::string name_of_file(const char* file) { return std::filesystem::path(file).filename(); }

// Those whose first run was short take turns; each keeps the median.
void take_turns(MeshedModel& model, std::span<TessellatorRow> rows, int rounds) {
  std::vector<Mesher> meshers;
  std::vector<TessellatorRow*> timed;
  for (TessellatorRow& row : rows)
    if (row.failure.empty() && row.seconds <= kLongSeconds) meshers.push_back(row.mesher), timed.push_back(&row);
  if (timed.empty()) return;
  const auto seconds = seconds_in_turns(model, timed.front()->tolerance, meshers, rounds);
  for (std::size_t i = 0; i < timed.size(); ++i) {
    if (seconds[i].empty()) continue;
    timed[i]->seconds = median(seconds[i]);
    timed[i]->runs = rounds;
  }
}

void tell(const TessellatorRow& r) {
  if (!r.failure.empty()) {
    fmt::print(stderr, "  {:g} {}: {}\n", r.tolerance, name_of(r.mesher), r.failure);
    return;
  }
  fmt::print(stderr, "  {:g} {}: {} triangles, {:.3g} s, max {:.3f} T", r.tolerance, name_of(r.mesher), r.triangles, r.seconds, r.max);
  if (r.mesher == Mesher::ours && r.beyond_gap > 1)
    fmt::print(stderr, "; BEYOND THE GAP: {:.4f} T, face {} ({}) at uv {:.17g} {:.17g}: {:.4f} T", r.beyond_gap, r.worst_face, r.worst_kind,
               r.worst_uv.x, r.worst_uv.y, r.worst);
  fmt::print(stderr, "\n");
}

TessellatorRow left_out(const MeshedModel& model, double tolerance, Mesher mesher) {
  TessellatorRow row;
  row.model = model.name;
  row.faces = model.theirs.faces();
  row.tolerance = tolerance;
  row.mesher = mesher;
  row.failure = kLeftOut;
  return row;
}

void measure_rows(MeshedModel& model, const TessellatorOptions& options, TessellatorResults& results) {
  for (const double tolerance : options.tolerances) {
    std::vector<TessellatorRow> rows;
    for (const Mesher mesher : kMeshers) {
      const bool wanted = mesher == Mesher::ours || options.rivals == Rivals::measured;
      rows.push_back(wanted ? measured_in_child(model, tolerance, mesher, options.sampled_triangles) : left_out(model, tolerance, mesher));
    }
    take_turns(model, rows, options.rounds);
    for (const TessellatorRow& row : rows)
      if (row.mesher == Mesher::ours || options.rivals == Rivals::measured) tell(row);
    results.rows.insert(results.rows.end(), rows.begin(), rows.end());
  }
}

void measure_scaling(MeshedModel& model, const TessellatorOptions& options, TessellatorResults& results) {
  if (model.theirs.faces() < kScalingFaces) return;
  const double tolerance = *std::min_element(options.tolerances.begin(), options.tolerances.end(), [](double a, double b) {
    return std::abs(std::log(a / kScalingTolerance)) < std::abs(std::log(b / kScalingTolerance));
  });
  const auto wall = thread_times(model, tolerance, kScalingRuns);
  if (wall) results.scaling.push_back({model.name, model.theirs.faces(), tolerance, *wall});
}

}  // namespace

std::vector<std::string> tessellator_models() {
  std::vector<std::string> names;
  for (const char* file : kFiles) names.push_back(name_of_file(file));
  return names;
}

Result<TessellatorResults> measure_tessellators(const TessellatorOptions& options) {
  TessellatorResults results;
  const auto dir = test::occt_data_dir();
  for (const char* file : kFiles) {
    const std::string name = name_of_file(file);
    if (!options.models.empty() && std::find(options.models.begin(), options.models.end(), name) == options.models.end()) continue;
    if (!dir || !std::filesystem::exists(*dir / file)) {
      results.left_out.push_back(fmt::format("{}, because there is no file {}: it is of the package occt-misc", name, file));
      continue;
    }
    fmt::print(stderr, "measuring {} ...\n", name);
    auto model = read_meshed_model(name, *dir / file);
    if (!model) return model.error();
    if (std::abs(std::log(box_of(model->ours).diagonal() / model->theirs.diagonal())) > 0.05)
      fmt::print(stderr, "  the boxes differ: {:g} and {:g}\n", box_of(model->ours).diagonal(), model->theirs.diagonal());
    measure_rows(*model, options, results);
    measure_scaling(*model, options, results);
  }
  return results;
}

}  // namespace iso::bench
