#include "tests/bench/patch_rays.h"

#include <tbb/global_control.h>

#include <memory>

#include "patches/n_sided_part.h"
#include "patches/surface/patch_construct.h"
#include "raytracer/tracer.h"
#include "tests/support/polygons.h"

namespace iso::bench {

namespace {

constexpr int kSide = 10;  // squares along an edge of the cube: 600 in all, Goldberg's polyhedron has 642 faces

using Polygons = std::vector<std::vector<Vec3>>;

// A cube's squares, blown up to the sphere; or the two triangles of each of fewer squares.
Polygons blown_up_cube(int n, bool triangles) {
  Polygons out;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int a, int b) {
            Vec3 p;
            p[axis] = sign;
            p[(axis + 1) % 3] = std::tan(kPi / 4 * (2.0 * a / n - 1));
            p[(axis + 2) % 3] = sign * std::tan(kPi / 4 * (2.0 * b / n - 1));
            return glm::normalize(p);
          };
          const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (triangles)
            out.insert(out.end(), {{a, b, c}, {a, c, d}});
          else
            out.push_back({a, b, c, d});
        }
  return out;
}

NSidedPatch over_sphere(PatchBasis basis, const std::vector<Vec3>& polygon) {
  std::vector<PatchCorner> corners;
  for (const Vec3& p : polygon) corners.push_back({p, p});
  basis.sides = static_cast<int>(polygon.size());
  auto patch = patch_over(basis, corners);
  ISO_CHECK(bool(patch));
  return *patch;
}

// A four-sided cubic generalised Bezier patch is a bicubic one.
AnySurface as_bicubic(const NSidedPatch& patch) {
  NurbsSurface s;
  s.degree_u = s.degree_v = 3;
  s.count_u = s.count_v = 4;
  s.knots_u = s.knots_v = {0, 0, 0, 0, 1, 1, 1, 1};
  // Row by row from side 1: file order of the points is the centre, the boundary around, the inner ones around.
  static constexpr int kPlace[4][4] = {{1, 12, 11, 10}, {2, 13, 16, 9}, {3, 14, 15, 8}, {4, 5, 6, 7}};  // [along side 1][inward]
  for (const auto& row : kPlace)
    for (const int m : row) s.poles.push_back(Vec4(patch.points[static_cast<std::size_t>(m)], 1.0));
  return s;
}

struct Row {
  PatchRays told;
  std::unique_ptr<Tracer> tracer;
};

Row row_of(const std::string& name, int patches, Part part, double seconds) {
  Row row;
  row.told.name = name;
  row.told.patches = patches;
  for (const Face& face : part.faces) row.told.proven = std::max(row.told.proven, distance_of_pieces(face.surface));
  auto model = std::make_shared<Model>();
  model->parts.push_back(std::move(part));
  model->instances.push_back({});
  row.told.build = seconds + seconds_of([&] {
                     finish(*model);
                     TraceScene scene;
                     add_model(scene, model, {});
                     row.tracer = std::make_unique<Tracer>(std::move(scene));
                   });
  row.told.megabytes = 1e-6 * static_cast<double>(row.tracer->build_stats().bytes);
  return row;
}

Row patches_row(const std::string& name, const PatchBasis& basis, const Polygons& polygons) {
  std::vector<PatchEntry> entries;
  Part part;
  const double seconds = seconds_of([&] {
    for (const std::vector<Vec3>& polygon : polygons) {
      entries.emplace_back();
      entries.back().patch = over_sphere(basis, polygon);
    }
    part = part_of_patches(name, entries);
  });
  return row_of(name, static_cast<int>(polygons.size()), std::move(part), seconds);
}

Row bicubic_row(const Polygons& polygons) {
  Part part;
  for (const std::vector<Vec3>& polygon : polygons) {
    Face face;
    face.surface = as_bicubic(over_sphere({PatchKind::generalised_bezier, 4, 3}, polygon));
    face.domain = {Vec2(0.0), Vec2(1.0)};
    part.faces.push_back(std::move(face));
  }
  return row_of("bicubic Bezier", static_cast<int>(polygons.size()), std::move(part), 0);
}

// One ray for each pixel of a square picture that the sphere fills, in blocks of 4 x 4.
std::vector<Ray> rays_at_sphere(int count) {
  const int side = std::max(4, static_cast<int>(std::sqrt(static_cast<double>(count))) / 4 * 4);
  const Vec3 eye = 4.0 * glm::normalize(Vec3(1, 0.7, 0.5)), forward = -glm::normalize(eye);
  const Vec3 right = glm::normalize(glm::cross(forward, Vec3(0, 0, 1))), up = glm::cross(right, forward);
  std::vector<Ray> rays;
  for (int y0 = 0; y0 < side; y0 += 4)
    for (int x0 = 0; x0 < side; x0 += 4)
      for (int k = 0; k < 16; ++k) {
        const double x = (x0 + k % 4 + 0.5) / side - 0.5, y = (y0 + k / 4 + 0.5) / side - 0.5;
        rays.push_back({eye, glm::normalize(forward + 0.5 * (x * right + y * up))});
      }
  return rays;
}

}  // namespace

std::vector<PatchRays> measure_patch_rays(int count, int rounds) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const Polygons quads = blown_up_cube(kSide, false), triangles = blown_up_cube(7, true);
  const test::PolygonMesh mesh = test::read_polygons(ISOPHOTE_TEST_DATA "/meshes/goldberg-642.obj");
  Polygons goldberg;
  for (const std::vector<int>& polygon : mesh.polygons) {
    goldberg.emplace_back();
    for (const int p : polygon) goldberg.back().push_back(glm::normalize(mesh.points[static_cast<std::size_t>(p)]));
  }
  std::vector<Row> rows;
  rows.push_back(bicubic_row(quads));
  rows.push_back(patches_row("Gregory triangle", {PatchKind::gregory_triangle, 3, 3}, triangles));
  rows.push_back(patches_row("Gregory quad", {PatchKind::gregory_quad, 4, 3}, quads));
  rows.push_back(patches_row("generalised Gregory, 5 and 6 sides", {PatchKind::generalised_gregory, 6, 3}, goldberg));
  rows.push_back(patches_row("generalised Bezier, 5 and 6 sides", {PatchKind::generalised_bezier, 6, 3}, goldberg));
  rows.push_back(patches_row("Charrot-Gregory, 5 and 6 sides", {PatchKind::charrot_gregory, 6, 3}, goldberg));

  const std::vector<Ray> rays = rays_at_sphere(count);
  std::vector<Hit> hits(rays.size());
  std::vector<std::vector<double>> times(rows.size());
  for (int round = -1; round < rounds; ++round)  // the first one warms up
    for (std::size_t k = 0; k < rows.size(); ++k) {
      SolverStats stats;
      const double seconds = seconds_of([&] { rows[k].tracer->nearest(rays, hits, Tracer::Order::coherent, stats); });
      rows[k].told.hits = static_cast<int>(std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return bool(hit); }));
      if (round >= 0) times[k].push_back(1e9 * seconds / static_cast<double>(rays.size()));
    }
  std::vector<PatchRays> told;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].told.nanoseconds = timing_of(times[k]);
    // The sphere is about as large for all: another share of hits would be another question.
    ISO_CHECK(std::abs(rows[k].told.hits - rows[0].told.hits) < 0.01 * rows[0].told.hits);
    told.push_back(rows[k].told);
    told.back().of_bicubic = told.back().nanoseconds.median / rows[0].told.nanoseconds.median;
  }
  return told;
}

}  // namespace iso::bench
