// The only file that includes Embree: user geometry over leaves, closed-form faces and placed parts, and the batches of rays through them.
//
// Embree sees float boxes, rounded outward, and float rays that start on the box they enter; every decision is taken in double from the
// ray's own record (`Lane`). Placed parts are user geometry too, not Embree instances: their callback moves the ray into the part's
// coordinates in double and traces the part's scene from there, so a small part far away is met as exactly as one at the origin.
#include <embree3/rtcore.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <map>

#include "raytracer/analytic_solve.h"
#include "raytracer/bezier_solve.h"
#include "raytracer/leaf.h"
#include "raytracer/local_ray.h"
#include "raytracer/tracer.h"

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

namespace {

constexpr unsigned kWidth = 16;

enum class Query { nearest, occluded, all };

struct PartScene {
  PartGeometry geometry;
  RTCScene scene = nullptr;
};

struct PlacedPart {
  const PartScene* part = nullptr;
  Affine3 to_part;
  Box3 world_box;
};

// One ray on its way: in the world, and in the part that is being traced.
struct Lane {
  Vec3 o{0.0}, d{0.0};
  double tmin = 0, tmax = kInf;
  Hit best;
  bool blocked = false;
  std::vector<Hit>* all = nullptr;
  LocalRay local;     // in the part's coordinates, started `shift` along the ray
  double shift = 0;   // of the local ray, in t
  double length = 1;  // |local.d|: float distances count in part units
  double limit() const { return std::min(tmax, best.t); }
};

struct Context {
  RTCIntersectContext embree;
  Query query = Query::nearest;
  const PlacedPart* placed = nullptr;  // all of them
  int current = 0;                     // the placed part being traced
  Lane* lanes = nullptr;
  SolverStats* stats = nullptr;
  Vec3 centre{0.0};  // of the world, for the float rays of the top level
  std::array<double, kWidth> top_shift{}, top_length{};
};

// The part of a ray inside a box, in t; false if none of it is in [tmin, tmax].
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

float rounded_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? std::nextafter(f, std::numeric_limits<float>::infinity())
                                     : std::nextafter(std::nextafter(f, INFINITY), INFINITY);
}

void set_box(RTCBounds* out, const Box3& box) {
  const auto down = [](double x) { return std::nextafter(static_cast<float>(x), -INFINITY); };
  const auto up = [](double x) { return std::nextafter(static_cast<float>(x), INFINITY); };
  out->lower_x = down(box.lo.x);
  out->lower_y = down(box.lo.y);
  out->lower_z = down(box.lo.z);
  out->upper_x = up(box.hi.x);
  out->upper_y = up(box.hi.y);
  out->upper_z = up(box.hi.z);
}

// ---- accepting hits ----------------------------------------------------------------------------------------------------

// Equal distances are decided by the smaller index, so that the order of the traversal does not matter.
bool comes_first(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.placed != b.placed) return a.placed < b.placed;
  if (a.face != b.face) return a.face < b.face;
  if (a.uv.x != b.uv.x) return a.uv.x < b.uv.x;
  return a.uv.y < b.uv.y;
}

// Brings angles and other periodic parameters into the window of the face.
UV into_domain(const Face& face, UV uv) {
  const Vec2 period = periods(face.surface);
  for (const int c : {0, 1})
    if (period[c] > 0) {
      uv[c] -= period[c] * std::floor((uv[c] - face.domain.lo[c]) / period[c]);
      if (uv[c] > face.domain.hi[c] && uv[c] - period[c] >= face.domain.lo[c] - 1e-9 * period[c]) uv[c] = face.domain.lo[c];
    }
  return uv;
}

// Offers a root of one face to a lane. Returns true if the lane's state changed.
bool offer(Context& context, Lane& lane, const PartGeometry& geometry, std::uint32_t face_index, UV uv, double local_t, HitStatus status,
           unsigned steps, bool crossing) {
  Hit hit;
  hit.t = lane.shift + local_t;
  if (!(hit.t >= lane.tmin && hit.t <= lane.tmax) || !finite(uv)) return false;
  if (context.query == Query::nearest && hit.t > lane.best.t) return false;
  hit.placed = context.current;
  hit.face = static_cast<std::int32_t>(face_index);
  hit.status = status;
  hit.steps = static_cast<std::uint16_t>(std::min(steps, 65535u));
  const Face& face = geometry.part->faces[face_index];
  if (crossing) {
    ++context.stats->trim_queries;
    const TrimRegion::Answer answer = geometry.trims[face_index].contains(uv, face.surface);
    if (!answer.inside) return false;
    hit.by_tolerance = answer.by_tolerance;
  }
  hit.uv = into_domain(face, uv);
  if (status == HitStatus::tangent) ++context.stats->tangent;
  if (hit.by_tolerance) ++context.stats->by_tolerance;
  switch (context.query) {
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
bool in_domain(const Face& face, UV& uv) {
  uv = into_domain(face, uv);
  const Vec2 slack = 1e-12 * face.domain.size();
  return uv.x >= face.domain.lo.x - slack.x && uv.x <= face.domain.hi.x + slack.x && uv.y >= face.domain.lo.y - slack.y &&
         uv.y <= face.domain.hi.y + slack.y;
}

bool meet_analytic(Context& context, Lane& lane, const PartGeometry& geometry, std::uint32_t primitive) {
  const std::uint32_t index = geometry.analytic[primitive].face;
  const Face& face = geometry.part->faces[index];
  ++context.stats->analytic;
  AnalyticRoot roots[2];
  const int n = analytic_roots(face.surface, lane.local, roots);
  const bool untrimmed = geometry.trims[index].untrimmed();
  bool changed = false;
  for (int i = 0; i < n; ++i) {
    if (untrimmed && !in_domain(face, roots[i].uv)) continue;
    changed |= offer(context, lane, geometry, index, roots[i].uv, roots[i].t, roots[i].status, 0, !untrimmed);
  }
  return changed;
}

bool meet_leaf(Context& context, Lane& lane, const PartGeometry& geometry, std::uint32_t primitive) {
  thread_local std::vector<Root> roots;
  roots.clear();
  const Leaf& leaf = geometry.leaves[primitive];
  const LeafPatch& patch = geometry.patches[leaf.patch];
  roots_in_leaf(patch, leaf, lane.local, *context.stats, roots);
  bool changed = false;
  for (const Root& root : roots)
    changed |=
        offer(context, lane, geometry, patch.face, patch.piece.to_native(root.st), root.t, root.status, root.steps, leaf.crossing != 0);
  return changed;
}

// ---- callbacks ---------------------------------------------------------------------------------------------------------

float far_limit(const Lane& lane) { return rounded_up((lane.limit() - lane.shift) * lane.length); }

template <bool (*meet)(Context&, Lane&, const PartGeometry&, std::uint32_t)>
void intersect_part(const RTCIntersectFunctionNArguments* args) {
  auto& context = *reinterpret_cast<Context*>(args->context);
  const auto& geometry = static_cast<const PartScene*>(args->geometryUserPtr)->geometry;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    Lane& lane = context.lanes[RTCRayN_id(rays, args->N, i)];
    if (meet(context, lane, geometry, args->primID))
      RTCRayN_tfar(rays, args->N, i) = std::min(RTCRayN_tfar(rays, args->N, i), far_limit(lane));
  }
}

template <bool (*meet)(Context&, Lane&, const PartGeometry&, std::uint32_t)>
void occlude_part(const RTCOccludedFunctionNArguments* args) {
  auto& context = *reinterpret_cast<Context*>(args->context);
  const auto& geometry = static_cast<const PartScene*>(args->geometryUserPtr)->geometry;
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    Lane& lane = context.lanes[RTCRayN_id(args->ray, args->N, i)];
    if (!lane.blocked) meet(context, lane, geometry, args->primID);
    if (lane.blocked) RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
  }
}

void set_ray(RTCRayHit16& r, unsigned i, const Vec3& o, const Vec3& unit, double near, double far) {
  r.ray.org_x[i] = static_cast<float>(o.x);
  r.ray.org_y[i] = static_cast<float>(o.y);
  r.ray.org_z[i] = static_cast<float>(o.z);
  r.ray.dir_x[i] = static_cast<float>(unit.x);
  r.ray.dir_y[i] = static_cast<float>(unit.y);
  r.ray.dir_z[i] = static_cast<float>(unit.z);
  r.ray.tnear[i] = static_cast<float>(near);
  r.ray.tfar[i] = rounded_up(far);
  r.ray.time[i] = 0;
  r.ray.mask[i] = 0xffffffffu;
  r.ray.id[i] = i;
  r.ray.flags[i] = 0;
  r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

RTCRayHit single(const RTCRayHit16& r, unsigned i) {
  RTCRayHit s{};
  s.ray = {r.ray.org_x[i],
           r.ray.org_y[i],
           r.ray.org_z[i],
           r.ray.tnear[i],
           r.ray.dir_x[i],
           r.ray.dir_y[i],
           r.ray.dir_z[i],
           0.f,
           r.ray.tfar[i],
           0xffffffffu,
           i,
           0u};
  s.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  s.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return s;
}

// Packets where at least this many lanes live and the rays are neighbours; single rays else.
constexpr int kPacketFrom = 3;

void trace(RTCScene scene, Context& context, RTCRayHit16& rays, const int* valid, bool packet) {
  int live = 0;
  for (unsigned i = 0; i < kWidth; ++i) live += valid[i] ? 1 : 0;
  if (live == 0) return;
  if (packet && live >= kPacketFrom) {
    if (context.query == Query::occluded)
      rtcOccluded16(valid, scene, &context.embree, reinterpret_cast<RTCRay16*>(&rays.ray));
    else
      rtcIntersect16(valid, scene, &context.embree, &rays);
    return;
  }
  for (unsigned i = 0; i < kWidth; ++i) {
    if (!valid[i]) continue;
    RTCRayHit one = single(rays, i);
    if (context.query == Query::occluded)
      rtcOccluded1(scene, &context.embree, &one.ray);
    else
      rtcIntersect1(scene, &context.embree, &one);
  }
}

// Traces lanes through one placed part. Each lane's ray is moved to where it enters the part's box first.
void trace_placed(Context& context, int placed_index, const int* wanted, bool packet) {
  const PlacedPart& placed = context.placed[placed_index];
  const PartGeometry& geometry = placed.part->geometry;
  alignas(64) RTCRayHit16 rays;
  alignas(64) int valid[kWidth];
  for (unsigned i = 0; i < kWidth; ++i) {
    valid[i] = 0;
    if (!wanted[i]) continue;
    Lane& lane = context.lanes[i];
    const Vec3 o = placed.to_part.point(lane.o), d = placed.to_part.vector(lane.d);
    double enter, leave;
    if (!clip(geometry.box, o, d, lane.tmin, lane.limit(), enter, leave)) continue;
    lane.shift = enter;
    lane.length = glm::length(d);
    lane.local = make_local_ray(o + enter * d, d, geometry.size);
    const double slack = 1e-6 * geometry.size;  // against a first root that rounding puts just before the box
    set_ray(rays, i, lane.local.o - (slack / lane.length) * d, d / lane.length, 0, (leave - enter) * lane.length + 2 * slack);
    valid[i] = -1;
  }
  const int before = context.current;
  context.current = placed_index;
  trace(placed.part->scene, context, rays, valid, packet);
  context.current = before;
}

template <class Args>
void enter_placed(const Args* args, RTCRayN* rays) {
  auto& context = *reinterpret_cast<Context*>(args->context);
  alignas(64) int wanted[kWidth] = {};
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] && !context.lanes[RTCRayN_id(rays, args->N, i)].blocked) wanted[RTCRayN_id(rays, args->N, i)] = -1;
  trace_placed(context, static_cast<int>(args->primID), wanted, args->N > 1);
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    const unsigned id = RTCRayN_id(rays, args->N, i);
    const Lane& lane = context.lanes[id];
    float& far = RTCRayN_tfar(rays, args->N, i);
    if (context.query == Query::occluded) {
      if (lane.blocked) far = -std::numeric_limits<float>::infinity();
    } else if (context.query == Query::nearest) {
      far = std::min(far, rounded_up((lane.limit() - context.top_shift[id]) * context.top_length[id]));
    }
  }
}
void intersect_placed(const RTCIntersectFunctionNArguments* args) { enter_placed(args, RTCRayHitN_RayN(args->rayhit, args->N)); }
void occlude_placed(const RTCOccludedFunctionNArguments* args) { enter_placed(args, args->ray); }

// ---- building ----------------------------------------------------------------------------------------------------------

void leaf_bounds(const RTCBoundsFunctionArguments* args) {
  set_box(args->bounds_o, static_cast<const PartScene*>(args->geometryUserPtr)->geometry.leaf_boxes[args->primID]);
}
void analytic_bounds(const RTCBoundsFunctionArguments* args) {
  set_box(args->bounds_o, static_cast<const PartScene*>(args->geometryUserPtr)->geometry.analytic[args->primID].box);
}

void attach(RTCDevice device, RTCScene scene, std::size_t count, void* user, RTCBoundsFunction bounds, RTCIntersectFunctionN intersect,
            RTCOccludedFunctionN occluded) {
  if (count == 0) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
  rtcSetGeometryUserData(geometry, user);
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

}  // namespace

struct Tracer::Impl {
  TraceScene scene;
  BuildStats build;
  RTCDevice device = nullptr;
  std::vector<std::unique_ptr<PartScene>> parts;
  std::vector<PlacedPart> placed;
  RTCScene top = nullptr;
  Vec3 centre{0.0};
  Box3 box;

  explicit Impl(TraceScene s) : scene(std::move(s)) {
    const auto start = std::chrono::steady_clock::now();
    device = rtcNewDevice("");
    ISO_CHECK(device != nullptr);
    rtcSetDeviceMemoryMonitorFunction(device, count_memory, this);
    build_parts();
    build_top();
    build.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  ~Impl() {
    for (const auto& part : parts) rtcReleaseScene(part->scene);
    if (top) rtcReleaseScene(top);
    rtcReleaseDevice(device);
  }

  static bool count_memory(void* self, ssize_t bytes, bool) {
    static_cast<Impl*>(self)->embree_bytes += bytes;
    return true;
  }
  std::atomic<std::int64_t> embree_bytes{0};

  std::unique_ptr<PartScene> build_part(const Part& part) {
    auto out = std::make_unique<PartScene>();
    out->geometry = make_geometry(part);
    out->scene = rtcNewScene(device);
    rtcSetSceneFlags(out->scene, RTC_SCENE_FLAG_ROBUST);
    attach(device, out->scene, out->geometry.leaves.size(), out.get(), leaf_bounds, intersect_part<meet_leaf>, occlude_part<meet_leaf>);
    attach(device, out->scene, out->geometry.analytic.size(), out.get(), analytic_bounds, intersect_part<meet_analytic>,
           occlude_part<meet_analytic>);
    rtcCommitScene(out->scene);
    out->geometry.leaf_boxes = {};
    build.bezier_patches += out->geometry.patches.size();
    build.leaves += out->geometry.leaves.size();
    build.analytic_faces += out->geometry.analytic.size();
    build.bytes += out->geometry.bytes();
    return out;
  }

  void build_parts() {
    std::map<const Part*, const PartScene*> known;
    for (const Placed& p : scene.placed) {
      const PartScene*& part = known[p.part.get()];
      if (!part) {
        parts.push_back(build_part(*p.part));
        part = parts.back().get();
      }
      PlacedPart entry{part, inverse(p.to_world), transformed(p.to_world, part->geometry.box)};
      if (!part->geometry.box.empty()) box.include(entry.world_box);
      placed.push_back(entry);
    }
    if (!box.empty()) centre = box.middle();
    const double slack = 1e-6 * box.diagonal();
    if (!box.empty()) box = box.inflated(slack);
    for (PlacedPart& p : placed) p.world_box = {p.world_box.lo - centre - slack, p.world_box.hi - centre + slack};
  }

  void build_top() {
    if (placed.size() < 2) return;
    top = rtcNewScene(device);
    rtcSetSceneFlags(top, RTC_SCENE_FLAG_ROBUST);
    attach(
        device, top, placed.size(), placed.data(),
        [](const RTCBoundsFunctionArguments* args) {
          set_box(args->bounds_o, static_cast<const PlacedPart*>(args->geometryUserPtr)[args->primID].world_box);
        },
        intersect_placed, occlude_placed);
    rtcCommitScene(top);
  }

  // Up to 16 rays that are already in `lanes`.
  void trace_lanes(Context& context, unsigned count, bool packet) const {
    alignas(64) int valid[kWidth] = {};
    context.stats->rays += count;
    if (!top) {
      for (unsigned i = 0; i < count; ++i) valid[i] = -1;
      if (!placed.empty()) trace_placed(context, 0, valid, packet);
      return;
    }
    alignas(64) RTCRayHit16 rays;
    for (unsigned i = 0; i < count; ++i) {
      const Lane& lane = context.lanes[i];
      double enter, leave;
      if (!clip(box, lane.o, lane.d, lane.tmin, lane.tmax, enter, leave)) continue;
      const double length = glm::length(lane.d);
      context.top_shift[i] = enter;
      context.top_length[i] = length;
      set_ray(rays, i, lane.o + enter * lane.d - centre, lane.d / length, 0, (leave - enter) * length);
      valid[i] = -1;
    }
    trace(top, context, rays, valid, packet);
  }

  // Runs `rays` through in sixteens; `done(i, lane)` for each.
  template <class Begin, class Done>
  void batches(std::span<const Ray> rays, Query query, bool packet, SolverStats& stats, Begin begin, Done done) const {
    std::array<Lane, kWidth> lanes;
    Context context;
    rtcInitIntersectContext(&context.embree);
    if (packet) context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    context.query = query;
    context.placed = placed.data();
    context.lanes = lanes.data();
    context.stats = &stats;
    for (std::size_t first = 0; first < rays.size(); first += kWidth) {
      const unsigned count = static_cast<unsigned>(std::min<std::size_t>(kWidth, rays.size() - first));
      for (unsigned i = 0; i < count; ++i) {
        const Ray& ray = rays[first + i];
        lanes[i] = Lane{};
        lanes[i].o = ray.o;
        lanes[i].d = ray.d;
        lanes[i].tmin = ray.tmin;
        lanes[i].tmax = ray.tmax;
        begin(first + i, lanes[i]);
      }
      trace_lanes(context, count, packet);
      for (unsigned i = 0; i < count; ++i) done(first + i, lanes[i]);
    }
  }
};

Tracer::Tracer(TraceScene scene) : impl_(std::make_unique<Impl>(std::move(scene))) {
  impl_->build.bytes += static_cast<std::uint64_t>(impl_->embree_bytes.load());
}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

const TraceScene& Tracer::scene() const { return impl_->scene; }
const BuildStats& Tracer::build_stats() const { return impl_->build; }
const Face& Tracer::face(const Hit& hit) const {
  return impl_->scene.placed[static_cast<std::size_t>(hit.placed)].part->faces[static_cast<std::size_t>(hit.face)];
}

void Tracer::nearest(std::span<const Ray> rays, std::span<Hit> hits, Order order, SolverStats& stats) const {
  ISO_CHECK(hits.size() == rays.size());
  impl_->batches(
      rays, Query::nearest, order == Order::coherent, stats, [](std::size_t, Lane&) {},
      [&](std::size_t i, const Lane& lane) { hits[i] = lane.best; });
}

void Tracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked, Order order, SolverStats& stats) const {
  ISO_CHECK(blocked.size() == rays.size());
  impl_->batches(
      rays, Query::occluded, order == Order::coherent, stats, [](std::size_t, Lane&) {},
      [&](std::size_t i, const Lane& lane) { blocked[i] = lane.blocked ? 1 : 0; });
}

// ---- all hits ----------------------------------------------------------------------------------------------------------

namespace {

// Sorted hits of one ray, without the doubles that overlapping leaves, seams and edge tolerances make: the same face met in the same point
// in the same sense, or two faces at one loose edge.
void remove_doubles(const Tracer& tracer, const Ray& ray, double size, std::vector<Hit>& hits) {
  std::sort(hits.begin(), hits.end(), comes_first);
  if (hits.size() < 2) return;
  struct Seen {
    Hit hit;
    SurfacePoint at;
    bool entering;
  };
  std::vector<Seen> kept;
  const double length = glm::length(ray.d);
  for (const Hit& hit : hits) {
    const SurfacePoint at = tracer.surface_point(hit);
    const bool entering = glm::dot(at.n, ray.d) < 0;
    bool twice = false;
    for (auto k = kept.rbegin(); k != kept.rend() && !twice; ++k) {
      const double apart = (hit.t - k->hit.t) * length;
      if (apart > 1e-3 * size) break;
      if (k->hit.placed != hit.placed) continue;
      const bool same_face = k->hit.face == hit.face && glm::length(k->at.p - at.p) <= 1e-9 * size;
      const bool touching = hit.status == HitStatus::tangent || k->hit.status == HitStatus::tangent;
      if (same_face && (k->entering == entering || touching)) twice = true;
    }
    if (!twice) kept.push_back({hit, at, entering});
  }
  hits.clear();
  for (const Seen& k : kept) hits.push_back(k.hit);
}

}  // namespace

void Tracer::all(std::span<const Ray> rays, std::vector<Hit>& hits, std::vector<std::size_t>& offsets, SolverStats& stats) const {
  hits.clear();
  offsets.assign(1, 0);
  std::array<std::vector<Hit>, kWidth> found;
  const double size = impl_->box.diagonal();
  impl_->batches(
      rays, Query::all, false, stats,
      [&](std::size_t i, Lane& lane) {
        found[i % kWidth].clear();
        lane.all = &found[i % kWidth];
      },
      [&](std::size_t i, Lane& lane) {
        remove_doubles(*this, rays[i], size, *lane.all);
        hits.insert(hits.end(), lane.all->begin(), lane.all->end());
        offsets.push_back(hits.size());
      });
}

// ---- surroundings of a hit ---------------------------------------------------------------------------------------------

SurfacePoint Tracer::surface_point(const Hit& hit) const {
  const Placed& placed = impl_->scene.placed[static_cast<std::size_t>(hit.placed)];
  const PlacedPart& part = impl_->placed[static_cast<std::size_t>(hit.placed)];
  const Face& f = placed.part->faces[static_cast<std::size_t>(hit.face)];
  Jet2 j = jet2(f.surface, hit.uv);
  SurfacePoint out;
  const double part_size = part.part->geometry.size;
  Vec3 normal = unit_normal(f.surface, hit.uv, f.domain);
  if (f.reversed) normal = -normal;
  out.p = placed.to_world.point(j.S);
  for (Vec3* d : {&j.Su, &j.Sv, &j.Suu, &j.Suv, &j.Svv}) *d = placed.to_world.vector(*d);
  out.Su = j.Su;
  out.Sv = j.Sv;
  out.n = normal == Vec3(0.0) ? normal : transform_normal(part.to_part, normal);
  const Curvatures k = principal_curvatures(j, out.n);
  out.k1 = k.k1;
  out.k2 = k.k2;
  const double stretch =
      std::max({glm::length(placed.to_world.linear[0]), glm::length(placed.to_world.linear[1]), glm::length(placed.to_world.linear[2])});
  out.error_bound = kEps * (64 * stretch * part_size + 16 * (std::abs(out.p.x) + std::abs(out.p.y) + std::abs(out.p.z)));
  return out;
}

Vec3 offset_origin(const SurfacePoint& at, const Vec3& direction) {
  const double side = glm::dot(at.n, direction) < 0 ? -1.0 : 1.0;
  return at.p + side * at.error_bound * at.n;
}

}  // namespace iso
