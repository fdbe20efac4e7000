// `isophote continuity MODEL`: how smoothly the faces meet along their edges, as a table, JSON and a picture.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <memory>

#include "patches/files/output_file.h"
#include "patches/io/read_model.h"
#include "raytracer/cmd/command.h"
#include "raytracer/cmd/compare_pictures.h"
#include "raytracer/cmd/continuity_options.h"
#include "raytracer/cmd/continuity_picture.h"
#include "raytracer/cmd/continuity_report.h"
#include "raytracer/cmd/interrupt.h"
#include "raytracer/cmd/scene_view.h"
#include "raytracer/exr_writer.h"

namespace iso {
namespace {

ImageInfo info_for(const ContinuityReport& report, const SceneEntry& scene, const Camera& camera, const EdgeScale& scale) {
  ImageInfo info;
  info.version = kVersion;
  info.mode = "continuity";
  info.shade = "clay";
  info.units = report.unit;
  info.comments = "Edges in " + legend_text(report, scale);
  info.comments.pop_back();
  info.samples = scene.samples;
  info.world_to_camera = world_to_camera(camera);
  return info;
}

// The model in one grey before the sky, its edges over it.
Status write_picture(const ContinuityRequest& request, const std::shared_ptr<const Model>& model, const ContinuityReport& report,
                     const EdgeScale& scale, int threads) {
  const auto scene = scene_for(render_options_of(request));
  if (!scene) return scene.error();
  TraceScene placed;
  add_model(placed, model, {});
  if (placed.box().empty()) return bad_input(model->file, {}, "found no faces, expected some to make a picture of");
  paint_evenly(placed);
  const Tracer tracer(std::move(placed));
  const Camera camera = camera_for(scene->camera, tracer, scene->size);
  const Sampler sampler(scene->seed, scene->samples);
  const RenderSettings settings{scene->size, scene->samples, scene->seed, kAovNone, scene->background.value_or(Background{})};
  const InterruptGuard interrupt;
  RenderResult result = render(tracer, camera, clay(tracer, lights_for(scene->lights, camera), sampler), sampler, settings,
                               interrupt.flag(), [](int, int) {});
  if (!result.complete()) return Error{Exit::interrupted, request.picture, {}, "interrupted; no picture is written"};
  draw_edges(result.film.rgba, report, *model, scale, tracer, camera, scene->size);
  const auto bytes = encode_exr(result.film, info_for(report, *scene, camera, scale), threads);
  return bytes ? write_whole_file(request.picture, *bytes) : Status(bytes.error());
}

Exit continuity(const ContinuityRequest& request) {
  if (const auto checked = check_request(request); !checked) return fail(checked.error());
  const int threads = request.threads > 0 ? request.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  auto read = read_model(request.model, {request.patches.kind()});
  if (!read) return fail(read.error());
  const auto model = std::make_shared<const Model>(std::move(*read));
  const auto settings = settings_for(request, *model);
  if (!settings) return fail(settings.error());

  ContinuityReport report = report_of(*model, *settings);
  report.version = kVersion;
  std::string told = continuity_table(report);
  if (!request.json.empty())
    if (const auto written = write_whole_file(request.json, continuity_json(report)); !written) return fail(written.error());
  if (!request.picture.empty()) {
    const EdgeScale scale = edge_scale(report);
    if (const auto written = write_picture(request, model, report, scale, threads); !written) return fail(written.error());
    told += legend_text(report, scale);
  }
  if (!request.quiet)
    if (const auto written = write_stdout(told); !written) return fail(written.error());
  return tell_broken(broken_limits(report), request.model);
}

constexpr const char* kContinuityHelp =
    "Along every edge that two faces share, and every seam, at samples, and climbed to from the worst of them (measured, not proven):\n"
    "  gap        distance from the border of one face to the nearest place of the other's border\n"
    "  off        from there to the other's surface\n"
    "  normal     angle between the tangent planes, degrees: 0 smooth, 180 folded back\n"
    "  curvature  difference of the normal curvatures square to the edge, one over the unit of the model; '-' where the edge is sharp";

}  // namespace

void add_continuity_command(CLI::App& app, Exit& exit) {
  CLI::App* command = app.add_subcommand("continuity", "gaps, angles and curvature jumps between the faces of a model");
  command->footer(kContinuityHelp);
  const auto request = declare_continuity_options(*command);
  command->callback([request, &exit] { exit = continuity(*request); });
}

}  // namespace iso
