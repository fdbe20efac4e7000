// No tolerance is absolute: a model a hundred times larger or smaller gives the same hits, scaled. By a transform, and with the geometry
// rewritten by Open CASCADE. What differs must lie where the file's own tolerance decides: at edges, or on grazing rays.
#include <fstream>

#include "raytracer/scene_file.h"
#include "tests/support/brl_cad_models.h"
#include "tests/support/edge_distance.h"
#include "tests/support/load.h"
#include "tests/support/occt_scale.h"
#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"
#include "tests/support/told.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240616;
constexpr double kGrazing = 1e-4;

struct Comparison {
  std::uint64_t rays = 0, equal = 0, hits = 0, grazing = 0, edge = 0, unexplained = 0, met = 0;
  double worst_t = 0;
  Told told;
};

bool passes_an_edge(const TraceScene& scene, const Ray& ray, double loosest) {
  for (const Placed& p : scene.placed) {
    const Affine3 back = inverse(p.to_world);
    const double rounding = std::max(loosest, 1e-11 * p.part->box.diagonal());
    if (test::passes_an_edge(*p.part, back.point(ray.o), glm::normalize(back.vector(ray.d)), rounding)) return true;
  }
  return false;
}

bool grazes(const Tracer& tracer, const Ray& ray, std::span<const Hit> hits) {
  for (const Hit& hit : hits)
    if (hit.status == HitStatus::tangent || std::abs(glm::dot(tracer.surface_point(hit).n, glm::normalize(ray.d))) < kGrazing) return true;
  return false;
}

// The largest tolerance that the file, or its scaled copy, states for an edge, in units of the original.
double loosest_edge(const TraceScene& scene) {
  double most = 0;
  for (const Placed& p : scene.placed)
    for (const Edge& edge : p.part->edges) most = std::max({most, edge.file_tolerance, edge.closing});
  return most;
}

// All hits of the same rays through both; `factor`: how much larger the second one is.
Comparison compare(const Tracer& original, const Tracer& scaled, double factor, int count) {
  Random random(kSeed);
  const Box3 box = original.scene().box();
  const double size = box.diagonal(), loosest = loosest_edge(scaled.scene()) / factor;
  std::vector<Ray> rays, scaled_rays;
  for (int i = 0; i < count; ++i) {
    const Vec3 through = box.lo + box.size() * Vec3(point_in(random, {{0, 0}, {1, 1}}), between(random, 0, 1)),
               d = random_direction(random);
    rays.push_back({through - 1.5 * size * d, d});
    scaled_rays.push_back({factor * rays.back().o, rays.back().d});
  }
  std::vector<Hit> a_hits, b_hits;
  std::vector<std::size_t> a_at, b_at;
  SolverStats stats;
  original.all(rays, a_hits, a_at, stats);
  scaled.all(scaled_rays, b_hits, b_at, stats);
  Comparison c;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::span<const Hit> a(a_hits.data() + a_at[i], a_at[i + 1] - a_at[i]), b(b_hits.data() + b_at[i], b_at[i + 1] - b_at[i]);
    ++c.rays;
    c.hits += a.size();
    c.met += !a.empty();
    bool equal = a.size() == b.size();
    double worst = 0;
    for (std::size_t k = 0; equal && k < a.size(); ++k) worst = std::max(worst, std::abs(b[k].t / factor - a[k].t) / a[k].t);
    if (equal && worst <= 1e-9) {
      ++c.equal;
      c.worst_t = std::max(c.worst_t, worst);
    } else if (grazes(original, rays[i], a) || grazes(scaled, scaled_rays[i], b)) {
      ++c.grazing;
    } else if (passes_an_edge(original.scene(), rays[i], loosest)) {
      ++c.edge;
    } else {
      ++c.unexplained;
      const Ray& r = rays[i];
      std::string text = fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}:", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
      for (const Hit& hit : a) text += fmt::format(" [face {} t {:.17g}]", hit.face, hit.t);
      text += " but";
      for (const Hit& hit : b) text += fmt::format(" [face {} t {:.17g}]", hit.face, hit.t / factor);
      c.told.add([&] { return text; });
    }
  }
  return c;
}

void expect_same(const std::string& name, const Tracer& original, const Tracer& scaled, double factor, int count, double most_exceptions) {
  const Comparison c = compare(original, scaled, factor, count);
  fmt::print(
      "[ measured ] {} x {}: {} rays, {} meet it, {} hits; {} equal (t to {:.2g}); differing: {} grazing, {} past an edge, {} "
      "unexplained\n",
      name, factor, c.rays, c.met, c.hits, c.equal, c.worst_t, c.grazing, c.edge, c.unexplained);
  EXPECT_EQ(c.rays, static_cast<std::uint64_t>(count));
  EXPECT_GE(c.met, c.rays / 10);
  EXPECT_EQ(c.unexplained, 0u);
  EXPECT_LE(static_cast<double>(c.rays - c.equal), most_exceptions * count);
  c.told.fail(fmt::format("{} x {}", name, factor));
}

// Scaling by a transform leaves the part's own numbers alone: hardly a ray may differ. Those that do pass within the gap of an edge, where
// rounding decides whether they meet one of its faces or both.
void by_transform(const std::string& path, int count) {
  const auto model = load(path);
  const Tracer original = tracer_of(model);
  for (const double factor : {0.01, 100.0})
    expect_same(std::filesystem::path(path).filename().string() + " by transform", original,
                tracer_of(model, Affine3{Mat3(factor), Vec3(0.0)}), factor, count, 2e-4);
}

// Rewritten geometry has new roundings, new parameters and tolerances of its own.
void rewritten(const std::string& path, int count) {
  const TemporaryDir folder;
  // The original goes through the same writer, so that the files differ in scale alone.
  const std::string plain = (folder.path() / "plain.step").string();
  ASSERT_EQ(write_scaled_step(path, 1, plain), "");
  const Tracer original = tracer_of(load(plain));
  for (const double factor : {0.01, 100.0}) {
    const std::string file = (folder.path() / fmt::format("scaled-{}.step", factor)).string();
    ASSERT_EQ(write_scaled_step(path, factor, file), "");
    const auto model = load(file);
    ASSERT_TRUE(model);
    const Tracer scaled = tracer_of(model);
    EXPECT_NEAR(scaled.scene().box().diagonal() / factor, original.scene().box().diagonal(), 1e-6 * original.scene().box().diagonal());
    expect_same(std::filesystem::path(path).filename().string() + " rewritten", original, scaled, factor, count, 1e-3);
  }
}

TEST(Scale, SmallModelsByTransform) {
  for (const char* name : {"cad/occt-screw.step", "cad/stepcode-dm1-id-214.stp", "patches/teapot.bpt"}) by_transform(data(name), 20000);
}
// Not the screw: its surfaces of revolution come out of Open CASCADE's transformation as approximations to an absolute tolerance.
TEST(Scale, SmallModelsRewritten) {
  for (const char* name : {"cad/stepcode-dm1-id-214.stp", "cad/occtjs-conical-surface.step", "cad/mayo-issue-332.stp"})
    rewritten(data(name), 20000);
}
// The same text in another unit: the reader multiplies all lengths.
TEST(Scale, OtherUnitsInTheFile) {
  const TemporaryDir folder;
  const auto text = read_text(data("cad/occt-screw.step"));
  ASSERT_TRUE(text);
  const std::string unit = "SI_UNIT(.MILLI.,.METRE.)";
  ASSERT_NE(text->find(unit), std::string::npos);
  const Tracer original = tracer_of(load(data("cad/occt-screw.step")));
  for (const auto& [prefix, factor] : {std::pair(".DECI.", 100.0), std::pair(".CENTI.", 10.0), std::pair(".MICRO.", 1e-3)}) {
    std::string changed = *text;
    for (std::size_t at = 0; (at = changed.find(unit, at)) != std::string::npos; at += unit.size())
      changed.replace(at, unit.size(), std::string("SI_UNIT(") + prefix + ",.METRE.)");
    const auto file = folder.path() / "unit.step";
    std::ofstream(file) << changed;
    expect_same(std::string("occt-screw.step in ") + prefix, original, tracer_of(load(file.string())), factor, 20000, 1e-3);
  }
}

// The models that BRL-CAD was measured on, whose tolerances are absolute.
class BrlCadScaleSlow : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const auto found = path_of(model());
    if (!found) GTEST_SKIP() << model().file << " is in the larger collection, which is not here";
    path = *found;
  }
  const BrlCadModel& model() const { return kBrlCadModels[static_cast<std::size_t>(GetParam())]; }
  std::string path;
};
TEST_P(BrlCadScaleSlow, SameHitsByTransform) { by_transform(path, 100000); }
// Not the screw: Open CASCADE's transformation approximates its surfaces; see OtherUnitsInTheFile.
class BrlCadRewrittenSlow : public BrlCadScaleSlow {};
TEST_P(BrlCadRewrittenSlow, SameHits) { rewritten(path, 100000); }
std::vector<int> all_but_the_screw() {
  std::vector<int> models;
  for (int i = 0; i < static_cast<int>(kBrlCadModels.size()); ++i)
    if (std::string(kBrlCadModels[static_cast<std::size_t>(i)].name) != "screw") models.push_back(i);
  return models;
}
const auto kNames = [](const testing::TestParamInfo<int>& info) {
  std::string name = kBrlCadModels[static_cast<std::size_t>(info.param)].name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
};
INSTANTIATE_TEST_SUITE_P(All, BrlCadScaleSlow, testing::Range(0, static_cast<int>(kBrlCadModels.size())), kNames);
INSTANTIATE_TEST_SUITE_P(All, BrlCadRewrittenSlow, testing::ValuesIn(all_but_the_screw()), kNames);

}  // namespace
}  // namespace iso::test
