// Where a ray ends behind its nearest hit does not matter to the hit, to the last bit: neither the ray's own end, nor that which a hit
// found earlier puts to it. So the order of the traversal does not matter.
#include "tests/support/closed_surfaces.h"
#include "tests/support/load.h"
#include "tests/support/residuals.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240704;

void examine(const std::string& name, const Tracer& tracer) {
  constexpr std::size_t kRays = 20000;
  const Box3 box = tracer.scene().box();
  Random random(kSeed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < kRays; ++i) rays.push_back(random_ray(random, box.middle(), 0.5 * box.diagonal()));
  std::vector<Hit> open(kRays), ended(kRays);
  SolverStats stats;
  tracer.nearest(rays, open, Tracer::Order::scattered, stats);
  Tally tally(name + ": an end behind the hit does not move it", kSeed);
  std::uint64_t hits = 0;
  for (const double behind : {1e-1, 1e-2, 1e-3, 1e-5, 1e-8}) {
    for (std::size_t i = 0; i < kRays; ++i) rays[i].tmax = open[i] ? open[i].t + behind * box.diagonal() : kInf;
    tracer.nearest(rays, ended, Tracer::Order::scattered, stats);
    for (std::size_t i = 0; i < kRays; ++i) {
      const Hit &a = open[i], &b = ended[i];
      hits += a ? 1 : 0;
      tally.check(a.placed == b.placed && a.face == b.face && a.t == b.t && a.uv == b.uv, [&] {
        return fmt::format("t {:.17g} uv {:.17g} {:.17g} becomes t {:.17g} uv {:.17g} {:.17g} with tmax {:.17g}, {}", a.t, a.uv.x, a.uv.y,
                           b.t, b.uv.x, b.uv.y, rays[i].tmax, text_of(rays[i]));
      });
    }
  }
  EXPECT_GE(hits, kRays) << name;
  tally.finish(5 * kRays);
}

TEST(Limit, BehindTheNearestHitDoesNotMoveIt) {
  examine("teapot", tracer_of(load(data("patches/teapot.bpt"))));
  examine("screw", tracer_of(load(data("cad/occt-screw.step"))));
  for (int i = 0; i < kClosedSurfaces; ++i) {
    const ClosedSurface s = closed_surface(i);
    examine(s.name, Tracer(one_face(s.surface, s.domain)));
  }
}

}  // namespace
}  // namespace iso::test
