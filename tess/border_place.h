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

// How a border is looked at.
struct BorderSide {
  bool left = true;  // the face lies left of it, see face_side.h
  int ahead = 1;     // +1 or -1: where knots of the surface cross the border at the place, derivatives are those of the piece on the way to
                     // rising shares, or falling ones; always of the piece inside the face
  double length = 0;  // of the edge, about, world units
};
BorderPlace border_place(const Face& face, const EdgeUse& use, double share, const BorderSide& side);

// The distance of p from the surface near (u, v), within its natural domain, by Newton steps; however the face is trimmed.
double distance_to_surface(const AnySurface& surface, UV uv, const Point3& p);

}  // namespace iso
