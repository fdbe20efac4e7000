// A model as triangles, whoever made them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "patches/base/vec.h"

namespace iso::bench {

// Some of a mesh's triangles are those of a grid: points first + row * columns + column, each cell divided between the corners
// (row + 1, column) and (row, column + 1), as Embree divides its grids.
struct MeshGrid {
  std::uint32_t first = 0;
  std::uint32_t rows = 0, columns = 0;  // of points
};

struct TriangleMesh {
  std::vector<Vec3> points;  // world
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MeshGrid> grids;  // of all triangles, or of none
  double error = 0;             // measured, world units: largest distance of the surface's samples from the planes of their triangles
  double usual_error = 0;       // the same, of all triangles but one in a hundred
  double seconds = 0;           // CPU time that making it took
};

}  // namespace iso::bench
