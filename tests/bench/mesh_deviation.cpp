// With embree_triangles.cpp the only file of the benchmarks that includes Embree.
#include "tests/bench/mesh_deviation.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <random>

#include "patches/base/check.h"

namespace iso::bench {
namespace {

double distance_to_segment(const Point3& p, const Point3& a, const Point3& b) {
  const Vec3 d = b - a;
  const double square = glm::dot(d, d);
  const double t = square > 0 ? std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + t * d));
}

// Above the triangle it is the distance from its plane, else that from its nearest side.
double distance_to_triangle(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const Vec3 n = glm::cross(b - a, c - a);
  const double square = glm::dot(n, n);
  const auto inside = [&](const Point3& from, const Point3& to) { return glm::dot(glm::cross(to - from, p - from), n) >= 0; };
  if (square > 0 && inside(a, b) && inside(b, c) && inside(c, a)) return std::abs(glm::dot(p - a, n)) / std::sqrt(square);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

// Nearest points of a mesh. Embree's boxes are in float about the middle of the mesh; what that rounds away is added to the radius.
class NearestOnMesh {
 public:
  explicit NearestOnMesh(const PartMesh& mesh) : mesh_(mesh), device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    Box3 box;
    for (const Point3& p : mesh.points) box.include(p);
    middle_ = box.empty() ? Point3(0.0) : box.middle();
    constexpr double kFloatRounding = 4 * 0x1p-24;
    slack_ = kFloatRounding * box.diagonal();
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.points.size()));
    for (const Point3& p : mesh.points)
      for (int c = 0; c < 3; ++c) *points++ = static_cast<float>(p[c] - middle_[c]);
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t node : t) *corners++ = mesh.nodes[node].point;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    ISO_CHECK(rtcGetDeviceError(device_) == RTC_ERROR_NONE);
  }
  ~NearestOnMesh() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  NearestOnMesh(const NearestOnMesh&) = delete;
  NearestOnMesh& operator=(const NearestOnMesh&) = delete;

  double own(const Point3& p, const Triangle& t) const {
    return distance_to_triangle(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
  }

  // `known`: of one of the triangles.
  double distance(const Point3& p, double known) const {
    Search search{this, p, known};
    RTCPointQuery query{};
    query.x = static_cast<float>(p.x - middle_.x);
    query.y = static_cast<float>(p.y - middle_.y);
    query.z = static_cast<float>(p.z - middle_.z);
    query.radius = radius(known);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, visit, &search);
    return search.best;
  }

 private:
  struct Search {
    const NearestOnMesh* mesh;
    Point3 p;
    double best;
  };

  float radius(double distance) const {
    constexpr double kMore = 1 + 1e-5;
    return static_cast<float>(kMore * (distance + slack_));
  }

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    Search& search = *static_cast<Search*>(arguments->userPtr);
    const double distance = search.mesh->own(search.p, search.mesh->mesh_.triangles[arguments->primID]);
    if (!(distance < search.best)) return false;
    search.best = distance;
    arguments->query->radius = search.mesh->radius(distance);
    return true;
  }

  const PartMesh& mesh_;
  Point3 middle_{0.0};
  double slack_ = 0;
  RTCDevice device_;
  RTCScene scene_;
};

std::array<Vec3, kSamplesPerTriangle> samples_inside() {
  std::array<Vec3, kSamplesPerTriangle> all;
  constexpr int kParts = 8;
  std::size_t count = 0;
  for (int i = 1; i < kParts; ++i)
    for (int j = 1; i + j < kParts; ++j) all[count++] = Vec3(i, j, kParts - i - j) / double(kParts);
  ISO_CHECK(count == all.size());
  return all;
}

double percentile_999(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * (180 / kPi); }

}  // namespace

MeshDeviation mesh_deviation(const PartMesh& mesh, const MeasuredSurfaces& surfaces, const MeterOptions& options) {
  MeshDeviation result;
  result.faces.resize(static_cast<std::size_t>(mesh.face_count()));
  if (mesh.triangles.empty()) return result;
  const NearestOnMesh nearest(mesh);
  const auto samples = samples_inside();
  std::mt19937_64 random(20261122);
  std::uniform_real_distribution<double> unit(0, 1);
  const double chance = static_cast<double>(options.triangles) / static_cast<double>(mesh.triangles.size());
  std::vector<float> curved;
  for (std::size_t f = 0; f < result.faces.size(); ++f) {
    FaceExtreme& face = result.faces[f];
    for (std::uint32_t i = mesh.first_triangle[f]; i < mesh.first_triangle[f + 1]; ++i) {
      if (chance < 1 && unit(random) > chance) continue;
      const Triangle& t = mesh.triangles[i];
      ++result.triangles;
      for (const Vec3& l : samples) {
        const UV uv = l.x * mesh.nodes[t[0]].uv + l.y * mesh.nodes[t[1]].uv + l.z * mesh.nodes[t[2]].uv;
        const Point3 p = surfaces.point(static_cast<int>(f), uv);
        double distance = nearest.own(p, t);
        if (distance > options.negligible) distance = nearest.distance(p, distance);
        if (!surfaces.flat[f]) curved.push_back(static_cast<float>(distance));
        if (distance > face.distance) face = {distance, uv};
      }
    }
    if (face.distance > result.max) result.max = face.distance, result.worst_face = static_cast<int>(f);
  }
  result.samples = result.triangles * kSamplesPerTriangle;
  result.p999 = percentile_999(curved);
  return result;
}

MeshQuality mesh_quality(const PartMesh& mesh) {
  MeshQuality quality;
  std::vector<PointTriangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({mesh.nodes[a].point, mesh.nodes[b].point, mesh.nodes[c].point});
  quality.topology = check_topology(mesh.points, triangles);
  for (const Triangle& t : mesh.triangles) {
    const Point3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    ++quality.shapes.triangles;
    if (has_no_area(a, b, c)) continue;
    const double least = std::min({degrees_between(b - a, c - a), degrees_between(c - b, a - b), degrees_between(a - c, b - c)});
    quality.shapes.smallest_angle = std::min(quality.shapes.smallest_angle, least);
    quality.shapes.slivers += least < kSliver;
    const Vec3 normals = mesh.nodes[t[0]].normal + mesh.nodes[t[1]].normal + mesh.nodes[t[2]].normal;
    if (normals != Vec3(0.0) && glm::dot(glm::cross(b - a, c - a), normals) <= 0) ++quality.folded;
  }
  return quality;
}

}  // namespace iso::bench
