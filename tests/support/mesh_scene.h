// Nearest hits of rays with a triangle mesh, by Embree's own triangle intersection: the ray caster of the second opinion.
#pragma once

#include <memory>

#include "raytracer/tracer.h"
#include "tests/support/occt_mesh.h"

namespace iso::test {

struct MeshHit {
  double t = kInf;
  std::int32_t triangle = -1;  // index into OcctMesh::triangles; -1: no hit

  explicit operator bool() const { return triangle >= 0; }
};

// Embree computes in float. The mesh is moved to its middle in double before it is rounded, and rays start where they enter the box, so
// what remains is about 1e-7 of the box's diagonal.
class MeshScene {
 public:
  explicit MeshScene(const OcctMesh& mesh);
  ~MeshScene();
  MeshScene(const MeshScene&) = delete;
  MeshScene& operator=(const MeshScene&) = delete;

  MeshHit nearest(const Ray& ray) const;  // unit direction
  double rounding() const;                // world units: how far a hit may be off by float arithmetic

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace iso::test
