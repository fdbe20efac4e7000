// Where to put the points inside a face: boxes of its parameter plane, each with an even grid just fine enough for the tolerance.
#pragma once

#include <vector>

#include "tess/face_shape.h"

namespace iso {

// A box cut into columns x rows cells; a flat right triangle of half a cell keeps the tolerance.
struct SampleGrid {
  Box2 box;
  int columns = 1, rows = 1;
};

struct SampleGrids {
  std::vector<SampleGrid> grids;  // a cover of the domain; boxes touch at borders only
  Vec2 scale{1.0};                // of u and v: makes the cells about square, in which a triangulation should be Delaunay
};

// Divides a face's domain until the curvature in a box varies too little for another division to pay [Safko 2022, 4.3: a quadtree; here
// boxes are halved in one direction at a time and filled with grids of any number, so that a cylinder is never cut along its axis and no
// power of two is wasted].
SampleGrids sample_grids(const FaceShape& shape, const Box2& domain, double tolerance);

}  // namespace iso
