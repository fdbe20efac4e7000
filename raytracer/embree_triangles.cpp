#include "raytracer/embree_triangles.h"

#include "patches/base/check.h"

namespace iso {

RTCScene new_triangle_scene(RTCDevice device, const PartMesh& mesh, void* user, RTCFilterFunctionN filter) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  if (!mesh.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    ISO_CHECK(points && corners);
    for (const Point3& p : mesh.points)
      for (int c = 0; c < 3; ++c) *points++ = static_cast<float>(p[c]);
    for (const Triangle& triangle : mesh.triangles)
      for (const std::uint32_t node : triangle) {
        ISO_CHECK(node < mesh.nodes.size() && mesh.nodes[node].point < mesh.points.size());
        *corners++ = mesh.nodes[node].point;
      }
    rtcSetGeometryUserData(geometry, user);
    rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcSetGeometryOccludedFilterFunction(geometry, filter);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  return scene;
}

}  // namespace iso
