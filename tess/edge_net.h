// The edges of a part as polylines, sampled once for all faces that use them: what makes the mesh watertight.
//
// A segment between two samples is short enough when, on every face that uses the edge, the proven distances to the curve stay below the
// tolerance: of the curve from the chord in space, and of the surface from the flat mesh beside it [Safko 2022, 4.3: the control polygon on
// the surface is the bound; here it bounds how far the trim curve strays from its chord in (u, v), and the second derivatives of the
// surface do the rest].
#pragma once

#include "tess/boundary.h"
#include "tess/face_shape.h"

namespace iso {

struct EdgePolicy {
  double chord = 0;    // world units: allowed distance of the polyline from the curve
  double surface = 0;  // world units: allowed for the mesh beside it, the width of what lies between chord and curve included
  double turn = kInf;  // radians: allowed between the surface's normals at the ends of a segment, and between the curve's tangents
};

// Proven distances of one segment on one face, world units.
struct SegmentError {
  double chord = 0;    // of the curve from the chord in space
  double sliver = 0;   // of the curve from the chord, along the surface: so far the mesh ends beyond the face or before it
  double surface = 0;  // of the surface from the chord, over the straight line in (u, v)
};

class EdgeNet {
 public:
  EdgeNet(const Part& part, const Boundary& boundary, const std::vector<FaceShape>& shapes, const EdgePolicy& policy);

  struct SampledEdge {
    std::vector<double> share;               // rising from 0 to 1
    std::vector<std::uint32_t> point;        // of each share
    std::vector<std::vector<UV>> uv;         // of each use, of each share
    std::vector<std::vector<float>> sliver;  // of each use, of each segment
  };
  const SampledEdge& edge(int e) const { return edges_[static_cast<std::size_t>(e)]; }
  const std::vector<Point3>& points() const { return points_; }

  // Which of an edge's uses this is: the index into SampledEdge::uv.
  int place_of(int use) const { return place_[static_cast<std::size_t>(use)]; }

  // Puts a sample into a segment (between samples i and i + 1); false if the segment is too short to be split.
  bool split(int edge, std::size_t segment);

  // Segments that are short of the policy because they could not be split further.
  int unresolved() const { return unresolved_; }

 private:
  UV uv_on(int use, double share) const;
  double share_on(int use, double share) const;
  Point3 place(int use, const UV& uv) const;
  SegmentError error_of(int use, double a, double b) const;
  double excess(int edge, double a, double b) const;
  bool turns_too_far(int use, double a, double b) const;
  int even_parts(int edge, double a, double b, double over) const;
  void sample(int edge);
  void place_points(int edge);
  std::uint32_t point_at(const Point3& p, std::uint32_t before, std::uint32_t after);
  void put_samples(int edge, std::vector<double> shares);
  double split_at(int edge, double a, double b) const;
  std::vector<double> preferred_splits(int edge);

  const Part* part_;
  const Boundary* boundary_;
  const std::vector<FaceShape>* shapes_;
  EdgePolicy policy_;
  std::vector<SampledEdge> edges_;
  std::vector<int> place_;
  std::vector<std::vector<std::pair<double, double>>> anchors_;  // of each use: shares of the edge and of the use that are one place
  std::vector<std::vector<double>> preferred_;                   // of each edge: shares at which to split first
  std::vector<Point3> points_;
  int unresolved_ = 0;
};

}  // namespace iso
