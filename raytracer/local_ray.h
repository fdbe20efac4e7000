// A ray in the coordinates of one part, as the solvers want it: starting on or in the part's box, and written as the meet of two planes.
#pragma once

#include "patches/base/vec.h"
#include "raytracer/tracer.h"

namespace iso {

struct LocalRay {
  Vec3 o{0.0}, d{0.0};    // t counts in d
  double inverse_dd = 1;  // 1 / (d . d)
  Vec3 n1{0.0}, n2{0.0};  // unit normals of two planes at right angles that hold the ray
  double d1 = 0, d2 = 0;  // n . o
  double scale = 1;       // size of the numbers involved: rounding errors are a small multiple of scale * epsilon

  double t_of(const Vec3& p) const { return glm::dot(p - o, d) * inverse_dd; }
};

}  // namespace iso
