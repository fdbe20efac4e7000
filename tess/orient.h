// Faces of one shell that look to different sides, as files without topology have them: finds those to be turned.
#pragma once

#include <vector>

#include "patches/triangle_mesh.h"

namespace iso {

struct Orientation {
  std::vector<bool> turned;  // of each face
  int count = 0;             // how many are turned
  int conflicts = 0;         // pairs of neighbours that still look to different sides: the shell has one side only
};

// Faces are neighbours where exactly two triangles meet at a side; they agree if those run through it in opposite directions. Within each
// connected shell whose faces disagree, the faces turned are those that make the enclosed volume positive if it is closed, else the smaller
// number. A shell whose faces agree is left alone, also when it is inside out: voids are.
Orientation orient(const PartMesh& mesh);

// Turns these faces: order of corners and normals.
void turn(PartMesh& mesh, const std::vector<bool>& faces);

}  // namespace iso
