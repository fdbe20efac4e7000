// The only file of the benchmarks that includes Embree.
#include "tests/bench/embree_triangles.h"

#include <embree3/rtcore.h>

#include <atomic>

#include "tests/bench/timing.h"

namespace iso::bench {

const char* name_of(Build build) { return build == Build::medium ? "MEDIUM" : "HIGH"; }

struct EmbreeTriangles::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<std::int64_t> bytes{0};
  double seconds = 0;

  static bool count_memory(void* self, ssize_t bytes, bool) {
    static_cast<Impl*>(self)->bytes += bytes;
    return true;
  }
};

EmbreeTriangles::EmbreeTriangles(const TriangleMesh& mesh, Build build) : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice("threads=1");
  ISO_CHECK(impl_->device != nullptr);
  rtcSetDeviceMemoryMonitorFunction(impl_->device, Impl::count_memory, impl_.get());
  impl_->seconds = seconds_of([&] {
    impl_->scene = rtcNewScene(impl_->device);
    rtcSetSceneBuildQuality(impl_->scene, build == Build::medium ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
    for (const Vec3& p : mesh.points)
      for (int c = 0; c < 3; ++c) *points++ = static_cast<float>(p[c]);
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
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

double EmbreeTriangles::build_seconds() const { return impl_->seconds; }
std::size_t EmbreeTriangles::bytes() const { return static_cast<std::size_t>(impl_->bytes.load()); }

namespace {

constexpr unsigned kWidth = 16;

void trace_packets(RTCScene scene, std::span<const FloatRay> rays, std::span<TriangleHit> hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) RTCRayHit16 packet{};
  alignas(64) int valid[kWidth];
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
      packet.ray.mask[i] = 0xffffffffu;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid, scene, &context, &packet);
    for (unsigned i = 0; i < kWidth && first + i < rays.size(); ++i) {
      const bool hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      hits[first + i] = hit ? TriangleHit{packet.ray.tfar[i], packet.hit.primID[i]} : TriangleHit{};
    }
  }
}

void trace_single(RTCScene scene, std::span<const FloatRay> rays, std::span<TriangleHit> hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const FloatRay& ray = rays[i];
    RTCRayHit one{};
    one.ray = {ray.o.x, ray.o.y, ray.o.z, ray.tmin, ray.d.x, ray.d.y, ray.d.z, 0.0f, ray.tmax, 0xffffffffu, 0u, 0u};
    one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &one);
    hits[i] = one.hit.geomID != RTC_INVALID_GEOMETRY_ID ? TriangleHit{one.ray.tfar, one.hit.primID} : TriangleHit{};
  }
}

}  // namespace

void EmbreeTriangles::nearest(std::span<const FloatRay> rays, std::span<TriangleHit> hits, Tracer::Order order) const {
  ISO_CHECK(hits.size() == rays.size());
  (order == Tracer::Order::coherent ? trace_packets : trace_single)(impl_->scene, rays, hits);
}

}  // namespace iso::bench
