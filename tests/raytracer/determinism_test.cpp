// Hits do not depend on how rays are batched, ordered, or spread over threads: equal to the last bit.
#include <cstring>
#include <thread>

#include "tests/support/load.h"
#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240614;

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }
bool same(const Hit& a, const Hit& b) {
  return same_bits(a.t, b.t) && same_bits(a.uv.x, b.uv.x) && same_bits(a.uv.y, b.uv.y) && a.placed == b.placed && a.face == b.face &&
         a.status == b.status && a.by_tolerance == b.by_tolerance && a.steps == b.steps;
}
std::string text(const Hit& h) {
  return fmt::format("t {:.17g} uv ({:.17g}, {:.17g}) part {} face {} status {} by_tolerance {} steps {}", h.t, h.uv.x, h.uv.y, h.placed,
                     h.face, int(h.status), h.by_tolerance, h.steps);
}

// A picture's rays (neighbours are neighbours), then as many random ones.
std::vector<Ray> mixed_rays(const Box3& box, int side, Random& random) {
  std::vector<Ray> rays;
  const Vec3 d = glm::normalize(Vec3(-1, -0.7, -0.4)), right = glm::normalize(glm::cross(d, Vec3(0, 0, 1))), up = glm::cross(right, d);
  const double size = box.diagonal();
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      rays.push_back({box.middle() - size * d + size * ((x + 0.5) / side - 0.5) * right + size * ((y + 0.5) / side - 0.5) * up, d});
  for (int i = side * side; i > 0; --i) rays.push_back(random_ray(random, box.middle(), 0.5 * size));
  return rays;
}

void check_order(const std::string& name, const Tracer& tracer) {
  Random random(kSeed);
  const std::vector<Ray> rays = mixed_rays(tracer.scene().box(), 100, random);
  Tally tally(name, kSeed);
  SolverStats stats;
  std::vector<Hit> first(rays.size());
  tracer.nearest(rays, first, Tracer::Order::coherent, stats);
  const auto compare = [&](std::size_t ray, const Hit& hit, const char* how) {
    tally.check(same(hit, first[ray]), [&] { return fmt::format("ray {} {}: {}; first {}", ray, how, text(hit), text(first[ray])); });
  };

  std::vector<Hit> again(rays.size());
  tracer.nearest(rays, again, Tracer::Order::scattered, stats);
  for (std::size_t i = 0; i < rays.size(); ++i) compare(i, again[i], "scattered");

  std::vector<std::size_t> order(rays.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  std::vector<Ray> shuffled;
  for (const std::size_t i : order) shuffled.push_back(rays[i]);
  tracer.nearest(shuffled, again, Tracer::Order::coherent, stats);
  for (std::size_t i = 0; i < rays.size(); ++i) compare(order[i], again[i], "shuffled");

  for (std::size_t i = 0; i < rays.size(); ++i) tracer.nearest({&rays[i], 1}, {&again[i], 1}, Tracer::Order::coherent, stats);
  for (std::size_t i = 0; i < rays.size(); ++i) compare(i, again[i], "alone");

  std::vector<std::thread> threads;
  std::array<SolverStats, 4> their_stats;
  for (std::size_t k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      for (std::size_t i = 37 * k; i < rays.size(); i += 4 * 37) {
        const std::size_t n = std::min<std::size_t>(37, rays.size() - i);
        tracer.nearest({&rays[i], n}, {&again[i], n}, Tracer::Order::coherent, their_stats[k]);
      }
    });
  for (std::thread& t : threads) t.join();
  for (std::size_t i = 0; i < rays.size(); ++i) compare(i, again[i], "in four threads");

  std::vector<std::uint8_t> blocked(rays.size());
  for (const auto how : {Tracer::Order::coherent, Tracer::Order::scattered}) {
    tracer.occluded(rays, blocked, how, stats);
    for (std::size_t i = 0; i < rays.size(); ++i)
      tally.check((blocked[i] != 0) == bool(first[i]),
                  [&] { return fmt::format("ray {} blocked: {}, {}", i, blocked[i], text(first[i])); });
  }
  std::vector<Hit> all;
  std::vector<std::size_t> offsets;
  tracer.all(rays, all, offsets, stats);
  std::uint64_t met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool any = offsets[i + 1] > offsets[i];
    met += any;
    tally.check(any == bool(first[i]) && (!any || same(all[offsets[i]], first[i])), [&] {
      return fmt::format("ray {}: first of all is {}; nearest {}", i, any ? text(all[offsets[i]]) : "none", text(first[i]));
    });
    bool rising = true;
    for (std::size_t k = offsets[i]; k + 1 < offsets[i + 1]; ++k) rising = rising && all[k].t <= all[k + 1].t;
    tally.check(rising, [&] { return fmt::format("ray {}: hits are not in order", i); });
  }
  EXPECT_GE(met, rays.size() / 10) << name << ": too few rays hit";
  tally.finish(rays.size() * 8);
}

TEST(Determinism, TeaSet) { check_order("teapot", tracer_of(load(data("patches/teapot.bpt")))); }
TEST(Determinism, Screw) { check_order("screw", tracer_of(load(data("cad/occt-screw.step")))); }
TEST(Determinism, AssemblyOfSplines) { check_order("dm1", tracer_of(load(data("cad/stepcode-dm1-id-214.stp")))); }
TEST(Determinism, FarFromTheOrigin) { check_order("far screw", tracer_of(load(data("cad/far-screw-placed.brep")))); }
TEST(Determinism, TorusOfBezierPieces) { check_order("torus", Tracer(one_face(Torus{}, natural_domain(Torus{})))); }

// Rays that begin or end on a hit: tmin and tmax are part of the interval, and the hits between are those of the whole ray.
TEST(Determinism, PartsOfRaysHaveTheHitsOfTheWhole) {
  Random random(kSeed + 1);
  const Tracer tracer = tracer_of(load(data("cad/occt-screw.step")));
  const Box3 box = tracer.scene().box();
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i) rays.push_back(random_ray(random, box.middle(), 0.5 * box.diagonal()));
  std::vector<Hit> whole_hits, part_hits;
  std::vector<std::size_t> whole_offsets, part_offsets;
  SolverStats stats;
  tracer.all(rays, whole_hits, whole_offsets, stats);
  std::vector<Ray> parts = rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    double a = between(random, 0, 4 * box.diagonal()), b = between(random, 0, 4 * box.diagonal());
    parts[i].tmin = std::min(a, b);
    parts[i].tmax = std::max(a, b);
  }
  tracer.all(parts, part_hits, part_offsets, stats);
  Tally tally("parts of rays", kSeed + 1);
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    std::vector<Hit> expected;
    bool near_end = false;
    for (std::size_t k = whole_offsets[i]; k < whole_offsets[i + 1]; ++k) {
      const double t = whole_hits[k].t, rounding = 1e-12 * box.diagonal();
      near_end = near_end || std::abs(t - parts[i].tmin) < rounding || std::abs(t - parts[i].tmax) < rounding;
      if (t >= parts[i].tmin && t <= parts[i].tmax) expected.push_back(whole_hits[k]);
    }
    if (near_end) continue;
    bool equal = part_offsets[i + 1] - part_offsets[i] == expected.size();
    for (std::size_t k = 0; equal && k < expected.size(); ++k) {
      const Hit& got = part_hits[part_offsets[i] + k];
      equal = got.face == expected[k].face && std::abs(got.t - expected[k].t) < 1e-11 * box.diagonal();
    }
    hits += expected.size();
    tally.check(equal, [&] {
      return fmt::format("ray {}: {} hits in the part, expected {}", i, part_offsets[i + 1] - part_offsets[i], expected.size());
    });
  }
  EXPECT_GE(hits, 2000u);
  tally.finish(rays.size());
}

}  // namespace
}  // namespace iso::test
