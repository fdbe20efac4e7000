#include "raytracer/lane.h"

#include "raytracer/analytic_solve.h"
#include "raytracer/bezier_solve.h"

namespace iso {

SolverStats& SolverStats::operator+=(const SolverStats& o) {
  rays += o.rays;
  leaf_visits += o.leaf_visits;
  slab_rejects += o.slab_rejects;
  solves += o.solves;
  newton_steps += o.newton_steps;
  analytic += o.analytic;
  trim_queries += o.trim_queries;
  fallbacks += o.fallbacks;
  fallback_cells += o.fallback_cells;
  fallback_out_of_budget += o.fallback_out_of_budget;
  tangent += o.tangent;
  by_tolerance += o.by_tolerance;
  return *this;
}

bool clip(const Box3& box, const Vec3& o, const Vec3& d, double tmin, double tmax, double& enter, double& leave) {
  enter = tmin;
  leave = tmax;
  for (int c = 0; c < 3; ++c) {
    if (d[c] == 0) {
      if (o[c] < box.lo[c] || o[c] > box.hi[c]) return false;
      continue;
    }
    double a = (box.lo[c] - o[c]) / d[c], b = (box.hi[c] - o[c]) / d[c];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter <= leave;
}

bool comes_first(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.placed != b.placed) return a.placed < b.placed;
  if (a.face != b.face) return a.face < b.face;
  if (a.uv.x != b.uv.x) return a.uv.x < b.uv.x;
  return a.uv.y < b.uv.y;
}

namespace {

// Brings angles and other periodic parameters into the window of the face.
UV into_domain(const Face& face, const Vec2& period, UV uv) {
  for (const int c : {0, 1})
    if (period[c] > 0) {
      uv[c] -= period[c] * std::floor((uv[c] - face.domain.lo[c]) / period[c]);
      if (uv[c] > face.domain.hi[c] && uv[c] - period[c] >= face.domain.lo[c] - 1e-9 * period[c]) uv[c] = face.domain.lo[c];
    }
  return uv;
}

// Offers a root of one face to a lane. Returns true if the lane's state changed.
bool offer(Search& search, Lane& lane, const PartGeometry& geometry, std::uint32_t face_index, UV uv, double local_t, HitStatus status,
           unsigned steps, bool crossing) {
  Hit hit;
  hit.t = lane.shift + local_t;
  if (!(hit.t >= lane.tmin && hit.t <= lane.tmax) || !finite(uv)) return false;
  if (search.query == Query::nearest && hit.t > lane.best.t) return false;
  hit.placed = search.current;
  hit.face = static_cast<std::int32_t>(face_index);
  hit.status = status;
  hit.steps = static_cast<std::uint16_t>(std::min(steps, 65535u));
  const Face& face = geometry.part->faces[face_index];
  if (crossing) {
    ++search.stats->trim_queries;
    const TrimRegion::Answer answer = geometry.trims[face_index].contains(uv, face.surface, lane.local.d);
    if (!answer.inside) return false;
    hit.by_tolerance = answer.by_tolerance;
  }
  hit.uv = into_domain(face, geometry.trims[face_index].period(), uv);
  if (status == HitStatus::tangent) ++search.stats->tangent;
  if (hit.by_tolerance) ++search.stats->by_tolerance;
  switch (search.query) {
    case Query::occluded:
      lane.blocked = true;
      return true;
    case Query::all:
      lane.all->push_back(hit);
      return false;
    case Query::nearest:
      break;
  }
  if (!comes_first(hit, lane.best)) return false;
  lane.best = hit;
  return true;
}

// The faces without loops are bounded by their domain: the closed forms do not know it.
bool in_domain(const Face& face, const Vec2& period, UV& uv) {
  uv = into_domain(face, period, uv);
  const Vec2 slack = 1e-12 * face.domain.size();
  return uv.x >= face.domain.lo.x - slack.x && uv.x <= face.domain.hi.x + slack.x && uv.y >= face.domain.lo.y - slack.y &&
         uv.y <= face.domain.hi.y + slack.y;
}

}  // namespace

bool meet_analytic(Search& search, Lane& lane, const PartGeometry& geometry, std::uint32_t primitive) {
  const std::uint32_t index = geometry.analytic[primitive].face;
  const Face& face = geometry.part->faces[index];
  ++search.stats->analytic;
  AnalyticRoot roots[2];
  const int n = analytic_roots(face.surface, lane.local, roots);
  const bool untrimmed = geometry.trims[index].untrimmed();
  bool changed = false;
  for (int i = 0; i < n; ++i) {
    if (untrimmed && !in_domain(face, geometry.trims[index].period(), roots[i].uv)) continue;
    changed |= offer(search, lane, geometry, index, roots[i].uv, roots[i].t, roots[i].status, 0, !untrimmed);
  }
  return changed;
}

bool meet_leaf(Search& search, Lane& lane, const PartGeometry& geometry, std::uint32_t primitive) {
  thread_local std::vector<Root> roots;
  roots.clear();
  const Leaf& leaf = geometry.leaves[primitive];
  const LeafPatch& patch = geometry.patches[leaf.patch];
  roots_in_leaf(patch, leaf, lane.local, *search.stats, roots);
  bool changed = false;
  for (const Root& root : roots)
    changed |=
        offer(search, lane, geometry, patch.face, patch.piece.to_native(root.st), root.t, root.status, root.steps, leaf.crossing != 0);
  return changed;
}

}  // namespace iso
