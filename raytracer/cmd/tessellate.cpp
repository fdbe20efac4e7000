// `isophote tessellate MODEL -o mesh.stl`: a watertight mesh, and how far it is from the surfaces.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <chrono>
#include <optional>

#include "patches/files/output_file.h"
#include "patches/io/read_model.h"
#include "patches/io/write_mesh.h"
#include "raytracer/cmd/command.h"
#include "raytracer/cmd/interrupt.h"
#include "raytracer/cmd/mesh_report.h"
#include "raytracer/cmd/report.h"
#include "raytracer/cmd/tessellate_options.h"
#include "raytracer/progress.h"

namespace iso {
namespace {

using Time = std::chrono::steady_clock::time_point;
Time now() { return std::chrono::steady_clock::now(); }
double seconds(Time begin, Time end) { return std::chrono::duration<double>(end - begin).count(); }

std::vector<PartToMesh> parts_of(const Model& model) {
  std::vector<PartToMesh> parts;
  for (const Part& part : model.parts) parts.push_back({&part, {}});
  for (const Instance& instance : model.instances) parts[static_cast<std::size_t>(instance.part)].placements.push_back(instance.to_model);
  return parts;
}

struct Times {
  Time begin, read, made;
};

// Writes what was asked for, and says the closing line and every promise that is not kept.
Exit write_and_tell(const TessellateOptions& options, const Model& model, const ModelMesh& mesh, const MeshFigures& figures,
                    const Times& times, ProgressStyle style) {
  const InterruptGuard interrupt;  // files appear whole: an interrupt waits for them
  const std::vector<std::string> broken = broken_promises(figures);
  std::optional<WrittenMesh> written;
  if (!options.output.empty()) {
    auto result = write_mesh(options.output, model, mesh, {kVersion});
    if (!result) return fail(result.error());
    written = std::move(*result);
  }
  const Time end = now();
  const double all = seconds(times.begin, end);
  if (!options.report.empty()) {
    const ReportHead head{kVersion, options.model, seconds(times.begin, times.read), seconds(times.made, end),
                          all,      peak_memory(), written ? &*written : nullptr};
    if (const auto done = write_whole_file(options.report, report_json(figures, broken, head)); !done) return fail(done.error());
  }
  const std::string& file = written ? options.output : options.model;
  if (style == ProgressStyle::json)
    fmt::print(stderr, "{{\"event\":\"done\",\"seconds\":{:.3f},\"peak_bytes\":{},\"kept\":{},\"mesh\":{}}}\n", all, peak_memory(),
               broken.empty(), totals_json(figures).dump());
  else if (!options.quiet)
    fmt::print(stderr, "{}: {}; {:.1f} s\n", file, summary_text(figures), all);
  return tell_broken(broken, file);
}

Exit tessellate_command(const TessellateOptions& options) {
  if (const auto checked = check_request(options); !checked) return fail(checked.error());
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Times times;
  times.begin = now();
  const auto model = read_model(options.model, {options.patches.kind()});
  if (!model) return fail(model.error());
  const auto settings = settings_for(options, *model);
  if (!settings) return fail(settings.error());
  times.read = now();

  Progress progress(options.quiet ? "none" : options.progress, "steps");
  ModelMesh mesh;
  MeshFigures figures = mesh_parts(parts_of(*model), *settings, mesh, [&](int done, int all) { progress.update(done, all); });
  figures.unit = model->unit;
  progress.finish();
  times.made = now();
  return write_and_tell(options, *model, mesh, figures, times, progress.style());
}

}  // namespace

void add_tessellate_command(CLI::App& app, Exit& exit) {
  CLI::App* command = app.add_subcommand("tessellate", "a watertight mesh and its proven distance from the surfaces");
  const auto options = declare_tessellate_options(*command);
  command->callback([options, &exit] { exit = tessellate_command(*options); });
}

}  // namespace iso
