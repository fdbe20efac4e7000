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
#include <iterator>
#include <map>

#include "raytracer/all_hits.h"
#include "raytracer/lane.h"
#include "raytracer/tracer.h"

namespace iso {

namespace {

constexpr unsigned kWidth = 16;

struct PartScene {
  PartGeometry geometry;
  RTCScene scene = nullptr;
};

struct PlacedPart {
  const PartScene* part = nullptr;
  Affine3 to_part;
  Box3 world_box;
};

struct Context {
  RTCIntersectContext embree;
  Search search;
  const PlacedPart* placed = nullptr;  // all of them
  Vec3 centre{0.0};                    // of the world, for the float rays of the top level
  std::array<double, kWidth> top_shift{}, top_length{};
  double top_slack = 0;  // left behind the limit of top-level rays against float rounding, in world units
};

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

// ---- callbacks ---------------------------------------------------------------------------------------------------------

// The float ray starts `slack` before the local ray, and as much is left behind the limit, against the rounding of both.
float far_limit(const Lane& lane) { return rounded_up((lane.limit() - lane.shift) * lane.length + 2 * lane.slack); }

template <bool (*meet)(Search&, Lane&, const PartGeometry&, std::uint32_t)>
void intersect_part(const RTCIntersectFunctionNArguments* args) {
  auto& context = *reinterpret_cast<Context*>(args->context);
  const auto& geometry = static_cast<const PartScene*>(args->geometryUserPtr)->geometry;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    Lane& lane = context.search.lanes[RTCRayN_id(rays, args->N, i)];
    if (meet(context.search, lane, geometry, args->primID))
      RTCRayN_tfar(rays, args->N, i) = std::min(RTCRayN_tfar(rays, args->N, i), far_limit(lane));
  }
}

template <bool (*meet)(Search&, Lane&, const PartGeometry&, std::uint32_t)>
void occlude_part(const RTCOccludedFunctionNArguments* args) {
  auto& context = *reinterpret_cast<Context*>(args->context);
  const auto& geometry = static_cast<const PartScene*>(args->geometryUserPtr)->geometry;
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    Lane& lane = context.search.lanes[RTCRayN_id(args->ray, args->N, i)];
    if (!lane.blocked) meet(context.search, lane, geometry, args->primID);
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

// Lanes that take no part must still hold rays: Embree's narrower kernels look at all of them. These end before they begin.
RTCRayHit16 idle_rays() {
  RTCRayHit16 rays;
  for (unsigned i = 0; i < kWidth; ++i) {
    set_ray(rays, i, Vec3(0.0), Vec3(0, 0, 1), 0, 0);
    rays.ray.tnear[i] = std::numeric_limits<float>::infinity();
    rays.ray.tfar[i] = -std::numeric_limits<float>::infinity();
  }
  return rays;
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
    if (context.search.query == Query::occluded)
      rtcOccluded16(valid, scene, &context.embree, reinterpret_cast<RTCRay16*>(&rays.ray));
    else
      rtcIntersect16(valid, scene, &context.embree, &rays);
    return;
  }
  for (unsigned i = 0; i < kWidth; ++i) {
    if (!valid[i]) continue;
    RTCRayHit one = single(rays, i);
    if (context.search.query == Query::occluded)
      rtcOccluded1(scene, &context.embree, &one.ray);
    else
      rtcIntersect1(scene, &context.embree, &one);
  }
}

// Float rays start this share of the part's size before the local ray: a root may lie just before the box by rounding.
constexpr double kStartSlack = 1e-6;

// Traces lanes through one placed part. Each lane's ray is moved to where it enters the part's box first.
void trace_placed(Context& context, int placed_index, const int* wanted, bool packet) {
  const PlacedPart& placed = context.placed[placed_index];
  const PartGeometry& geometry = placed.part->geometry;
  alignas(64) RTCRayHit16 rays = idle_rays();
  alignas(64) int valid[kWidth];
  for (unsigned i = 0; i < kWidth; ++i) {
    valid[i] = 0;
    if (!wanted[i]) continue;
    Lane& lane = context.search.lanes[i];
    const Vec3 o = placed.to_part.point(lane.o), d = placed.to_part.vector(lane.d);
    double enter, leave;
    if (!clip(geometry.box, o, d, lane.tmin, lane.limit(), enter, leave)) continue;
    lane.shift = enter;
    lane.length = glm::length(d);
    lane.local = make_local_ray(o + enter * d, d, geometry.size);
    lane.slack = kStartSlack * geometry.size;
    set_ray(rays, i, lane.local.o - (lane.slack / lane.length) * d, d / lane.length, 0, (leave - enter) * lane.length + 2 * lane.slack);
    valid[i] = -1;
  }
  const int before = context.search.current;
  context.search.current = placed_index;
  trace(placed.part->scene, context, rays, valid, packet);
  context.search.current = before;
}

template <class Args>
void enter_placed(const Args* args, RTCRayN* rays) {
  auto& context = *reinterpret_cast<Context*>(args->context);
  alignas(64) int wanted[kWidth] = {};
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] && !context.search.lanes[RTCRayN_id(rays, args->N, i)].blocked) wanted[RTCRayN_id(rays, args->N, i)] = -1;
  trace_placed(context, static_cast<int>(args->primID), wanted, args->N > 1);
  for (unsigned i = 0; i < args->N; ++i) {
    if (!args->valid[i]) continue;
    const unsigned id = RTCRayN_id(rays, args->N, i);
    const Lane& lane = context.search.lanes[id];
    float& far = RTCRayN_tfar(rays, args->N, i);
    if (context.search.query == Query::occluded) {
      if (lane.blocked) far = -std::numeric_limits<float>::infinity();
    } else if (context.search.query == Query::nearest) {
      far = std::min(far, rounded_up((lane.limit() - context.top_shift[id]) * context.top_length[id] + context.top_slack));
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

  Impl(TraceScene s, const std::string& configuration) : scene(std::move(s)) {
    const auto start = std::chrono::steady_clock::now();
    device = rtcNewDevice(configuration.c_str());
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
    context.search.stats->rays += count;
    if (!top) {
      for (unsigned i = 0; i < count; ++i) valid[i] = -1;
      if (!placed.empty()) trace_placed(context, 0, valid, packet);
      return;
    }
    context.top_slack = kStartSlack * box.diagonal();
    alignas(64) RTCRayHit16 rays = idle_rays();
    for (unsigned i = 0; i < count; ++i) {
      const Lane& lane = context.search.lanes[i];
      double enter, leave;
      if (!clip(box, lane.o, lane.d, lane.tmin, lane.tmax, enter, leave)) continue;
      const double length = glm::length(lane.d);
      context.top_shift[i] = enter;
      context.top_length[i] = length;
      set_ray(rays, i, lane.o + enter * lane.d - centre, lane.d / length, 0, (leave - enter) * length + context.top_slack);
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
    context.search.query = query;
    context.placed = placed.data();
    context.search.lanes = lanes.data();
    context.search.stats = &stats;
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

Tracer::Tracer(TraceScene scene, const std::string& device) : impl_(std::make_unique<Impl>(std::move(scene), device)) {
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
        sort_and_remove_doubles(*this, rays[i], size, *lane.all);
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

namespace {

std::vector<int> edges_of(const Face& face) {
  std::vector<int> edges;
  for (const TrimLoop& loop : face.loops)
    for (const TrimCurve& curve : loop.curves)
      if (curve.edge >= 0) edges.push_back(curve.edge);
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Hits this many gaps away from an edge, along the surface, belong to it: rays at an angle and gaps between samples included.
constexpr double kGapsFromEdge = 4;

}  // namespace

bool Tracer::meet_at_loose_edge(const Hit& a, const Hit& b) const {
  if (a.placed != b.placed) return false;
  const PartGeometry& geometry = impl_->placed[static_cast<std::size_t>(a.placed)].part->geometry;
  const Face &fa = face(a), &fb = face(b);
  const Point3 pa = point(fa.surface, a.uv), pb = point(fb.surface, b.uv);
  if (glm::length(pa - pb) > 16 * geometry.largest_gap) return false;
  const std::vector<int> ea = edges_of(fa), eb = edges_of(fb);
  std::vector<int> shared;
  if (a.face != b.face) {
    std::set_intersection(ea.begin(), ea.end(), eb.begin(), eb.end(), std::back_inserter(shared));
  } else {  // the seams of one face
    for (std::size_t i = 1; i < ea.size(); ++i)
      if (ea[i] == ea[i - 1]) shared.push_back(ea[i]);
  }
  for (const int e : shared) {
    const double reach = kGapsFromEdge * geometry.part->edges[static_cast<std::size_t>(e)].closing;
    if (reach > 0 && glm::length(pa - pb) <= 4 * reach &&
        geometry.trims[static_cast<std::size_t>(a.face)].distance_to_edge(a.uv, e, fa.surface) <= reach &&
        geometry.trims[static_cast<std::size_t>(b.face)].distance_to_edge(b.uv, e, fb.surface) <= reach)
      return true;
  }
  return false;
}

Vec3 offset_origin(const SurfacePoint& at, const Vec3& direction) {
  const double side = glm::dot(at.n, direction) < 0 ? -1.0 : 1.0;
  return at.p + side * at.error_bound * at.n;
}

}  // namespace iso
