// Meshes as if of other makers, of shapes whose distances have closed forms; and models to compare them with.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "tess/mesh_comparison.h"
#include "tests/support/solid_parts.h"

namespace iso::test {

// One part, finished and placed as it was made.
inline Model model_of(Part part) {
  Model model;
  model.parts.push_back(std::move(part));
  model.instances.emplace_back();
  finish(model);
  return model;
}

inline std::vector<PlacedPart> placed_parts(const Model& model, const Affine3& moved = {}) {
  std::vector<PlacedPart> placed;
  for (const Instance& i : model.instances) placed.push_back({&model.parts[static_cast<std::size_t>(i.part)], moved * i.to_model});
  return placed;
}

inline MeshComparison compared(const Model& model, const ForeignMesh& mesh, const Affine3& moved = {},
                               const ComparisonSettings& settings = {}) {
  const std::vector<PlacedPart> placed = placed_parts(model, moved);
  return compare_mesh(placed, mesh, settings, [](double) {});
}

inline ForeignMesh moved(ForeignMesh mesh, const Affine3& by) {
  for (Point3& p : mesh.points) p = by.point(p);
  if (glm::determinant(by.linear) < 0)
    for (PointTriangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

// The names of what is wrong with a mesh, in order.
inline std::vector<std::string> names_of(const std::vector<FaultFound>& faults) {
  std::vector<std::string> names;
  for (const FaultFound& f : faults) names.push_back(name_of(f.fault));
  return names;
}

// The prism over an even n-gon in a circle of radius r, from z = 0 to `height`.
inline ForeignMesh prism_mesh(int n, double r, double height) {
  ForeignMesh mesh;
  mesh.points = {{0, 0, 0}, {0, 0, height}};
  for (int i = 0; i < n; ++i)
    for (const double z : {0.0, height}) mesh.points.push_back({r * std::cos(kTwoPi * i / n), r * std::sin(kTwoPi * i / n), z});
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::uint32_t>(2 + 2 * i), b = static_cast<std::uint32_t>(2 + 2 * ((i + 1) % n));
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({0, b, a});
    mesh.triangles.push_back({1, a + 1, b + 1});
  }
  return mesh;
}

// An icosahedron with corners on the sphere of radius r about the origin, each triangle divided `levels` times into four.
inline ForeignMesh icosphere(int levels, double r) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  ForeignMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double a : {-1.0, 1.0})
      for (const double b : {-g, g}) {
        Vec3 p(0.0);
        p[(axis + 1) % 3] = a;
        p[(axis + 2) % 3] = b;
        mesh.points.push_back(r * glm::normalize(p));
      }
  // Its triangles are those of three corners that are nearest to each other.
  const double side = 1.01 * r * 2 / std::sqrt(1 + g * g);
  const auto near = [&](std::uint32_t a, std::uint32_t b) { return glm::length(mesh.points[a] - mesh.points[b]) < side; };
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c)
        if (near(a, b) && near(b, c) && near(c, a)) {
          const Vec3 n = glm::cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
          mesh.triangles.push_back(glm::dot(n, mesh.points[a]) > 0 ? PointTriangle{a, b, c} : PointTriangle{a, c, b});
        }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.points.size()));
      if (fresh) mesh.points.push_back(r * glm::normalize(mesh.points[a] + mesh.points[b]));
      return at->second;
    };
    std::vector<PointTriangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

// The bilinear patch z = x y over [-1, 1]^2, and its mesh of n x n squares, cut along x = y.
inline Model saddle_model() {
  Part part;
  Face face;
  NurbsSurface s;
  s.degree_u = s.degree_v = 1;
  s.count_u = s.count_v = 2;
  s.knots_u = s.knots_v = {-1, -1, 1, 1};
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) s.poles.push_back({x, y, x * y, 1});
  face.surface = s;
  face.domain = natural_domain(face.surface);
  part.faces.push_back(std::move(face));
  return model_of(std::move(part));
}

template <class Height>
ForeignMesh grid_mesh(int n, Height z) {
  ForeignMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double x = -1 + 2.0 * i / n, y = -1 + 2.0 * j / n;
      mesh.points.push_back({x, y, z(x, y)});
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (n + 1) + j), b = a + static_cast<std::uint32_t>(n) + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}
inline ForeignMesh saddle_mesh(int n) {
  return grid_mesh(n, [](double x, double y) { return x * y; });
}

}  // namespace iso::test
