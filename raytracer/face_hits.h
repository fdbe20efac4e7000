// What becomes of hits on exact faces: their surroundings, and whether two of them are one. Knows nothing of Embree.
#pragma once

#include "raytracer/packet.h"

namespace iso {

// The surroundings of a hit on a face of `placed`. `size`: of the part.
SurfacePoint point_on_face(const Placed& placed, const Affine3& to_part, double size, const Hit& hit);

// Of the face at the hit's (u, v), in world coordinates; see Tracer::shape_operator.
Mat3 shape_operator_on_face(const Placed& placed, const Affine3& to_part, const Hit& hit);

// Whether two hits on one placed part lie on faces that share an edge with a gap, both so near to it that they may be one crossing.
bool meet_at_loose_edge(const PartGeometry& geometry, const Hit& a, const Hit& b);

}  // namespace iso
