// All meets of a ray with a whole plane, cylinder, cone or sphere, in closed form.
//
// The quadrics are solved from the point of the ray nearest to their axis or centre, where the quadratic loses no digits, and each root is
// improved by one Newton step on the implicit equation.
#pragma once

#include "raytracer/local_ray.h"

namespace iso {

struct AnalyticRoot {
  UV uv{0.0};
  double t = 0;
  HitStatus status = HitStatus::converged;
};

// Up to two roots, whatever their t, angles in [0, 2 pi). A double root is reported once, as tangent. A ray that lies in the surface has
// none.
int analytic_roots(const AnySurface& surface, const LocalRay& ray, AnalyticRoot roots[2]);

}  // namespace iso
