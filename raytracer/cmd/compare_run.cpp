#include "raytracer/cmd/compare_run.h"

#include <fmt/format.h>

#include <filesystem>

#include "patches/base/units.h"
#include "patches/io/read_mesh.h"
#include "raytracer/cmd/command.h"
#include "raytracer/cmd/compare_cost.h"
#include "raytracer/cmd/compare_pictures.h"
#include "raytracer/cmd/compare_slope.h"
#include "raytracer/cmd/mesh_report.h"
#include "raytracer/cmd/scene_view.h"

namespace iso {
namespace {

constexpr int kSteps = 1000;  // of the progress of one mesh

// Thrown by what hears of the progress, through the work that tells of it.
struct Interrupted {};
Error interrupted_error() { return {Exit::interrupted, {}, {}, "interrupted; the report is not written"}; }

// The mesh of the placed parts, in world coordinates.
ForeignMesh mesh_of(const TraceScene& scene) {
  ForeignMesh all;
  for (const Placed& placed : scene.placed) {
    const auto first = static_cast<std::uint32_t>(all.points.size());
    for (const Point3& p : placed.mesh->points) all.points.push_back(placed.to_world.point(p));
    const bool mirrored = glm::determinant(placed.to_world.linear) < 0;
    for (const Triangle& t : placed.mesh->triangles) {
      PointTriangle corners;
      for (std::size_t k = 0; k < 3; ++k) corners[k] = first + placed.mesh->nodes[t[mirrored ? 2 - k : k]].point;
      all.triangles.push_back(corners);
    }
  }
  return all;
}

// The discrete mean curvature at the points of `mesh_of`.
std::vector<double> curvature_of(const TraceScene& scene) {
  std::vector<double> all;
  for (const Placed& placed : scene.placed)
    for (const double H : discrete_mean_curvature(*placed.mesh)) all.push_back(H / stretch_of(placed.to_world));
  return all;
}

// Of all parts together; what is far larger than the rest shows.
std::optional<CurvatureError> curvature_error_of(const MeshFigures& figures) {
  CurvatureError all;
  for (const PartFigures& part : figures.parts) {
    if (!part.curvature) return {};
    const CurvatureError& one = *part.curvature;
    const auto points = static_cast<double>(all.points + one.points);
    if (points > 0)
      all.rms =
          std::sqrt((static_cast<double>(all.points) * all.rms * all.rms + static_cast<double>(one.points) * one.rms * one.rms) / points);
    all.points += one.points;
    all.max = std::max(all.max, one.max);
    all.largest = std::max(all.largest, one.largest);
  }
  return all;
}

// Our own mesh stands where the model is. What a coarse one looks like from its box alone is no fault of it.
void forget_misplaced(ReportMesh& mesh) {
  if (std::erase_if(mesh.comparison.faults, [](const FaultFound& f) { return f.fault <= MeshFault::placement; }) > 0)
    mesh.notes.push_back("so coarse that its box is not the model's, as its tolerance allows: faults were not looked for");
}

std::string view_text(const CameraEntry& camera) {
  const bool ortho = camera.projection == Projection::orthographic;
  const std::string from = camera.look_from ? "placed by the scene" : kViewNames[static_cast<std::size_t>(camera.view.value_or(View::iso))];
  return ortho ? from + ", orthographic" : fmt::format("{}, perspective {:g} degrees", from, camera.fov.value_or(kDefaultFov));
}

}  // namespace

struct CompareRun::Scene {
  SceneEntry entry;
  LoadedModels loaded;
  std::vector<PlacedPart> parts;
  std::unique_ptr<Tracer> exact;
  PictureSettings pictures;
  std::optional<DirectPicture> direct;
  std::optional<ReportLegend> curvature;  // the scale of the exact surface's
};

CompareRun::CompareRun(const CompareOptions& options, int threads)
    : options_(options), threads_(threads), progress_(options.quiet ? "none" : options.progress, "steps") {}
CompareRun::~CompareRun() = default;

void CompareRun::go_on(int done, int all) {
  if (interrupt_.flag()) throw Interrupted{};
  progress_.update(done, all);
}

Result<double> CompareRun::length(const std::string& text, const char* option) const {
  return in_units(*tolerance_named(text, option), report_.diagonal, report_.unit, option);
}

Status CompareRun::load() {
  scene_ = std::make_unique<Scene>();
  auto entry = scene_for(render_options_of(options_));
  if (!entry) return entry.error();
  scene_->entry = std::move(*entry);
  auto loaded = load_models(scene_->entry.models, scene_->entry.hash_text);
  if (!loaded) return loaded.error();
  scene_->loaded = std::move(*loaded);
  if (!options_.quiet)
    for (const std::string& note : scene_->loaded.notes) fmt::print(stderr, "isophote: {}\n", note);
  TraceScene& scene = scene_->loaded.scene;
  if (scene.placed.empty() || scene.box().empty()) return bad_input(options_.input, {}, "has no faces to compare with");
  if (!options_.meshes.empty()) paint_evenly(scene);
  for (const Placed& placed : scene.placed) scene_->parts.push_back({placed.part.get(), placed.to_world});

  report_.version = kVersion;
  report_.machine = machine_text(threads_);
  report_.model = options_.input;
  report_.unit = scene_->loaded.unit;
  report_.diagonal = scene.box().diagonal();
  report_.size = scene_->entry.size;
  report_.samples = scene_->entry.samples;
  report_.seed = scene_->entry.seed;
  report_.view = view_text(scene_->entry.camera);
  for (std::size_t p = 0; p < scene.placed.size(); ++p) {
    const Part& part = *scene.placed[p].part;
    report_.faces += part.faces.size();
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      std::string name = scene.placed.size() == 1 ? std::to_string(f) : fmt::format("{}.{}", p, f);
      if (!part.faces[f].name.empty()) name += " " + part.faces[f].name;
      report_.face_names.push_back(std::move(name));
    }
  }
  return Done{};
}

// Lengths that have no meaning for this model and meshes that cannot be read are told before any long work.
Status CompareRun::check_request() {
  const auto tolerances = tolerances_of(options_);
  if (!tolerances) return tolerances.error();
  tolerances_ = *tolerances;
  for (const Tolerance& tolerance : tolerances_)
    if (const auto found = in_units(tolerance, report_.diagonal, report_.unit, "--tolerances"); !found) return found.error();
  if (options_.reference) {
    const auto reference = length(*options_.reference, "--reference");
    if (!reference) return reference.error();
    reference_ = *reference;
  }
  if (options_.strategies) {
    std::vector<const Part*> parts;
    for (const PlacedPart& placed : scene_->parts) parts.push_back(placed.part);
    if (const auto fits = check_patches(parts, options_.input, "--strategies"); !fits) return fits.error();
  }
  if (options_.mesh_unit && !metres_of(report_.unit))
    return Error{Exit::bad_command_line, options_.input, {}, "--mesh-unit: the model's own unit is not known"};
  for (const std::string& path : options_.meshes) {
    auto mesh = read_mesh(path);
    if (!mesh) return mesh.error();
    meshes_.push_back(std::move(*mesh));
  }
  return fail_limits();
}

Status CompareRun::fail_limits() {
  if (options_.fail_above) {
    const auto distance = length(*options_.fail_above, "--fail-above");
    if (!distance) return distance.error();
    limits_.distance = *distance;
  }
  if (options_.fail_normal) limits_.angle = *options_.fail_normal * kPi / 180;
  limits_.open = options_.fail_open;
  limits_.faults = options_.fail_faults;
  return Done{};
}

// The exact surface's camera, and its picture.
Status CompareRun::start_pictures() {
  scene_->exact = std::make_unique<Tracer>(scene_->loaded.scene);
  const Tracer& exact = *scene_->exact;
  PictureSettings& settings = scene_->pictures;
  settings.camera = camera_for(scene_->entry.camera, exact, scene_->entry.size);
  settings.size = scene_->entry.size;
  settings.samples = scene_->entry.samples;
  settings.seed = scene_->entry.seed;
  settings.background = scene_->entry.background.value_or(Background{});
  settings.version = kVersion;
  settings.unit = report_.unit;
  settings.threads = threads_;
  settings.look = [lights = scene_->entry.lights](const Tracer& tracer, const Camera& camera, const Sampler& sampler) {
    return clay(tracer, lights_for(lights, camera), sampler);
  };
  const Camera& camera = settings.camera;
  const double height = 2 * camera.half_height / settings.size.height;
  report_.pixel = camera.projection == Projection::orthographic
                      ? height
                      : height * std::abs(glm::dot(exact.scene().box().middle() - camera.position, camera.back));
  if (options_.no_pictures) return Done{};
  report_.direct = cost_of(exact, camera, settings.size);
  auto direct = picture_direct(exact, settings, {interrupt_.flag(), {}});
  if (!direct) return direct.error();
  if (const auto kept = (*keep_)({direct->file.picture.file, direct->file.exr}); !kept) return kept;
  report_.pictures.push_back(direct->file.picture);
  direct->file.exr.clear();
  if (options_.strategies) {
    auto curvature = picture_curvature(exact, settings, {interrupt_.flag(), {}});
    if (!curvature) return curvature.error();
    if (const auto kept = (*keep_)({curvature->picture.file, curvature->exr}); !kept) return kept;
    report_.pictures.push_back(std::move(curvature->picture));
    scene_->curvature = report_.pictures.back().legend;
  }
  scene_->direct = std::move(*direct);
  return Done{};
}

Status CompareRun::add_pictures(ReportMesh& mesh, const ForeignMesh& triangles, const TraceScene& scene) {
  const Tracer tracer(scene);
  const double tessellated = mesh.cost.tessellate_seconds;
  mesh.cost = cost_of(tracer, scene_->pictures.camera, report_.size);
  mesh.cost.tessellate_seconds = tessellated;
  const TriangleTree tree(triangles.points, triangles.triangles);
  MeshToShow shown;
  shown.tracer = &tracer;
  shown.name = fmt::format("mesh-{}", report_.meshes.size() + 1);
  shown.smooth = mesh.ours;
  shown.deviation = [&](const Point3& p, const Vec3&, std::int32_t, std::int32_t) { return tree.nearest(p).distance; };
  shown.normal_error = [&](const Point3& p, const Vec3& n, std::int32_t, std::int32_t) {
    const PointTriangle& t = triangles.triangles[tree.nearest(p).triangle];
    const Vec3 m = glm::cross(triangles.points[t[1]] - triangles.points[t[0]], triangles.points[t[2]] - triangles.points[t[0]]);
    return m == Vec3(0.0) || n == Vec3(0.0) ? std::nan("") : std::atan2(glm::length(glm::cross(n, m)), glm::dot(n, m));
  };
  std::vector<double> curvature;
  if (scene_->curvature && mesh.curvature) {
    curvature = curvature_of(scene);
    shown.curvature_scale = scene_->curvature;
    shown.curvature = [&](const Point3& p, const Vec3&, std::int32_t, std::int32_t) {
      const TriangleTree::Nearest at = tree.nearest(p);
      const PointTriangle& t = triangles.triangles[at.triangle];
      return at.weights.x * curvature[t[0]] + at.weights.y * curvature[t[1]] + at.weights.z * curvature[t[2]];
    };
  }
  auto pictures = pictures_of(shown, *scene_->exact, *scene_->direct, scene_->pictures, {interrupt_.flag(), {}});
  if (!pictures) return pictures.error();
  mesh.images = pictures->images;
  for (PictureFile& file : pictures->files) {
    if (const auto kept = (*keep_)({file.picture.file, file.exr}); !kept) return kept;
    mesh.pictures.push_back(std::move(file.picture));
  }
  return Done{};
}

Status CompareRun::compare(ReportMesh& mesh, const ForeignMesh& triangles, const TraceScene& scene, bool pictures) {
  ComparisonSettings settings;
  settings.unit = report_.unit;
  settings.reference = reference_;
  mesh.points = triangles.points.size();
  mesh.triangles = triangles.triangles.size();
  mesh.comparison =
      compare_mesh(scene_->parts, triangles, settings, [this](double share) { go_on(static_cast<int>(share * kSteps), kSteps); });
  progress_.finish();
  if (mesh.ours) forget_misplaced(mesh);
  if (pictures && !options_.no_pictures)
    if (const auto added = add_pictures(mesh, triangles, scene); !added) return added;
  mesh.verdict = verdict_of(mesh, report_);
  for (std::string& failure : failures_of(mesh, report_, limits_)) report_.failures.push_back(std::move(failure));
  if (!options_.quiet) {
    fmt::print(stderr, "{}\n", mesh.verdict);
    for (const FaultFound& fault : mesh.comparison.faults) fmt::print(stderr, "  {}: {}\n", name_of(fault.fault), fault.text);
  }
  report_.meshes.push_back(std::move(mesh));
  return Done{};
}

Status CompareRun::compare_ours(const Tolerance& tolerance, bool pictures, const std::optional<PatternSettings>& pattern) {
  LoadedModels meshed = scene_->loaded;
  MeshRequest request;
  request.tolerance = tolerance;
  request.tolerance_name = "--tolerances";
  const auto figures = tessellate_scene(
      meshed, request, [this](int done, int all) { go_on(done, all); }, pattern);
  progress_.finish();
  if (!figures) return figures.error();
  ReportMesh mesh;
  mesh.label = text_of(tolerance, report_.unit);
  mesh.ours = true;
  if (options_.strategies) {
    mesh.strategy = strategy_name(pattern);
    if (pattern && pattern->level > 0) mesh.level = pattern->level;
    mesh.label = mesh.strategy + (mesh.level ? fmt::format(", level {}", *mesh.level) : ", " + mesh.label);
    mesh.curvature = curvature_error_of(*figures);
  }
  mesh.tolerance = figures->settings.distance;
  const MeshTotals totals = totals_of(*figures);
  mesh.guaranteed = totals.bound + totals.offset;
  mesh.broken = broken_promises(*figures);
  mesh.cost.tessellate_seconds = figures->mesh_seconds;
  mesh.width = mean_width(meshed.scene);
  const ForeignMesh triangles = mesh_of(meshed.scene);
  if (triangles.triangles.empty())
    return Error{Exit::promise_not_kept, options_.input, {}, fmt::format("{}: no face could be meshed", mesh.label)};
  return compare(mesh, triangles, meshed.scene, pictures);
}

// With a level the adaptive tessellator comes last, and keeps what the best of the patterns has proven.
Status CompareRun::compare_strategies() {
  for (const Tolerance& tolerance : tolerances_) {
    if (const auto done = compare_ours(tolerance, true); !done) return done;
    for (const Strategy strategy : kStrategies)
      if (const auto done = compare_ours(tolerance, true, PatternSettings{strategy, 0}); !done) return done;
  }
  if (!options_.level) return Done{};
  double best = kInf;
  for (const Strategy strategy : kStrategies) {
    if (const auto done = compare_ours({1, ToleranceUnit::diagonal}, true, PatternSettings{strategy, *options_.level}); !done) return done;
    best = std::min(best, report_.meshes.back().guaranteed.value_or(kInf));
  }
  return best > 0 && best < report_.diagonal ? compare_ours({best, ToleranceUnit::model}, true) : Status(Done{});
}

Status CompareRun::compare_theirs(ForeignMesh triangles) {
  ReportMesh mesh;
  mesh.file = triangles.file;
  mesh.label = std::filesystem::path(triangles.file).filename().string();
  mesh.notes = triangles.notes;
  // What is known of both units is undone; what is not shows as a fault.
  const std::string unit = options_.mesh_unit.value_or(triangles.unit);
  const auto from = metres_of(unit), to = metres_of(report_.unit);
  if (from && to && *from != *to) {
    for (Point3& p : triangles.points) p *= *from / *to;
    triangles.rounding *= *from / *to;
    mesh.notes.push_back(fmt::format("coordinates taken as {} and turned into {}", unit, report_.unit));
  }
  TraceScene scene;
  scene.placed.push_back(placed_foreign(triangles));
  scene.mesh_shading = MeshShading::flat;
  paint_evenly(scene);
  return compare(mesh, triangles, scene, true);
}

// From coarse to fine, until one keeps what was asked for.
Status CompareRun::advise() {
  constexpr double kLadder[] = {1e-1, 5e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6};
  const double pixels = options_.pixels.value_or(0.5);
  for (const double share : kLadder) {
    const std::size_t failures = report_.failures.size();
    if (const auto done = compare_ours({share, ToleranceUnit::diagonal}, options_.flip.has_value()); !done) return done;
    const ReportMesh& mesh = report_.meshes.back();
    const double off = mesh.comparison.all.worst() / report_.pixel;
    if (options_.flip ? mesh.images.flip_ldr > *options_.flip : !(off <= pixels)) {
      report_.failures.resize(failures);  // of a mesh that is not advised
      continue;
    }
    const std::string length = length_text(mesh.tolerance, report_.unit);
    report_.advice =
        options_.flip
            ? fmt::format("a tolerance of {} ({} d) is the coarsest tried whose mean FLIP is at most {:g}: {:.2g}, with {} triangles",
                          length, share, *options_.flip, mesh.images.flip_ldr, mesh.triangles)
            : fmt::format("a tolerance of {} ({} d) is the coarsest tried that stays within {:g} pixels: {:.2g} pixels, with {} triangles",
                          length, share, pixels, off, mesh.triangles);
    return Done{};
  }
  report_.failures.push_back("no tolerance down to 1e-6 d keeps what --advise asks for");
  return Done{};
}

Status CompareRun::compare_all() {
  if (const auto loaded = load(); !loaded) return loaded;
  if (const auto checked = check_request(); !checked) return checked;
  if (interrupt_.flag()) return interrupted_error();
  if (const auto started = start_pictures(); !started) return started;
  if (options_.strategies) {
    if (const auto done = compare_strategies(); !done) return done;
  } else {
    for (const Tolerance& tolerance : tolerances_)
      if (const auto done = compare_ours(tolerance, true); !done) return done;
  }
  for (ForeignMesh& mesh : meshes_)
    if (const auto done = compare_theirs(std::move(mesh)); !done) return done;
  return options_.advise ? advise() : Status(Done{});
}

Result<CompareReport> CompareRun::run(const std::function<Status(const ReportFile&)>& keep) {
  keep_ = &keep;
  try {
    if (const auto done = compare_all(); !done) {
      progress_.finish();
      return done.error().kind == Exit::interrupted ? interrupted_error() : done.error();
    }
  } catch (const Interrupted&) {
    progress_.finish();
    return interrupted_error();
  }
  report_.slope = slope_of(report_);
  report_.verdict = verdict_of_all(report_);
  return std::move(report_);
}

}  // namespace iso
