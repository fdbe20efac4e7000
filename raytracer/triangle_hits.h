// What becomes of the triangles that Embree finds for a ray: hits on a mesh, decided in double. Knows nothing of Embree.
//
// Embree tells in float which triangles a ray passes, watertight along the edges of triangles that share points. (At a corner the signs of
// its edge functions may contradict each other: of rays aimed exactly at corners one in some hundreds slips through.) Distance and
// barycentric coordinates are computed again from the mesh's own doubles. At a cosine below about 1e-3 the two may differ by more than
// `kTriangleSlack`; the distance then stays that near to Embree's. So whatever Embree prunes by distance is further than the nearest hit,
// and the order in which it meets triangles does not matter.
#pragma once

#include "raytracer/packet.h"

namespace iso {

// Share of the mesh's size by which distances in float and in double may differ; the slack of the local rays in a mesh.
inline constexpr double kTriangleSlack = 1e-4;

// A triangle that Embree's ray passes, in float: `distance` along the local ray, in part units; the weights of its second and third corner.
struct FloatHit {
  double distance;
  Vec2 weights;
};

// Box and size of a mesh; nothing else of the geometry is used.
PartGeometry mesh_geometry(const Part& part, const PartMesh& mesh);
std::size_t bytes_of(const PartMesh& mesh);

// Offers a triangle to a lane. Returns true if the lane's nearest hit or its blocking changed.
bool meet_triangle(Packet& packet, int lane, const PartMesh& mesh, std::uint32_t triangle, const FloatHit& found);

// The surroundings of a hit on `placed.mesh`; k1 and k2 are NaN. `size`: of the mesh.
SurfacePoint point_on_triangle(const Placed& placed, const Affine3& to_part, double size, const Hit& hit, MeshShading shading,
                               Terminator terminator);

// Whether two hits on the mesh of one placed part, met in the same sense, may be one crossing of an edge or a corner: their triangles have
// a corner in common and lie as near to each other as float tells apart. `cosine`: of the flatter one.
bool cross_at_shared_corner(const Placed& placed, const Hit& a, const Hit& b, double apart, double cosine);

}  // namespace iso
