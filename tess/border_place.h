// What a face is like at a place of its border: point, tangent, normal, and how it bends across the border.
#pragma once

#include <cmath>

#include "tess/boundary.h"

namespace iso {

struct BorderPlace {
  UV uv{0.0};
  Point3 S{0.0};
  Vec3 normal{0.0};   // unit: Su x Sv where the face lies left of its border, against it where it lies right; zero where there is none
  Vec3 tangent{0.0};  // of the border in the direction of rising shares, world units per share; zero where the curve stands still
  double curvature = std::nan("");  // normal curvature square to the border, per world unit, positive where the surface bends toward
                                    // `normal`; NaN at singular places
  bool regular = false;             // the first derivatives span the tangent plane; else the normal is a limit
};

// `left`: see face_side.h. `ahead`: +1 or -1. Where knots of the surface meet at the place, derivatives are those of the piece that lies
// inside the face and on the way to rising shares (ahead > 0) or falling ones; all others belong to other places.
BorderPlace border_place(const Face& face, const EdgeUse& use, double share, bool left, int ahead);

// The distance of p from the surface near (u, v), within its natural domain, by Newton steps; however the face is trimmed.
double distance_to_surface(const AnySurface& surface, UV uv, const Point3& p);

}  // namespace iso
