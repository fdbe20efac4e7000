// Closed meshes of polygons as parts of patches, for tests: one patch over each polygon, its charts the faces.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "patches/n_sided_part.h"
#include "patches/surface/patch_construct.h"
#include "raytracer/trace_scene.h"
#include "tests/support/polygons.h"

namespace iso::test {

// An octahedron's corners cut off so far that it has 6 squares and 8 hexagons; edges of length 1.
inline PolygonMesh truncated_octahedron() {
  PolygonMesh mesh;
  const double h = std::sqrt(0.5);
  for (int zero = 0; zero < 3; ++zero)
    for (const int swap : {1, 2})
      for (const double a : {-h, h})
        for (const double b : {-2 * h, 2 * h}) {
          Vec3 p(0.0);
          p[(zero + swap) % 3] = a;
          p[(zero + 3 - swap) % 3] = b;
          mesh.points.push_back(p);
        }
  std::vector<Vec3> normals;
  for (int c = 0; c < 3; ++c)
    for (const double sign : {-1.0, 1.0}) {
      normals.push_back(Vec3(0.0));
      normals.back()[c] = sign;
    }
  for (int k = 0; k < 8; ++k) normals.push_back(glm::normalize(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
  for (const Vec3& n : normals) {
    double most = -kInf;
    for (const Vec3& p : mesh.points) most = std::max(most, glm::dot(n, p));
    std::vector<std::pair<double, int>> around;
    const Vec3 x = any_perpendicular(n), y = glm::cross(n, x);
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      if (glm::dot(n, mesh.points[i]) > most - 1e-9)
        around.push_back({std::atan2(glm::dot(y, mesh.points[i]), glm::dot(x, mesh.points[i])), static_cast<int>(i)});
    std::sort(around.begin(), around.end());
    mesh.polygons.emplace_back();
    for (const auto& [angle, i] : around) mesh.polygons.back().push_back(i);
  }
  return mesh;
}

// Of a vertex: the mean of its polygons', each as large as its area.
inline std::vector<Vec3> vertex_normals(const PolygonMesh& mesh) {
  std::vector<Vec3> sums(mesh.points.size(), Vec3(0.0));
  for (const std::vector<int>& polygon : mesh.polygons) {
    Vec3 area(0.0);
    const Vec3 from = mesh.points[polygon[0]];
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
      area += glm::cross(mesh.points[polygon[k]] - from, mesh.points[polygon[k + 1]] - from);
    for (const int v : polygon) sums[v] += area;
  }
  for (Vec3& n : sums) n = glm::normalize(n);
  return sums;
}

// `mean_value`: of patches with a choice, on those parameters.
enum class MeshKind { gregory, charrot_gregory, gregory_mean_value, charrot_gregory_mean_value };
inline PatchBasis basis_of(MeshKind kind, int sides) {
  const bool gregory = kind == MeshKind::gregory || kind == MeshKind::gregory_mean_value;
  PatchBasis basis = gregory ? gregory_basis(sides) : PatchBasis{PatchKind::charrot_gregory, sides, 3};
  const bool has_choice = basis.kind == PatchKind::generalised_gregory || basis.kind == PatchKind::charrot_gregory;
  if (has_choice && kind >= MeshKind::gregory_mean_value) basis.parameters = SideParameters::mean_value;
  return basis;
}

// One patch a polygon. Neighbours have one boundary curve, bit for bit.
inline std::vector<NSidedPatch> patches_over(const PolygonMesh& mesh, MeshKind kind) {
  const std::vector<Vec3> normals = vertex_normals(mesh);
  std::vector<NSidedPatch> patches;
  for (const std::vector<int>& polygon : mesh.polygons) {
    const int n = static_cast<int>(polygon.size());
    std::vector<PatchCorner> corners;
    for (const int v : polygon) corners.push_back({mesh.points[v], normals[v]});
    auto made = patch_over(basis_of(kind, n), corners);
    if (!made) {
      ADD_FAILURE() << made.error().text();
      return {};
    }
    patches.push_back(std::move(*made));
  }
  return patches;
}

// All charts of all patches, patch by patch: bare faces, or with the edges that they share.
enum class Edges { none, shared };
inline TraceScene scene_of(const std::vector<NSidedPatch>& patches, Edges edges = Edges::none) {
  auto model = std::make_shared<Model>();
  std::vector<PatchEntry> entries;
  for (const NSidedPatch& patch : patches) entries.push_back({.patch = patch, .corners = {}, .colour = {}, .name = {}});
  model->parts.push_back(part_of_patches("patches", entries));
  if (edges == Edges::none) {
    model->parts[0].edges.clear();
    for (Face& face : model->parts[0].faces) face.loops.clear();
  }
  model->instances.emplace_back();
  finish(*model);
  TraceScene scene;
  add_model(scene, model, Affine3{});
  return scene;
}

}  // namespace iso::test
