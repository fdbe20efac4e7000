// The measured distance between a mesh and the surfaces it was made from, in both directions, at sample points of every triangle and along
// every edge. It is a lower bound of the true largest distance, as FaceReport::bound is an upper one, and is found another way: by nearest
// points, not by derivatives.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"

namespace iso {

// Distances by size: bins of a constant ratio, so that percentiles are right to 1 %.
class DistanceCounts {
 public:
  void add(double distance);
  void add(const DistanceCounts& other);
  std::uint64_t count() const { return count_; }
  double max() const { return max_; }
  double mean() const { return count_ ? sum_ / static_cast<double>(count_) : 0.0; }
  double rms() const;
  // The distance that this share of the samples does not exceed.
  double percentile(double share) const;

 private:
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
  double max_ = 0, sum_ = 0, sum2_ = 0;
};

struct FaceDeviation {
  DistanceCounts to_surface;  // of points of triangles from the surface
  DistanceCounts to_mesh;     // of points of the surface from the mesh; the largest are points of the face, inside its loops
  UV worst_uv{0.0};
  Point3 worst_place{0.0};
  double worst = 0;        // the larger of both maxima, at worst_place
  double worst_angle = 0;  // radians, between a triangle and the surface's normal over it
  double mean_angle = 0;
};

struct Deviation {
  std::vector<FaceDeviation> faces;
  FaceDeviation all;
  int worst_face = -1;
};

// How many samples per triangle: `quick` the middles of the sides and of the triangle, `fine` 16 more.
enum class Sampling { quick, fine };

Deviation measure(const Part& part, const PartMesh& mesh, Sampling sampling);

}  // namespace iso
