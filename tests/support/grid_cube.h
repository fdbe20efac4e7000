// A cube as a part of six plane faces with shared edges, and its mesh: each face a grid of n x n squares, cut in two triangles.
#pragma once

#include <map>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"

namespace iso::test {

// Faces 1, 3 and 5 are stored reversed: their outward normal is against Su x Sv.
class GridCube {
 public:
  explicit GridCube(int n, double side = 10.0 / 3, const Point3& corner = Point3(0.1)) : n_(n), side_(side), corner_(corner) {
    for (int axis = 0; axis < 3; ++axis)
      for (const bool far : {false, true}) add_face(axis, far);
    part.name = "cube";
    part.solids = 1;
    part.box = {corner, corner + Vec3(side)};
  }

  Part part;
  PartMesh mesh;

 private:
  void add_face(int axis, bool far) {
    Vec3 X(0.0), Y(0.0), O = corner_;
    X[(axis + 1) % 3] = 1;
    Y[(axis + 2) % 3] = 1;
    if (far) O[axis] += side_;
    const Vec3 outward = (far ? 1.0 : -1.0) * glm::cross(X, Y);
    Face face;
    face.reversed = !far;
    face.solid = 0;
    face.surface = Plane{{O, X, Y, glm::cross(X, Y)}};
    face.domain = {Vec2(0), Vec2(side_)};
    add_loop(face, O, X, Y);
    part.faces.push_back(std::move(face));
    add_nodes(O, X, Y, outward);
    add_triangles(!far);
  }

  void add_loop(Face& face, const Vec3& O, const Vec3& X, const Vec3& Y) {
    const Vec2 corners[] = {{0, 0}, {side_, 0}, {side_, side_}, {0, side_}};
    TrimLoop loop;
    for (int k = 0; k < 4; ++k) {
      const Vec2 a = corners[k], b = corners[(k + 1) % 4];
      const int edge = edge_of(point_of(O + a.x * X + a.y * Y), point_of(O + b.x * X + b.y * Y));
      loop.curves.push_back({Line<Vec2>{a, b - a}, 0, 1, edge});
    }
    face.loops.push_back(std::move(loop));
  }

  int edge_of(std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] = edges_.try_emplace(std::minmax(a, b), static_cast<int>(part.edges.size()));
    if (is_new) part.edges.emplace_back();
    ++part.edges[static_cast<std::size_t>(at->second)].uses;
    return at->second;
  }

  std::uint32_t point_of(const Point3& p) {
    const auto [at, is_new] = points_.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.points.size()));
    if (is_new) mesh.points.push_back(p);
    return at->second;
  }

  void add_nodes(const Vec3& O, const Vec3& X, const Vec3& Y, const Vec3& outward) {
    for (int j = 0; j <= n_; ++j)
      for (int i = 0; i <= n_; ++i) {
        const UV uv{side_ * i / n_, side_ * j / n_};
        mesh.nodes.push_back({point_of(O + uv.x * X + uv.y * Y), uv, outward});
      }
    mesh.first_node.push_back(static_cast<std::uint32_t>(mesh.nodes.size()));
  }

  void add_triangles(bool reversed) {
    const std::uint32_t first = mesh.first_node[mesh.first_node.size() - 2];
    const auto node = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * (n_ + 1) + i); };
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i < n_; ++i)
        for (Triangle t :
             {Triangle{node(i, j), node(i + 1, j), node(i + 1, j + 1)}, Triangle{node(i, j), node(i + 1, j + 1), node(i, j + 1)}}) {
          if (reversed) std::swap(t[1], t[2]);
          mesh.triangles.push_back(t);
        }
    mesh.first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
  }

  int n_;
  double side_;
  Point3 corner_;
  std::map<std::array<double, 3>, std::uint32_t> points_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges_;
};

}  // namespace iso::test
