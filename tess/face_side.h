// On which side of its border curves a face lies. Readers keep loops as the file has them, so a loop's direction does not tell; even-odd
// counting does, as it does for points (patches/trim.h).
#pragma once

#include <vector>

#include "tess/boundary.h"

namespace iso {

// For each use of a boundary, whether the face lies left of its curve in the (u, v) plane, run through in the direction of rising shares.
// Rays go from five places of a use, across it, and count the loops as polylines that they cross; most of the five decide. Where a border
// runs back over itself (a slit) both sides are the face, and the answer is either.
std::vector<bool> lies_left(const Part& part, const Boundary& boundary);

}  // namespace iso
