// `isophote info FILE`: what is in a model or a mesh.
#include <memory>

#include "patches/io/model_info.h"
#include "patches/io/read_mesh.h"
#include "patches/io/read_model.h"
#include "raytracer/cmd/command.h"
#include "raytracer/cmd/mesh_info.h"
#include "raytracer/cmd/patches_option.h"

namespace iso {
namespace {

struct Options {
  std::string file;
  PatchesOption patches;
  bool json = false;
};

// The text to be printed.
Result<std::string> told(const Options& options) {
  if (!options.patches.name && is_mesh_file(options.file)) {
    const auto mesh = read_mesh(options.file);
    if (!mesh) return mesh.error();
    const MeshInfo described = describe(*mesh);
    return options.json ? to_json(described) : to_text(described);
  }
  const auto model = read_model(options.file, {options.patches.kind()});
  if (!model) return model.error();
  const ModelInfo described = describe(*model);
  return options.json ? to_json(described) : to_text(described);
}

Exit info(const Options& options) {
  auto text = told(options);
  if (!text) return fail(text.error());
  if (text->empty() || text->back() != '\n') *text += '\n';
  const auto written = write_stdout(*text);
  return written ? Exit::done : fail(written.error());
}

}  // namespace

void add_info_command(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "what is in a model: faces, units, box, edges, problems; or in a mesh");
  command->add_option("FILE", options->file, "STEP, IGES, BREP, OBJ, BPT, IPATCH, GBP, LOP or MP file; or a mesh: STL, OBJ, PLY or glTF")
      ->required();
  declare_patches_option(*command, options->patches);
  command->add_flag("--json", options->json, "as JSON");
  command->callback([options, &exit] { exit = info(*options); });
}

}  // namespace iso
