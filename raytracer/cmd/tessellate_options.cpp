#include "raytracer/cmd/tessellate_options.h"

#include <fmt/format.h>

#include <filesystem>
#include <numbers>

#include "patches/files/output_file.h"
#include "patches/io/write_mesh.h"
#include "raytracer/tolerance.h"

namespace iso {
namespace {

constexpr double kLeastAngle = 0.1;  // degrees: below, triangles would be beyond count

Error bad_option(std::string file, const std::string& message) { return {Exit::bad_command_line, std::move(file), {}, message}; }

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(a, ignored) == std::filesystem::weakly_canonical(b, ignored);
}

const std::string& tolerance_of(const TessellateOptions& options) {
  static const std::string usual = "1e-3d";
  return options.tolerance.empty() ? usual : options.tolerance;
}

// A pattern has a level or a tolerance, and nothing that only the adaptive tessellator keeps.
Status check_strategy(const TessellateOptions& options) {
  const bool adaptive = options.strategy == "adaptive";
  if (options.level && adaptive) return bad_option({}, "--level needs --strategy with a pattern: the adaptive one has no levels");
  if (options.level && !options.tolerance.empty()) return bad_option({}, "--level and --tolerance: expected one of them");
  if (options.level && (*options.level < 1 || *options.level > kMostLevel))
    return bad_option({}, fmt::format("--level: found {}, expected 1 to {}", *options.level, kMostLevel));
  if (adaptive) return Done{};
  for (const auto& [given, name] : {std::pair{!options.trim_tolerance.empty(), "--trim-tolerance"},
                                    {options.angle.has_value(), "--angle"},
                                    {options.sew != "auto", "--sew"}})
    if (given)
      return bad_option({}, fmt::format("{} has no meaning with --strategy {}: expected it with adaptive only", name, options.strategy));
  return Done{};
}

// The pattern of this name, if it is one.
std::optional<Strategy> pattern_named(const std::string& name) {
  for (const Strategy strategy : kStrategies)
    if (name == name_of(strategy)) return strategy;
  return {};
}

}  // namespace

std::shared_ptr<TessellateOptions> declare_tessellate_options(CLI::App& command) {
  auto options = std::make_shared<TessellateOptions>();
  command.add_option("MODEL", options->model, "STEP, IGES, BREP, OBJ, BPT, IPATCH, GBP, LOP or MP file")->required();
  declare_patches_option(command, options->patches);
  command.add_option("-o,--output", options->output, "mesh to write: .stl, .obj, .ply or .glb");
  command.add_option("--tolerance", options->tolerance,
                     "allowed distance, either way: 1e-4d (diagonals), 0.05mm, or in units of the model [1e-3d]");
  std::vector<std::string> strategies{"adaptive"};
  for (const Strategy strategy : kStrategies) strategies.push_back(name_of(strategy));
  command
      .add_option("--strategy", options->strategy,
                  "how patches with any number of sides are divided: adaptive fan-triangles fan-quads symmetric-triangles symmetric-quads "
                  "[adaptive]")
      ->check(CLI::IsMember(strategies));
  command.add_option("--level", options->level, "segments a side, in place of a tolerance; needs a --strategy that is not adaptive");
  command.add_option("--trim-tolerance", options->trim_tolerance, "the same for edges and their polylines [as --tolerance]");
  command.add_option("--angle", options->angle, "allowed between the normals at two corners of a triangle, degrees [any]");
  command.add_option("--sew", options->sew,
                     "join edges of faces that share none: auto (within the file's tolerances), off, or a length like --tolerance [auto]");
  command.add_option("--report", options->report, "JSON file to write: the figures of every face, what was verified");
  command.add_option("--measure", options->measure, "quick (4 points a triangle) or fine (20) [quick]")
      ->check(CLI::IsMember({"quick", "fine"}));
  command.add_option("-t,--threads", options->threads, "threads to use; 0: all [0]")->check(CLI::Range(0, 1024));
  command.add_option("--progress", options->progress, "auto (bar or lines), json, none [auto]")
      ->check(CLI::IsMember({"auto", "json", "none"}));
  command.add_flag("-q,--quiet", options->quiet, "say nothing but errors");
  return options;
}

Status check_request(const TessellateOptions& options) {
  if (options.output.empty() && options.report.empty())
    return bad_option({}, "nothing to write: expected -o with a mesh (.stl, .obj, .ply, .glb), or --report with a JSON file, or both");
  if (const auto strategy = check_strategy(options); !strategy) return strategy.error();
  if (const auto tolerance = tolerance_named(tolerance_of(options)); !tolerance) return tolerance.error();
  if (!options.trim_tolerance.empty())
    if (const auto trim = tolerance_named(options.trim_tolerance, "--trim-tolerance"); !trim) return trim.error();
  if (options.sew != "auto" && options.sew != "off")
    if (const auto sew = tolerance_named(options.sew, "--sew"); !sew) return sew.error();
  if (options.angle && !(*options.angle >= kLeastAngle && *options.angle <= 180))
    return bad_option({}, fmt::format("--angle: found {}, expected degrees from {} to 180", *options.angle, kLeastAngle));
  for (const std::string& path : {options.output, options.report}) {
    if (path.empty()) continue;
    if (same_file(path, options.model)) return bad_option(path, "is the model itself; expected another name to write to");
    if (const auto writable = check_writable(path); !writable) return writable.error();
  }
  if (options.output.empty()) return Done{};
  if (!options.report.empty() && same_file(options.output, options.report))
    return bad_option(options.report, "-o and --report name the same file");
  const auto format = mesh_format_of(options.output);
  return format ? Status(Done{}) : Status(format.error());
}

Result<MeshSettings> settings_for(const TessellateOptions& options, const Model& model) {
  MeshSettings settings;
  const double diagonal = box_of(model).diagonal();
  if (!options.level) {
    const auto distance = in_units(*tolerance_named(tolerance_of(options)), diagonal, model.unit);
    if (!distance) return distance.error();
    settings.distance = *distance;
  }
  if (const auto strategy = pattern_named(options.strategy)) {
    std::vector<const Part*> parts;
    for (const Part& part : model.parts) parts.push_back(&part);
    if (const auto fits = check_patches(parts, options.model, "--strategy " + options.strategy); !fits) return fits.error();
    settings.pattern = PatternSettings{*strategy, options.level.value_or(0)};
  }
  if (!options.trim_tolerance.empty()) {
    const auto trim = in_units(*tolerance_named(options.trim_tolerance), diagonal, model.unit, "--trim-tolerance");
    if (!trim) return trim.error();
    settings.trim = *trim;
  }
  if (options.sew == "off") settings.sew = -1;
  if (options.sew != "auto" && options.sew != "off") {
    const auto sew = in_units(*tolerance_named(options.sew, "--sew"), diagonal, model.unit, "--sew");
    if (!sew) return sew.error();
    settings.sew = *sew;
  }
  if (options.angle) settings.angle = *options.angle * std::numbers::pi / 180;
  if (options.measure == "fine") settings.sampling = Sampling::fine;
  return settings;
}

}  // namespace iso
