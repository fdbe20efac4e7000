// The two directions of a comparison, as one_sided.h asks for them.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>

#include "tess/mesh_faults.h"
#include "tess/one_sided.h"

namespace iso {

// The exact faces from the mesh.
class SurfaceSource {
 public:
  SurfaceSource(const ExactFaces& faces, const TriangleTree& mesh, const ForeignMesh& triangles)
      : faces_(&faces), mesh_(&mesh), of_mesh_(&triangles), of_point_(faces.points().size()) {
    constexpr std::size_t kChunk = 1024;
    tbb::parallel_for(std::size_t{0}, (of_point_.size() + kChunk - 1) / kChunk, [&](std::size_t c) {
      TriangleTree::Nearest near;
      for (std::size_t i = c * kChunk; i < std::min(of_point_.size(), (c + 1) * kChunk); ++i) {
        near = mesh.nearest(faces.points()[i], near.triangle);
        of_point_[i] = {faces.points()[i], near.distance, near.triangle};
      }
    });
  }

  std::size_t size() const { return faces_->triangles().size(); }
  std::uint32_t group(std::size_t i) const { return faces_->face_of(static_cast<std::uint32_t>(i)); }
  std::array<Point3, 3> corners(std::size_t i) const {
    const auto& [a, b, c] = faces_->triangles()[i];
    return {faces_->points()[a], faces_->points()[b], faces_->points()[c]};
  }
  Measured measure(std::size_t i, const Vec3& weights, std::uint32_t hint) const {
    for (int k = 0; k < 3; ++k)
      if (weights[k] == 1) return of_point_[faces_->triangles()[i][static_cast<std::size_t>(k)]];
    const Point3 at = faces_->lifted(static_cast<std::uint32_t>(i), weights).point;
    const TriangleTree::Nearest near = mesh_->nearest(at, hint);
    return {at, near.distance, near.triangle};
  }
  void walk(std::size_t& i, Vec3& weights) const {
    auto triangle = static_cast<std::uint32_t>(i);
    faces_->walk(triangle, weights);
    i = triangle;
  }
  bool side_matters(std::size_t i, int k) const { return faces_->is_border(static_cast<std::uint32_t>(i), k); }
  double bound(std::size_t i, double near, double enough) const {
    // Our mesh may be farther than the surface it stands for.
    const double off = faces_->faces()[group(i)].bound;
    return cover_bound(*mesh_, of_mesh_->points, of_mesh_->triangles, corners(i), near + off, enough + off).bound + off;
  }

 private:
  const ExactFaces* faces_;
  const TriangleTree* mesh_;
  const ForeignMesh* of_mesh_;
  std::vector<Measured> of_point_;  // of our mesh
};

// The mesh from the exact faces.
class MeshSource {
 public:
  MeshSource(const ExactFaces& faces, const ForeignMesh& mesh, const std::vector<TriangleFinding>& triangles,
             const std::vector<PointFinding>& points)
      : faces_(&faces), mesh_(&mesh), triangles_(&triangles), points_(&points) {}

  std::size_t size() const { return mesh_->triangles.size(); }
  std::uint32_t group(std::size_t i) const { return (*triangles_)[i].face; }
  std::array<Point3, 3> corners(std::size_t i) const {
    const auto& [a, b, c] = mesh_->triangles[i];
    return {mesh_->points[a], mesh_->points[b], mesh_->points[c]};
  }
  Measured measure(std::size_t i, const Vec3& weights, std::uint32_t hint) const {
    const PointTriangle& t = mesh_->triangles[i];
    for (int k = 0; k < 3; ++k)
      if (weights[k] == 1) {
        const PointFinding& known = (*points_)[t[static_cast<std::size_t>(k)]];
        return {mesh_->points[t[static_cast<std::size_t>(k)]], known.distance, known.reference};
      }
    const auto c = corners(i);
    if (glm::length(weights - Vec3(1 / 3.0)) < 1e-9) {
      const TriangleFinding& known = (*triangles_)[i];
      return {(c[0] + c[1] + c[2]) / 3.0, known.distance, known.reference};
    }
    const Point3 at = weights.x * c[0] + weights.y * c[1] + weights.z * c[2];
    const ExactFaces::Foot foot = faces_->nearest(at, hint);
    return {at, foot.distance, foot.triangle};
  }
  void walk(std::size_t&, Vec3& weights) const {
    weights = glm::max(weights, Vec3(0.0));
    weights /= weights.x + weights.y + weights.z;
  }
  bool side_matters(std::size_t, int) const { return true; }
  double bound(std::size_t i, double near, double enough) const {
    const double off = faces_->bound();
    return cover_bound(faces_->tree(), faces_->points(), faces_->triangles(), corners(i), near + off, enough + off).bound + off;
  }

 private:
  const ExactFaces* faces_;
  const ForeignMesh* mesh_;
  const std::vector<TriangleFinding>* triangles_;
  const std::vector<PointFinding>* points_;
};

}  // namespace iso
