// Rays that answer wrongly, counted in two steps: Open CASCADE's mesh of the same file, traced by Embree, finds the candidates, and roots
// by subdivision with a trim decision of their own (reference/trimmed_roots.h) decide each. Some more rays are decided though nobody
// objects.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raytracer/tracer.h"
#include "tests/support/occt_mesh.h"

namespace iso::test {

enum class Ruling : std::uint8_t {
  right,      // the first meeting within the trim loops
  undecided,  // right, or not, by what lies within the gap of an edge or touches: the file's tolerance or rounding decides
  wrong,      // something nearer was passed over, or there is nothing where the hit is
};

struct RayCounts {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t candidates = 0;    // the mesh shows something else than the hit, by more than it was asked to be off at most
  std::uint64_t loose = 0;         // of these: the mesh's triangle is measured to be off by as much as they differ
  std::uint64_t mesh_wrong = 0;    // of these: decided for the hit, beyond doubt
  std::uint64_t undecided = 0;     // of these
  std::uint64_t lost = 0;          // wrong, of these: a miss, or a hit behind the first one
  std::uint64_t extra = 0;         // wrong, of these: a hit before the first one, or where there is none
  std::uint64_t sampled = 0;       // decided though the mesh agrees
  std::uint64_t sample_wrong = 0;  // of these
  std::vector<std::string> told;   // the first few wrong and undecided ones, in full

  std::uint64_t wrong() const { return lost + extra + sample_wrong; }
};

// Through a random point of the box, in a random direction, from outside.
std::vector<Ray> rays_through(const Box3& box, std::uint64_t seed, std::size_t count);

class RayJudge {
 public:
  RayJudge(OcctMesh mesh, const Tracer& tracer);  // the tracer must outlive it
  ~RayJudge();

  // Decides candidates, and one ray in `sample_step`.
  RayCounts count(std::span<const Ray> rays, std::span<const Hit> hits, std::size_t sample_step) const;

  Ruling decide(const Ray& ray, const Hit& hit) const;  // unit direction
  const OcctMesh& mesh() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Every face belongs to a solid, and every edge joins two faces: what a ray enters it leaves.
bool is_closed(const TraceScene& scene);

}  // namespace iso::test
