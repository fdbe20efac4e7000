// Meshes of shapes whose truth is known, with the exact parts they stand for; and rays for them.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "tests/support/solids.h"

namespace iso::test {

inline constexpr double kPoleEnd = kPi / 2;
inline const Box2 kWholeSphere{{0, -kPoleEnd}, {kTwoPi, kPoleEnd}};

// The unit sphere as one face and its mesh over a grid of (u, v): the seam's nodes share points, each pole is one point with a node per
// triangle. `top`: where the mesh ends in v; below the pole it is a bowl.
inline TraceScene sphere_by_grid(int round, int across, double top = kPoleEnd) {
  TraceScene scene = one_face(Sphere{{}, 1.0}, kWholeSphere);
  const Face& face = scene.placed[0].part->faces[0];
  auto mesh = std::make_shared<PartMesh>();
  const auto node = [&](std::uint32_t at, UV uv) {
    mesh->nodes.push_back({at, uv, unit_normal(face.surface, uv, face.domain)});
    return static_cast<std::uint32_t>(mesh->nodes.size() - 1);
  };
  const auto uv = [&](double i, double j) { return UV{kTwoPi * i / round, -kPoleEnd + (top + kPoleEnd) * j / across}; };
  const auto point_at = [&](int i, int j) {  // rows of `round` points; a pole's are equal
    const bool pole = j == 0 || (j == across && top == kPoleEnd);
    return static_cast<std::uint32_t>(j * round + (pole ? 0 : i % round));
  };
  for (int j = 0; j <= across; ++j)
    for (int i = 0; i < round; ++i) mesh->points.push_back(point(face.surface, uv(i, j)));
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < round; ++i) {
      const bool south = j == 0, north = j + 1 == across && top == kPoleEnd;
      const double shift = south || north ? 0.5 : 0;
      const auto corner = [&](int a, int b) { return node(point_at(i + a, j + b), uv(i + a, j + b)); };
      if (south) {
        mesh->triangles.push_back({node(point_at(i, j), uv(i + shift, j)), corner(1, 1), corner(0, 1)});
      } else if (north) {
        mesh->triangles.push_back({corner(0, 0), corner(1, 0), node(point_at(i, j + 1), uv(i + shift, j + 1))});
      } else {
        const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        mesh->triangles.push_back({a, b, c});
        mesh->triangles.push_back({a, c, d});
      }
    }
  mesh->first_node.push_back(static_cast<std::uint32_t>(mesh->nodes.size()));
  mesh->first_triangle.push_back(static_cast<std::uint32_t>(mesh->triangles.size()));
  scene.placed[0].mesh = mesh;
  return scene;
}

// The unit sphere as an octahedron whose triangles are divided `levels` times into four. (u, v) are the sphere's, wrong across the seam.
inline TraceScene sphere_by_octahedron(int levels) {
  TraceScene scene = one_face(Sphere{{}, 1.0}, kWholeSphere);
  auto mesh = std::make_shared<PartMesh>();
  const auto add = [&](Vec3 p) {
    p = glm::normalize(p);
    mesh->points.push_back(p);
    const double u = std::atan2(p.y, p.x);
    mesh->nodes.push_back({static_cast<std::uint32_t>(mesh->nodes.size()), {u < 0 ? u + kTwoPi : u, std::asin(p.z)}, p});
    return static_cast<std::uint32_t>(mesh->nodes.size() - 1);
  };
  for (const Vec3 p : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) add(p);
  for (std::uint32_t i = 0; i < 4; ++i) {
    mesh->triangles.push_back({i, (i + 1) % 4, 4});
    mesh->triangles.push_back({(i + 1) % 4, i, 5});
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, 0);
      if (fresh) at->second = add(mesh->points[a] + mesh->points[b]);
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh->triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Triangle& t : {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}}) finer.push_back(t);
    }
    mesh->triangles = std::move(finer);
  }
  mesh->first_node.push_back(static_cast<std::uint32_t>(mesh->nodes.size()));
  mesh->first_triangle.push_back(static_cast<std::uint32_t>(mesh->triangles.size()));
  scene.placed[0].mesh = mesh;
  return scene;
}

// The same scene without its meshes.
inline TraceScene exact(TraceScene scene) {
  for (Placed& p : scene.placed) p.mesh = nullptr;
  return scene;
}

// How far the triangles' planes pass inside the unit sphere about the origin: no point of the mesh lies deeper.
inline double deepest_chord(const PartMesh& mesh) {
  double deepest = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 n = glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    deepest = std::max(deepest, 1 - glm::dot(glm::normalize(n), mesh.corner(t, 0)));
  }
  return deepest;
}

inline std::vector<Ray> random_rays(std::uint64_t seed, int count, double reach = 1, const Vec3& centre = Vec3(0.0)) {
  std::mt19937_64 random(seed);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) rays.push_back(random_ray(random, centre, reach));
  return rays;
}

inline std::vector<Hit> nearest(const Tracer& tracer, const std::vector<Ray>& rays, Tracer::Order order = Tracer::Order::scattered) {
  std::vector<Hit> hits(rays.size());
  SolverStats stats;
  tracer.nearest(rays, hits, order, stats);
  return hits;
}

inline std::vector<std::uint8_t> occluded(const Tracer& tracer, const std::vector<Ray>& rays,
                                          Tracer::Order order = Tracer::Order::scattered) {
  std::vector<std::uint8_t> blocked(rays.size());
  SolverStats stats;
  tracer.occluded(rays, blocked, order, stats);
  return blocked;
}

inline const PartMesh& mesh_of(const Tracer& tracer) { return *tracer.scene().placed[0].mesh; }

// Rays that float cannot place on one side: exactly through corners and middles of edges.
inline std::vector<Ray> rays_at_edges(const PartMesh& mesh, std::uint64_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle& t = mesh.triangles[i % mesh.triangles.size()];
    const Vec3 d = random_direction(random);
    const Vec3 to = i % 2 ? mesh.corner(t, 0) : 0.5 * (mesh.corner(t, 0) + mesh.corner(t, 1));
    rays.push_back({to - 4.0 * d, d});
  }
  return rays;
}

}  // namespace iso::test
