// `isophote render`: a scene or a bare model to an OpenEXR picture.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <chrono>

#include "patches/files/output_file.h"
#include "raytracer/cmd/command.h"
#include "raytracer/cmd/interrupt.h"
#include "raytracer/cmd/load_models.h"
#include "raytracer/cmd/mesh_report.h"
#include "raytracer/cmd/render_options.h"
#include "raytracer/cmd/report.h"
#include "raytracer/cmd/scene_mesh.h"
#include "raytracer/cmd/scene_view.h"
#include "raytracer/exr_writer.h"
#include "raytracer/progress.h"

namespace iso {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

bool has_exr_name(const std::string& path) { return path.starts_with("/dev/") || path.ends_with(".exr") || path.ends_with(".EXR"); }

// What can be said against the request before anything is read or rendered.
Status check_request(const RenderOptions& options) {
  if (!has_exr_name(options.output))
    return Error{Exit::bad_command_line,
                 options.output,
                 {},
                 "render writes OpenEXR, expected a name ending in .exr; `isophote display` makes PNG and JPEG"};
  return check_writable(options.output);
}

ImageInfo info_for(const SceneEntry& scene, const LoadedModels& loaded, const Camera& camera, const Tracer& tracer) {
  ImageInfo info;
  info.version = kVersion;
  info.shade = kShadeNames[static_cast<std::size_t>(scene.shade)];
  info.units = loaded.unit;
  info.scene_hash = loaded.hash;
  info.comments =
      "Exact surfaces, traced without triangles. N, P, Z, uv, id: unfiltered, at pixel centres; N is the face's outward normal.";
  info.seed = scene.seed;
  info.samples = scene.samples;
  info.world_to_camera = world_to_camera(camera);
  info.world_to_ndc = world_to_ndc(camera, scene.size, depth_range(camera, tracer.scene().box()));
  return info;
}

// The closing line, and everything there is to count if wanted. `mesh` is null for exact surfaces.
void report(const RenderOptions& options, const SceneEntry& scene, const RenderResult& result, const Tracer& tracer,
            const MeshFigures* mesh, double seconds, ProgressStyle style) {
  if (style == ProgressStyle::json) {
    fmt::print(stderr, "{{\"event\":\"{}\",\"seconds\":{:.3f},\"rays_per_second\":{:.0f},\"peak_bytes\":{},{}\"statistics\":{}}}\n",
               result.complete() ? "done" : "interrupted", seconds, double(result.stats.rays) / seconds, peak_memory(),
               mesh ? fmt::format("\"mesh\":{},", totals_json(*mesh).dump()) : "", statistics_json(tracer.build_stats(), result.stats));
    return;
  }
  if (!options.quiet)
    fmt::print(stderr, "{}: {} x {}, {} samples, {:.1f} s (build {:.1f} s), {:.2f} Mray/s, {:.0f} MB; {}\n", options.output,
               scene.size.width, scene.size.height, scene.samples, seconds, tracer.build_stats().seconds,
               1e-6 * double(result.stats.rays) / seconds, 1e-6 * double(peak_memory()),
               mesh ? "tessellated: " + summary_text(*mesh) : "solver: " + rare_branches(result.stats));
  if (options.stats && mesh) fmt::print(stderr, "{}", mesh_statistics(*mesh));
  if (options.stats) fmt::print(stderr, "{}", full_statistics(tracer.build_stats(), result.stats));
}

Exit render_scene(const RenderOptions& options, const SceneEntry& scene, LoadedModels& loaded, const MeshFigures* mesh,
                  const RenderSettings& settings, int threads) {
  const Tracer tracer(std::move(loaded.scene));
  const Camera camera = camera_for(scene.camera, tracer, scene.size);
  const Sampler sampler(scene.seed, scene.samples);
  const SceneLook look = look_for(scene, tracer, camera, sampler, loaded.unit);

  // From here on an interrupt ends with a picture of what is done.
  const InterruptGuard interrupt;
  Progress progress(options.quiet ? "none" : options.progress);
  const auto begin = std::chrono::steady_clock::now();
  RenderResult result =
      render(tracer, camera, look.integrator, sampler, settings, interrupt.flag(), [&](int done, int all) { progress.update(done, all); });
  const double seconds = std::max(seconds_since(begin), 1e-9);
  progress.finish();
  if (look.legend) draw_legend(*look.legend, result.film);

  ImageInfo info = info_for(scene, loaded, camera, tracer);
  info.complete = result.complete();
  if (mesh) info.mode = "tessellated";
  if (mesh) info.comments = mesh_comment(*mesh, *scene.mesh);
  if (look.scale) info.comments += fmt::format(" Colours from {:g} to {:g}.", look.scale->range.lo, look.scale->range.hi);
  const auto bytes = encode_exr(result.film, info, threads);
  if (!bytes) return fail(bytes.error());
  if (const auto written = write_whole_file(options.output, *bytes); !written) return fail(written.error());
  report(options, scene, result, tracer, mesh, seconds, progress.style());
  if (result.complete()) return mesh ? tell_broken(broken_promises(*mesh), options.output) : Exit::done;
  return fail({Exit::interrupted,
               options.output,
               {},
               fmt::format("interrupted; {} of {} tiles are done and written", result.tiles_done, result.tiles)});
}

Exit render_command(const RenderOptions& options) {
  if (const auto checked = check_request(options); !checked) return fail(checked.error());
  const auto aovs = aovs_named(options.aovs);
  if (!aovs) return fail(aovs.error());
  const auto scene = scene_for(options);
  if (!scene) return fail(scene.error());

  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  auto loaded = load_models(scene->models, scene->hash_text);
  if (!loaded) return fail(loaded.error());
  if (!options.quiet)
    for (const std::string& note : loaded->notes) fmt::print(stderr, "isophote: {}\n", note);

  const RenderSettings settings = settings_for(*scene, *aovs);
  if (!scene->mesh) return render_scene(options, *scene, *loaded, nullptr, settings, threads);
  Progress progress(options.quiet ? "none" : options.progress, "steps");
  const auto mesh = tessellate_scene(*loaded, *scene->mesh, [&](int done, int all) { progress.update(done, all); });
  progress.finish();
  if (!mesh && scene->mesh->tolerance_name != MeshRequest{}.tolerance_name)
    return fail({Exit::bad_input, options.input, {}, mesh.error().message});
  if (!mesh) return fail(mesh.error());
  return render_scene(options, *scene, *loaded, &*mesh, settings, threads);
}

}  // namespace

void add_render_command(CLI::App& app, Exit& exit) {
  CLI::App* command = app.add_subcommand("render", "a scene or a model to an OpenEXR picture");
  const auto options = declare_render_options(*command);
  command->callback([options, &exit] { exit = render_command(*options); });
}

}  // namespace iso
