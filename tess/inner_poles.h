// Points in which a surface meets itself inside a face. A torus of two equal radii shrinks to its middle along a whole line of the
// parameters (v = pi), and where a face goes on across that line no edge of the model marks it.
#pragma once

#include "patches/brep.h"

namespace iso {

struct Boundary;

// Adds such lines as collapsed edges that the face uses twice, there and back, so that the line is kept free of triangles and all of it is
// one vertex: between vertices of the face's loops that lie on the line, where all between them is inside. For a boundary whose vertices
// are not numbered yet. Faces whose loops meet the line elsewhere stay as they are.
void add_inner_poles(const Part& part, Boundary& boundary);

}  // namespace iso
