// What the readers find in real CAD files, against facts that are not ours: faces by kind, solids and free edges as counted with Open
// CASCADE's own tools when the files were collected (tests/data/README.md), sizes by its BRepBndLib::AddOptimal.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <set>

#include "patches/io/model_info.h"
#include "patches/io/read_model.h"
#include "tests/support/model_soundness.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

constexpr long kAny = -1;

struct Fact {
  const char* file;
  const char* kinds;  // in alphabetical order, as placed; offset surfaces become NURBS
  long solids, free_edges;
  Vec3 size;  // millimetres for STEP and IGES
  const char* unit;
  double slack = 0.01;  // how much larger, relative to the largest side, our guaranteed box may be
};

// Where faces without area are dropped, the kinds are those that are left, and edges of the dropped ones may be free.
const Fact kFacts[] = {
    {"afem-simple-wing-openvsp.stp", "nurbs 7", 0, 20, {9774, 15240, 390.3}, "foot"},
    {"axom-revolved-sphere.step", "sphere 1", 1, 0, {10, 10, 10}, "millimetre"},
    {"axom-sliced-cylinder.step", "cylinder 2, plane 3", 1, 0, {100, 200, 137.2}, "centimetre"},
    {"bladex-blade-tip.iges", "nurbs 1", 0, 2, {10.06, 22.47, 4.529}, "mm"},
    {"bladex-shaft.iges", "nurbs 3, revolution 4", 0, 30, {1484, 75.85, 75.85}, "m"},
    {"brlcad-wing128.igs", "nurbs 2", 0, 8, {254, 1270, 25.4}, "inch"},
    {"cadquery-red-cube-blue-cylinder.step", "cylinder 1, plane 8", 2, 0, {25, 10, 10}, "metre"},
    {"dealii-dtmb-5415-bulbous-bow.iges", "nurbs 1", 0, 4, {1049, 314.5, 773.3}, "m", 0.03},
    {"dealii-goteborg-hull.iges", "nurbs 3", 0, 8, {6119, 413.7, 773.3}, "m"},
    {"dealii-goteborg-hull.step", "nurbs 3", 0, 12, {6119, 413.7, 773.3}, "metre"},
    {"dealii-naca-wing.iges", "nurbs 4", 0, 14, {1000, 5000, 120}, "m"},
    {"dealii-wigley-hull.iges", "nurbs 1", 0, 4, {2500, 124.8, 312.5}, "m", 0.03},
    {"far-screw-baked.step", "cone 2, cylinder 1, plane 4, revolution 3", 1, 0, {19.84, 20, 42.3}, "millimetre"},
    {"far-screw-placed.brep", "cone 2, cylinder 1, plane 4, torus 3", 1, 0, {19.84, 20, 42.3}, ""},
    {"mayo-issue-332.stp", "cone 2, cylinder 1, plane 4", 3, 0, {20, 20, 100}, "millimetre"},
    {"nist-mbe-pmi-11.stp", "nurbs 8, plane 2", 1, 0, {63, 63, 3}, "millimetre"},
    {"occt-crank-arm.brep", "cone 5, cylinder 11, nurbs 16, plane 21", 2, 0, {153.9, 40.82, 72}, ""},
    {"occt-screw.step", "cone 2, cylinder 1, plane 4, torus 3", 1, 0, {19.84, 20, 42.3}, "millimetre"},
    {"occt-wing.brep", "nurbs 4", 0, 16, {1.554, 4.75, 0.4768}, ""},
    {"occtjs-conical-surface.step", "cone 1, cylinder 2, plane 2", 1, 0, {7, 27.03, 27.03}, "inch"},
    {"occtjs-cube-face-colours.step", "plane 6", 1, 0, {10, 10, 10}, "millimetre"},
    {"occtjs-cube-in.step", "plane 6", 1, 0, {1000, 1000, 1000}, "inch"},
    {"occtjs-cube-m.step", "plane 6", 1, 0, {1000, 1000, 1000}, "metre"},
    {"occtjs-cube-mm.step", "plane 6", 1, 0, {1000, 1000, 1000}, "millimetre"},
    {"pygem-pipe-hollow.iges", "plane 2, revolution 4", 0, 20, {2000, 2000, 10000}, "m"},
    {"stepcode-as1-oc-214.stp", "nurbs 70, plane 90", 18, 0, {200, 150, 84}, "millimetre"},
    {"stepcode-dm1-id-214.stp", "nurbs 48", 7, 0, {50, 87, 100}, "inch"},
    {"tigl-d150-wing.igs", "nurbs 6, plane 2", 0, 0, {9393, 16960, 1739}, "mm"},
    {"trim-curve-swings.brep", "nurbs 1", 0, 4, {10, 7, 2.469}, "", 0.02},
    {"edge-cases/brep-with-voids.stp", "plane 12", 2, 0, {20, 20, 20}, "millimetre"},
    {"edge-cases/collapsed-wavy-periodic-band.stp", "cylinder 1", 0, 3, {0.8, 0.8, 4.682}, "millimetre"},
    {"edge-cases/conical-closed-edge-band.stp", "cone 1", 0, 3, {24, 24, 2}, "millimetre"},
    {"edge-cases/degenerate-torus-endpoint.stp", "torus 1", 0, 4, {1.976, 2, 0.7887}, "millimetre", 0.25},
    {"edge-cases/degenerate-torus-sheet.stp", "torus 1", 0, 2, {2, 1, 3.464}, "millimetre"},
    {"edge-cases/duplicate-periodic-seam.stp", "cylinder 1, plane 2", 0, 2, {2, 2, 2}, "millimetre"},
    {"edge-cases/exact-distinct-edge-zero-area-face.stp", "plane 4", 1, kAny, {20, 10, 10}, "millimetre"},
    {"edge-cases/four-face-keyhole.stp", "cone 1, cylinder 1, plane 1, torus 1", 0, 12, {0.144, 1.822, 1.822}, "millimetre"},
    {"edge-cases/horn-torus-keyhole.stp", "torus 1", 0, 7, {10, 20, 10}, "millimetre"},
    {"edge-cases/mapped-items.stp", "plane 8", 2, 0, {40, 25, 10}, "millimetre"},
    {"edge-cases/measured-full-period-chain.stp", "sphere 1", 0, 2, {0.2297, 0.4594, 0.4594}, "millimetre"},
    {"edge-cases/multi-edge-conical-cap.stp", "cone 1, plane 1", 0, 8, {24, 24, 12}, "millimetre"},
    {"edge-cases/near-degenerate-nurbs-pole.stp", "nurbs 1", 0, 3, {1000, 1000, 0}, "millimetre"},
    {"edge-cases/negative-spindle-torus.stp", "torus 1", 0, 4, {22, 22, 10.39}, "millimetre"},
    {"edge-cases/neighbor-keyhole-seam.stp", "cone 1, cylinder 1", 0, 2, {1.679, 1.503, 0.8438}, "millimetre"},
    {"edge-cases/nonmanifold-four-use-edge.stp", "cylinder 4", 0, 14, {6.391, 2.845, 10.5}, "millimetre"},
    {"edge-cases/nurbs-native-seam.stp", "nurbs 1", 0, 4, {10, 20, 1}, "millimetre"},
    {"edge-cases/nurbs-terminal-extension.stp", "plane 1", 0, kAny, {1, 1, 0}, "millimetre"},
    {"edge-cases/offset-extrusion.stp", "nurbs 1", 0, 2, {22, 22, 20}, "millimetre"},
    {"edge-cases/offset-revolution.stp", "nurbs 1", 0, 2, {22, 22, 20}, "millimetre"},
    {"edge-cases/offset-vertex-periodic-band.stp", "cylinder 1", 0, 2, {130, 1699, 130}, "millimetre"},
    {"edge-cases/open-nurbs-measured-mismatch.stp", "nurbs 1", 0, 4, {10, 10, 0}, "millimetre"},
    {"edge-cases/periodic-edge-propagation.stp", "nurbs 1, plane 2", 1, 0, {20, 20, 20}, "millimetre"},
    {"edge-cases/permissive-periodic-boundary-inference.stp", "nurbs 1", 0, 3, {20, 20, 20}, "millimetre"},
    {"edge-cases/repeated-distinct-surface-knots.stp", "nurbs 1", 0, 4, {10, 10, 0}, "millimetre"},
    {"edge-cases/two-side-singular-corner.stp", "nurbs 1", 0, 2, {1, 0.5, 0}, "millimetre"},
    {"edge-cases/vertex-loop-spline-pole.stp", "nurbs 1", 0, 1, {10, 10, 10}, "metre"},
};

Model model_of(const std::string& name) {
  auto model = read_model(data("cad/" + name));
  if (model) return std::move(*model);
  ADD_FAILURE() << model.error().text();
  return {};
}

std::string lower(std::string s) {
  for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

std::string kinds_in(const ModelInfo& info) {
  std::map<std::string, long> kinds;
  for (const FaceCount& count : info.kinds) kinds[count.kind] += count.placed;
  std::string text;
  for (const auto& [kind, count] : kinds) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kind, count);
  return text;
}

void expect_size(const Fact& fact, const Box3& box) {
  const Vec3 size = box.hi - box.lo;
  const double largest = std::max({fact.size.x, fact.size.y, fact.size.z});
  // Four digits of the fact are known; the box is guaranteed, so it may be larger but never smaller.
  for (int c = 0; c < 3; ++c) {
    EXPECT_GE(size[c], fact.size[c] * (1 - 5e-4)) << fact.file << ", side " << c;
    EXPECT_LE(size[c], fact.size[c] + fact.slack * largest) << fact.file << ", side " << c;
  }
}

long count_of(const Model& model, const std::string& what) {
  long count = 0;
  for (const Problem& problem : model.problems)
    if (problem.what.find(what) != std::string::npos) count += problem.count;
  return count;
}

TEST(ModelReading, FactsOfEveryFile) {
  std::set<std::string> listed;
  for (const Fact& fact : kFacts) {
    const Model model = model_of(fact.file);
    const ModelInfo info = describe(model);
    EXPECT_EQ(unsound(model), "") << fact.file;
    EXPECT_EQ(kinds_in(info), fact.kinds) << fact.file;
    EXPECT_EQ(info.solids, fact.solids) << fact.file;
    if (fact.free_edges != kAny) {
      EXPECT_EQ(info.edge_uses[1], fact.free_edges) << fact.file;
    }
    EXPECT_EQ(lower(info.file_unit), fact.unit) << fact.file;
    EXPECT_EQ(info.unit, std::string(fact.file).ends_with(".brep") ? "" : "mm") << fact.file;
    expect_size(fact, info.box);
    listed.insert(fact.file);
  }
  for (const auto& path : files_in(data_dir() / "cad", {".step", ".stp", ".iges", ".igs", ".brep"}))
    EXPECT_TRUE(listed.contains(std::filesystem::relative(path, data_dir() / "cad"))) << path << " has no facts here";
  EXPECT_EQ(listed.size(), 56u);
}

TEST(ModelReading, NothingIsDroppedButFacesWithoutArea) {
  long dropped = 0;
  for (const Fact& fact : kFacts)
    for (const Problem& problem : model_of(fact.file).problems) {
      if (problem.kind != Problem::Kind::dropped) continue;
      EXPECT_EQ(problem.what, "it has no area") << fact.file << ", " << problem.entity;
      dropped += problem.count;
    }
  EXPECT_EQ(dropped, 7) << "six in the OpenVSP wing, the one made to have none";
  EXPECT_EQ(count_of(model_of("afem-simple-wing-openvsp.stp"), "no area"), 6);
}

TEST(ModelReading, APartThatIsPlacedOftenIsStoredOnce) {
  const struct {
    const char* file;
    std::size_t parts, instances;
  } kAssemblies[] = {{"stepcode-as1-oc-214.stp", 5, 18},
                     {"stepcode-dm1-id-214.stp", 3, 7},
                     {"edge-cases/mapped-items.stp", 1, 2},
                     {"mayo-issue-332.stp", 3, 3},
                     {"cadquery-red-cube-blue-cylinder.step", 2, 2},
                     {"occt-screw.step", 1, 1}};
  for (const auto& assembly : kAssemblies) {
    const Model model = model_of(assembly.file);
    EXPECT_EQ(model.parts.size(), assembly.parts) << assembly.file;
    EXPECT_EQ(model.instances.size(), assembly.instances) << assembly.file;
  }
}

// as1: a plate, two brackets, three bolts with nuts through each, and a rod with a nut at each end.
TEST(ModelReading, TheAssemblyHasItsPartsNamesAndColours) {
  const Model model = model_of("stepcode-as1-oc-214.stp");
  std::map<std::string, int> placed;
  for (const Instance& instance : model.instances) ++placed[model.parts[static_cast<std::size_t>(instance.part)].name];
  EXPECT_EQ(placed, (std::map<std::string, int>{{"plate", 1}, {"l-bracket", 2}, {"bolt", 6}, {"nut", 8}, {"rod", 1}}));
  EXPECT_EQ(describe(model).colours, 5);
}

TEST(ModelReading, ColoursOfFacesAndParts) {
  EXPECT_EQ(describe(model_of("occtjs-cube-face-colours.step")).colours, 6) << "each face its own";
  EXPECT_EQ(describe(model_of("stepcode-dm1-id-214.stp")).colours, 3);
  EXPECT_EQ(describe(model_of("axom-revolved-sphere.step")).colours, 1);
  EXPECT_EQ(describe(model_of("occt-screw.step")).colours, 0);

  // The red cube and the blue cylinder: the file's colours are sRGB, ours are linear.
  const Model model = model_of("cadquery-red-cube-blue-cylinder.step");
  EXPECT_EQ(describe(model).colours, 2);
  int red = 0, blue = 0;
  for (const Instance& instance : model.instances)
    for (const Face& face : model.parts[static_cast<std::size_t>(instance.part)].faces) {
      const auto colour = face.colour ? face.colour : instance.colour;
      ASSERT_TRUE(colour);
      (colour->r > colour->b ? red : blue) += 1;
    }
  EXPECT_EQ(red, 6);
  EXPECT_EQ(blue, 3);
}

TEST(ModelReading, ACubeOfAMetreMeasuresAMetreInEveryUnit) {
  for (const char* unit : {"mm", "in", "m"}) {
    const Box3 box = box_of(model_of(fmt::format("occtjs-cube-{}.step", unit)));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(box.hi[c] - box.lo[c], 1000, 0.5) << unit;
  }
}

// The hull: three open shells whose only bound is a FACE_BOUND, edges as SURFACE_CURVEs; the same through IGES.
TEST(ModelReading, FacesWithoutOuterBoundOpenShellsAndSurfaceCurvesImportWhole) {
  const Model step = model_of("dealii-goteborg-hull.step"), iges = model_of("dealii-goteborg-hull.iges");
  const ModelInfo info = describe(step);
  EXPECT_EQ(info.faces_placed, 3);
  EXPECT_EQ(info.loops, 3);
  EXPECT_EQ(info.untrimmed, 0);
  EXPECT_TRUE(step.problems.empty());
  const Box3 a = box_of(step), b = box_of(iges);
  EXPECT_LT(glm::length(a.lo - b.lo) + glm::length(a.hi - b.hi), 1e-3 * a.diagonal());

  // The screw: nothing but FACE_BOUNDs, three seam curves; each seam is one edge used twice by its face.
  const Model screw = model_of("occt-screw.step");
  ASSERT_EQ(screw.parts.size(), 1u);
  int seams = 0;
  for (const Face& face : screw.parts[0].faces) {
    std::map<int, int> uses;
    for (const TrimLoop& loop : face.loops)
      for (const TrimCurve& curve : loop.curves) ++uses[curve.edge];
    for (const auto& [edge, count] : uses) seams += edge >= 0 && count == 2;
  }
  EXPECT_EQ(seams, 3);
  EXPECT_EQ(describe(screw).edge_uses[2], 22) << "closed: every edge has two uses";
}

// Optional files of the larger collection.
TEST(ModelReading, TheNacelleImportsWhole) {
  const auto shared = shared_data_dir();
  if (!shared || !std::filesystem::exists(*shared / "cad/tigl-nacelle.stp")) GTEST_SKIP() << "the larger collection is not here";
  const auto model = read_model(*shared / "cad/tigl-nacelle.stp");
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(kinds_in(describe(*model)), "nurbs 6");
  EXPECT_EQ(describe(*model).edge_uses[1], 4);
}

}  // namespace
}  // namespace iso::test
