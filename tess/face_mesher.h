// A face on its way to triangles: what the steps of face_mesh.h hand on to each other. Its border is in face_border.cpp, the points inside
// and the result in face_mesh.cpp, refinement in face_refine.cpp.
#pragma once

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "tess/face_mesh.h"
#include "tess/sample_grid.h"
#include "tess/triangulation.h"

namespace iso {

// Segments of the border by their two vertices in the triangulation.
struct BorderSegment {
  EdgeSegment at;
  float sliver = 0;
  bool degenerate = false;
};
inline std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
}

// Nearer than this share of the coordinates' size to a crease is on it.
inline constexpr double kOnCrease = 1e-12;

class FaceMesher {
 public:
  FaceMesher(const FaceShape& shape, const Boundary& boundary, const EdgeNet& net, const FacePolicy& policy)
      : shape_(shape), boundary_(boundary), net_(net), policy_(policy) {}

  FaceMesh mesh(const std::vector<std::vector<int>>& loops, const std::vector<UV>& extra);

 private:
  using Corners = Triangulation::Triangle;

  // Closed forms are sampled by the grid alone, with a little left for what the triangulation makes of it. Elsewhere the bound over a whole
  // cell is far above what a triangle in it needs: the grid only starts what refinement ends (at 8 there are a tenth more triangles).
  double grid_share() const { return shape_.bend().cells() == 0 ? 0.95 : 16.0; }

  // ---- border ----

  void collect_border(const std::vector<std::vector<int>>& loops);
  void find_poles();
  UV settled(std::uint32_t point, const UV& uv);
  void add_border_node(std::uint32_t point, const UV& sampled);
  void make_triangulation();
  void constrain(std::uint32_t a, std::uint32_t b, const BorderSegment& segment);
  bool ask_for(const BorderSegment& segment, std::uint32_t a, std::uint32_t b);
  void check_sides();

  // ---- points inside ----

  void set_node(std::uint32_t vertex, std::uint32_t node);
  std::uint32_t add_inner(const UV& uv, bool check_inside);
  bool is_beside_border(const Corners& t, const Vec2& p) const;
  bool inside_at(const Vec2& p);
  bool wants_point(std::uint32_t triangle) const;
  void add_grid(const SampleGrid& grid);
  void constrain_creases();
  void constrain_crease(int axis, double crease);

  // ---- refinement ----

  const MeshNode& node(std::uint32_t vertex) const { return mesh_.nodes[node_of_[vertex]]; }
  SurfaceCorner corner(std::uint32_t vertex) const { return {node(vertex).uv, surface_points_[node_of_[vertex]]}; }
  Point3 placed(std::uint32_t vertex) const;
  bool same_point(std::uint32_t a, std::uint32_t b) const { return node(a).point == node(b).point; }

  bool is_border(const Corners& t, int k) const;
  bool is_collapsed(const Corners& t) const;
  double sliver_of(const Corners& t) const;
  FaceShape::Verdict verdict_of(std::uint32_t triangle, double most) const;
  bool turns_too_far(const Corners& t) const;
  bool exceeds(std::uint32_t triangle) const;
  void refine();
  bool divide(const Corners& t);
  bool has_turning_border(const Corners& t) const;
  void ask_for_borders(const std::vector<std::uint32_t>& triangles);

  // ---- parts without area ----

  bool is_without_area(const Corners& t) const;
  bool join(const Corners& t);

  // ---- result ----

  void collect_triangles();
  bool covers_area(const Corners& t) const;
  bool is_folded(const Corners& t) const;
  void count_folded(const Corners& t);

  const FaceShape& shape_;
  const Boundary& boundary_;
  const EdgeNet& net_;
  FacePolicy policy_;
  FaceMesh mesh_;
  Box2 domain_;
  Vec2 scale_{1.0};
  std::vector<BorderSegment> segments_;  // from border node i to the next of its loop
  std::vector<std::pair<std::size_t, std::size_t>> loop_ends_;
  std::unordered_multimap<std::uint32_t, UV> settled_;  // places of the border's points
  std::vector<std::int8_t> pole_axis_;                  // of border nodes: the parameter that has no meaning there, -1 where both have
  std::vector<Point3> surface_points_;                  // of the nodes: on this face's own surface
  std::optional<Triangulation> triangulation_;
  struct Proven {
    std::array<std::uint32_t, 3> v{};
    double bound = kInf;
  };
  mutable std::vector<Proven> proven_;  // of each triangle of the triangulation
  std::vector<std::uint32_t> node_of_;  // of each vertex of the triangulation
  std::unordered_map<std::uint64_t, BorderSegment> border_;
  std::uint32_t near_ = Triangulation::kNone, located_ = 0;
};

}  // namespace iso
