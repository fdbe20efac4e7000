#include "raytracer/packet.h"

#include "raytracer/chart_root.h"

#include "raytracer/analytic_kernel.h"
#include "raytracer/bezier_solve.h"
#include "raytracer/leaf_kernel.h"

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

LaneMask Packet::start_on(LaneMask lanes, std::int32_t primitive) const {
  LaneMask on = 0;
  for_each_lane(lanes, [&](int i) { on |= (from_primitive[i] == primitive && from_placed[i] == current ? 1u : 0u) << i; });
  return on;
}

bool comes_first(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.placed != b.placed) return a.placed < b.placed;
  if (a.face != b.face) return a.face < b.face;
  if (a.uv.x != b.uv.x) return a.uv.x < b.uv.x;
  if (a.uv.y != b.uv.y) return a.uv.y < b.uv.y;
  return a.primitive < b.primitive;
}

bool take(Packet& packet, int lane, const Hit& hit) {
  switch (packet.query) {
    case Query::occluded:
      packet.blocked |= 1u << lane;
      return true;
    case Query::all:
      packet.all[lane]->push_back(hit);
      return false;
    case Query::nearest:
      break;
  }
  if (!comes_first(hit, packet.best[lane])) return false;
  packet.best[lane] = hit;
  packet.limit[lane] = hit.t;
  return true;
}

double rounding_of_point(const Affine3& to_world, double terms, const Point3& at) {
  const double stretch = std::max({glm::length(to_world.linear[0]), glm::length(to_world.linear[1]), glm::length(to_world.linear[2])});
  return kEps * (64 * stretch * terms + 16 * (std::abs(at.x) + std::abs(at.y) + std::abs(at.z)));
}

namespace {

// Brings angles and other periodic parameters into the window of the face.
UV into_domain(const Face& face, const Vec2& period, UV uv) {
  if (face.domain.contains(uv)) return uv;
  for (const int c : {0, 1})
    if (period[c] > 0) {
      uv[c] -= period[c] * std::floor((uv[c] - face.domain.lo[c]) / period[c]);
      if (uv[c] > face.domain.hi[c] && uv[c] - period[c] >= face.domain.lo[c] - 1e-9 * period[c]) uv[c] = face.domain.lo[c];
    }
  return uv;
}

// A root on its way to become a hit.
struct Offer {
  std::uint32_t face = 0;
  UV uv{0.0};
  double t = 0;  // along the local ray
  HitStatus status = HitStatus::converged;
  unsigned steps = 0;
  bool crossing = false;  // the trim loops must be asked
  std::int32_t primitive = -1;
};

// Offers a root to a lane. Returns true if the lane's nearest hit or its blocking changed.
bool offer(Packet& packet, int lane, const PartGeometry& geometry, const Offer& root) {
  Hit hit;
  hit.t = packet.local.shift[lane] + root.t;
  if (!(hit.t >= packet.tmin[lane] && hit.t <= packet.limit[lane]) || !finite(root.uv)) return false;
  hit.placed = packet.current;
  hit.face = static_cast<std::int32_t>(root.face);
  hit.primitive = root.primitive;
  hit.status = root.status;
  hit.steps = static_cast<std::uint16_t>(std::min(root.steps, 65535u));
  const Face& face = geometry.part->faces[root.face];
  const TrimRegion& trim = geometry.trims[root.face];
  if (root.crossing) {
    ++packet.stats->trim_queries;
    const Vec3 direction{packet.local.d[0][lane], packet.local.d[1][lane], packet.local.d[2][lane]};
    const TrimRegion::Answer answer = trim.contains(root.uv, face.surface, direction);
    if (!answer.inside) return false;
    hit.by_tolerance = answer.by_tolerance;
  }
  hit.uv = into_domain(face, trim.period(), root.uv);
  if (root.status == HitStatus::tangent) ++packet.stats->tangent;
  if (hit.by_tolerance) ++packet.stats->by_tolerance;
  return take(packet, lane, hit);
}

// The faces without loops are bounded by their domain: the closed forms do not know it.
bool in_domain(const Face& face, const Vec2& period, UV& uv) {
  uv = into_domain(face, period, uv);
  const Vec2 slack = 1e-12 * face.domain.size();
  return uv.x >= face.domain.lo.x - slack.x && uv.x <= face.domain.hi.x + slack.x && uv.y >= face.domain.lo.y - slack.y &&
         uv.y <= face.domain.hi.y + slack.y;
}

}  // namespace

LaneMask meet_analytic(Packet& packet, LaneMask lanes, const PartGeometry& geometry, std::uint32_t primitive) {
  const AnalyticFace& analytic = geometry.analytic[primitive];
  const Face& face = geometry.part->faces[analytic.face];
  const TrimRegion& trim = geometry.trims[analytic.face];
  const bool untrimmed = trim.untrimmed();
  packet.stats->analytic += lane_count(lanes);
  const std::int32_t id = analytic_id(primitive);
  if (analytic.kind == AnalyticKind::plane) lanes &= ~packet.start_on(lanes, id);
  if (!lanes) return 0;
  AnalyticRoots roots;
  roots_of_packet(analytic, packet, lanes, roots);
  LaneMask changed = 0;
  for (int i = 0; i < 2; ++i) {
    const LaneMask wanted = roots.found[i] & (packet.query == Query::all ? kAllLanes : ~changed);  // the first root is the nearer one
    for_each_lane(wanted, [&](int lane) {
      UV uv{roots.u[i][lane], roots.v[i][lane]};
      if (untrimmed && !in_domain(face, trim.period(), uv)) return;
      const HitStatus status = i == 0 && (roots.tangent >> lane & 1) ? HitStatus::tangent : HitStatus::converged;
      if (offer(packet, lane, geometry, {analytic.face, uv, roots.t[i][lane], status, 0, !untrimmed, id})) changed |= 1u << lane;
    });
  }
  return changed;
}

namespace {

// Offers the roots of one leaf to the lanes of a packet.
class Offers final : public RootSink {
 public:
  Offers(Packet& packet, const PartGeometry& geometry, std::uint32_t leaf)
      : packet_(packet),
        geometry_(geometry),
        patch_(geometry.patches[geometry.leaves[leaf].patch]),
        chart_(blended_chart(geometry.part->faces[patch_.face].surface)),
        id_(leaf_id(leaf)),
        crossing_(geometry.leaves[leaf].crossing != 0) {}

  LaneMask changed() const { return changed_; }

  void missed_slab(LaneMask lanes) override { packet_.stats->slab_rejects += lane_count(lanes); }

  void found(const LeafRoots& roots) override {
    packet_.stats->solves += lane_count(roots.found);
    if (chart_) return found_beside(roots);
    for_each_lane(roots.found, [&](int lane) {
      const unsigned steps = static_cast<unsigned>(roots.steps[lane]);
      packet_.stats->newton_steps += steps;
      propose(lane, patch_.piece.to_native({roots.s[lane], roots.t[lane]}), roots.distance[lane], HitStatus::converged, steps);
    });
  }

  void undecided(LaneMask lanes, const Window& window) override {
    thread_local std::vector<Root> roots;
    thread_local PassedFolds passed;
    thread_local BezierPatch net;
    bernstein_form(geometry_, patch_, net);
    passed.within = chart_ ? chart_->error : 0;
    for_each_lane(lanes, [&](int lane) {
      roots.clear();
      passed.at.clear();
      roots_in_window(net, window, packet_.local.ray(lane), *packet_.stats, roots, chart_ ? kOverlapOfShared : kOverlap,
                      chart_ ? &passed : nullptr);
      for (const Root& root : roots) {
        const UV uv = patch_.piece.to_native(root.st);
        if (chart_)
          propose_on_chart(lane, uv, root.status, root.steps);
        else
          propose(lane, uv, root.t, root.status, root.steps);
      }
      for (const Vec2& at : passed.at) propose_at_fold(lane, patch_.piece.to_native(at));
    });
  }

 private:
  // Roots of the spline beside a chart.
  void found_beside(const LeafRoots& roots) {
    LeafRoots exact = roots;
    const BezierPiece& piece = patch_.piece;
    const Box2 box = piece.native_box();
    const LaneMask left = roots_on_chart(*chart_, {&geometry_.powers[patch_.powers], piece.patch.pu, piece.patch.pv, box.lo, box.size()},
                                         packet_.local, exact);
    for_each_lane(roots.found, [&](int lane) {
      if (left >> lane & 1)
        return propose_on_chart(lane, piece.to_native({roots.s[lane], roots.t[lane]}), HitStatus::converged,
                                static_cast<unsigned>(roots.steps[lane]));
      const unsigned steps = static_cast<unsigned>(exact.steps[lane]);
      packet_.stats->newton_steps += steps;
      propose(lane, {exact.s[lane], exact.t[lane]}, exact.distance[lane], HitStatus::converged, steps);
    });
  }

  void propose_on_chart(int lane, const UV& near, HitStatus status, unsigned steps) {
    const ChartRoot root = root_on_chart(*chart_, packet_.local.ray(lane), near);
    packet_.stats->newton_steps += root.steps;
    propose(lane, root.st, root.t, root.met ? status : HitStatus::tangent, steps + root.steps);
  }

  // What the spline does not have. A pair that is met from several windows is one, once hits are sorted.
  void propose_at_fold(int lane, const UV& near) {
    const auto roots = roots_at_fold(*chart_, packet_.local.ray(lane), near);
    if (!roots) return;
    for (const ChartRoot& root : *roots) {
      packet_.stats->newton_steps += root.steps;
      if (Box2{Vec2(-kOverlapOfShared), Vec2(1 + kOverlapOfShared)}.contains(root.st))
        propose(lane, root.st, root.t, HitStatus::fallback, root.steps);
    }
  }

  void propose(int lane, const UV& uv, double t, HitStatus status, unsigned steps) {
    if (offer(packet_, lane, geometry_, {patch_.face, uv, t, status, steps, crossing_, id_})) changed_ |= 1u << lane;
  }

  Packet& packet_;
  const PartGeometry& geometry_;
  const LeafPatch& patch_;
  const PatchChart* chart_;  // where roots on the pieces are beside those of the surface
  std::int32_t id_;
  bool crossing_;
  LaneMask changed_ = 0;
};

}  // namespace

LaneMask meet_leaf(Packet& packet, LaneMask lanes, const PartGeometry& geometry, std::uint32_t primitive) {
  packet.stats->leaf_visits += lane_count(lanes);
  Offers offers(packet, geometry, primitive);
  roots_of_packet(geometry, primitive, packet.local, lanes, packet.start_on(lanes, leaf_id(primitive)), offers);
  return offers.changed();
}

}  // namespace iso
