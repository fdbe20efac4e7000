// How far surfaces are from a mesh, for meshes of any maker and with nothing of the tessellator's: points of the exact surface under every
// triangle, at evenly spread (u, v) inside it, to the nearest point of the whole mesh, found by Embree and measured in double. What is
// found is a lower bound of the largest distance from surface to mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "patches/triangle_mesh.h"
#include "tess/topology.h"
#include "tess/verify.h"

namespace iso::bench {

// The surfaces that a mesh was made from: the point at (u, v) of the surface of one of its faces.
struct MeasuredSurfaces {
  std::function<Point3(int face, const UV&)> point;
  std::vector<bool> flat;  // by face: a plane; its samples do not count for the percentile
};

struct MeterOptions {
  double negligible = 0;             // distances from a sample's own triangle up to this are not looked at closer
  std::uint64_t triangles = 60'000;  // of larger meshes a random choice of about as many is sampled
};

struct FaceExtreme {
  double distance = 0;
  UV uv{0.0};
};

struct MeshDeviation {
  double max = 0, p999 = 0;  // of the samples of all faces; of those of faces that are not planes
  std::uint64_t samples = 0, triangles = 0;
  int worst_face = -1;
  std::vector<FaceExtreme> faces;
};

inline constexpr int kSamplesPerTriangle = 21;

MeshDeviation mesh_deviation(const PartMesh& mesh, const MeasuredSurfaces& surfaces, const MeterOptions& options);

// What is wrong with a mesh, by the same rules for every maker (tess/topology.h, tess/verify.h).
struct MeshQuality {
  TopologyReport topology;
  TriangleShapes shapes;
  std::uint64_t folded = 0;  // triangles with area that are not on the side of the mean of their nodes' normals
};
MeshQuality mesh_quality(const PartMesh& mesh);

}  // namespace iso::bench
