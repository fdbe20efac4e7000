// The scene description (JSON, scenes/scene.schema.json) as plain data. Nothing is loaded here: model files are named, not read.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "patches/control_mesh.h"
#include "raytracer/json_reader.h"
#include "raytracer/render.h"
#include "raytracer/smoothness.h"
#include "raytracer/tolerance.h"
#include "raytracer/trace_scene.h"

namespace iso {

struct ModelEntry {
  std::string file;  // as it can be opened from the working folder: relative names count from the scene file
  Affine3 to_world;
  std::optional<Colour> colour;
  std::optional<MeshPatches> patches;  // of the polygons of a control mesh
  bool polygons_needed = true;         // ReadOptions::polygons_needed
};

// A camera is placed by points, or frames the models from a named view.
struct CameraEntry {
  std::optional<Projection> projection;
  std::optional<View> view;
  std::optional<Vec3> look_from, look_at;
  Vec3 up{0, 0, 1};
  std::optional<double> fov, height;  // degrees, vertical; world units
};

// Empty members take the defaults that go with the camera.
struct LightsEntry {
  std::optional<Colour> zenith, ground;
  std::optional<Vec3> sky_up, key_from;
  std::optional<Colour> key_colour;
  std::optional<double> key_strength, key_angle;  // factor; diameter in radians
};

// Triangles in the place of the surfaces.
struct MeshRequest {
  Tolerance tolerance{1e-4, ToleranceUnit::diagonal};
  std::string tolerance_name = "--tolerance";  // what errors call it
  MeshShading shading = MeshShading::smooth;
  Terminator terminator = Terminator::faceted;
};

struct SceneEntry {
  std::vector<ModelEntry> models;
  CameraEntry camera;
  LightsEntry lights;
  std::optional<Background> background;
  ImageSize size;
  int samples = 16;
  std::uint64_t seed = 0;
  Shade shade = Shade::clay;
  ShadeOptions shade_options;       // all of them mean something to the shade
  std::optional<MeshRequest> mesh;  // none: exact surfaces
  std::string hash_text;            // what the scene hash covers beside the model files
};

// Errors: file not readable (Exit::read_write); anything in it that is not as the schema says (Exit::bad_input).
Result<SceneEntry> read_scene(const std::string& path);
Result<SceneEntry> scene_from_text(const std::string& text, const std::string& path);

// The keys of each kind of object, by its name in the schema's $defs ("scene" is the root): the reader knows no others.
const std::map<std::string, std::vector<const char*>>& scene_keys();

// "transparent", "sky", or a colour.
std::optional<Background> background_named(std::string_view text);

// Whole text of a file.
Result<std::string> read_text(const std::string& path);

}  // namespace iso
