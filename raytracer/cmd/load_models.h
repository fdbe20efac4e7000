// Model files to a scene the tracer takes.
#pragma once

#include <string>
#include <vector>

#include "raytracer/scene_file.h"
#include "raytracer/trace_scene.h"

namespace iso {

struct LoadedModels {
  TraceScene scene;
  std::string unit;                // of the coordinates; empty if unknown or if the models differ
  std::string hash;                // of the scene description and the contents of the model files, 16 hex digits
  std::vector<std::string> notes;  // one line per file that could not be used whole
};

// Reads each file once, or once per kind of patches asked of it. Errors: those of `read_model`, and a scene whose box is not finite.
Result<LoadedModels> load_models(const std::vector<ModelEntry>& models, const std::string& hash_text);

}  // namespace iso
