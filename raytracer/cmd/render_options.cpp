#include "raytracer/cmd/render_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

namespace iso {
namespace {

Error bad_option(const std::string& message) { return {Exit::bad_command_line, {}, {}, message}; }

std::set<std::string> names(const auto& list) { return {list.begin(), list.end()}; }

bool has_ending(const std::string& path, const char* wanted) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == wanted;
}

// "1280x960".
std::optional<ImageSize> size_named(const std::string& text) {
  const auto x = text.find_first_of("xX");
  if (x == std::string::npos) return {};
  ImageSize size;
  const auto number = [](std::string_view part, int& value) {
    const auto [end, code] = std::from_chars(part.data(), part.data() + part.size(), value);
    return code == std::errc{} && end == part.data() + part.size() && value >= 1 && value <= kMaxImageSide;
  };
  const std::string_view whole = text;
  if (!number(whole.substr(0, x), size.width) || !number(whole.substr(x + 1), size.height)) return {};
  if (static_cast<long long>(size.width) * size.height > kMaxPixels) return {};
  return size;
}

Status apply_camera_options(const RenderOptions& options, CameraEntry& camera) {
  if (options.view) {
    // A named view replaces the scene's viewpoint, not its kind of projection.
    camera = {.projection = camera.projection,
              .view = view_named(*options.view),
              .look_from = {},
              .look_at = {},
              .fov = camera.fov,
              .height = {}};
  }
  if (options.orthographic && camera.look_from && camera.projection != Projection::orthographic)
    return bad_option("--ortho needs a framed camera; the scene places its own, so add --view, or 'type' and 'height' in the scene");
  if (options.orthographic) camera.projection = Projection::orthographic;
  if (options.fov && camera.projection == Projection::orthographic) return bad_option("--fov has no meaning for an orthographic camera");
  if (options.fov) camera.fov = options.fov;
  return Done{};
}

// What the scene asks for is replaced by what is given.
Status apply_mesh_options(const RenderOptions& options, std::optional<MeshRequest>& mesh) {
  if (options.mode == "direct") mesh.reset();
  if (options.mode == "tessellated" && !mesh) mesh.emplace();
  if (!mesh) {
    const char* given = options.tolerance ? "--tolerance" : options.flat ? "--flat" : options.terminator_fix ? "--terminator-fix" : nullptr;
    if (given) return bad_option(fmt::format("{} needs --mode tessellated: 'direct' makes no triangles", given));
    return Done{};
  }
  if (options.flat && options.terminator_fix)
    return bad_option("--terminator-fix has no meaning with --flat, whose triangles are lit by their own normals");
  if (options.tolerance) {
    const auto tolerance = tolerance_named(*options.tolerance);
    if (!tolerance) return tolerance.error();
    mesh->tolerance = *tolerance;
    mesh->tolerance_name = "--tolerance";
  }
  if (options.flat || options.terminator_fix) {
    mesh->shading = options.flat ? MeshShading::flat : MeshShading::smooth;
    mesh->terminator = options.flat ? Terminator::faceted : Terminator::softened;
  }
  return Done{};
}

// "x,y,z": as many finite numbers as wanted, with commas between.
std::optional<std::vector<double>> numbers_named(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  const char *at = text.data(), *const end = at + text.size();
  while (numbers.size() < count) {
    double value = 0;
    const auto [next, code] = std::from_chars(at, end, value);
    if (code != std::errc{} || !std::isfinite(value)) return {};
    numbers.push_back(value);
    at = next;
    if (numbers.size() < count && (at == end || *at++ != ',')) return {};
  }
  return at == end ? std::optional(numbers) : std::nullopt;
}

Result<Vec3> direction_named(const std::string& text) {
  const auto numbers = numbers_named(text, 3);
  const Vec3 v = numbers ? Vec3{(*numbers)[0], (*numbers)[1], (*numbers)[2]} : Vec3(0.0);
  // Scaled first, so that neither large nor small numbers leave the range of doubles.
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) return bad_option(fmt::format("--direction: found '{}', expected X,Y,Z: three numbers, not all of them 0", text));
  return glm::normalize(v / largest);
}

Result<Range> range_named(const std::string& text) {
  const auto ends = numbers_named(text, 2);
  if (!ends || !((*ends)[0] < (*ends)[1]) || !std::isfinite((*ends)[1] - (*ends)[0]))
    return bad_option(fmt::format("--range: found '{}', expected LO,HI: two numbers, the first less than the second", text));
  return Range{(*ends)[0], (*ends)[1]};
}

// What is given wins over the scene's; the scene's options go with the scene's shade.
Status apply_shade_options(const RenderOptions& options, SceneEntry& scene) {
  if (options.shade) {
    const Shade shade = *shade_named(*options.shade);
    if (shade != scene.shade) scene.shade_options = {};
    scene.shade = shade;
  }
  ShadeOptions& shown = scene.shade_options;
  if (options.direction) {
    const auto direction = direction_named(*options.direction);
    if (!direction) return direction.error();
    shown.direction = *direction;
  }
  if (options.lines) shown.lines = options.lines;
  if (options.line_width) {
    const auto width = numbers_named(*options.line_width, 1);
    if (!width || !(width->front() > 0 && width->front() < 1))
      return bad_option(fmt::format("--line-width: found '{}', expected a share of the period between 0 and 1", *options.line_width));
    shown.line_width = width->front();
  }
  if (options.range) {
    const auto range = range_named(*options.range);
    if (!range) return range.error();
    shown.range = *range;
  }
  if (options.no_legend) shown.legend = false;

  constexpr std::array kNames{"--direction", "--lines", "--line-width", "--range", "--no-legend"};  // in the order of ShadeOption
  if (const auto option = meaningless_option(shown, scene.shade))
    return bad_option(fmt::format("{} has no meaning for --shade {}; it belongs to {}", kNames[static_cast<std::size_t>(*option)],
                                  kShadeNames[static_cast<std::size_t>(scene.shade)], shades_with(*option)));
  return Done{};
}

void declare_shade_options(CLI::App& command, RenderOptions& options) {
  command
      .add_option(
          "--shade", options.shade,
          "clay normals uv faces kinds curvature depth solver zebra reflection-lines isophotes mean-curvature gauss-curvature [clay]")
      ->check(CLI::IsMember(names(kShadeNames)));
  command.add_option("--direction", options.direction,
                     "X,Y,Z: zebra: that the bands lie about; reflection-lines: of the lines; isophotes: to compare normals with [as the "
                     "camera stands]");
  command
      .add_option("--lines", options.lines,
                  "zebra: bands to half a turn [12]; reflection-lines: lines all round [36]; isophotes: bands for cosines 0 to 1 [12]")
      ->check(CLI::Range(1, kMaxLines));
  command.add_option("--line-width", options.line_width, "of their period: 0 to 1 [0.5; reflection-lines 0.25]");
  command.add_option("--range", options.range,
                     "LO,HI: mean-curvature, gauss-curvature: ends of the colours, per (square) unit of the model [fitting the view]");
  command.add_flag("--no-legend", options.no_legend, "mean-curvature, gauss-curvature: no bar with numbers in the picture");
}

}  // namespace

std::shared_ptr<RenderOptions> declare_render_options(CLI::App& command) {
  auto options = std::make_shared<RenderOptions>();
  command.add_option("INPUT", options->input, "scene file (.json) or a model: STEP, IGES, BREP, OBJ, BPT, IPATCH, GBP, LOP, MP")
      ->required();
  declare_patches_option(command, options->patches);
  command.add_option("-o,--output", options->output, "OpenEXR file to write")->required();
  command.add_option("--view", options->view, "frame the models from: iso front back left right top bottom (z is up)")
      ->check(CLI::IsMember(names(kViewNames)));
  declare_shade_options(command, *options);
  command.add_option("--size", options->size, "WIDTHxHEIGHT in pixels [1280x960]");
  command.add_option("--samples", options->samples, "rays per pixel [16]")->check(CLI::Range(1, kMaxSamples));
  command.add_flag("--ortho", options->orthographic, "orthographic camera");
  command.add_option("--fov", options->fov, "vertical field of view in degrees [28]")->check(CLI::Range(kMinFov, kMaxFov));
  command.add_option("--background", options->background, "transparent, sky or #rrggbb [sky for a model, transparent for a scene]");
  command.add_option("--aov", options->aovs, "data layers: all, none, or a list of N P Z uv id with commas [all]");
  command
      .add_option("--mode", options->mode,
                  "direct (exact surfaces) or tessellated (triangles, with their distance told) [direct, or as the scene]")
      ->check(CLI::IsMember({"direct", "tessellated"}));
  command.add_option("--tolerance", options->tolerance,
                     "tessellated: allowed distance, 1e-4d (diagonals), 0.05mm, or in units of the model [1e-4d]");
  command.add_flag("--flat", options->flat, "tessellated: shade triangles by their own normals");
  command.add_flag("--terminator-fix", options->terminator_fix, "tessellated: hide the facets where light grazes");
  command.add_option("--seed", options->seed, "another seed gives other noise [0]");
  command.add_option("-t,--threads", options->threads, "threads to use; 0: all [0]")->check(CLI::Range(0, 1024));
  command.add_option("--progress", options->progress, "auto (bar or lines), json, none [auto]")
      ->check(CLI::IsMember({"auto", "json", "none"}));
  command.add_flag("-q,--quiet", options->quiet, "say nothing but errors");
  command.add_flag("--stats", options->stats, "all counters of the build and the solver when done");
  return options;
}

Result<SceneEntry> scene_for(const RenderOptions& options) {
  // A bare model is a scene with default camera and lights, before a light sky.
  SceneEntry scene;
  if (has_ending(options.input, ".json")) {
    auto read = read_scene(options.input);
    if (!read) return read.error();
    scene = std::move(*read);
    bool used = false;
    for (ModelEntry& entry : scene.models)
      if (options.patches.name && has_ending(entry.file, ".obj")) {
        entry.polygons_needed = entry.patches.has_value();  // others may hold surfaces alone
        entry.patches = options.patches.kind();
        used = true;
      }
    if (options.patches.name && !used)
      return bad_input(options.input, "models", "patches are made of control meshes (--patches), expected a model that is an OBJ file");
  } else {
    scene.models.push_back({options.input, {}, {}, options.patches.kind()});
    scene.background = Background{BackgroundKind::sky, {}};
  }

  if (const auto applied = apply_camera_options(options, scene.camera); !applied) return applied.error();
  if (const auto applied = apply_mesh_options(options, scene.mesh); !applied) return applied.error();
  if (const auto applied = apply_shade_options(options, scene); !applied) return applied.error();
  if (options.size) {
    const auto size = size_named(*options.size);
    if (!size)
      return bad_option(fmt::format("--size: found '{}', expected WIDTHxHEIGHT such as 1280x960, sides up to {}, at most {} pixels",
                                    *options.size, kMaxImageSide, kMaxPixels));
    scene.size = *size;
  }
  if (options.background) {
    scene.background = background_named(*options.background);
    if (!scene.background)
      return bad_option(fmt::format("--background: found '{}', expected transparent, sky or #rrggbb", *options.background));
  }
  if (options.samples) scene.samples = *options.samples;
  if (options.seed) scene.seed = *options.seed;
  return scene;
}

Result<unsigned> aovs_named(const std::string& text) {
  if (text == "all") return unsigned{kAovAll};
  if (text == "none") return unsigned{kAovNone};
  unsigned set = kAovNone;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const std::vector<const char*> known{"N", "P", "Z", "uv", "id"};
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      return bad_option(fmt::format("--aov: found '{}', expected all, none, or names of N P Z uv id with commas", name));
    set |= 1u << (found - known.begin());
    begin = end + 1;
  }
  return set;
}

}  // namespace iso
