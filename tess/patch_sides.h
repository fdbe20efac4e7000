// Which sides and corners the patches of a part share.
#pragma once

#include <vector>

#include "patches/base/result.h"
#include "patches/brep.h"

namespace iso {

// The patches of a part: patch p has the faces first_face[p] .. first_face[p] + sides - 1, its charts.
struct PartPatches {
  std::vector<NSidedPatch> patches;
  std::vector<std::size_t> first_face;
};
// Error: a face that is no chart, or charts that are not the corners of one patch in order.
Result<PartPatches> patches_of(const Part& part);

struct PatchSides {
  struct Side {
    int users = 0;
    bool degenerate = false;  // a point in space
  };
  std::vector<Side> sides;
  struct Use {
    int side = 0;
    bool backward = false;
  };
  std::vector<std::vector<Use>> of_patch;   // [patch][side]: from v_(side-1) to v_side
  std::vector<std::vector<int>> corner_of;  // [patch][corner]: a number that all patches have for the same point
  int corners = 0;
};
// By the edges that the loops of the charts name: a side is a pair of half sides. Sides without edges are of one patch each.
PatchSides sides_of(const Part& part, const PartPatches& patches);

}  // namespace iso
