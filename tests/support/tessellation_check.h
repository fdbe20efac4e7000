// Everything a tessellated part must keep, as a table of what it does not: topology, folds and overlaps by tess/verify.h, the proven
// bounds, and distances by search (mesh_distance.h).
#pragma once

#include <string>
#include <vector>

#include "tess/tessellate.h"
#include "tests/support/random_shapes.h"

namespace iso::test {

// A promise that a mesh breaks.
struct Defect {
  std::string what;  // "folded", "crack", "bound", "far from surface", ...
  int part = 0, face = -1;
  std::string kind;   // of the face's surface
  double figure = 0;  // how many; distances as a multiple of the tolerance
  std::string where;
};

std::string text_of(const Defect& defect);

// `samples`: of each face and direction.
std::vector<Defect> defects_of(const Part& part, const PartTessellation& made, double tolerance, int samples, Random& random);

}  // namespace iso::test
