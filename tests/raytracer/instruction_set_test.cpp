// Hits are the same to the last bit whichever instruction set Embree walks its tree with, in packets with idle lanes, alone and for
// occlusion.
#include <gtest/gtest.h>

#include <cstring>

#include "patches/io/read_model.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace iso::test {
namespace {

struct Answers {
  std::vector<Hit> coherent, scattered;
  std::vector<std::uint8_t> blocked;
};

Answers trace(const TraceScene& scene, const std::vector<Ray>& rays, const std::string& device) {
  const Tracer tracer(scene, device);
  Answers a{std::vector<Hit>(rays.size()), std::vector<Hit>(rays.size()), std::vector<std::uint8_t>(rays.size())};
  SolverStats stats;
  tracer.nearest(rays, a.coherent, Tracer::Order::coherent, stats);
  tracer.nearest(rays, a.scattered, Tracer::Order::scattered, stats);
  tracer.occluded(rays, a.blocked, Tracer::Order::coherent, stats);
  return a;
}

bool same(const Hit& a, const Hit& b) {
  return std::memcmp(&a.t, &b.t, sizeof a.t) == 0 && a.uv == b.uv && a.placed == b.placed && a.face == b.face;
}

// One part (traced directly) and an assembly of eighteen placements (traced through the top level). Ray counts that leave packets part
// empty.
TEST(InstructionSets, GiveTheSameHits) {
  for (const char* name : {"patches/teapot.bpt", "cad/stepcode-as1-oc-214.stp"}) {
    const auto model = read_model(data(name));
    ASSERT_TRUE(model) << model.error().text();
    TraceScene scene;
    add_model(scene, std::make_shared<const Model>(*model), Affine3{});
    std::mt19937_64 random(3);
    std::vector<Ray> rays;
    for (int i = 0; i < 20005; ++i) rays.push_back(random_ray(random, scene.box().middle(), 0.5 * scene.box().diagonal()));
    const Answers plain = trace(scene, rays, "");
    std::size_t hits = 0;
    for (const char* device : {"isa=sse2", "isa=sse4.2", "isa=avx2"}) {
      const Answers other = trace(scene, rays, device);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(same(plain.coherent[i], other.coherent[i]) && same(plain.coherent[i], other.scattered[i]))
            << name << " " << device << " ray " << i;
        ASSERT_EQ(plain.blocked[i], other.blocked[i]) << name << " " << device << " ray " << i;
        ASSERT_EQ(plain.blocked[i] != 0, static_cast<bool>(plain.coherent[i])) << name << " ray " << i;
        hits += plain.blocked[i];
      }
    }
    EXPECT_GT(hits, rays.size() / 4) << name;
  }
}

}  // namespace
}  // namespace iso::test
