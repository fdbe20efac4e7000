// Hits do not depend on the instruction set. Whichever Embree walks its tree with, in packets with idle lanes, alone and for occlusion,
// they are the same to the last bit. Those that the kernels are compiled for differ by rounding (some have fused multiplication and
// addition, some have not); where the nearest hits differ by more, the ray grazes, or two faces meet there.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/closed_surfaces.h"
#include "tests/support/edge_distance.h"
#include "tests/support/instruction_set.h"
#include "tests/support/load.h"
#include "tests/support/residuals.h"
#include "tests/support/told.h"

namespace iso::test {
namespace {

constexpr int kRays = 20005;  // leaves packets part empty

struct Answers {
  std::vector<Hit> coherent, scattered;
  std::vector<std::uint8_t> blocked;
};

Answers trace(const Tracer& tracer, const std::vector<Ray>& rays) {
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

struct Subject {
  std::string name;
  TraceScene scene;
  std::vector<Ray> rays;
};

// One part (traced directly) and an assembly of eighteen placements (traced through the top level), closed forms, trims, and smooth
// patches.
std::vector<Subject> subjects() {
  std::vector<Subject> out;
  for (const char* name : {"patches/teapot.bpt", "cad/stepcode-as1-oc-214.stp", "cad/occt-screw.step"}) {
    out.push_back({name, {}, {}});
    add_model(out.back().scene, load(data(name)), Affine3{});
  }
  for (const int index : {1, 2, 3}) {
    const ClosedSurface s = closed_surface(index);
    out.push_back({s.name, one_face(s.surface, s.domain), {}});
  }
  for (Subject& s : out) {
    std::mt19937_64 random(3);
    for (int i = 0; i < kRays; ++i) s.rays.push_back(random_ray(random, s.scene.box().middle(), 0.5 * s.scene.box().diagonal()));
  }
  return out;
}

TEST(InstructionSets, OfEmbreeGiveTheSameHits) {
  for (const Subject& s : subjects()) {
    const Answers plain = trace(Tracer(s.scene), s.rays);
    std::size_t hits = 0;
    for (const char* device : {"isa=sse2", "isa=sse4.2", "isa=avx2"}) {
      const Answers other = trace(Tracer(s.scene, device), s.rays);
      for (std::size_t i = 0; i < s.rays.size(); ++i) {
        ASSERT_TRUE(same(plain.coherent[i], other.coherent[i]) && same(plain.coherent[i], other.scattered[i]))
            << s.name << " " << device << " ray " << i;
        ASSERT_EQ(plain.blocked[i], other.blocked[i]) << s.name << " " << device << " ray " << i;
        ASSERT_EQ(plain.blocked[i] != 0, static_cast<bool>(plain.coherent[i])) << s.name << " ray " << i;
        hits += plain.blocked[i];
      }
    }
    EXPECT_GT(hits, s.rays.size() / 4) << s.name;
  }
}

constexpr double kRounding = 1e-12;  // of the size: what t, and the points of (u, v), may differ by
constexpr double kMeet = 1e-9;       // of the size: hits this near to each other may be one crossing on the faces of an edge

// What became of a ray under two instruction sets.
struct Differences {
  std::uint64_t rays = 0, hits = 0, to_last_bit = 0, grazing = 0, faces_meet = 0, at_border = 0, unexplained = 0;
  double t = 0, uv = 0;  // largest, of the size
  Told told;
};

// The distance that (u, v) moves a hit by.
double apart(const SurfacePoint& at, const Hit& a, const Hit& b) {
  const Vec2 d = a.uv - b.uv;
  return std::max(glm::length(at.Su) * std::abs(d.x), glm::length(at.Sv) * std::abs(d.y));
}

// Whether a trimmed face's loop, or the end of its domain, passes within kMeet of the hit.
bool at_border(const Tracer& tracer, const Ray& ray, double size) {
  for (const Placed& p : tracer.scene().placed) {
    const Affine3 back = inverse(p.to_world);
    if (passes_an_edge(*p.part, back.point(ray.o), glm::normalize(back.vector(ray.d)), kMeet * size)) return true;
  }
  return false;
}

void compare(const Tracer& tracer, const Ray& ray, const Hit& a, const Hit& b, double size, Differences& sum) {
  ++sum.rays;
  if (same(a, b)) {
    sum.hits += a ? 1 : 0;
    ++sum.to_last_bit;
    return;
  }
  const bool grazes =
      (a && std::abs(cosine_at(tracer, a, ray)) <= kGrazingCosine) || (b && std::abs(cosine_at(tracer, b, ray)) <= kGrazingCosine);
  if (a && b && a.placed == b.placed && a.face == b.face) {
    const double t = std::abs(a.t - b.t) * glm::length(ray.d) / size, uv = apart(tracer.surface_point(a), a, b) / size;
    if (t <= kRounding && uv <= kRounding) {
      ++sum.hits;
      sum.t = std::max(sum.t, t);
      sum.uv = std::max(sum.uv, uv);
      return;
    }
  }
  if (grazes)
    ++sum.grazing;
  else if (a && b && std::abs(a.t - b.t) * glm::length(ray.d) <= kMeet * size)
    ++sum.faces_meet;  // two faces, or two ends of a seam
  else if (at_border(tracer, ray, size))
    ++sum.at_border;
  else {
    ++sum.unexplained;
    sum.told.add([&] {
      return fmt::format("t {:.17g} face {} uv {:.17g} {:.17g}; t {:.17g} face {} uv {:.17g} {:.17g}; {}", a.t, a.face, a.uv.x, a.uv.y, b.t,
                         b.face, b.uv.x, b.uv.y, text_of(ray));
    });
  }
}

TEST(InstructionSets, OfTheKernelsDifferByRounding) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  EXPECT_GE(targets.size(), 2u) << "nothing to compare";
  for (const Subject& s : subjects()) {
    const Tracer tracer(s.scene);
    const double size = s.scene.box().diagonal();
    const Answers plain = trace(tracer, s.rays);
    std::size_t sets_that_differ = 0;
    for (const std::int64_t target : targets) {
      const KernelsFor kernels(target);
      const Answers other = trace(tracer, s.rays);
      Differences sum;
      for (std::size_t i = 0; i < s.rays.size(); ++i) {
        compare(tracer, s.rays[i], plain.coherent[i], other.coherent[i], size, sum);
        ASSERT_TRUE(same(other.coherent[i], other.scattered[i])) << s.name << " " << hwy::TargetName(target) << " ray " << i;
        ASSERT_EQ(other.blocked[i] != 0, static_cast<bool>(other.coherent[i])) << s.name << " " << hwy::TargetName(target) << " ray " << i;
      }
      sets_that_differ += sum.to_last_bit < sum.rays;
      fmt::print(
          "[ measured ] {}, {}: {} rays, {} the same to the last bit, others by at most {:.2g} of the size in t and {:.2g} in (u, v); but "
          "for "
          "{} that graze, {} where faces meet, {} at a border, {} unexplained\n",
          s.name, hwy::TargetName(target), sum.rays, sum.to_last_bit, sum.t, sum.uv, sum.grazing, sum.faces_meet, sum.at_border,
          sum.unexplained);
      EXPECT_GT(sum.hits, sum.rays / 4) << s.name;
      EXPECT_EQ(sum.unexplained, 0u) << s.name << " " << hwy::TargetName(target);
      EXPECT_LE(sum.grazing + sum.faces_meet + sum.at_border, sum.rays / 2000) << "few, explained or not: " << s.name;
      sum.told.fail(s.name + " " + hwy::TargetName(target));
    }
    // Rounding shows that the kernels were switched at all.
    EXPECT_GE(sets_that_differ, 1u) << s.name;
  }
}

}  // namespace
}  // namespace iso::test
