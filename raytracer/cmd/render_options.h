// The command line of `isophote render`, and its meeting with the scene file: what is given on the command line wins.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "raytracer/cmd/patches_option.h"
#include "raytracer/scene_file.h"

namespace iso {

struct RenderOptions {
  std::string input, output;
  std::optional<std::string> view, shade, size, background;
  std::optional<int> samples;
  std::optional<std::uint64_t> seed;
  std::optional<double> fov;
  bool orthographic = false;
  PatchesOption patches;
  std::string aovs = "all", progress = "auto";
  std::optional<std::string> mode, tolerance;
  bool flat = false, terminator_fix = false;
  std::optional<std::string> direction, range, line_width;
  std::optional<int> lines;
  bool no_legend = false;
  int threads = 0;  // 0: all
  bool quiet = false, stats = false;
};

std::shared_ptr<RenderOptions> declare_render_options(CLI::App& command);

// The scene to render: read from a scene file, or made around a bare model; options applied, --patches to the OBJ files among the models.
// Without triangles, --tolerance, --flat and --terminator-fix are refused, and so are the options of other shades. The options that a scene
// has for its shade go with that shade.
Result<SceneEntry> scene_for(const RenderOptions& options);

// The set of layers in "all", "none" or a list like "N,P,Z,uv,id".
Result<unsigned> aovs_named(const std::string& text);

}  // namespace iso
