// One plane, cylinder, cone or sphere against the rays of a packet, several at a time, in closed form and in double.
//
// The quadrics are solved from the point of the ray nearest to their axis or centre, where the quadratic loses no digits, and each root is
// improved by one Newton step on the implicit equation. Roots outside the box of the trimmed face are dropped before their parameters are
// computed.
#pragma once

#include "raytracer/packet.h"

namespace iso {

// Up to two roots a ray, the nearer one first. A double root is reported once, as tangent. A ray that lies in the surface has none.
struct alignas(64) AnalyticRoots {
  Lanes<double> t[2];          // along the local ray
  Lanes<double> u[2], v[2];    // angles in [0, 2 pi)
  LaneMask found[2] = {0, 0};  // lanes whose root lies in the box and between the ray's limits
  LaneMask tangent = 0;        // of the first root
};

void roots_of_packet(const AnalyticFace& face, const Packet& packet, LaneMask lanes, AnalyticRoots& roots);

}  // namespace iso
