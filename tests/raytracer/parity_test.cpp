// A line meets the boundary of a solid an even number of times. Each odd count must be explained: by a hit that touches or all but touches,
// or by an edge that the line passes within the file's tolerance.
#include <thread>

#include "tests/support/edge_distance.h"
#include "tests/support/load.h"
#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"
#include "tests/support/told.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240615;
constexpr double kGrazing = 1e-4;  // cosine between ray and normal below which the parity of the whole ray counts as a graze

struct Parity {
  std::uint64_t rays = 0, hits = 0, met = 0, odd = 0, tangent = 0, by_tolerance = 0, grazing = 0, edge = 0, unexplained = 0;
  Told told;

  void add(const Parity& o) {
    rays += o.rays;
    hits += o.hits;
    met += o.met;
    odd += o.odd;
    tangent += o.tangent;
    by_tolerance += o.by_tolerance;
    grazing += o.grazing;
    edge += o.edge;
    unexplained += o.unexplained;
    told.add(o.told);
  }
};

// The line in the part's own coordinates, where files state their tolerances.
bool passes_an_edge(const TraceScene& scene, const Ray& ray) {
  for (const Placed& p : scene.placed) {
    const Affine3 back = inverse(p.to_world);
    const double rounding = 1e-11 * p.part->box.diagonal();
    if (test::passes_an_edge(*p.part, back.point(ray.o), glm::normalize(back.vector(ray.d)), rounding)) return true;
  }
  return false;
}

void explain(const Tracer& tracer, const Ray& ray, std::span<const Hit> hits, Parity& sum) {
  ++sum.odd;
  for (const Hit& hit : hits)
    if (hit.status == HitStatus::tangent) return void(++sum.tangent);
  for (const Hit& hit : hits)
    if (hit.by_tolerance) return void(++sum.by_tolerance);
  for (const Hit& hit : hits)
    if (std::abs(glm::dot(tracer.surface_point(hit).n, glm::normalize(ray.d))) < kGrazing) return void(++sum.grazing);
  if (passes_an_edge(tracer.scene(), ray)) return void(++sum.edge);
  ++sum.unexplained;
  std::string text = fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}:", ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z);
  for (const Hit& hit : hits)
    text += fmt::format(" [face {} t {:.17g} uv {:.17g} {:.17g} n.d {:.3g}]", hit.face, hit.t, hit.uv.x, hit.uv.y,
                        glm::dot(tracer.surface_point(hit).n, glm::normalize(ray.d)));
  sum.told.add([&] { return text; });
}

// Chunks have seeds of their own, so the rays do not depend on the number of threads.
Parity chunk(const Tracer& tracer, std::uint64_t seed, int count) {
  Random random(seed);
  Parity sum;
  SolverStats stats;
  const Box3 box = tracer.scene().box();
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    // Through two random points of the box, from outside it.
    const Vec3 a = box.lo + box.size() * Vec3(between(random, 0, 1), between(random, 0, 1), between(random, 0, 1)),
               d = random_direction(random);
    rays.push_back({a - 1.5 * box.diagonal() * d, d});
  }
  std::vector<Hit> hits;
  std::vector<std::size_t> offsets;
  tracer.all(rays, hits, offsets, stats);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::span<const Hit> mine(hits.data() + offsets[i], offsets[i + 1] - offsets[i]);
    ++sum.rays;
    sum.hits += mine.size();
    sum.met += !mine.empty();
    if (mine.size() % 2 == 1) explain(tracer, rays[i], mine, sum);
  }
  return sum;
}

void count_parity(const std::string& name, const Tracer& tracer, int rays) {
  constexpr int kChunk = 10000;
  const int chunks = rays / kChunk;
  std::vector<Parity> sums(static_cast<std::size_t>(chunks));
  std::vector<std::thread> threads;
  for (int k = 0; k < 2; ++k)
    threads.emplace_back([&, k] {
      for (int c = k; c < chunks; c += 2) sums[static_cast<std::size_t>(c)] = chunk(tracer, kSeed + static_cast<std::uint64_t>(c), kChunk);
    });
  for (std::thread& t : threads) t.join();
  Parity sum;
  for (const Parity& s : sums) sum.add(s);
  fmt::print(
      "[ measured ] {}: {} rays, {} meet it, {} hits; odd {}: touching {}, by tolerance {}, grazing {}, past an edge {}, unexplained {}\n",
      name, sum.rays, sum.met, sum.hits, sum.odd, sum.tangent, sum.by_tolerance, sum.grazing, sum.edge, sum.unexplained);
  EXPECT_EQ(sum.rays, static_cast<std::uint64_t>(rays));
  EXPECT_GE(sum.met, sum.rays / 10);
  EXPECT_EQ(sum.unexplained, 0u);
  EXPECT_LE(sum.odd, sum.rays / 1000) << "explained or not, that is a sieve";
  sum.told.fail("unexplained");
}

// Parts of the test that must be fast.
TEST(Parity, Sphere) { count_parity("sphere", Tracer(one_face(Sphere{}, natural_domain(Sphere{}))), 200000); }
TEST(Parity, Torus) { count_parity("torus", Tracer(one_face(Torus{}, natural_domain(Torus{}))), 200000); }
TEST(Parity, Screw) { count_parity("screw", tracer_of(load(data("cad/occt-screw.step"))), 200000); }
TEST(Parity, SmallSolids) {
  for (const char* name :
       {"cad/axom-revolved-sphere.step", "cad/occtjs-conical-surface.step", "cad/cadquery-red-cube-blue-cylinder.step",
        "cad/nist-mbe-pmi-11.stp", "cad/mayo-issue-332.stp", "cad/occtjs-cube-mm.step", "cad/edge-cases/brep-with-voids.stp"})
    count_parity(name, tracer_of(load(data(name))), 50000);
}

// Ten million in all.
TEST(ParitySlow, Sphere) { count_parity("sphere", Tracer(one_face(Sphere{}, natural_domain(Sphere{}))), 2000000); }
TEST(ParitySlow, Torus) { count_parity("torus", Tracer(one_face(Torus{}, natural_domain(Torus{}))), 2000000); }
TEST(ParitySlow, Linkrods) { count_parity("linkrods", tracer_of(load(occt_data("step/linkrods.step"))), 2000000); }
TEST(ParitySlow, Bottle) { count_parity("bottle", tracer_of(load(occt_data("occ/bottle.brep"))), 2000000); }
TEST(ParitySlow, Screw) { count_parity("screw", tracer_of(load(occt_data("step/screw.step"))), 2000000); }

}  // namespace
}  // namespace iso::test
