// The command line of `isophote compare`.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "patches/base/result.h"
#include "raytracer/cmd/render_options.h"
#include "raytracer/tolerance.h"

namespace iso {

struct CompareOptions {
  std::string input, output;
  std::string tolerances;   // with commas
  bool strategies = false;  // each way to divide patches with any number of sides
  std::optional<int> level;
  std::vector<std::string> meshes;
  std::optional<std::string> mesh_unit, reference;
  bool advise = false;
  std::optional<double> pixels, flip;
  std::optional<std::string> fail_above;
  std::optional<double> fail_normal;  // degrees
  bool fail_open = false, fail_faults = false, no_pictures = false;
  std::optional<std::string> accept, why;
  // The camera and how pictures are made, as `render` has them.
  std::optional<std::string> view, size;
  std::optional<int> samples;
  std::optional<std::uint64_t> seed;
  std::optional<double> fov;
  bool orthographic = false;
  PatchesOption patches;
  std::string progress = "auto";
  int threads = 0;
  bool quiet = false;
};

std::shared_ptr<CompareOptions> declare_compare_options(CLI::App& command);

// What contradicts itself is an error.
Status check_request(const CompareOptions& options);

// The tolerances asked for; 1e-2d, 1e-3d, 1e-4d where neither they nor meshes were, 1e-3d of strategies without a level.
Result<std::vector<Tolerance>> tolerances_of(const CompareOptions& options);

// As `render` would be asked for the same picture.
RenderOptions render_options_of(const CompareOptions& options);

}  // namespace iso
