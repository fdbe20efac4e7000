// Faces that a part holds twice: files written by more than one program, or pasted together, do. A mesh with both is no manifold, since
// four triangles meet at every side of their border.
#pragma once

#include <vector>

#include "patches/brep.h"

namespace iso {

// For each face the first one that it repeats, or -1. Faces repeat each other if they are of one solid, look to the same side, and lie
// within kSameBorder (join_edges.h) of the part's size of each other: places of their borders, and places inside, which must be inside the
// other too. They may be other surfaces and be parametrised and trimmed in other ways. Faces of two solids that touch, or that look to
// opposite sides, are no copies. About n log n in the number of faces, if few are.
std::vector<int> copied_faces(const Part& part);

}  // namespace iso
