// Embree's own triangles: what direct intersection is compared with. Its best side is shown: float rays that are ready for it, the widest
// packets that Embree has instructions for, and no ROBUST flag (the direct side has it). As on the direct side, rays and hits are arrays,
// and moving them to packets and back is part of the time.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>

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
  std::uint32_t primitive = kMiss;  // the triangle; of a grid build, the grid

  static constexpr std::uint32_t kMiss = 0xffffffffu;
  explicit operator bool() const { return primitive != kMiss; }
};

// How the tree is built: triangles at Embree's medium or high quality, or Embree's grids, which are smaller and built faster.
enum class Build { medium, high, grid };
const char* name_of(Build build);

enum class Mode { packets, single };
const char* name_of(Mode mode);

class EmbreeTriangles {
 public:
  // `device`: Embree's own configuration, "isa=avx2" say. Grids are for meshes that have them.
  EmbreeTriangles(const TriangleMesh& mesh, Build build, const std::string& device = {});
  ~EmbreeTriangles();
  EmbreeTriangles(EmbreeTriangles&&) noexcept;

  void nearest(std::span<const FloatRay> rays, std::span<TriangleHit> hits, Mode mode) const;
  void occluded(std::span<const FloatRay> rays, std::span<std::uint8_t> blocked, Mode mode) const;

  Build build() const;
  double build_seconds() const;  // CPU time of the calling thread; one thread, if the caller has limited TBB so
  std::size_t bytes() const;     // points, indices and tree, as Embree counts them

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace iso::bench
