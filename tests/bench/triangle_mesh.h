// A model as triangles, whoever made them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "patches/base/vec.h"

namespace iso::bench {

struct TriangleMesh {
  std::vector<Vec3> points;  // world
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double error = 0;    // measured, world units: largest distance of the surface's samples from the planes of their triangles
  double seconds = 0;  // CPU time that making it took
};

}  // namespace iso::bench
