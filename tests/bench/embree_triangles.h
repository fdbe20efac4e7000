// Embree's own triangles: what direct intersection is compared with. Its best side is shown: float rays that are ready for it, packets of
// 16 for neighbouring rays and single rays else, and no ROBUST flag (the direct side has it).
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "raytracer/tracer.h"
#include "tests/bench/triangle_mesh.h"

namespace iso::bench {

struct FloatRay {
  glm::vec3 o{0.0f};
  float tmin = 0;
  glm::vec3 d{0.0f};
  float tmax = std::numeric_limits<float>::infinity();
};
struct TriangleHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kMiss;

  static constexpr std::uint32_t kMiss = 0xffffffffu;
  explicit operator bool() const { return triangle != kMiss; }
};

enum class Build { medium, high };
inline constexpr Build kBuilds[] = {Build::medium, Build::high};
const char* name_of(Build build);

class EmbreeTriangles {
 public:
  EmbreeTriangles(const TriangleMesh& mesh, Build build);
  ~EmbreeTriangles();
  EmbreeTriangles(EmbreeTriangles&&) noexcept;

  void nearest(std::span<const FloatRay> rays, std::span<TriangleHit> hits, Tracer::Order order) const;

  double build_seconds() const;  // CPU time of the calling thread; one thread, if the caller has limited TBB so
  std::size_t bytes() const;     // points, indices and tree, as Embree counts them

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace iso::bench
