#include "raytracer/scene_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <sstream>

namespace iso {
namespace {

const std::vector<const char*>& keys_of(const char* object) { return scene_keys().at(object); }

// --- transforms -------------------------------------------------------------------------------------------------------------------

// Rotation about a unit axis through the origin.  [Rodrigues]
Mat3 rotation(const Vec3& axis, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  const Mat3 cross{{0, axis.z, -axis.y}, {-axis.z, 0, axis.x}, {axis.y, -axis.x, 0}};
  return Mat3(1.0) + s * cross + (1 - c) * (cross * cross);
}

Affine3 matrix_transform(const Node& node) {
  const std::vector<Node> items = node.items("a list of 16 numbers, row by row");
  if (items.size() != 16) node.expected("a list of 16 numbers, row by row");
  Affine3 affine;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) affine.linear[column][row] = items[static_cast<std::size_t>(4 * row + column)].number();
    affine.translation[row] = items[static_cast<std::size_t>(4 * row + 3)].number();
  }
  for (std::size_t i = 12; i < 16; ++i)
    if (items[i].number() != (i == 15 ? 1.0 : 0.0)) items[i].expected("0 0 0 1 as the last row (no projection)");
  return affine;
}

Mat3 scale_transform(const Node& node) {
  const Vec3 factors = node.is_array() ? node.vector() : Vec3(node.number());
  if (factors.x == 0 || factors.y == 0 || factors.z == 0) node.expected("factors other than 0");
  return {{factors.x, 0, 0}, {0, factors.y, 0}, {0, 0, factors.z}};
}

// Refuses maps that flatten space, or that scale out of any sensible range.
void check_transform(const Node& node, const Affine3& affine) {
  constexpr double kSmallest = 1e-20, kLargest = 1e20, kFlat = 1e-12;  // flatter: the inverse would lose all but a few digits
  Mat3 unit;
  for (int c = 0; c < 3; ++c) {
    const Vec3& column = affine.linear[c];
    const double largest = std::max({std::abs(column.x), std::abs(column.y), std::abs(column.z)});
    if (largest == 0) node.fail("the transform is singular: it flattens the model");
    if (!(largest >= kSmallest && largest <= kLargest))
      node.fail(fmt::format("the transform scales by about {:g}, expected {:g} to {:g}", largest, kSmallest, kLargest));
    unit[c] = glm::normalize(column / largest);
  }
  if (!(std::abs(glm::determinant(unit)) > kFlat)) node.fail("the transform is singular: it flattens the model");
  if (!finite(affine.translation)) node.fail("the translation is not finite");
}

// One object: its matrix, or scale, then rotation, then translation.
Affine3 single_transform(const Node& node) {
  node.check_keys(keys_of("transform"));
  Affine3 affine;
  if (node.has("matrix")) {
    for (const char* other : {"translate", "rotate", "scale"})
      if (node.has(other))
        node.fail(fmt::format("'matrix' and '{}' in one object; use a list to apply several transforms in order", other));
    affine = matrix_transform(node["matrix"]);
  }
  if (node.has("scale")) affine.linear = scale_transform(node["scale"]);
  if (node.has("rotate")) {
    const Node rotate = node["rotate"];
    rotate.check_keys(keys_of("rotate"));
    affine.linear = rotation(rotate["axis"].direction(), glm::radians(rotate["degrees"].number())) * affine.linear;
  }
  if (node.has("translate")) affine.translation = node["translate"].vector();
  check_transform(node, affine);
  return affine;
}

Affine3 transform(const Node& node) {
  if (!node.is_array()) return single_transform(node);
  Affine3 affine;
  for (const Node& item : node.items("a list of transforms")) affine = single_transform(item) * affine;
  check_transform(node, affine);
  return affine;
}

// --- parts of the scene -----------------------------------------------------------------------------------------------------------

ModelEntry model(const Node& node, const std::filesystem::path& folder) {
  node.check_keys(keys_of("model"));
  ModelEntry entry;
  const std::string file = node["file"].text();
  if (file.empty() || file.find('\0') != std::string::npos) node["file"].expected("the name of a model file");
  entry.file = (folder / file).string();
  if (node.has("transform")) entry.to_world = transform(node["transform"]);
  if (node.has("colour")) entry.colour = node["colour"].colour();
  if (node.has("patches")) entry.patches = static_cast<MeshPatches>(node["patches"].word(kMeshPatchNames));
  return entry;
}

double fov(const Node& node) {
  const double degrees = node.number();
  if (!(degrees >= kMinFov && degrees <= kMaxFov)) node.expected(fmt::format("an angle from {} to {} degrees", kMinFov, kMaxFov));
  return degrees;
}

// Keys that say the same thing in two ways, or nothing at all, are refused.
void check_camera(const Node& node, const CameraEntry& camera) {
  if (camera.look_from.has_value() != camera.look_at.has_value()) node.fail("'look_from' and 'look_at' belong together");
  if (camera.view && camera.look_from) node.fail("either 'view' or 'look_from' and 'look_at', not both");
  if (node.has("up") && !camera.look_from) node.fail("'up' needs 'look_from' and 'look_at'");
  const bool orthographic = camera.projection == Projection::orthographic;
  if (camera.fov && orthographic) node["fov"].fail("an orthographic camera has 'height', not 'fov'");
  if (camera.height && !orthographic) node["height"].fail("'height' belongs to \"type\": \"orthographic\"");
  if (camera.height && !camera.look_from) node["height"].fail("'height' needs 'look_from' and 'look_at'");
  if (orthographic && camera.look_from && !camera.height)
    node.fail("an orthographic camera with 'look_from' needs 'height', the visible height");
  if (camera.look_from && !look_at(Projection::perspective, *camera.look_from, *camera.look_at, camera.up, kDefaultFov))
    node.fail("'look_from' and 'look_at' coincide, or 'up' is parallel to the line of sight");
}

CameraEntry camera(const Node& node) {
  node.check_keys(keys_of("camera"));
  CameraEntry entry;
  if (node.has("type")) entry.projection = static_cast<Projection>(node["type"].word({"perspective", "orthographic"}));
  if (node.has("view")) entry.view = static_cast<View>(node["view"].word(kViewNames));
  if (node.has("look_from")) entry.look_from = node["look_from"].vector();
  if (node.has("look_at")) entry.look_at = node["look_at"].vector();
  if (node.has("up")) entry.up = node["up"].direction();
  if (node.has("fov")) entry.fov = fov(node["fov"]);
  if (node.has("height")) entry.height = node["height"].positive();
  check_camera(node, entry);
  return entry;
}

LightsEntry lights(const Node& node) {
  node.check_keys(keys_of("lights"));
  LightsEntry entry;
  if (node.has("sky")) {
    const Node sky = node["sky"];
    sky.check_keys(keys_of("sky"));
    if (sky.has("zenith")) entry.zenith = sky["zenith"].colour();
    if (sky.has("ground")) entry.ground = sky["ground"].colour();
    if (sky.has("up")) entry.sky_up = sky["up"].direction();
  }
  if (node.has("key")) {
    const Node key = node["key"];
    key.check_keys(keys_of("key"));
    if (key.has("from")) entry.key_from = key["from"].direction();
    if (key.has("colour")) entry.key_colour = key["colour"].colour();
    if (key.has("strength")) {
      entry.key_strength = key["strength"].number();
      if (!(*entry.key_strength >= 0 && *entry.key_strength <= 1e6)) key["strength"].expected("a number from 0 to 1e6");
    }
    if (key.has("angle")) {
      entry.key_angle = glm::radians(key["angle"].number());
      if (!(*entry.key_angle >= 0 && *entry.key_angle <= kPi)) key["angle"].expected("a diameter from 0 to 180 degrees");
    }
  }
  return entry;
}

void image(const Node& node, SceneEntry& scene) {
  node.check_keys(keys_of("image"));
  if (node.has("width")) scene.size.width = static_cast<int>(node["width"].whole(1, kMaxImageSide));
  if (node.has("height")) scene.size.height = static_cast<int>(node["height"].whole(1, kMaxImageSide));
  if (node.has("samples")) scene.samples = static_cast<int>(node["samples"].whole(1, kMaxSamples));
  if (node.has("seed")) scene.seed = static_cast<std::uint64_t>(node["seed"].whole(0, 1ll << 53));
  if (static_cast<long long>(scene.size.width) * scene.size.height > kMaxPixels)
    node.fail(fmt::format("{} x {} pixels are too many; at most {}", scene.size.width, scene.size.height, kMaxPixels));
}

Background background(const Node& node) {
  if (!node.is_string()) return {BackgroundKind::plain, node.colour()};
  if (const auto named = background_named(node.text())) return *named;
  node.expected("\"transparent\", \"sky\", or a colour");
}

MeshRequest mesh(const Node& node) {
  node.check_keys(keys_of("mesh"));
  MeshRequest request;
  request.tolerance_name = "mesh.tolerance";
  if (node.has("tolerance")) {
    const auto tolerance = tolerance_named(node["tolerance"].text());
    if (!tolerance) node["tolerance"].expected("a length such as \"0.05mm\", diagonals such as \"1e-4d\", or units of the models");
    request.tolerance = *tolerance;
  }
  if (node.has("flat") && node["flat"].boolean()) request.shading = MeshShading::flat;
  if (node.has("terminator_fix") && node["terminator_fix"].boolean()) request.terminator = Terminator::softened;
  if (request.shading == MeshShading::flat && request.terminator == Terminator::softened)
    node.fail("'terminator_fix' has no meaning with 'flat', whose triangles are lit by their own normals");
  return request;
}

ShadeOptions shade_options(const Node& node, Shade shade) {
  node.check_keys(keys_of("shade_options"));
  ShadeOptions options;
  if (node.has("direction")) options.direction = node["direction"].direction();
  if (node.has("lines")) options.lines = static_cast<int>(node["lines"].whole(1, kMaxLines));
  if (node.has("line_width")) {
    options.line_width = node["line_width"].number();
    if (!(*options.line_width > 0 && *options.line_width < 1)) node["line_width"].expected("a share of the period between 0 and 1");
  }
  if (node.has("range")) {
    const std::vector<Node> ends = node["range"].items("a list of two numbers");
    if (ends.size() != 2) node["range"].expected("a list of two numbers");
    options.range = Range{ends[0].number(), ends[1].number()};
    if (!(options.range->lo < options.range->hi)) node["range"].fail("the first end of the range must be less than the second");
    if (!finite(options.range->width())) node["range"].fail("the range is too wide for numbers");
  }
  if (node.has("legend")) options.legend = node["legend"].boolean();

  if (const auto option = meaningless_option(options, shade)) {
    const char* name = keys_of("shade_options")[static_cast<std::size_t>(*option)];
    node[name].fail(fmt::format("'{}' has no meaning for \"shade\": \"{}\"; it belongs to {}", name,
                                kShadeNames[static_cast<std::size_t>(shade)], shades_with(*option)));
  }
  return options;
}

SceneEntry scene(const Node& root, const std::filesystem::path& folder) {
  root.check_keys(keys_of("scene"));
  SceneEntry entry;
  const Node models = root["models"];
  for (const Node& item : models.items("a list of models")) entry.models.push_back(model(item, folder));
  if (entry.models.empty()) models.expected("at least one model");
  if (root.has("camera")) entry.camera = camera(root["camera"]);
  if (root.has("lights")) entry.lights = lights(root["lights"]);
  if (root.has("background")) entry.background = background(root["background"]);
  if (root.has("image")) image(root["image"], entry);
  if (root.has("shade")) entry.shade = static_cast<Shade>(root["shade"].word(kShadeNames));
  if (root.has("shade_options")) entry.shade_options = shade_options(root["shade_options"], entry.shade);
  if (root.has("mesh")) entry.mesh = mesh(root["mesh"]);
  if (root.has("$schema")) static_cast<void>(root["$schema"].text());
  if (root.has("comment")) static_cast<void>(root["comment"].text());
  return entry;
}

}  // namespace

const std::map<std::string, std::vector<const char*>>& scene_keys() {
  static const std::map<std::string, std::vector<const char*>> keys{
      {"scene", {"$schema", "comment", "models", "camera", "lights", "background", "image", "shade", "shade_options", "mesh"}},
      {"model", {"file", "transform", "colour", "patches"}},
      {"transform", {"translate", "rotate", "scale", "matrix"}},
      {"rotate", {"axis", "degrees"}},
      {"camera", {"type", "view", "look_from", "look_at", "up", "fov", "height"}},
      {"lights", {"sky", "key"}},
      {"sky", {"zenith", "ground", "up"}},
      {"key", {"from", "colour", "strength", "angle"}},
      {"image", {"width", "height", "samples", "seed"}},
      {"shade_options", {"direction", "lines", "line_width", "range", "legend"}},  // in the order of ShadeOption
      {"mesh", {"tolerance", "flat", "terminator_fix"}}};
  return keys;
}

std::optional<Background> background_named(std::string_view text) {
  if (text == "transparent") return Background{BackgroundKind::transparent, {}};
  if (text == "sky") return Background{BackgroundKind::sky, {}};
  if (const auto colour = colour_from_hex(text)) return Background{BackgroundKind::plain, *colour};
  return {};
}

Result<std::string> read_text(const std::string& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) return read_write_error(path, "is a folder; expected a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) return read_write_error(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad()) return read_write_error(path, "reading failed");
  return std::move(text).str();
}

Result<SceneEntry> scene_from_text(const std::string& text, const std::string& path) {
  try {
    const nlohmann::json json = parse_json(text, path);
    SceneEntry entry = scene(Node(json, path), std::filesystem::path(path).parent_path());
    entry.hash_text = json.dump();
    return entry;
  } catch (const SceneError& e) {
    return e.error;
  }
}

Result<SceneEntry> read_scene(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  return scene_from_text(*text, path);
}

}  // namespace iso
