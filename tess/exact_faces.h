// The exact faces of placed parts, prepared for questions of nearest points: held as a proven mesh of our own, on which a nearest point is
// found and then polished on the surface by Newton steps.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"
#include "tess/surface_eval.h"
#include "tess/triangle_tree.h"

namespace iso {

struct PlacedPart {
  const Part* part = nullptr;
  Affine3 to_world;
};

class ExactFaces {
 public:
  // `distance`: world units, of the mesh from the faces. Parts must stay where they are; each is meshed once, however often it is placed.
  ExactFaces(std::span<const PlacedPart> parts, double distance);

  // Of all placed parts, in their order.
  struct Known {
    int placed = 0, face = 0;
    double bound = 0;                  // the mesh's distance from the face, with the gap of its edges; world units
    double gap = 0;                    // of it the model's own: how far its edges are off the surface
    double area = 0;                   // of its triangles
    std::uint32_t first = 0, end = 0;  // its triangles
    bool turned = false;               // outward is -(Su x Sv)
  };
  const std::vector<Known>& faces() const { return faces_; }
  double bound() const { return bound_; }
  double gap() const { return gap_; }

  // The mesh in world coordinates; points of different faces are shared where edges are.
  const std::vector<Point3>& points() const { return points_; }
  const std::vector<PointTriangle>& triangles() const { return triangles_; }
  const TriangleTree& tree() const { return *tree_; }
  std::uint32_t face_of(std::uint32_t triangle) const { return face_of_[triangle]; }

  // Moves on over the sides of triangles, inside the face: weights that are negative become those of the same (u, v) in the triangle that
  // holds it. At the border of the face, and after many triangles, they are clamped.
  void walk(std::uint32_t& triangle, Vec3& weights) const;

  // Whether the side of a triangle opposite to corner k is on the border of its face.
  bool is_border(std::uint32_t triangle, int k) const { return beside_[triangle][static_cast<std::size_t>(k)] == TriangleTree::kNone; }

  // Where the model itself ends: pairs of points.
  const std::vector<PointTriangle>& free_sides() const { return free_sides_; }

  // A point of the exact surface, with its unit outward normal (zero where there is none).
  struct OnSurface {
    Point3 point{0.0};
    Vec3 normal{0.0};
  };
  // At the (u, v) that have these barycentric weights in a triangle.
  OnSurface lifted(std::uint32_t triangle, const Vec3& weights) const;

  // The point nearest to p; its distance is right to `bound`, and far better where it lies inside a face.
  struct Foot : OnSurface {
    std::uint32_t triangle = TriangleTree::kNone;
    double distance = kInf;
  };
  Foot nearest(const Point3& p, std::uint32_t hint = TriangleTree::kNone) const;

 private:
  struct Place {
    const Part* part;
    std::shared_ptr<const PartMesh> mesh;
    std::shared_ptr<const std::vector<SurfaceEval>> surfaces;  // of the part's faces
    Affine3 to_world, to_part;
    std::uint32_t first_triangle = 0;
  };
  struct Corners {
    const Place* place;
    const SurfaceEval* surface;
    const AnySurface* exact;  // the same
    UV uv[3];
    bool turned;
  };
  Corners corners_of(std::uint32_t triangle) const;
  TangentJet at(const Corners& c, UV uv) const;
  Vec3 normal(const Corners& c, const TangentJet& world) const;
  UV downhill(const Corners& c, const Point3& p, UV uv, TangentJet& at_uv) const;
  void add_neighbours(const PartMesh& mesh);

  std::vector<Place> places_;
  std::vector<Known> faces_;
  std::vector<Point3> points_;
  std::vector<PointTriangle> triangles_, free_sides_;
  std::vector<std::uint32_t> face_of_;
  std::vector<std::array<std::uint32_t, 3>> beside_;  // over the sides opposite to the corners, on the same face; none at its border
  std::unique_ptr<TriangleTree> tree_;
  double bound_ = 0, gap_ = 0;
};

}  // namespace iso
