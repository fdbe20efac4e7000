#include "raytracer/cmd/compare_options.h"

#include <fmt/format.h>

#include <cmath>

#include "raytracer/camera.h"
#include "raytracer/sampling.h"
#include "raytracer/shading.h"
#include "raytracer/tolerance.h"
#include "tess/multisided.h"

namespace iso {
namespace {

Error bad_option(const std::string& message) { return {Exit::bad_command_line, {}, {}, message}; }

void declare_pictures(CLI::App& command, CompareOptions& options) {
  command.add_option("--view", options.view, "frame the models from: iso front back left right top bottom (z is up)")
      ->check(CLI::IsMember(std::set<std::string>(kViewNames.begin(), kViewNames.end())));
  command.add_option("--size", options.size, "WIDTHxHEIGHT in pixels [640x480]");
  command.add_option("--samples", options.samples, "rays per pixel [16]")->check(CLI::Range(1, kMaxSamples));
  command.add_option("--seed", options.seed, "another seed gives other noise [0]");
  command.add_flag("--ortho", options.orthographic, "orthographic camera");
  command.add_option("--fov", options.fov, "vertical field of view in degrees [28]")->check(CLI::Range(kMinFov, kMaxFov));
  command.add_flag("--no-pictures", options.no_pictures, "measure only: no pictures, no rates");
}

}  // namespace

std::shared_ptr<CompareOptions> declare_compare_options(CLI::App& command) {
  auto options = std::make_shared<CompareOptions>();
  command.add_option("INPUT", options->input,
                     "model (STEP, IGES, BREP, OBJ, BPT, IPATCH, GBP, LOP, MP) or scene (.json): the exact surfaces");
  declare_patches_option(command, options->patches);
  command.add_option("-o,--output", options->output, "folder for index.html, report.json, table.csv and the pictures; left out: only told");
  command.add_option("--tolerances", options->tolerances,
                     "our meshes: distances with commas, like 1e-3d,0.05mm [1e-2d,1e-3d,1e-4d without --mesh]");
  command.add_flag("--strategies", options->strategies,
                   "patches with any number of sides: the adaptive tessellator and all four patterns for each of --tolerances [1e-3d]");
  command.add_option("--level", options->level, "--strategies: the patterns with so many segments a side, in place of tolerances")
      ->check(CLI::Range(1, kMostLevel));
  command.add_option("--mesh", options->meshes, "somebody's mesh: .stl, .obj, .ply, .glb or .gltf; again for more")
      ->allow_extra_args(false);
  command.add_option("--mesh-unit", options->mesh_unit, "unit of the meshes' coordinates [the model's, glTF metres]")
      ->check(CLI::IsMember({"m", "cm", "mm", "um", "in", "ft"}));
  command.add_option("--reference", options->reference, "how fine the surfaces are held for the search, like --tolerances [as needed]");
  command.add_flag("--advise", options->advise, "find the coarsest tolerance for --pixels or --flip");
  command.add_option("--pixels", options->pixels, "--advise: largest distance, in pixels of the picture [0.5]")->check(CLI::PositiveNumber);
  command.add_option("--flip", options->flip, "--advise: largest mean FLIP of the picture")->check(CLI::PositiveNumber);
  command.add_option("--fail-above", options->fail_above, "exit code 1 if a distance is larger, like --tolerances");
  command.add_option("--fail-normal", options->fail_normal, "exit code 1 if normals are farther apart, degrees")
      ->check(CLI::PositiveNumber);
  command.add_flag("--fail-open", options->fail_open, "exit code 1 if the mesh is open where the model is closed, or not manifold");
  command.add_flag("--fail-faults", options->fail_faults, "exit code 1 if anything is found wrong with a mesh");
  command.add_option("--accept", options->accept, "make the golden picture of a gallery scene anew; needs --why");
  command.add_option("--why", options->why, "the reason, for --accept");
  declare_pictures(command, *options);
  command.add_option("-t,--threads", options->threads, "threads to use; 0: all [0]")->check(CLI::Range(0, 1024));
  command.add_option("--progress", options->progress, "auto (bar or lines), json, none [auto]")
      ->check(CLI::IsMember({"auto", "json", "none"}));
  command.add_flag("-q,--quiet", options->quiet, "say nothing but errors and what fails");
  return options;
}

Status check_request(const CompareOptions& options) {
  if (options.accept) {
    if (!options.input.empty()) return bad_option("--accept names the scene itself: expected no INPUT beside it");
    return options.why ? Status(Done{}) : Status(bad_option("--accept needs --why with the reason"));
  }
  if (options.why) return bad_option("--why needs --accept");
  if (options.input.empty()) return bad_option("nothing to compare: expected a model or a scene");
  if ((options.pixels || options.flip) && !options.advise) return bad_option("--pixels and --flip need --advise");
  if (options.pixels && options.flip) return bad_option("--pixels and --flip: expected one of them");
  if (options.flip && options.no_pictures) return bad_option("--flip needs the pictures that --no-pictures leaves out");
  if (options.level && !options.strategies) return bad_option("--level needs --strategies");
  if (options.level && !options.tolerances.empty()) return bad_option("--level and --tolerances: expected one of them");
  if (options.strategies && options.advise) return bad_option("--strategies and --advise: expected one of them");
  if (options.mesh_unit && options.meshes.empty()) return bad_option("--mesh-unit needs --mesh");
  for (const auto& [value, name] :
       {std::pair{options.pixels, "--pixels"}, {options.flip, "--flip"}, {options.fail_normal, "--fail-normal"}})
    if (value && !std::isfinite(*value)) return bad_option(fmt::format("{}: found {}, expected a positive number", name, *value));
  for (const auto& [text, name] : {std::pair{options.reference, "--reference"}, {options.fail_above, "--fail-above"}})
    if (text)
      if (const auto length = tolerance_named(*text, name); !length) return length.error();
  const auto tolerances = tolerances_of(options);
  return tolerances ? Status(Done{}) : Status(tolerances.error());
}

Result<std::vector<Tolerance>> tolerances_of(const CompareOptions& options) {
  std::string list = options.tolerances;
  if (list.empty() && options.strategies && !options.level) list = "1e-3d";
  if (list.empty() && !options.strategies && options.meshes.empty() && !options.advise) list = "1e-2d,1e-3d,1e-4d";
  std::vector<Tolerance> found;
  for (std::size_t begin = 0; !list.empty() && begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const auto one = tolerance_named(list.substr(begin, end - begin), "--tolerances");
    if (!one) return one.error();
    found.push_back(*one);
    begin = end + 1;
  }
  return found;
}

RenderOptions render_options_of(const CompareOptions& options) {
  RenderOptions render;
  render.input = options.input;
  render.view = options.view;
  render.size = options.size.value_or("640x480");
  render.samples = options.samples;
  render.seed = options.seed;
  render.fov = options.fov;
  render.orthographic = options.orthographic;
  render.patches = options.patches;
  render.mode = "direct";
  return render;
}

}  // namespace iso
