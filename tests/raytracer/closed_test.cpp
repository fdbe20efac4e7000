// Nothing gets through a closed surface: each ray from inside hits its back, each ray from outside that is aimed at it hits its front, and
// the hits lie on the surface to rounding. $ISOPHOTE_RAYS sets the number of rays per surface of the slow suite.
#include "tests/support/closed_surfaces.h"
#include "tests/support/residuals.h"
#include "tests/support/told.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240701;
constexpr std::uint64_t kChunk = 8192;

struct Found {
  std::uint64_t inside = 0, outside = 0, missed = 0, wrong_side = 0, far = 0, grazing = 0, orders_differ = 0;
  Residuals residuals;
  SolverStats stats;
  Told told;

  void tell(const char* what, const Ray& ray, const Hit& hit) {
    told.add([&] {
      return fmt::format("{}: t {:.17g} uv {:.17g} {:.17g} status {}, {}", what, hit.t, hit.uv.x, hit.uv.y, int(hit.status), text_of(ray));
    });
  }
  void add(const Found& o) {
    inside += o.inside;
    outside += o.outside;
    missed += o.missed;
    wrong_side += o.wrong_side;
    far += o.far;
    grazing += o.grazing;
    orders_differ += o.orders_differ;
    residuals.add(o.residuals);
    stats += o.stats;
    told.add(o.told);
  }
};

// From the free surroundings of the core, or from 1e-7 .. 1 of the way to it below a point of the surface.
Ray from_inside(const ClosedSurface& s, Random& random) {
  const Vec3 d = random_direction(random), on = s.at(point_in(random, s.domain)), core = s.core_near(on);
  if (random() % 2) return {core + s.reach * std::cbrt(between(random, 0, 1)) * random_direction(random), d};
  return {on + std::pow(10.0, between(random, -7, 0)) * (core - on), d};
}

struct Aimed {
  Ray ray;
  double target = 0;  // in t
};
Aimed from_outside(const ClosedSurface& s, Random& random) {
  const double target = 2 * s.size;
  const Vec3 d = random_direction(random);
  return {{s.at(point_in(random, s.domain)) - target * d, d}, target};
}

bool same(const Hit& a, const Hit& b) {
  return a.placed == b.placed && a.face == b.face && a.t == b.t && a.uv == b.uv && a.status == b.status;
}

// Even rays start inside, odd ones outside.
Found chunk(const ClosedSurface& s, const Tracer& tracer, std::uint64_t number) {
  Random random(kSeed + number);
  Found f;
  std::vector<Ray> rays;
  std::vector<double> targets;
  for (std::uint64_t i = 0; i < kChunk; ++i) {
    const Aimed aimed = i % 2 ? from_outside(s, random) : Aimed{from_inside(s, random), kInf};
    rays.push_back(aimed.ray);
    targets.push_back(aimed.target);
  }
  std::vector<Hit> hits(rays.size()), others(rays.size());
  const bool coherent = number % 2;
  tracer.nearest(rays, hits, coherent ? Tracer::Order::coherent : Tracer::Order::scattered, f.stats);
  // One chunk in eight is traced in both orders.
  const bool both = number % 8 == 0;
  if (both) tracer.nearest(rays, others, coherent ? Tracer::Order::scattered : Tracer::Order::coherent, f.stats);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool outside = i % 2;
    ++(outside ? f.outside : f.inside);
    if (both && !same(hits[i], others[i])) {
      ++f.orders_differ;
      f.tell("coherent and scattered differ", rays[i], hits[i]);
    }
    if (!hits[i]) {
      ++f.missed;
      f.tell(outside ? "missed from outside" : "missed from inside", rays[i], hits[i]);
      continue;
    }
    const SurfacePoint at = tracer.surface_point(hits[i]);
    const double cosine = glm::dot(s.outward(at.n, at.p), rays[i].d);
    f.residuals.add(tracer, rays[i], hits[i], cosine, s.size);
    if (hits[i].t > targets[i] + 1e-6 * s.size) {
      ++f.far;
      f.tell("hit behind its target", rays[i], hits[i]);
    }
    if (std::abs(cosine) <= kGrazingCosine)
      ++f.grazing;
    else if ((cosine < 0) != outside) {
      ++f.wrong_side;
      f.tell("hit on the wrong side", rays[i], hits[i]);
    }
  }
  return f;
}

void examine(const ClosedSurface& s, std::uint64_t rays) {
  const Tracer tracer(one_face(s.surface, s.domain));
  const std::uint64_t chunks = (rays + kChunk - 1) / kChunk;
  Found sums[2];
  in_chunks(chunks, [&](std::uint64_t c, std::uint64_t thread) { sums[thread].add(chunk(s, tracer, c)); });
  Found f = sums[0];
  f.add(sums[1]);
  fmt::print(
      "[ measured ] {}: {} rays from inside, {} from outside; missed {}, wrong side {}, behind the target {}, orders differ {}; {} "
      "grazing, "
      "{} fallbacks, {} touching, {} out of budget\n",
      s.name, f.inside, f.outside, f.missed, f.wrong_side, f.far, f.orders_differ, f.grazing, f.stats.fallbacks, f.stats.tangent,
      f.stats.fallback_out_of_budget);
  f.residuals.finish(s.name);
  EXPECT_EQ(f.inside + f.outside, chunks * kChunk);
  EXPECT_EQ(f.missed, 0u) << s.name;
  EXPECT_EQ(f.wrong_side, 0u) << s.name;
  EXPECT_EQ(f.far, 0u) << s.name;
  EXPECT_EQ(f.orders_differ, 0u) << s.name;
  // Those met at a cosine of some 1e-7 use up the budget of parts; they are told as touching.
  EXPECT_LE(f.stats.fallback_out_of_budget, (f.inside + f.outside) / 1000000) << s.name;
  f.told.fail(s.name);
}

class Closed : public testing::TestWithParam<int> {};
class ClosedSlow : public testing::TestWithParam<int> {};
TEST_P(Closed, NoRayGetsThroughOrFindsTheWrongSide) { examine(closed_surface(GetParam()), 50000); }
TEST_P(ClosedSlow, NoneOfAMillionRaysGetsThroughOrFindsTheWrongSide) {
  examine(closed_surface(GetParam()), wanted("ISOPHOTE_RAYS", 1000000));
}
const auto kNames = [](const testing::TestParamInfo<int>& info) { return std::string(kClosedNames[info.param]); };
INSTANTIATE_TEST_SUITE_P(All, Closed, testing::Range(0, kClosedSurfaces), kNames);
INSTANTIATE_TEST_SUITE_P(All, ClosedSlow, testing::Range(0, kClosedSurfaces), kNames);

}  // namespace
}  // namespace iso::test
