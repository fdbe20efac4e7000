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

// The folder of the report; its parent must be there. If nothing came into a folder that was made here, it goes again.
class ReportFolder {
 public:
  explicit ReportFolder(const std::string& path) : path_(path) {}
  ~ReportFolder() {
    std::error_code ignored;
    if (made_) std::filesystem::remove(path_, ignored);  // only if it is empty
  }
  Status make() {
    std::error_code error;
    if (!path_.empty()) made_ = std::filesystem::create_directory(path_, error);
    if (path_.empty() || std::filesystem::is_directory(path_)) return Done{};
    return read_write_error(path_.string(), std::filesystem::exists(path_) ? "is no folder" : "cannot make the folder: " + error.message());
  }
  // Without a folder nothing is kept.
  Status keep(const ReportFile& file) const {
    return path_.empty() ? Status(Done{}) : write_whole_file((path_ / file.name).string(), file.bytes);
  }

 private:
  std::filesystem::path path_;
  bool made_ = false;
};

Exit compare_command(const CompareOptions& options, const std::string& command) {
  if (const auto checked = check_request(options); !checked) return fail(checked.error());
  if (options.accept) return accept_golden(*options.accept, *options.why);
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  CompareRun run(options, threads);
  ReportFolder folder(options.output);
  if (const auto made = folder.make(); !made) return fail(made.error());
  auto report = run.run([&](const ReportFile& file) { return folder.keep(file); });
  if (!report) return fail(report.error());
  report->command = command;
  for (const ReportFile& file :
       {ReportFile{"index.html", compare_page(*report)}, {"report.json", compare_json(*report)}, {"table.csv", compare_csv(*report)}})
    if (const auto kept = folder.keep(file); !kept) return fail(kept.error());
  if (!options.quiet && !report->advice.empty()) fmt::print(stderr, "{}\n", report->advice);
  if (!options.quiet && !options.output.empty())
    fmt::print(stderr, "{}\n", (std::filesystem::path(options.output) / "index.html").string());
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
