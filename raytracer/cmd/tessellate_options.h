// The command line of `isophote tessellate`.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "patches/base/result.h"
#include "raytracer/cmd/mesh_parts.h"
#include "raytracer/cmd/patches_option.h"

namespace iso {

struct TessellateOptions {
  std::string model, output, report;  // no output: no mesh is written, no report: none
  std::string tolerance, trim_tolerance, sew = "auto", measure = "quick", progress = "auto";
  std::string strategy = "adaptive";  // or the name of a pattern
  std::optional<int> level;
  std::optional<double> angle;  // degrees
  PatchesOption patches;
  int threads = 0;  // 0: all
  bool quiet = false;
};

std::shared_ptr<TessellateOptions> declare_tessellate_options(CLI::App& command);

// What can be said against the request before the model is read.
Status check_request(const TessellateOptions& options);

// The request in units of the model, once it is known.
Result<MeshSettings> settings_for(const TessellateOptions& options, const Model& model);

}  // namespace iso
