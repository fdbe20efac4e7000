// Patches with any number of sides as a part: for each patch one face per corner (its charts, patches/surface/patch_chart.h), and the edges
// they share: half sides of the polygons, from a corner to the middle of a side, and spokes, from there to the patch's centre.
//
// Each face has the domain [0, 1]^2 and one loop of its four straight sides, counter-clockwise from the corner: t = 0, s = 1, t = 1,
// s = 0. All uses of an edge run the same way in space: half sides away from their corners, spokes toward the centre.
//
// Which sides are one. Between patches that say which vertices their corners are, by these: a side is the unordered pair of its vertices,
// and its curves are taken for the same without a look (`finish` measures the gap). Between the others, by place: the control points of the
// two boundary curves, raised to one degree, differ by no more than kSameSide of the size of all patches, in either direction. More than
// two uses of a side (non-manifold) are one edge with as many. A side that is a point is no one's neighbour, and its edges are degenerate.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/surface/patch_chart.h"

namespace iso {

inline constexpr double kSameSide = 1e-6;  // what six digits of a file keep

// A patch and what a file says about it.
struct PatchEntry {
  NSidedPatch patch;               // problem_of(patch) is empty
  std::vector<long long> corners;  // numbers of the vertices, as many as sides; empty: not known
  std::optional<Colour> colour;    //
  std::string name;                // empty: "patch 17", counted from 1
  double approximation_error = 0;  // world units; > 0 where the file's patch had to be approximated
};

// Entry of patch p, corner k: first_chart[p] + k.
struct PatchEdges {
  std::vector<Edge> edges;                   // with their uses; not measured
  std::vector<std::size_t> first_chart{0};   // one more than patches
  std::vector<std::array<int, 4>> of_chart;  // edges in the order of the loop
  std::vector<int> solid_of_patch;           // see Face::solid: connected, every side used twice, in opposite directions; else -1
  int solids = 0;
};
PatchEdges edges_of_patches(const std::vector<PatchEntry>& patches);

// Faces in the order of patches and corners, named "patch 17, corner 2". `finish` has not been called.
Part part_of_patches(std::string name, const std::vector<PatchEntry>& patches);

}  // namespace iso
