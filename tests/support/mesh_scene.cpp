#include "tests/support/mesh_scene.h"

#include <embree3/rtcore.h>

namespace iso::test {

struct MeshScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 middle{0.0};
  double radius = 0;  // of the ball about `middle` that holds the mesh
};

MeshScene::MeshScene(const OcctMesh& mesh) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.middle = mesh.box.middle();
  s.radius = 0.5 * mesh.box.diagonal();
  s.device = rtcNewDevice("threads=1");
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);  // no ray slips between neighbouring triangles
  const RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
  for (const Vec3& p : mesh.points)
    for (int c = 0; c < 3; ++c) *points++ = float(p[c] - s.middle[c]);
  auto* corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const MeshTriangle& t : mesh.triangles) corners = std::copy(t.corners.begin(), t.corners.end(), corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(s.scene);
}

MeshScene::~MeshScene() {
  rtcReleaseScene(state_->scene);
  rtcReleaseDevice(state_->device);
}

MeshHit MeshScene::nearest(const Ray& ray) const {
  const State& s = *state_;
  // The start moves along the ray to the ball's surface, in double.
  const double skip = std::max(0.0, glm::dot(s.middle - ray.o, ray.d) - 1.1 * s.radius);
  const Vec3 o = ray.o + skip * ray.d - s.middle;
  RTCRayHit query{};
  query.ray.org_x = float(o.x), query.ray.org_y = float(o.y), query.ray.org_z = float(o.z);
  query.ray.dir_x = float(ray.d.x), query.ray.dir_y = float(ray.d.y), query.ray.dir_z = float(ray.d.z);
  query.ray.tfar = float(4 * s.radius);
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(s.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {skip + double(query.ray.tfar), std::int32_t(query.hit.primID)};
}

double MeshScene::rounding() const { return 1e-6 * state_->radius; }

}  // namespace iso::test
