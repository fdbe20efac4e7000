// A ray on its way through the parts, and what decides in double which of the roots it is offered become hits. Knows nothing of Embree.
#pragma once

#include <vector>

#include "raytracer/leaf.h"
#include "raytracer/local_ray.h"
#include "raytracer/tracer.h"

namespace iso {

enum class Query { nearest, occluded, all };

// One ray on its way: in the world, and in the part that is being traced.
struct Lane {
  Vec3 o{0.0}, d{0.0};
  double tmin = 0, tmax = kInf;
  Hit best;
  bool blocked = false;
  std::vector<Hit>* all = nullptr;
  LocalRay local;     // in the part's coordinates, started `shift` along the ray
  double shift = 0;   // of the local ray, in t
  double slack = 0;   // how far before the local ray its float companion starts, in part units
  double length = 1;  // |local.d|: float distances count in part units
  double limit() const { return std::min(tmax, best.t); }
};

// What a batch of rays is after, and the placed part that is being traced.
struct Search {
  Query query = Query::nearest;
  int current = 0;
  Lane* lanes = nullptr;
  SolverStats* stats = nullptr;
};

// The part of a ray inside a box, in t; false if none of it is in [tmin, tmax].
bool clip(const Box3& box, const Vec3& o, const Vec3& d, double tmin, double tmax, double& enter, double& leave);

// Order of hits along a ray. Equal distances are decided by the smaller index, so that the order of the traversal does not matter.
bool comes_first(const Hit& a, const Hit& b);

// Meets a lane's local ray with one closed-form face or one leaf of a part. True if the lane's nearest hit or its blocking changed.
bool meet_analytic(Search& search, Lane& lane, const PartGeometry& geometry, std::uint32_t primitive);
bool meet_leaf(Search& search, Lane& lane, const PartGeometry& geometry, std::uint32_t primitive);

}  // namespace iso
