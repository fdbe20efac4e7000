// The command line of `isophote continuity`.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "patches/base/result.h"
#include "patches/brep.h"
#include "raytracer/cmd/continuity_report.h"
#include "raytracer/cmd/render_options.h"

namespace iso {

struct ContinuityRequest {
  std::string model, json, picture;  // no json, no picture: none is written
  std::string by = "normal";
  int rows = 20;
  std::string gap = "1e-6d", normal = "0.1deg", curvature = "0.1/d", sew = "auto";
  std::optional<std::string> fail_gap, fail_normal, fail_curvature;
  bool fail_open = false;
  std::optional<std::string> scale;
  // The camera and how the picture is made, as `render` has them.
  std::optional<std::string> view, size;
  std::optional<int> samples;
  std::optional<double> fov;
  bool orthographic = false;
  PatchesOption patches;
  int threads = 0;
  bool quiet = false;
};

std::shared_ptr<ContinuityRequest> declare_continuity_options(CLI::App& command);

// What can be said against the request before the model is read.
Status check_request(const ContinuityRequest& request);

// The request in units of the model, once it is known.
Result<ContinuitySettings> settings_for(const ContinuityRequest& request, const Model& model);

// As `render` would be asked for the picture without lines.
RenderOptions render_options_of(const ContinuityRequest& request);

}  // namespace iso
