#include "raytracer/triangle_hits.h"

namespace iso {
namespace {

// Boxes are larger than the mesh by this share of its size: float rays start on them.
constexpr double kBoxInflation = 1e-6;

// The rounding of a crossing in float, as a share of the mesh's size: of the vertices, of the ray, and of Embree's edge functions.
constexpr double kFloatRounding = 1e-6;

const Triangle& triangle_of(const PartMesh& mesh, std::int32_t primitive) { return mesh.triangles[static_cast<std::size_t>(primitive)]; }

std::int32_t face_of(const PartMesh& mesh, std::uint32_t triangle) {
  const auto after = std::upper_bound(mesh.first_triangle.begin(), mesh.first_triangle.end(), triangle);
  return static_cast<std::int32_t>(after - mesh.first_triangle.begin()) - 1;
}

// Weights of the three corners, none negative, of sum 1.
Vec3 inside(Vec3 weights) {
  weights = glm::max(weights, Vec3(0.0));
  return weights / (weights.x + weights.y + weights.z);
}

struct Crossing {
  double t;      // along the local ray
  Vec3 weights;  // of the corners
};

// Where the ray o + t d crosses the plane of a triangle. Edge functions of a shared edge are computed alike from both sides.
Crossing cross_plane(const Vec3& o, const Vec3& d, const Vec3& p0, const Vec3& p1, const Vec3& p2) {
  const Vec3 a = p0 - o, b = p1 - o, c = p2 - o;
  const Vec3 edges{glm::dot(d, glm::cross(c, b)), glm::dot(d, glm::cross(a, c)), glm::dot(d, glm::cross(b, a))};
  const Vec3 n = glm::cross(p1 - p0, p2 - p0);
  return {glm::dot(a, n) / glm::dot(d, n), edges / (edges.x + edges.y + edges.z)};
}

// A ray that leaves a triangle stays on its side of the plane: what does not reach there is not met, so not its neighbours at an edge or
// corner from which it starts.
bool behind_start(const Packet& packet, int lane, const PartMesh& mesh, const Vec3& d, const Point3& p) {
  if (packet.from_placed[lane] != packet.current || packet.from_primitive[lane] < 0) return false;
  const Triangle& from = triangle_of(mesh, packet.from_primitive[lane]);
  const Point3& a = mesh.corner(from, 0);
  const Vec3 n = glm::cross(mesh.corner(from, 1) - a, mesh.corner(from, 2) - a);
  const double size = packet.local.slack / kTriangleSlack, rounding = 64 * kEps * size * glm::length(n);
  return (glm::dot(n, d) < 0 ? -1 : 1) * glm::dot(n, p - a) <= rounding;
}

}  // namespace

PartGeometry mesh_geometry(const Part& part, const PartMesh& mesh) {
  ISO_CHECK(static_cast<std::size_t>(mesh.face_count()) == part.faces.size());
  ISO_CHECK(mesh.first_triangle.back() == mesh.triangles.size() && mesh.triangles.size() <= 0x7fffffffu);
  PartGeometry geometry;
  geometry.part = &part;
  for (const Point3& p : mesh.points) geometry.box.include(p);
  geometry.size = geometry.box.diagonal();
  geometry.box = geometry.box.inflated(kBoxInflation * geometry.size);
  return geometry;
}

std::size_t bytes_of(const PartMesh& mesh) {
  return mesh.points.size() * sizeof(Point3) + mesh.nodes.size() * sizeof(MeshNode) + mesh.triangles.size() * sizeof(Triangle) +
         (mesh.first_node.size() + mesh.first_triangle.size()) * sizeof(std::uint32_t);
}

bool meet_triangle(Packet& packet, int lane, const PartMesh& mesh, std::uint32_t triangle, const FloatHit& found) {
  const auto primitive = static_cast<std::int32_t>(triangle);
  if (packet.start_on(1u << lane, primitive)) return false;
  const Triangle& corners = mesh.triangles[triangle];
  const LocalRays& local = packet.local;
  const Vec3 o{local.o[0][lane], local.o[1][lane], local.o[2][lane]}, d{local.d[0][lane], local.d[1][lane], local.d[2][lane]};
  Crossing crossing = cross_plane(o, d, mesh.corner(corners, 0), mesh.corner(corners, 1), mesh.corner(corners, 2));

  // Embree decides what is passed: what double sees beyond an edge is on it. Its word stands where a ray runs along the plane.
  const double slack = local.slack / local.length[lane], by_float = found.distance / local.length[lane];
  if (!finite(crossing.t) || !finite(crossing.weights))
    crossing = {by_float, {1 - found.weights.x - found.weights.y, found.weights.x, found.weights.y}};
  const Vec3 weights = inside(crossing.weights);
  const double t = std::clamp(crossing.t, by_float - slack, by_float + slack);

  Hit hit;
  hit.t = local.shift[lane] + t;
  if (!(hit.t >= packet.tmin[lane] && hit.t <= packet.limit[lane])) return false;
  Point3 p{0.0};
  for (int k = 0; k < 3; ++k) {
    p += weights[k] * mesh.corner(corners, k);
    hit.uv += weights[k] * mesh.nodes[corners[static_cast<std::size_t>(k)]].uv;
  }
  if (behind_start(packet, lane, mesh, d, p)) return false;
  hit.placed = packet.current;
  hit.face = face_of(mesh, triangle);
  hit.primitive = primitive;
  hit.weights = glm::vec2(static_cast<float>(weights.y), static_cast<float>(weights.z));
  return take(packet, lane, hit);
}

namespace {

// One corner as shading sees it, in part coordinates.
struct Corner {
  Point3 p;
  Vec3 n;  // the triangle's where the node has none
};

// How far p lies under the tangent planes of the corners, each on its side, by the weights: added to p, rays along the smooth surface clear
// the facets. [Hanika 2021, Hacking the Shadow Terminator]
Vec3 lift(const Corner (&corners)[3], const Vec3& weights, const Point3& p, double side) {
  Vec3 sum{0.0};
  for (int k = 0; k < 3; ++k) {
    const Vec3 n = side * corners[k].n;
    sum -= weights[k] * std::min(0.0, glm::dot(p - corners[k].p, n)) * n;
  }
  return sum;
}

// The map from (u, v) to space that takes the triangle's nodes to its corners: its two columns; zero where the nodes lie on a line.
void set_tangents(const PartMesh& mesh, const Triangle& t, const Placed& placed, SurfacePoint& out) {
  const Vec2 a = mesh.nodes[t[1]].uv - mesh.nodes[t[0]].uv, b = mesh.nodes[t[2]].uv - mesh.nodes[t[0]].uv;
  const Vec3 ea = placed.to_world.vector(mesh.corner(t, 1) - mesh.corner(t, 0)),
             eb = placed.to_world.vector(mesh.corner(t, 2) - mesh.corner(t, 0));
  const double area = a.x * b.y - a.y * b.x;
  out.Su = out.Sv = Vec3(0.0);
  if (area == 0 || !finite(1 / area)) return;
  out.Su = (b.y * ea - a.y * eb) / area;
  out.Sv = (a.x * eb - b.x * ea) / area;
}

}  // namespace

SurfacePoint point_on_triangle(const Placed& placed, const Affine3& to_part, double size, const Hit& hit, MeshShading shading,
                               Terminator terminator) {
  const PartMesh& mesh = *placed.mesh;
  const Triangle& t = triangle_of(mesh, hit.primitive);
  const Vec3 ng = glm::normalize(glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
  const double w1 = hit.weights.x, w2 = hit.weights.y;
  const Vec3 weights = inside({1 - w1 - w2, w1, w2});
  Corner corners[3];
  Point3 p{0.0};
  Vec3 n{0.0};
  for (int k = 0; k < 3; ++k) {
    const Vec3& normal = mesh.nodes[t[static_cast<std::size_t>(k)]].normal;
    corners[k] = {mesh.corner(t, k), normal == Vec3(0.0) ? ng : normal};
    p += weights[k] * corners[k].p;
    n += weights[k] * corners[k].n;
  }

  SurfacePoint out;
  out.p = placed.to_world.point(p);
  out.ng = transform_normal(to_part, ng);
  // Normals that contradict the triangle are not believed.
  const bool smooth = shading == MeshShading::smooth && glm::dot(n, ng) > 0;
  out.n = smooth ? transform_normal(to_part, n) : out.ng;
  out.side = out.ng;
  if (smooth && terminator == Terminator::softened) {
    out.side = out.n;
    out.lift_out = placed.to_world.vector(lift(corners, weights, p, 1));
    out.lift_in = placed.to_world.vector(lift(corners, weights, p, -1));
  }
  set_tangents(mesh, t, placed, out);
  out.k1 = out.k2 = std::numeric_limits<double>::quiet_NaN();
  out.error_bound = rounding_of_point(placed.to_world, size + std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), out.p);
  return out;
}

bool cross_at_shared_corner(const Placed& placed, const Hit& a, const Hit& b, double apart, double cosine) {
  if (apart > kFloatRounding * transformed(placed.to_world, placed.part->box).diagonal() / cosine) return false;
  const Triangle &ta = triangle_of(*placed.mesh, a.primitive), &tb = triangle_of(*placed.mesh, b.primitive);
  for (const std::uint32_t i : ta)
    for (const std::uint32_t k : tb)
      if (placed.mesh->nodes[i].point == placed.mesh->nodes[k].point) return true;
  return false;
}

}  // namespace iso
