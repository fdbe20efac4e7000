// Meshes in place of the surfaces of a scene, for `render --mode tessellated`.
#pragma once

#include <functional>
#include <string>

#include "raytracer/cmd/load_models.h"
#include "raytracer/cmd/mesh_parts.h"
#include "raytracer/cmd/render_options.h"

namespace iso {

// Each part of the scene is meshed once, fine enough for its largest instance. With a pattern that has a level no tolerance is kept. Error:
// a tolerance that has no meaning for the scene.
Result<MeshFigures> tessellate_scene(LoadedModels& loaded, const MeshRequest& request, const std::function<void(int, int)>& progress,
                                     const std::optional<PatternSettings>& pattern = {});

// What a picture says of itself: how it was made, how far its triangles are from the surfaces, and what was not kept.
std::string mesh_comment(const MeshFigures& figures, const MeshRequest& request);

// For --stats, a figure a line.
std::string mesh_statistics(const MeshFigures& figures);

}  // namespace iso
