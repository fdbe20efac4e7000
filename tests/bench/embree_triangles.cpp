// The only file of the benchmarks that includes Embree.
#include "tests/bench/embree_triangles.h"

#include <embree3/rtcore.h>

#include <atomic>

#include "tests/bench/timing.h"

namespace iso::bench {

const char* name_of(Build build) { return build == Build::medium ? "MEDIUM" : build == Build::high ? "HIGH" : "GRID"; }
const char* name_of(Mode mode) { return mode == Mode::packets ? "packets" : "single"; }

struct EmbreeTriangles::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Build build = Build::medium;
  bool has_packets_of_16 = true;  // else Embree takes them apart, and packets of 8 are faster
  std::atomic<std::int64_t> bytes{0};
  double seconds = 0;

  static bool count_memory(void* self, ssize_t bytes, bool) {
    static_cast<Impl*>(self)->bytes += bytes;
    return true;
  }
};

namespace {

void set_triangles(RTCGeometry geometry, const TriangleMesh& mesh) {
  auto* corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
}

void set_grids(RTCGeometry geometry, const TriangleMesh& mesh) {
  auto* grids = static_cast<RTCGrid*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), mesh.grids.size()));
  constexpr std::uint32_t kMost = 32767;  // Embree's limit
  for (const MeshGrid& g : mesh.grids) {
    ISO_CHECK(g.rows <= kMost && g.columns <= kMost);
    *grids++ = {g.first, g.columns, static_cast<unsigned short>(g.columns), static_cast<unsigned short>(g.rows)};
  }
}

}  // namespace

EmbreeTriangles::EmbreeTriangles(const TriangleMesh& mesh, Build build, const std::string& device) : impl_(std::make_unique<Impl>()) {
  ISO_CHECK(build != Build::grid || !mesh.grids.empty());
  impl_->build = build;
  impl_->device = rtcNewDevice(("threads=1" + (device.empty() ? "" : "," + device)).c_str());
  ISO_CHECK(impl_->device != nullptr);
  impl_->has_packets_of_16 = rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  rtcSetDeviceMemoryMonitorFunction(impl_->device, Impl::count_memory, impl_.get());
  impl_->seconds = seconds_of([&] {
    impl_->scene = rtcNewScene(impl_->device);
    rtcSetSceneBuildQuality(impl_->scene, build == Build::high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry geometry = rtcNewGeometry(impl_->device, build == Build::grid ? RTC_GEOMETRY_TYPE_GRID : RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
    for (const Vec3& p : mesh.points)
      for (int c = 0; c < 3; ++c) *points++ = static_cast<float>(p[c]);
    (build == Build::grid ? set_grids : set_triangles)(geometry, mesh);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->scene);
  });
  ISO_CHECK(rtcGetDeviceError(impl_->device) == RTC_ERROR_NONE);
}

EmbreeTriangles::~EmbreeTriangles() {
  if (!impl_) return;
  rtcReleaseScene(impl_->scene);
  rtcReleaseDevice(impl_->device);
}
EmbreeTriangles::EmbreeTriangles(EmbreeTriangles&&) noexcept = default;

Build EmbreeTriangles::build() const { return impl_->build; }
double EmbreeTriangles::build_seconds() const { return impl_->seconds; }
std::size_t EmbreeTriangles::bytes() const { return static_cast<std::size_t>(impl_->bytes.load()); }

namespace {

struct Wide16 {
  using RayHits = RTCRayHit16;
  static constexpr unsigned kWidth = 16;
  static constexpr auto kNearest = rtcIntersect16;
  static constexpr auto kOccluded = rtcOccluded16;
};
struct Wide8 {
  using RayHits = RTCRayHit8;
  static constexpr unsigned kWidth = 8;
  static constexpr auto kNearest = rtcIntersect8;
  static constexpr auto kOccluded = rtcOccluded8;
};

RTCIntersectContext context_of(Mode mode) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (mode == Mode::packets) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

// Calls trace(valid, packet) for the packets of the rays, then done(i, packet, lane) for each ray.
template <class Wide, class Trace, class Done>
void for_packets(std::span<const FloatRay> rays, const Trace& trace, const Done& done) {
  constexpr unsigned kWidth = Wide::kWidth;
  alignas(64) typename Wide::RayHits packet{};
  alignas(64) int valid[kWidth];
  std::fill_n(packet.ray.mask, kWidth, 0xffffffffu);
  for (std::size_t first = 0; first < rays.size(); first += kWidth) {
    for (unsigned i = 0; i < kWidth; ++i) {
      valid[i] = first + i < rays.size() ? -1 : 0;
      const FloatRay& ray = rays[std::min(first + i, rays.size() - 1)];
      packet.ray.org_x[i] = ray.o.x;
      packet.ray.org_y[i] = ray.o.y;
      packet.ray.org_z[i] = ray.o.z;
      packet.ray.tnear[i] = ray.tmin;
      packet.ray.dir_x[i] = ray.d.x;
      packet.ray.dir_y[i] = ray.d.y;
      packet.ray.dir_z[i] = ray.d.z;
      packet.ray.tfar[i] = ray.tmax;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    trace(valid, packet);
    for (unsigned i = 0; i < kWidth && first + i < rays.size(); ++i) done(first + i, packet, i);
  }
}

template <class Wide>
void nearest_in_packets(RTCScene scene, std::span<const FloatRay> rays, std::span<TriangleHit> hits) {
  RTCIntersectContext context = context_of(Mode::packets);
  for_packets<Wide>(
      rays, [&](const int* valid, auto& packet) { Wide::kNearest(valid, scene, &context, &packet); },
      [&](std::size_t ray, const auto& packet, unsigned i) {
        const bool hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        hits[ray] = hit ? TriangleHit{packet.ray.tfar[i], packet.hit.primID[i]} : TriangleHit{};
      });
}

template <class Wide>
void occluded_in_packets(RTCScene scene, std::span<const FloatRay> rays, std::span<std::uint8_t> blocked) {
  RTCIntersectContext context = context_of(Mode::packets);
  for_packets<Wide>(
      rays, [&](const int* valid, auto& packet) { Wide::kOccluded(valid, scene, &context, &packet.ray); },
      [&](std::size_t ray, const auto& packet, unsigned i) { blocked[ray] = packet.ray.tfar[i] < 0; });
}

RTCRay embree_ray(const FloatRay& ray) {
  return {ray.o.x, ray.o.y, ray.o.z, ray.tmin, ray.d.x, ray.d.y, ray.d.z, 0.0f, ray.tmax, 0xffffffffu, 0u, 0u};
}

void nearest_singly(RTCScene scene, std::span<const FloatRay> rays, std::span<TriangleHit> hits) {
  RTCIntersectContext context = context_of(Mode::single);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RTCRayHit one{};
    one.ray = embree_ray(rays[i]);
    one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &one);
    hits[i] = one.hit.geomID != RTC_INVALID_GEOMETRY_ID ? TriangleHit{one.ray.tfar, one.hit.primID} : TriangleHit{};
  }
}

void occluded_singly(RTCScene scene, std::span<const FloatRay> rays, std::span<std::uint8_t> blocked) {
  RTCIntersectContext context = context_of(Mode::single);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RTCRay one = embree_ray(rays[i]);
    rtcOccluded1(scene, &context, &one);
    blocked[i] = one.tfar < 0;
  }
}

}  // namespace

void EmbreeTriangles::nearest(std::span<const FloatRay> rays, std::span<TriangleHit> hits, Mode mode) const {
  ISO_CHECK(hits.size() == rays.size());
  const auto packets = impl_->has_packets_of_16 ? nearest_in_packets<Wide16> : nearest_in_packets<Wide8>;
  (mode == Mode::packets ? packets : nearest_singly)(impl_->scene, rays, hits);
}

void EmbreeTriangles::occluded(std::span<const FloatRay> rays, std::span<std::uint8_t> blocked, Mode mode) const {
  ISO_CHECK(blocked.size() == rays.size());
  const auto packets = impl_->has_packets_of_16 ? occluded_in_packets<Wide16> : occluded_in_packets<Wide8>;
  (mode == Mode::packets ? packets : occluded_singly)(impl_->scene, rays, blocked);
}

}  // namespace iso::bench
