// How fast our meshes come near the surface: halving the width of the triangles leaves a quarter of the distance.
#include <gtest/gtest.h>

#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/child.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

// Large models are not in the source tree.
std::optional<std::string> model_at(const std::string& name, const char* of_occt) {
  for (const std::string& at : {data("cad/" + name), shared_data_dir() ? (*shared_data_dir() / "cad" / name).string() : std::string(),
                                occt_data_dir() && *of_occt ? (*occt_data_dir() / of_occt).string() : std::string()})
    if (std::filesystem::exists(at)) return at;
  return {};
}

// The width is the mean height of the triangles over their longest side, by area, on faces that are not planes: where a surface bends one
// way only, triangles are long along the other, and no length of a side tells of the error.
TEST(MeshSlopeSlow, TheRootMeanSquareOfTheDistanceFallsWithTheSquareOfTheTrianglesWidth) {
  const std::pair<const char*, const char*> models[] = {
      {"occt-linkrods.step", "step/linkrods.step"}, {"occt-bottle.brep", "occ/bottle.brep"}, {"occt-propeller.brep", ""}};
  int measured = 0;
  std::string missing;
  for (const auto& [name, of_occt] : models) {
    const auto model = model_at(name, of_occt);
    if (!model) {
      missing += std::string(missing.empty() ? "" : ", ") + name;
      continue;
    }
    const TemporaryDir dir;
    ChildLimits limits;
    limits.seconds = 300;
    const ChildResult result = run_isophote({"compare", *model, "-o", dir.path() / "report", "--tolerances", "1e-2d,3e-3d,1e-3d,3e-4d",
                                             "--reference", "5e-5d", "--no-pictures", "--progress", "none"},
                                            {}, limits);
    ASSERT_EQ(result.code, 0) << result.summary();
    const auto report = nlohmann::json::parse(detail::content_of(dir.path() / "report" / "report.json"));
    ASSERT_EQ(report["meshes"].size(), 4u);
    std::cout << name << ": slope " << report["slope"] << ";";
    double wider = std::numeric_limits<double>::infinity();
    for (const auto& mesh : report["meshes"]) {
      const double width = mesh["width"];
      std::cout << " width " << width << " rms " << mesh["distance"]["rms"] << " (" << mesh["triangles"] << " triangles)";
      EXPECT_LT(width, wider);
      wider = width;
    }
    std::cout << "\n";
    EXPECT_NEAR(report["slope"].get<double>(), 2, 0.3) << name;
    ++measured;
  }
  if (measured == 0) GTEST_SKIP() << "models that are not here: " << missing;
  if (!missing.empty()) std::cout << "models that are not here: " << missing << "\n";
}

}  // namespace
}  // namespace iso::test
