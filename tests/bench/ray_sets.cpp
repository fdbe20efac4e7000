#include "tests/bench/ray_sets.h"

#include <numeric>
#include <random>

#include "raytracer/framing.h"
#include "raytracer/sampling.h"

namespace iso::bench {
namespace {

constexpr int kBlock = 4;
constexpr int kBatch = kBlock * kBlock;

FloatRay as_float(const Ray& ray) { return {.o = glm::vec3(ray.o), .d = glm::vec3(ray.d), .tmax = static_cast<float>(ray.tmax)}; }

}  // namespace

RaySet primary_rays(const Tracer& tracer, int count) {
  const int blocks = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(count) / kBatch))));
  const ImageSize size{blocks * kBlock, blocks * kBlock};
  const Camera camera = frame_model(tracer, View::iso, Projection::perspective, kDefaultFov, size);
  RaySet set{.name = "primary", .direct = {}, .triangles = {}};
  for (int block = 0; block < blocks * blocks; ++block)
    for (int pixel = 0; pixel < kBatch; ++pixel) {
      const int x = block % blocks * kBlock + pixel % kBlock, y = block / blocks * kBlock + pixel / kBlock;
      set.direct.push_back(camera_ray(camera, size, x + 0.5, y + 0.5));
      set.triangles.push_back(as_float(set.direct.back()));
    }
  return set;
}

SecondaryRays::SecondaryRays(const Tracer& tracer, const EmbreeTriangles& triangles, const TriangleMesh& mesh, const RaySet& primary)
    : box_(tracer.scene().box()) {
  ISO_CHECK(triangles.build() != Build::grid);
  std::vector<Hit> hits(primary.direct.size());
  std::vector<TriangleHit> triangle_hits(primary.triangles.size());
  SolverStats ignored;
  tracer.nearest(primary.direct, hits, primary.order, ignored);
  triangles.nearest(primary.triangles, triangle_hits, Mode::packets);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i] || !triangle_hits[i]) continue;
    const Ray& ray = primary.direct[i];
    const SurfacePoint at = tracer.surface_point(hits[i]);
    if (!finite(at.n) || !(glm::dot(at.n, at.n) > 0.5)) continue;  // at a point without a normal
    const auto& t = mesh.triangles[triangle_hits[i].primitive];
    const Vec3 cross = glm::cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
    starts_.push_back({hits[i], at, glm::dot(at.n, ray.d) > 0 ? -at.n : at.n, ray.o + static_cast<double>(triangle_hits[i].t) * ray.d,
                       glm::normalize(cross), static_cast<std::uint32_t>(i)});
  }
}

// The triangles' ray starts off their plane, on the side of the direction, by what float rounding asks for.
void SecondaryRays::add(RaySet& set, const Start& start, const Vec3& d, double tmax) const {
  constexpr double kOffset = 1e-6;  // of the scene's diagonal: some eight units in the last place
  const double offset = (glm::dot(start.triangle_normal, d) < 0 ? -kOffset : kOffset) * box_.diagonal();
  set.direct.push_back(secondary_ray(start.hit, start.exact, d, tmax));
  set.triangles.push_back(as_float({start.p + offset * start.triangle_normal, d, 0, tmax}));
}

RaySet SecondaryRays::cosine_rays(const char* name, double side) const {
  const Sampler sampler(0, 1);
  RaySet set{.name = name, .incoherent = true, .direct = {}, .triangles = {}};
  for (const Start& start : starts_) {
    const SampleId id{start.ray & 0xffffu, start.ray >> 16, 0};
    add(set, start, cosine_hemisphere(side * start.n, sampler.pair(id, Dimension::sky)), kInf);
  }
  return set;
}

RaySet SecondaryRays::bounce() const { return cosine_rays("bounce", 1); }
RaySet SecondaryRays::room() const { return cosine_rays("room", -1); }

RaySet SecondaryRays::scattered() const {
  const RaySet room = cosine_rays("room", -1);
  RaySet set{.name = "scattered", .order = Tracer::Order::scattered, .direct = {}, .triangles = {}};
  std::vector<std::size_t> order(room.direct.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random(1);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  for (const std::size_t i : order) {
    set.direct.push_back(room.direct[i]);
    set.triangles.push_back(room.triangles[i]);
  }
  return set;
}

RaySet SecondaryRays::occlusion() const {
  const Vec3 light = box_.middle() + box_.diagonal() * glm::normalize(Vec3(1, -0.3, 0.4));  // low and aside, so that it casts shadows
  constexpr double kHorizon = 0.01;                                                         // below it the facets' own shadows decide
  RaySet set{.name = "occlusion", .occlusion = true, .direct = {}, .triangles = {}};
  for (const Start& start : starts_) {
    const Vec3 way = light - start.exact.p;
    const Vec3 facet = glm::dot(start.n, start.triangle_normal) < 0 ? -start.triangle_normal : start.triangle_normal;
    if (std::min(glm::dot(way, start.n), glm::dot(way, facet)) > kHorizon * glm::length(way))
      add(set, start, glm::normalize(way), glm::length(way));
  }
  return set;
}

}  // namespace iso::bench
