// The scene file: the reader and the published schema agree, and every refusal names its place.
#include "raytracer/scene_file.h"

#include <gtest/gtest.h>

#include <set>

namespace iso {
namespace {

constexpr const char* kFile = "scenes/test.json";

std::string refusal(const std::string& text) {
  const auto scene = scene_from_text(text, kFile);
  if (scene) return "accepted";
  EXPECT_EQ(scene.error().kind, Exit::bad_input);
  return scene.error().text();
}

std::string with_camera(const std::string& camera) { return R"({"models": [{"file": "a.step"}], "camera": )" + camera + "}"; }
std::string with_mesh(const std::string& mesh) { return R"({"models": [{"file": "a.step"}], "mesh": )" + mesh + "}"; }
std::string with_transform(const std::string& transform) { return R"({"models": [{"file": "a.step", "transform": )" + transform + "}]}"; }

TEST(SceneFile, SchemaAndReaderKnowTheSameKeys) {
  const auto text = read_text(ISOPHOTE_SOURCE_DIR "/scenes/scene.schema.json");
  ASSERT_TRUE(text);
  const auto schema = nlohmann::json::parse(*text);
  int objects = 0;
  for (const auto& [name, definition] : schema["$defs"].items()) {
    if (!definition.contains("properties")) continue;
    ++objects;
    ASSERT_TRUE(scene_keys().contains(name)) << name;
    EXPECT_EQ(definition["additionalProperties"], false) << name;
    std::set<std::string> in_schema;
    for (const auto& property : definition["properties"].items()) in_schema.insert(property.key());
    EXPECT_EQ(in_schema, std::set<std::string>(scene_keys().at(name).begin(), scene_keys().at(name).end())) << name;
  }
  EXPECT_EQ(objects, static_cast<int>(scene_keys().size()));
  EXPECT_EQ(schema["$defs"]["scene"]["properties"]["shade"]["enum"].size(), kShadeNames.size());
  EXPECT_EQ(schema["$defs"]["camera"]["properties"]["view"]["enum"].size(), kViewNames.size());
}

TEST(SceneFile, RefusalsNamePlaceAndExpectation) {
  const struct {
    std::string text, message;
  } kCases[] = {
      {with_camera(R"({"fvo": 30})"), "scenes/test.json:camera.fvo: unknown key 'fvo'; did you mean 'fov'?"},
      {with_camera(R"({"fov": "wide"})"), "scenes/test.json:camera.fov: found \"wide\", expected a number"},
      {with_camera(R"({"fov": 180})"), "scenes/test.json:camera.fov: found 180, expected an angle from 0.01 to 170 degrees"},
      {with_camera(R"({"view": "tpo"})"),
       "scenes/test.json:camera.view: found \"tpo\", expected iso, front, back, left, right, top or bottom; did you mean 'top'?"},
      {with_camera(R"({"look_from": [0, 0, 1]})"), "scenes/test.json:camera: 'look_from' and 'look_at' belong together"},
      {with_transform(R"({"scale": [1, 0, 1]})"),
       "scenes/test.json:models[0].transform.scale: found a list of 3, expected factors other than 0"},
      {with_transform(R"({"rotate": {"axis": [0, 0, 0], "degrees": 9}})"),
       "scenes/test.json:models[0].transform.rotate.axis: found [0, 0, 0], expected a direction"},
      {with_transform("[{}, 7]"),
       "scenes/test.json:models[0].transform[1]: found 7, expected an object with translate, rotate, scale or matrix"},
      {with_transform(R"({"matrix": [1,0,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1]})"),
       "scenes/test.json:models[0].transform: the transform is singular: it flattens the model"},
      {with_mesh(R"({"tolerance": "1parsec"})"),
       "scenes/test.json:mesh.tolerance: found \"1parsec\", expected a length such as \"0.05mm\", diagonals such as \"1e-4d\", or units of "
       "the models"},
      {with_mesh(R"({"tolerance": 0.1})"), "scenes/test.json:mesh.tolerance: found 0.1, expected a text"},
      {with_mesh(R"({"flat": 1})"), "scenes/test.json:mesh.flat: found 1, expected true or false"},
      {with_mesh(R"({"flta": true})"), "scenes/test.json:mesh.flta: unknown key 'flta'; did you mean 'flat'?"},
      {with_mesh(R"({"flat": true, "terminator_fix": true})"),
       "scenes/test.json:mesh: 'terminator_fix' has no meaning with 'flat', whose triangles are lit by their own normals"},
      {with_mesh("7"), "scenes/test.json:mesh: found 7, expected an object with tolerance, flat or terminator_fix"},
      {R"({"models": [], "models": []})", "scenes/test.json: the key 'models' occurs twice in one object"},
      {R"({"models": []})", "scenes/test.json:models: found a list of 0, expected at least one model"},
      {"{}", "scenes/test.json: the key 'models' is missing"},
  };
  for (const auto& c : kCases) EXPECT_EQ(refusal(c.text), c.message) << c.text;
}

TEST(SceneFile, AMeshIsMadeOnlyWhereItIsAskedFor) {
  EXPECT_FALSE(scene_from_text(R"({"models": [{"file": "a.step"}]})", kFile)->mesh);
  const auto plain = scene_from_text(with_mesh("{}"), kFile),
             told = scene_from_text(with_mesh(R"({"tolerance": "0.5 mm", "flat": true})"), kFile);
  ASSERT_TRUE(plain && plain->mesh && told && told->mesh);
  EXPECT_EQ(plain->mesh->tolerance.value, 1e-4);
  EXPECT_EQ(plain->mesh->tolerance.unit, ToleranceUnit::diagonal);
  EXPECT_EQ(plain->mesh->shading, MeshShading::smooth);
  EXPECT_EQ(told->mesh->tolerance.value, 0.5);
  EXPECT_EQ(told->mesh->tolerance.unit, ToleranceUnit::millimetre);
  EXPECT_EQ(told->mesh->shading, MeshShading::flat);
  EXPECT_EQ(told->mesh->terminator, Terminator::faceted);
}

TEST(SceneFile, SyntaxErrorsGiveLineAndColumn) {
  EXPECT_TRUE(refusal("{\n  \"models\": [,]\n}").starts_with("scenes/test.json:2:14: syntax error")) << refusal("{\n  \"models\": [,]\n}");
}

TEST(SceneFile, TransformsOfAListApplyInOrderAndFilesCountFromTheScene) {
  const auto scene =
      scene_from_text(with_transform(R"([{"scale": 2}, {"rotate": {"axis": [0, 0, 5], "degrees": 90}}, {"translate": [1, 0, 0]}])"), kFile);
  ASSERT_TRUE(scene);
  const Vec3 p = scene->models[0].to_world.point({1, 0, 0});
  EXPECT_NEAR(glm::length(p - Vec3(1, 2, 0)), 0, 4 * kEps);
  EXPECT_EQ(scene->models[0].file, "scenes/a.step");
}

TEST(SceneFile, HexColoursAreSrgb) {
  EXPECT_EQ(*colour_from_hex("#ffffff"), Colour(1.0f));
  EXPECT_NEAR(colour_from_hex("#808080")->r, 0.2158605f, 1e-6f);
  EXPECT_FALSE(colour_from_hex("#12345"));
  EXPECT_FALSE(colour_from_hex("#12345-"));
}

}  // namespace
}  // namespace iso
