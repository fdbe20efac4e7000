#include "raytracer/cmd/continuity_options.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "patches/files/output_file.h"
#include "raytracer/tolerance.h"

namespace iso {
namespace {

constexpr double kDegree = kPi / 180;

Error bad_option(const std::string& message) { return {Exit::bad_command_line, {}, {}, message}; }

// A positive number at the begin of the text, and what follows it.
std::optional<double> positive_number(std::string_view text, std::string_view& rest) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || !(value > 0) || !finite(value)) return {};
  rest = text.substr(static_cast<std::size_t>(end - text.data()));
  while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  return value;
}

// "0.1" or "0.1deg", as radians.
Result<double> angle_named(const std::string& text, const std::string& option) {
  std::string_view rest;
  const auto value = positive_number(text, rest);
  if (!value || !(rest.empty() || rest == "deg") || *value > 180)
    return bad_option(fmt::format("{}: found '{}', expected degrees above 0, at most 180, such as 0.1 or 0.1deg", option, text));
  return *value * kDegree;
}

// One over a length: "0.1/d", "0.02/mm", or a bare number, one over the unit of the model.
struct CurvatureNamed {
  double value = 0;
  Tolerance length{1, ToleranceUnit::model};  // value over it
};
Result<CurvatureNamed> curvature_named(const std::string& text, const std::string& option) {
  std::string_view rest;
  const auto value = positive_number(text, rest);
  const Error error = bad_option(
      fmt::format("{}: found '{}', expected a positive number, alone (one over the unit of the model) or with /d (one over the diagonal of "
                  "its box) or / and one of m cm mm um in ft",
                  option, text));
  if (!value) return error;
  if (rest.empty()) return CurvatureNamed{*value, {1, ToleranceUnit::model}};
  if (rest.front() != '/' || rest.size() < 2) return error;
  const auto length = tolerance_named("1" + std::string(rest.substr(1)), option);
  if (!length || length->value != 1) return error;
  return CurvatureNamed{*value, *length};
}

// The texts of one measure, and what reads them.
struct MeasureOptions {
  Measure measure;
  const char *option, *fail_option;
  const std::string& tolerance;
  const std::optional<std::string>& fail;
};
std::array<MeasureOptions, 3> measures_of(const ContinuityRequest& r) {
  return {{{Measure::gap, "--gap", "--fail-above-gap", r.gap, r.fail_gap},
           {Measure::normal, "--normal", "--fail-above-normal", r.normal, r.fail_normal},
           {Measure::curvature, "--curvature", "--fail-above-curvature", r.curvature, r.fail_curvature}}};
}

// A value of a measure in units of the model; without a model only its form is checked.
Result<double> value_of(Measure measure, const std::string& text, const std::string& option, const Model* model, double diagonal) {
  if (measure == Measure::normal) return angle_named(text, option);
  if (measure == Measure::curvature) {
    const auto named = curvature_named(text, option);
    if (!named) return named.error();
    if (!model) return named->value;
    const auto length = in_units(named->length, diagonal, model->unit, option);
    return length ? Result<double>(named->value / *length) : length.error();
  }
  const auto length = tolerance_named(text, option);
  if (!length) return length.error();
  return model ? in_units(*length, diagonal, model->unit, option) : length->value;
}

// All values of the request, for a model or without one.
Status read_values(const ContinuityRequest& request, const Model* model, ContinuitySettings& settings) {
  const double diagonal = model ? box_of(*model).diagonal() : 1;
  for (const MeasureOptions& of : measures_of(request)) {
    const auto tolerance = value_of(of.measure, of.tolerance, of.option, model, diagonal);
    if (!tolerance) return tolerance.error();
    settings.tolerance[static_cast<std::size_t>(of.measure)] = *tolerance;
    if (of.fail) {
      const auto limit = value_of(of.measure, *of.fail, of.fail_option, model, diagonal);
      if (!limit) return limit.error();
      settings.limit[static_cast<std::size_t>(of.measure)] = *limit;
    }
    if (of.measure == settings.by && request.scale) {
      const auto scale = value_of(of.measure, *request.scale, "--scale", model, diagonal);
      if (!scale) return scale.error();
      settings.scale = *scale;
    }
  }
  if (request.sew == "off") settings.sew = -1;
  if (request.sew == "off" || request.sew == "auto") return Done{};
  const auto sew = value_of(Measure::gap, request.sew, "--sew", model, diagonal);
  if (!sew) return sew.error();
  settings.sew = *sew;
  return Done{};
}

Measure measure_named(const std::string& name) {
  return static_cast<Measure>(std::find(kMeasureNames.begin(), kMeasureNames.end(), name) - kMeasureNames.begin());
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(a, ignored) == std::filesystem::weakly_canonical(b, ignored);
}

}  // namespace

std::shared_ptr<ContinuityRequest> declare_continuity_options(CLI::App& command) {
  auto r = std::make_shared<ContinuityRequest>();
  command.add_option("MODEL", r->model, "STEP, IGES, BREP, OBJ, BPT, IPATCH, GBP, LOP or MP file")->required();
  declare_patches_option(command, r->patches);
  command.add_option("--by", r->by, "what the table is sorted and the picture coloured by: gap, normal or curvature [normal]")
      ->check(CLI::IsMember({"gap", "normal", "curvature"}));
  command.add_option("--rows", r->rows, "rows of the table [20]")->check(CLI::Range(0, 1000000));
  command.add_option("--gap", r->gap, "faces within it join (G0): 1e-6d (diagonals), 0.001mm, or in units of the model [1e-6d]");
  command.add_option("--normal", r->normal, "and are tangent within it (G1): degrees, 0.1 or 0.1deg [0.1deg]");
  command.add_option("--curvature", r->curvature,
                     "and continue in curvature within it (G2): 0.1/d, 0.02/mm, or one over the unit of the model [0.1/d]");
  command.add_option("--sew", r->sew,
                     "join edges of faces that share none: auto (within the file's tolerances), off, or a length like --gap [auto]");
  command.add_option("--fail-above-gap", r->fail_gap, "exit code 1 if a gap is larger, like --gap");
  command.add_option("--fail-above-normal", r->fail_normal, "exit code 1 if a normal jumps by more, like --normal");
  command.add_option("--fail-above-curvature", r->fail_curvature,
                     "exit code 1 if the curvature jumps by more where faces are tangent, like --curvature");
  command.add_flag("--fail-open", r->fail_open, "exit code 1 if there are free or non-manifold edges");
  command.add_option("--json", r->json, "JSON file to write: every edge");
  command.add_option("--picture", r->picture, "OpenEXR file to write: the model with its edges coloured");
  command.add_option("--scale", r->scale, "upper end of the picture's colours, like the tolerance of --by [the largest value]");
  command.add_option("--view", r->view, "picture from: iso front back left right top bottom (z is up) [iso]")
      ->check(CLI::IsMember(std::vector<std::string>(kViewNames.begin(), kViewNames.end())));
  command.add_option("--size", r->size, "WIDTHxHEIGHT in pixels [1280x960]");
  command.add_option("--samples", r->samples, "rays per pixel [16]")->check(CLI::Range(1, kMaxSamples));
  command.add_flag("--ortho", r->orthographic, "orthographic camera");
  command.add_option("--fov", r->fov, "vertical field of view in degrees [28]")->check(CLI::Range(kMinFov, kMaxFov));
  command.add_option("-t,--threads", r->threads, "threads to use; 0: all [0]")->check(CLI::Range(0, 1024));
  command.add_flag("-q,--quiet", r->quiet, "no table, nothing but errors");
  return r;
}

Status check_request(const ContinuityRequest& request) {
  ContinuitySettings settings;
  settings.by = measure_named(request.by);
  if (const auto read = read_values(request, nullptr, settings); !read) return read.error();
  if (!request.picture.empty() && !request.picture.starts_with("/dev/") && !request.picture.ends_with(".exr"))
    return Error{Exit::bad_command_line,
                 request.picture,
                 {},
                 "--picture writes OpenEXR, expected a name ending in .exr; `isophote display` makes PNG and JPEG"};
  for (const std::string& path : {request.json, request.picture}) {
    if (path.empty()) continue;
    if (same_file(path, request.model))
      return Error{Exit::bad_command_line, path, {}, "is the model itself; expected another name to write to"};
    if (const auto writable = check_writable(path); !writable) return writable.error();
  }
  if (!request.json.empty() && same_file(request.json, request.picture)) return bad_option("--json and --picture name the same file");
  if (const auto scene = scene_for(render_options_of(request)); !scene) return scene.error();
  return Done{};
}

Result<ContinuitySettings> settings_for(const ContinuityRequest& request, const Model& model) {
  ContinuitySettings settings;
  settings.by = measure_named(request.by);
  settings.rows = request.rows;
  settings.fail_open = request.fail_open;
  if (const auto read = read_values(request, &model, settings); !read) return read.error();
  return settings;
}

RenderOptions render_options_of(const ContinuityRequest& request) {
  RenderOptions options;
  options.input = request.model;
  options.output = request.picture;
  options.view = request.view;
  options.size = request.size;
  options.samples = request.samples;
  options.fov = request.fov;
  options.orthographic = request.orthographic;
  options.patches = request.patches;
  return options;
}

}  // namespace iso
