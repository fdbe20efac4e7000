#include "raytracer/cmd/mesh_parts.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace iso {
namespace {

// The measurement finds nearest points to rounding: this times the size of the part.
constexpr double kMeasureRounding = 1e-11;

class Clock {
 public:
  double lap() {
    const auto begin = begin_;
    begin_ = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(begin_ - begin).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

DistanceFigures figures_of(const DistanceCounts& counts, double stretch) {
  return {stretch * counts.max(), stretch * counts.mean(), stretch * counts.rms(), stretch * counts.percentile(0.999), counts.count()};
}

FaceFigures figures_of(const FaceReport& report, const FaceDeviation& deviation, double stretch, const Affine3& place) {
  FaceFigures face;
  face.report = report;
  face.report.bound *= stretch;
  face.report.offset *= stretch;
  face.report.fold = place.point(report.fold);
  face.to_surface = figures_of(deviation.to_surface, stretch);
  face.to_mesh = figures_of(deviation.to_mesh, stretch);
  face.measured = stretch * deviation.worst;
  face.worst_uv = deviation.worst_uv;
  face.worst_place = place.point(deviation.worst_place);
  face.worst_angle = deviation.worst_angle;
  face.mean_angle = deviation.mean_angle;
  return face;
}

void add_to(FaceReport& all, const FaceReport& face) {
  all.bound = std::max(all.bound, face.bound);
  all.offset = std::max(all.offset, face.offset);
  all.triangles += face.triangles;
  all.unresolved += face.unresolved;
  all.collapsed += face.collapsed;
  if (all.at_folds == 0) all.fold = face.fold;
  all.folded += face.folded;
  all.at_folds += face.at_folds;
  all.crossings += face.crossings;
}

void move_places(MeshReport& check, const Affine3& place) {
  TopologyReport& t = check.topology;
  for (Finding* finding :
       {&t.open_edges, &t.non_manifold_edges, &t.misoriented_edges, &t.non_manifold_points, &t.zero_area, &t.duplicates, &t.isolated_points,
        &t.t_junctions, &check.free_edges, &check.cracks, &check.folded, &check.turned, &check.overlapping})
    for (MeshPlace& at : finding->places) at.at = place.point(at.at);
}

JoinReport placed(JoinReport joins, double stretch, const Affine3& place) {
  joins.tolerance *= stretch;
  joins.widest *= stretch;
  joins.looked *= stretch;
  for (OpenBorder& border : joins.open) {
    border.length *= stretch;
    border.width *= stretch;
    border.from = place.point(border.from);
    border.to = place.point(border.to);
  }
  return joins;
}

// The figures of a part's faces, and of all of them.
void take_figures(PartFigures& out, const PartTessellation& made, const Deviation& deviation, double distance, const Affine3& place) {
  const double rounding = kMeasureRounding * out.part->box.diagonal();
  FaceReport all;
  bool within = true, contradicts = false;
  for (std::size_t f = 0; f < made.faces.size(); ++f) {
    FaceFigures face = figures_of(made.faces[f], deviation.faces[f], out.stretch, place);
    face.within = !(distance > 0) || made.faces[f].bound <= distance;
    face.contradicts = deviation.faces[f].worst > made.faces[f].bound + made.faces[f].offset + rounding;
    within = within && face.within;
    contradicts = contradicts || face.contradicts;
    add_to(all, face.report);
    out.faces.push_back(std::move(face));
  }
  out.all = figures_of({}, deviation.all, out.stretch, place);
  out.all.report = all;
  out.all.within = within;
  out.all.contradicts = contradicts;
  out.worst_face = deviation.worst_face;
}

// By patterns or not. `cut` is empty where the mesh itself can be measured.
PatchMesh made_of(const Part& part, const MeshSettings& settings, double stretch) {
  const double distance = settings.distance / stretch;
  if (settings.pattern)
    return mesh_patches(part, {.strategy = settings.pattern->strategy, .level = settings.pattern->level, .distance = distance});
  PatchMesh out;
  out.made = tessellate(part, {distance, settings.trim / stretch, settings.angle, settings.sew / stretch});
  if (patches_of(part)) out.places = places_of(part, out.made.mesh);
  return out;
}

void take_patterns(PartFigures& out, const PatchMesh& made) {
  if (!made.places.empty()) {
    CurvatureError error = curvature_error(*out.part, discrete_mean_curvature(made.made.mesh), made.places);
    for (double* value : {&error.max, &error.rms, &error.largest}) *value /= out.stretch;
    out.curvature = error;
  }
  out.quads = made.quads;
  for (const PatternLevels& levels : made.levels) {
    std::vector<int> all = levels.of_side;
    all.push_back(levels.inner);
    for (const int level : all) {
      out.least_level = out.least_level == 0 ? level : std::min(out.least_level, level);
      out.most_level = std::max(out.most_level, level);
    }
  }
}

}  // namespace

Status check_patches(std::span<const Part* const> parts, const std::string& file, const std::string& option) {
  for (const Part* part : parts) {
    const auto patches = patches_of(*part);
    if (patches) continue;
    const Error& why = patches.error();
    return Error{Exit::bad_command_line, file, {}, option + ": " + why.place + " " + why.message};
  }
  return Done{};
}

MeshFigures mesh_parts(const std::vector<PartToMesh>& parts, const MeshSettings& settings, ModelMesh& meshes,
                       const std::function<void(int, int)>& progress) {
  // Three steps for each face: made, measured, verified.
  int steps = 0, done = 0;
  for (const PartToMesh& p : parts) steps += 3 * static_cast<int>(p.part->faces.size());
  MeshFigures figures;
  figures.settings = settings;
  for (const PartToMesh& p : parts) {
    PartFigures out;
    out.part = p.part;
    out.placements = static_cast<int>(p.placements.size());
    if (!p.placements.empty()) out.stretch = 0;
    for (const Affine3& placement : p.placements) out.stretch = std::max(out.stretch, stretch_of(placement));
    const Affine3 place = p.placements.empty() ? Affine3{} : p.placements.front();
    const auto step = [&] { progress(done += static_cast<int>(p.part->faces.size()), steps); };

    Clock clock;
    PatchMesh whole = made_of(*p.part, settings, out.stretch);
    PartTessellation& made = whole.made;
    const bool by_patterns = settings.pattern.has_value();
    figures.mesh_seconds += clock.lap();
    step();
    const Deviation deviation = measure(*p.part, by_patterns ? whole.cut : made.mesh, settings.sampling);
    figures.measure_seconds += clock.lap();
    step();
    out.check = by_patterns ? verify(*p.part, whole) : verify(*p.part, made.mesh, notes_of(made));
    figures.verify_seconds += clock.lap();
    step();

    move_places(out.check, place);
    out.rounds = made.rounds;
    out.unresolved_edges = made.unresolved_edges;
    out.joins = placed(made.joins, out.stretch, place);
    for (const FaceReport& face : made.faces) out.turned += face.turned;
    take_figures(out, made, deviation, settings.distance / out.stretch, place);
    take_patterns(out, whole);
    meshes.parts.push_back(std::move(made.mesh));
    figures.parts.push_back(std::move(out));
  }
  return figures;
}

}  // namespace iso
