// Rays and Embree: user geometry over leaves, closed-form faces and placed parts, and the batches of rays through them.
//
// Embree sees float boxes, rounded outward, and float rays that start on the box they enter; every decision is taken in double from the
// packet's own record. Placed parts are user geometry too, not Embree instances: their callback moves the rays into the part's coordinates
// in double and traces the part's scene from there, so a small part far away is met as exactly as one at the origin. Parts with a mesh are
// Embree's triangles (embree_triangles.cpp), every one of which asks a filter.
#include <embree3/rtcore.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <map>

#include "raytracer/all_hits.h"
#include "raytracer/embree_triangles.h"
#include "raytracer/face_hits.h"
#include "raytracer/packet.h"
#include "raytracer/tracer.h"
#include "raytracer/triangle_hits.h"

namespace iso {

namespace {

struct PartScene {
  PartGeometry geometry;
  RTCScene scene = nullptr;
  const PartMesh* mesh = nullptr;  // what the scene is made of, if not the geometry
  double ray_size = 0;             // the size for `enter_part`
};

struct PlacedPart {
  const PartScene* part = nullptr;
  Affine3 to_part;
  Box3 world_box;
};

struct Context {
  RTCIntersectContext embree;
  Packet packet;
  bool coherent = true;
  const PlacedPart* placed = nullptr;  // all of them
  LocalRays top;                       // the rays in the world, for the top level
};

// At least x, which is not negative, in float.
float rounded_up(double x) { return static_cast<float>(x * (1 + 3e-7)); }

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
float far_limit(const Packet& packet, const LocalRays& rays, int lane) {
  return rounded_up((packet.limit[lane] - rays.shift[lane]) * rays.length[lane] + 2 * rays.slack);
}

constexpr float kBlocked = -std::numeric_limits<float>::infinity();

// The lanes of Embree's rays: its packets may be narrower than ours.
LaneMask live_lanes(const int* valid, const RTCRayN* rays, unsigned n) {
  LaneMask lanes = 0;
  if (n == kWidth) {
    for (unsigned i = 0; i < kWidth; ++i) lanes |= static_cast<LaneMask>(valid[i]) & 1u << i;  // -1 or 0
    return lanes;
  }
  for (unsigned i = 0; i < n; ++i)
    if (valid[i]) lanes |= 1u << RTCRayN_id(const_cast<RTCRayN*>(rays), n, i);
  return lanes;
}

// Tells Embree and the kernels how far the rays of `changed` still reach.
void shorten(const Packet& packet, LocalRays& local, LaneMask changed, RTCRayN* rays, unsigned n) {
  const auto set = [&](unsigned i, unsigned lane) {
    float& far = RTCRayN_tfar(rays, n, i);
    far = packet.query == Query::occluded ? kBlocked : std::min(far, far_limit(packet, local, static_cast<int>(lane)));
    local.far[lane] = far;
  };
  if (n == kWidth) return for_each_lane(changed, [&](int lane) { set(static_cast<unsigned>(lane), static_cast<unsigned>(lane)); });
  for (unsigned i = 0; i < n; ++i)
    if (const unsigned lane = RTCRayN_id(rays, n, i); changed >> lane & 1) set(i, lane);
}

using Meet = LaneMask (*)(Packet&, LaneMask, const PartGeometry&, std::uint32_t);

template <Meet meet>
void meet_part(const int* valid, void* user, RTCIntersectContext* embree, RTCRayN* rays, unsigned n, unsigned primitive) {
  Packet& packet = reinterpret_cast<Context*>(embree)->packet;
  const LaneMask lanes = live_lanes(valid, rays, n) & ~packet.blocked;
  if (!lanes) return;
  const LaneMask changed = meet(packet, lanes, static_cast<const PartScene*>(user)->geometry, primitive);
  if (changed) shorten(packet, packet.local, changed, rays, n);
}
template <Meet meet>
void intersect_part(const RTCIntersectFunctionNArguments* args) {
  meet_part<meet>(args->valid, args->geometryUserPtr, args->context, RTCRayHitN_RayN(args->rayhit, args->N), args->N, args->primID);
}
template <Meet meet>
void occlude_part(const RTCOccludedFunctionNArguments* args) {
  meet_part<meet>(args->valid, args->geometryUserPtr, args->context, args->ray, args->N, args->primID);
}

// Of a single ray, N = 1. Taken or not, triangles up to the slack behind the nearest hit are still asked about.
void meet_mesh(const RTCFilterFunctionNArguments* args) {
  Packet& packet = reinterpret_cast<Context*>(args->context)->packet;
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const auto& part = *static_cast<const PartScene*>(args->geometryUserPtr);
  const auto lane = static_cast<int>(ray.id);
  if (meet_triangle(packet, lane, *part.mesh, hit.primID, {ray.tfar - packet.local.slack, {hit.u, hit.v}}))
    ray.tfar = packet.query == Query::occluded ? kBlocked : far_limit(packet, packet.local, lane);
  else
    args->valid[0] = 0;
}

// Lanes that take no part must still hold rays: Embree's narrower kernels look at all of them. These end before they begin.
void set_rays(RTCRayHit16& r, const LocalRays& rays, LaneMask lanes) {
  std::memcpy(r.ray.org_x, rays.fo, sizeof rays.fo);
  std::memcpy(r.ray.dir_x, rays.fd, sizeof rays.fd);
  for (unsigned i = 0; i < kWidth; ++i) {
    const bool live = lanes >> i & 1;
    r.ray.tnear[i] = live ? 0 : std::numeric_limits<float>::infinity();
    r.ray.tfar[i] = live ? rays.far[i] : kBlocked;
    r.ray.time[i] = 0;
    r.ray.mask[i] = 0xffffffffu;
    r.ray.id[i] = i;
    r.ray.flags[i] = 0;
    r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    if (!live)  // what stands there is of no ray
      for (float* x : {r.ray.org_x, r.ray.org_y, r.ray.org_z, r.ray.dir_x, r.ray.dir_y, r.ray.dir_z}) x[i] = 1;
  }
}

RTCRayHit single(const LocalRays& rays, unsigned i) {
  RTCRayHit s;
  s.ray = {
      rays.fo[0][i], rays.fo[1][i], rays.fo[2][i], 0.f, rays.fd[0][i], rays.fd[1][i], rays.fd[2][i], 0.f, rays.far[i], 0xffffffffu, i, 0u};
  s.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return s;
}

// Packets where at least this many lanes live and the rays are neighbours; single rays else.
constexpr unsigned kPacketFrom = 3;

void trace(RTCScene scene, Context& context, const LocalRays& local, LaneMask lanes) {
  if (!lanes) return;
  const bool occluded = context.packet.query == Query::occluded;
  if (context.coherent && lane_count(lanes) >= kPacketFrom) {
    alignas(64) RTCRayHit16 rays;
    alignas(64) int valid[kWidth];
    for (unsigned i = 0; i < kWidth; ++i) valid[i] = lanes >> i & 1 ? -1 : 0;
    set_rays(rays, local, lanes);
    if (occluded)
      rtcOccluded16(valid, scene, &context.embree, reinterpret_cast<RTCRay16*>(&rays.ray));
    else
      rtcIntersect16(valid, scene, &context.embree, &rays);
    return;
  }
  for_each_lane(lanes, [&](int lane) {
    RTCRayHit one = single(local, static_cast<unsigned>(lane));
    if (occluded)
      rtcOccluded1(scene, &context.embree, &one.ray);
    else
      rtcIntersect1(scene, &context.embree, &one);
  });
}

// Traces lanes through one placed part.
void trace_placed(Context& context, int placed_index, LaneMask wanted) {
  const PlacedPart& placed = context.placed[placed_index];
  const PartGeometry& geometry = placed.part->geometry;
  const LaneMask lanes = enter_part(context.packet, wanted, placed.to_part, geometry.box, placed.part->ray_size, context.packet.local);
  const int before = context.packet.current;
  const bool coherent = context.coherent;
  context.packet.current = placed_index;
  if (placed.part->mesh) context.coherent = false;  // at edges, packets may round to other triangles than single rays
  trace(placed.part->scene, context, context.packet.local, lanes);
  context.packet.current = before;
  context.coherent = coherent;
}

void enter_placed(const int* valid, RTCIntersectContext* embree, RTCRayN* rays, unsigned n, unsigned primitive) {
  auto& context = *reinterpret_cast<Context*>(embree);
  const LaneMask wanted = live_lanes(valid, rays, n) & ~context.packet.blocked;
  if (!wanted) return;
  trace_placed(context, static_cast<int>(primitive), wanted);
  // Whether a lane changed is not known here: all are told.
  if (context.packet.query == Query::occluded)
    shorten(context.packet, context.top, wanted & context.packet.blocked, rays, n);
  else if (context.packet.query == Query::nearest)
    shorten(context.packet, context.top, wanted, rays, n);
}
void intersect_placed(const RTCIntersectFunctionNArguments* args) {
  enter_placed(args->valid, args->context, RTCRayHitN_RayN(args->rayhit, args->N), args->N, args->primID);
}
void occlude_placed(const RTCOccludedFunctionNArguments* args) {
  enter_placed(args->valid, args->context, args->ray, args->N, args->primID);
}

// ---- building ----------------------------------------------------------------------------------------------------------

void leaf_bounds(const RTCBoundsFunctionArguments* args) {
  set_box(args->bounds_o, static_cast<const PartScene*>(args->geometryUserPtr)->geometry.leaf_boxes[args->primID]);
}
void analytic_bounds(const RTCBoundsFunctionArguments* args) {
  set_box(args->bounds_o, static_cast<const PartScene*>(args->geometryUserPtr)->geometry.analytic[args->primID].box);
}

// Compact trees are a fifth smaller here and as fast.
constexpr auto kSceneFlags = static_cast<RTCSceneFlags>(int{RTC_SCENE_FLAG_ROBUST} | int{RTC_SCENE_FLAG_COMPACT});

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
  Affine3 to_top;  // the top level's origin is the centre
  double top_size = 0;
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
    rtcSetSceneFlags(out->scene, kSceneFlags);
    attach(device, out->scene, out->geometry.leaves.size(), out.get(), leaf_bounds, intersect_part<meet_leaf>, occlude_part<meet_leaf>);
    attach(device, out->scene, out->geometry.analytic.size(), out.get(), analytic_bounds, intersect_part<meet_analytic>,
           occlude_part<meet_analytic>);
    rtcCommitScene(out->scene);
    out->geometry.leaf_boxes = {};
    out->ray_size = out->geometry.size;
    build.bezier_patches += out->geometry.patches.size();
    build.leaves += out->geometry.leaves.size();
    build.analytic_faces += out->geometry.analytic.size();
    build.bytes += out->geometry.bytes();
    return out;
  }

  std::unique_ptr<PartScene> build_mesh(const Part& part, const PartMesh& mesh) {
    auto out = std::make_unique<PartScene>();
    out->geometry = mesh_geometry(part, mesh);
    out->mesh = &mesh;
    out->scene = new_triangle_scene(device, mesh, out.get(), meet_mesh);
    out->ray_size = kTriangleSlack / kStartSlack * out->geometry.size;
    build.triangles += mesh.triangles.size();
    build.bytes += bytes_of(mesh);
    return out;
  }

  void build_parts() {
    std::map<std::pair<const Part*, const PartMesh*>, const PartScene*> known;
    for (const Placed& p : scene.placed) {
      const PartScene*& part = known[{p.part.get(), p.mesh.get()}];
      if (!part) {
        parts.push_back(p.mesh ? build_mesh(*p.part, *p.mesh) : build_part(*p.part));
        part = parts.back().get();
      }
      PlacedPart entry{part, inverse(p.to_world), transformed(p.to_world, part->geometry.box)};
      if (!part->geometry.box.empty()) box.include(entry.world_box);
      placed.push_back(entry);
    }
    if (!box.empty()) centre = box.middle();
    const double slack = 1e-6 * box.diagonal();
    if (!box.empty()) box = box.inflated(slack);
    to_top.translation = -centre;
    top_size = box.diagonal();
    for (PlacedPart& p : placed) p.world_box = {p.world_box.lo - centre - slack, p.world_box.hi - centre + slack};
  }

  void build_top() {
    if (placed.size() < 2) return;
    top = rtcNewScene(device);
    rtcSetSceneFlags(top, kSceneFlags);
    attach(
        device, top, placed.size(), placed.data(),
        [](const RTCBoundsFunctionArguments* args) {
          set_box(args->bounds_o, static_cast<const PlacedPart*>(args->geometryUserPtr)[args->primID].world_box);
        },
        intersect_placed, occlude_placed);
    rtcCommitScene(top);
  }

  // The rays that are in the packet.
  void trace_packet(Context& context, LaneMask lanes) const {
    if (!top) {
      if (!placed.empty()) trace_placed(context, 0, lanes);
      return;
    }
    trace(top, context, context.top, enter_part(context.packet, lanes, to_top, {box.lo - centre, box.hi - centre}, top_size, context.top));
  }

  // The rays of the next packet come from memory while this one is traced.
  static void prefetch(std::span<const Ray> rays, std::size_t first) {
    if (first >= rays.size()) return;
    constexpr std::size_t kLine = 64;
    const std::size_t end = std::min<std::size_t>(rays.size(), first + kWidth);
    const auto *from = reinterpret_cast<const char*>(rays.data() + first), *to = reinterpret_cast<const char*>(rays.data() + end);
    for (; from < to; from += kLine) __builtin_prefetch(from);
  }

  // Runs `rays` through in sixteens; `begin(i, lane)` and `done(i, lane)` for each.
  template <class Begin, class Done>
  void batches(std::span<const Ray> rays, Query query, bool coherent, SolverStats& stats, const Begin& begin, const Done& done) const {
    Context context;
    rtcInitIntersectContext(&context.embree);
    context.coherent = coherent;
    context.placed = placed.data();
    Packet& packet = context.packet;
    packet.query = query;
    SolverStats counted;  // our own: the caller's may share a cache line with another thread's
    counted.rays = rays.size();
    packet.stats = &counted;
    for (std::size_t first = 0; first < rays.size(); first += kWidth) {
      const int count = static_cast<int>(std::min<std::size_t>(kWidth, rays.size() - first));
      prefetch(rays, first + kWidth);
      for (int i = 0; i < count; ++i) {
        const Ray& ray = rays[first + i];
        for (int c = 0; c < 3; ++c) {
          packet.o[c][i] = ray.o[c];
          packet.d[c][i] = ray.d[c];
        }
        packet.tmin[i] = ray.tmin;
        packet.limit[i] = ray.tmax;
        packet.from_placed[i] = ray.from_placed;
        packet.from_primitive[i] = ray.from_primitive;
        begin(first + i, packet, i);
      }
      for (int i = count; i < kWidth; ++i) {  // of no ray, but numbers
        for (int c = 0; c < 3; ++c) packet.o[c][i] = packet.d[c][i] = 1;
        packet.tmin[i] = packet.limit[i] = 0;
      }
      packet.blocked = 0;
      trace_packet(context, (1u << count) - 1);
      for (int i = 0; i < count; ++i) done(first + i, packet, i);
    }
    stats += counted;
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
      rays, Query::nearest, order == Order::coherent, stats,
      [&](std::size_t i, Packet& packet, int lane) {
        hits[i] = Hit{};
        if (lane == 0) packet.best = &hits[i];
      },
      [](std::size_t, const Packet&, int) {});
}

void Tracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked, Order order, SolverStats& stats) const {
  ISO_CHECK(blocked.size() == rays.size());
  impl_->batches(
      rays, Query::occluded, order == Order::coherent, stats, [](std::size_t, Packet&, int) {},
      [&](std::size_t i, const Packet& packet, int lane) { blocked[i] = packet.blocked >> lane & 1; });
}

void Tracer::all(std::span<const Ray> rays, std::vector<Hit>& hits, std::vector<std::size_t>& offsets, SolverStats& stats) const {
  hits.clear();
  offsets.assign(1, 0);
  std::array<std::vector<Hit>, kWidth> found;
  const double size = impl_->box.diagonal();
  impl_->batches(
      rays, Query::all, false, stats,
      [&](std::size_t, Packet& packet, int lane) {
        found[lane].clear();
        packet.all[lane] = &found[lane];
      },
      [&](std::size_t i, const Packet& packet, int lane) {
        std::vector<Hit>& all = *packet.all[lane];
        sort_and_remove_doubles(*this, rays[i], size, all);
        hits.insert(hits.end(), all.begin(), all.end());
        offsets.push_back(hits.size());
      });
}

// ---- surroundings of a hit ---------------------------------------------------------------------------------------------

SurfacePoint Tracer::surface_point(const Hit& hit) const {
  const Placed& placed = impl_->scene.placed[static_cast<std::size_t>(hit.placed)];
  const PlacedPart& part = impl_->placed[static_cast<std::size_t>(hit.placed)];
  const double size = part.part->geometry.size;
  if (!placed.mesh) return point_on_face(placed, part.to_part, size, hit);
  return point_on_triangle(placed, part.to_part, size, hit, impl_->scene.mesh_shading, impl_->scene.terminator);
}

Curvatures Tracer::curvatures(const Hit& hit) const {
  const PlacedPart& part = impl_->placed[static_cast<std::size_t>(hit.placed)];
  const SurfacePoint exact =
      point_on_face(impl_->scene.placed[static_cast<std::size_t>(hit.placed)], part.to_part, part.part->geometry.size, hit);
  return {exact.k1, exact.k2};
}

Mat3 Tracer::shape_operator(const Hit& hit) const {
  const auto placed = static_cast<std::size_t>(hit.placed);
  return shape_operator_on_face(impl_->scene.placed[placed], impl_->placed[placed].to_part, hit);
}

bool Tracer::meet_at_loose_edge(const Hit& a, const Hit& b) const {
  if (a.placed != b.placed) return false;
  const PartGeometry& geometry = impl_->placed[static_cast<std::size_t>(a.placed)].part->geometry;
  return !geometry.trims.empty() && iso::meet_at_loose_edge(geometry, a, b);  // a mesh has no trims
}

}  // namespace iso
