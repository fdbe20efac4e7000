// Sixteen rays on their way through the parts, and what decides which of the roots they are offered become hits. Knows nothing of Embree.
#pragma once

#include <vector>

#include "raytracer/leaf.h"
#include "raytracer/local_ray.h"
#include "raytracer/tracer.h"

namespace iso {

inline constexpr int kWidth = 16;
using LaneMask = std::uint32_t;  // bit i: lane i
inline constexpr LaneMask kAllLanes = 0xffff;

template <class Work>
void for_each_lane(LaneMask mask, const Work& work) {
  for (; mask; mask &= mask - 1) work(__builtin_ctz(mask));
}

inline unsigned lane_count(LaneMask mask) {  // of sixteen bits
  mask = (mask & 0x5555) + (mask >> 1 & 0x5555);
  mask = (mask & 0x3333) + (mask >> 2 & 0x3333);
  mask = (mask & 0x0f0f) + (mask >> 4 & 0x0f0f);
  return (mask & 0xff) + (mask >> 8);
}

template <class T>
using Lanes = T[kWidth];

// Two planes at right angles that hold each ray: n . p = d.
template <class T>
struct alignas(64) PlaneLanes {
  Lanes<T> n1[3], n2[3], d1, d2;
};

// The rays in the coordinates of one part, as kernels want them: started on the part's box, and written as the meet of two planes (see
// local_ray.h); and their float companions, which start a little before, with directions of unit length.
struct alignas(64) LocalRays {
  Lanes<double> o[3], d[3];
  PlaneLanes<double> planes;
  PlaneLanes<float> float_planes;
  Lanes<double> inverse_dd, scale;
  Lanes<double> shift;   // of the start, in t
  Lanes<double> length;  // |d|: float distances count in part units
  Lanes<float> fo[3], fd[3], far;
  double slack = 0;  // how far before the start the float rays start, in part units

  LocalRay ray(int lane) const;
};

enum class Query { nearest, occluded, all };

// A batch of rays, what it is after, and the placed part that is being traced.
struct alignas(64) Packet {
  Lanes<double> o[3], d[3], tmin;
  Lanes<double> limit;  // hits beyond are not wanted: tmax, or the nearest hit so far
  Lanes<std::int32_t> from_placed, from_primitive;
  LocalRays local;
  Hit* best = nullptr;  // the nearest hits so far, one a lane
  Lanes<std::vector<Hit>*> all;
  LaneMask blocked = 0;
  Query query = Query::nearest;
  int current = 0;
  SolverStats* stats = nullptr;

  // Of `lanes`, those that start on a primitive of the part that is being traced.
  LaneMask start_on(LaneMask lanes, std::int32_t primitive) const;
};

// Float rays start this share of the size given to `enter_part` before the local ray: a root may lie just before the box by rounding.
inline constexpr double kStartSlack = 1e-6;

// How far to_world.point(S) may be off by rounding; `terms`: size of the numbers that S was added up from.
double rounding_of_point(const Affine3& to_world, double terms, const Point3& at);

// Hit::primitive.
inline std::int32_t leaf_id(std::uint32_t leaf) { return static_cast<std::int32_t>(leaf); }
inline std::int32_t analytic_id(std::uint32_t index) { return -2 - static_cast<std::int32_t>(index); }

// Moves the rays of `wanted` into a part and to where they enter its box. Returns the lanes that enter before their limit.
LaneMask enter_part(const Packet& packet, LaneMask wanted, const Affine3& to_part, const Box3& box, double part_size, LocalRays& local);

// Order of hits along a ray. Equal distances are decided by the smaller index, so that the order of the traversal does not matter.
bool comes_first(const Hit& a, const Hit& b);

// A hit that is within the ray's limits: nearest, blocking, or one of all. Returns true if the lane's nearest hit or its blocking changed.
bool take(Packet& packet, int lane, const Hit& hit);

// Meets the local rays of `lanes` with one closed-form face or one leaf of a part. Returns the lanes whose nearest hit or blocking changed.
LaneMask meet_analytic(Packet& packet, LaneMask lanes, const PartGeometry& geometry, std::uint32_t primitive);
LaneMask meet_leaf(Packet& packet, LaneMask lanes, const PartGeometry& geometry, std::uint32_t primitive);

}  // namespace iso
