// `isophote compare MODEL -o report/`: how far meshes are from the exact surfaces, in numbers and pictures.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <filesystem>

#include "patches/files/output_file.h"
#include "raytracer/cmd/command.h"
#include "raytracer/cmd/compare_run.h"
#include "raytracer/cmd/golden.h"

namespace iso {
namespace {

// The folder of the report; its parent must be there.
Status make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directory(path, error);
  if (std::filesystem::is_directory(path)) return Done{};
  return read_write_error(path, error ? fmt::format("cannot make the folder: {}", error.message()) : "is no folder");
}

Exit compare_command(const CompareOptions& options, const std::string& command) {
  if (const auto checked = check_request(options); !checked) return fail(checked.error());
  if (options.accept) return accept_golden(*options.accept, *options.why);
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const std::filesystem::path folder = options.output;
  if (!options.output.empty())
    if (const auto made = make_folder(options.output); !made) return fail(made.error());
  const auto keep = [&](const ReportFile& file) -> Status {
    return options.output.empty() ? Status(Done{}) : write_whole_file((folder / file.name).string(), file.bytes);
  };

  CompareRun run(options, threads);
  auto report = run.run(keep);
  if (!report) return fail(report.error());
  report->command = command;
  for (const ReportFile& file :
       {ReportFile{"index.html", compare_page(*report)}, {"report.json", compare_json(*report)}, {"table.csv", compare_csv(*report)}})
    if (const auto kept = keep(file); !kept) return fail(kept.error());
  if (!options.quiet && !report->advice.empty()) fmt::print(stderr, "{}\n", report->advice);
  if (!options.quiet && !options.output.empty()) fmt::print(stderr, "{}\n", (folder / "index.html").string());
  return tell_broken(report->failures, options.input);
}

// As it could be typed again.
std::string typed(const std::vector<std::string>& words) {
  std::string text = "isophote compare";
  for (const std::string& word : words) text += word.find(' ') == std::string::npos ? " " + word : " '" + word + "'";
  return text;
}

}  // namespace

void add_compare_command(CLI::App& app, Exit& exit, const std::vector<std::string>& words) {
  CLI::App* command = app.add_subcommand("compare", "how far a mesh, ours or somebody's, is from the exact surfaces: a report");
  const auto options = declare_compare_options(*command);
  command->callback([options, words, &exit] { exit = compare_command(*options, typed(words)); });
}

}  // namespace iso
