#include "tests/bench/ray_sets.h"

#include "raytracer/framing.h"
#include "raytracer/sampling.h"

namespace iso::bench {
namespace {

constexpr int kBlock = 4;
constexpr int kBatch = kBlock * kBlock;

FloatRay as_float(const Ray& ray) { return {.o = glm::vec3(ray.o), .d = glm::vec3(ray.d)}; }

// Off the triangle's plane, on the side of the direction, by what float rounding asks for.
Vec3 offset_from_triangle(const TriangleMesh& mesh, std::uint32_t index, const Vec3& p, const Vec3& direction, double size) {
  constexpr double kOffset = 1e-6;  // of the scene's diagonal: some eight units in the last place
  const auto& t = mesh.triangles[index];
  const Vec3 n = glm::normalize(glm::cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]));
  return p + (glm::dot(n, direction) < 0 ? -kOffset : kOffset) * size * n;
}

}  // namespace

RaySet primary_rays(const Tracer& tracer, int count) {
  const int blocks = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(count) / kBatch))));
  const ImageSize size{blocks * kBlock, blocks * kBlock};
  const Camera camera = frame_model(tracer, View::iso, Projection::perspective, kDefaultFov, size);
  RaySet set{.name = "primary", .order = Tracer::Order::coherent, .direct = {}, .triangles = {}};
  for (int block = 0; block < blocks * blocks; ++block)
    for (int pixel = 0; pixel < kBatch; ++pixel) {
      const int x = block % blocks * kBlock + pixel % kBlock, y = block / blocks * kBlock + pixel / kBlock;
      set.direct.push_back(camera_ray(camera, size, x + 0.5, y + 0.5));
      set.triangles.push_back(as_float(set.direct.back()));
    }
  return set;
}

RaySet bounce_rays(const Tracer& tracer, const EmbreeTriangles& triangles, const TriangleMesh& mesh, const RaySet& primary) {
  std::vector<Hit> hits(primary.direct.size());
  std::vector<TriangleHit> triangle_hits(primary.triangles.size());
  SolverStats ignored;
  tracer.nearest(primary.direct, hits, primary.order, ignored);
  triangles.nearest(primary.triangles, triangle_hits, primary.order);

  const double size = tracer.scene().box().diagonal();
  const Sampler sampler(0, 1);
  RaySet set{.name = "bounce", .order = Tracer::Order::scattered, .direct = {}, .triangles = {}};
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i] || !triangle_hits[i]) continue;
    const Ray& ray = primary.direct[i];
    const SurfacePoint at = tracer.surface_point(hits[i]);
    if (!finite(at.n) || !(glm::dot(at.n, at.n) > 0.5)) continue;  // at a point without a normal
    const Vec3 n = glm::dot(at.n, ray.d) > 0 ? -at.n : at.n;
    const SampleId id{static_cast<std::uint32_t>(i & 0xffffu), static_cast<std::uint32_t>(i >> 16), 0};
    const Vec3 d = cosine_hemisphere(n, sampler.pair(id, Dimension::sky));
    const Vec3 p = ray.o + static_cast<double>(triangle_hits[i].t) * ray.d;
    set.direct.push_back({offset_origin(at, d), d});
    set.triangles.push_back(as_float({offset_from_triangle(mesh, triangle_hits[i].triangle, p, d, size), d}));
  }
  return set;
}

}  // namespace iso::bench
