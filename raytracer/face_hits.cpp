#include "raytracer/face_hits.h"

#include <algorithm>
#include <iterator>

#include "raytracer/tracer.h"

namespace iso {

namespace {

void bring_to_world(const Placed& placed, Jet2& j) {
  for (Vec3* d : {&j.Su, &j.Sv, &j.Suu, &j.Suv, &j.Svv}) *d = placed.to_world.vector(*d);
}

// Unit, outward, in world coordinates; zero where there is none.
Vec3 outward_normal(const Face& face, const Affine3& to_part, UV uv) {
  Vec3 normal = unit_normal(face.surface, uv, face.domain);
  if (face.reversed) normal = -normal;
  return normal == Vec3(0.0) ? normal : transform_normal(to_part, normal);
}

}  // namespace

SurfacePoint point_on_face(const Placed& placed, const Affine3& to_part, double size, const Hit& hit) {
  const Face& f = placed.part->faces[static_cast<std::size_t>(hit.face)];
  Jet2 j = jet2(f.surface, hit.uv);
  SurfacePoint out;
  const double terms = size + size_of_terms(f.surface, j.S);
  out.p = placed.to_world.point(j.S);
  bring_to_world(placed, j);
  out.Su = j.Su;
  out.Sv = j.Sv;
  out.n = outward_normal(f, to_part, hit.uv);
  const Curvatures k = principal_curvatures(j, out.n);
  out.k1 = k.k1;
  out.k2 = k.k2;
  out.error_bound = rounding_of_point(placed.to_world, terms, out.p);
  out.ng = out.side = out.n;
  return out;
}

Mat3 shape_operator_on_face(const Placed& placed, const Affine3& to_part, const Hit& hit) {
  const Face& f = placed.part->faces[static_cast<std::size_t>(hit.face)];
  Jet2 j = jet2(f.surface, hit.uv);
  bring_to_world(placed, j);
  return shape_operator(j, outward_normal(f, to_part, hit.uv));
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

bool meet_at_loose_edge(const PartGeometry& geometry, const Hit& a, const Hit& b) {
  const Face &fa = geometry.part->faces[static_cast<std::size_t>(a.face)], &fb = geometry.part->faces[static_cast<std::size_t>(b.face)];
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

Ray secondary_ray(const Hit& hit, const SurfacePoint& at, const Vec3& direction, double tmax) {
  const double side = glm::dot(at.side, direction) < 0 ? -1.0 : 1.0;
  const bool under = side * glm::dot(at.ng, direction) < 0;
  return {at.p + (side < 0 ? at.lift_in : at.lift_out) + side * at.error_bound * at.ng,
          direction,
          0,
          tmax,
          hit.placed,
          under ? -1 : hit.primitive};
}

}  // namespace iso
