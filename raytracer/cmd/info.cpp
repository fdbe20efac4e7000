// `isophote info FILE`: what is in a model.
#include <memory>

#include "patches/io/model_info.h"
#include "patches/io/read_model.h"
#include "raytracer/cmd/command.h"

namespace iso {
namespace {

struct Options {
  std::string file;
  bool json = false;
};

Exit info(const Options& options) {
  const auto model = read_model(options.file);
  if (!model) return fail(model.error());
  const ModelInfo described = describe(*model);
  std::string text = options.json ? to_json(described) : to_text(described);
  if (text.empty() || text.back() != '\n') text += '\n';
  const auto written = write_stdout(text);
  return written ? Exit::done : fail(written.error());
}

}  // namespace

void add_info_command(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "what is in a model: faces, units, box, edges, problems");
  command->add_option("FILE", options->file, "STEP, IGES, BREP, OBJ or BPT file")->required();
  command->add_flag("--json", options->json, "as JSON");
  command->callback([options, &exit] { exit = info(*options); });
}

}  // namespace iso
