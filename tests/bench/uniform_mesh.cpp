#include "tests/bench/uniform_mesh.h"

#include "patches/base/check.h"
#include "patches/surface/bezier_patch.h"
#include "tests/bench/timing.h"

namespace iso::bench {
namespace {

// The points of a piece on a grid of nu x nv cells, or between them.
struct Grid {
  const AnySurface* surface;
  Box2 uv;
  int nu = 1, nv = 1;

  Vec3 at(double i, double j) const { return point(*surface, uv.lo + Vec2(i / nu, j / nv) * uv.size()); }
};

// A triangle by its corners in grid coordinates; every cell has two.
using GridTriangle = std::array<Vec2, 3>;
std::array<GridTriangle, 2> triangles_of_cell(int i, int j) {
  const Vec2 a(i, j), b(i + 1, j), c(i + 1, j + 1), d(i, j + 1);
  return {{{a, b, c}, {a, c, d}}};
}

double error_of(const Grid& grid, const GridTriangle& corners) {
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = grid.at(corners[k].x, corners[k].y);
  const Vec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double area = glm::length(cross);
  if (!(area > 0)) return 0;  // collapsed: no ray hits it
  constexpr double kWeights[4][3] = {{1. / 3, 1. / 3, 1. / 3}, {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}};
  double most = 0;
  for (const auto& w : kWeights) {
    const Vec2 middle = w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2];
    most = std::max(most, std::abs(glm::dot(grid.at(middle.x, middle.y) - p[0], cross / area)));
  }
  return most;
}

double error_of(const Grid& grid) {
  double most = 0;
  for (int i = 0; i < grid.nu; ++i)
    for (int j = 0; j < grid.nv; ++j)
      for (const GridTriangle& triangle : triangles_of_cell(i, j)) most = std::max(most, error_of(grid, triangle));
  return most;
}

// How many cells the bending in u and in v asks for: half the tolerance for each, du^2 |n . Suu| / 8 and so on.  [Filip et al. 1986]
Vec2 cells_wanted(const AnySurface& surface, const Box2& uv, double tolerance) {
  constexpr int kSamples = 5;
  Vec2 bend{0.0};
  for (int i = 0; i < kSamples; ++i)
    for (int j = 0; j < kSamples; ++j) {
      const Jet2 jet = jet2(surface, uv.lo + (Vec2(i, j) + 0.5) / double(kSamples) * uv.size());
      const Vec3 n = glm::cross(jet.Su, jet.Sv);
      if (!(glm::length(n) > 0)) continue;
      bend = glm::max(bend, glm::abs(Vec2(glm::dot(n, jet.Suu), glm::dot(n, jet.Svv))) / glm::length(n));
    }
  return uv.size() * glm::sqrt(bend / (4 * tolerance));
}

Grid coarsest_grid(const AnySurface& surface, const Box2& uv, double tolerance, double& error) {
  const Vec2 wanted = cells_wanted(surface, uv, tolerance);
  for (double factor = 0.5;; factor *= 1.05) {
    const Vec2 cells = glm::max(glm::ceil(factor * wanted + (factor - 0.5)), Vec2(1.0));
    const Grid grid{&surface, uv, static_cast<int>(cells.x), static_cast<int>(cells.y)};
    ISO_CHECK(cells.x * cells.y < 1e8);
    error = error_of(grid);
    if (error <= tolerance) return grid;
  }
}

void add(const Grid& grid, const Affine3& to_world, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (int i = 0; i <= grid.nu; ++i)
    for (int j = 0; j <= grid.nv; ++j) mesh.points.push_back(to_world.point(grid.at(i, j)));
  const auto index = [&](const Vec2& corner) {
    return first + static_cast<std::uint32_t>(corner.x) * static_cast<std::uint32_t>(grid.nv + 1) + static_cast<std::uint32_t>(corner.y);
  };
  for (int i = 0; i < grid.nu; ++i)
    for (int j = 0; j < grid.nv; ++j)
      for (const GridTriangle& t : triangles_of_cell(i, j)) mesh.triangles.push_back({index(t[0]), index(t[1]), index(t[2])});
}

}  // namespace

TriangleMesh mesh_uniformly(const TraceScene& scene, double tolerance) {
  struct Placement {
    Grid grid;
    Affine3 to_world;
  };
  std::vector<Placement> grids;
  TriangleMesh mesh;
  for (const Placed& placed : scene.placed)
    for (const Face& face : placed.part->faces) {
      ISO_CHECK(face.loops.empty());
      for (const BezierPiece& piece : bezier_pieces(face.surface, face.domain)) {
        double error = 0;
        grids.push_back({coarsest_grid(face.surface, piece.native_box(), tolerance, error), placed.to_world});
        mesh.error = std::max(mesh.error, error);
      }
    }
  // The search for the grids is no part of the time: a mesher with a good bound needs none.
  mesh.seconds = seconds_of([&] {
    for (const Placement& p : grids) add(p.grid, p.to_world, mesh);
  });
  return mesh;
}

}  // namespace iso::bench
