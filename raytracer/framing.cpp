#include "raytracer/framing.h"

namespace iso {
namespace {

// The corners of the parts' own boxes: tighter than the scene's box when parts are turned or spread.
std::vector<Vec3> box_corners(const TraceScene& scene) {
  std::vector<Vec3> corners;
  for (const Placed& placed : scene.placed) {
    const Box3& box = placed.part->box;
    for (int i = 0; i < 8 && !box.empty(); ++i)
      corners.push_back(placed.to_world.point({i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z}));
  }
  return corners;
}

std::size_t count_curves(const Part& part) {
  std::size_t count = 0;
  for (const Face& face : part.faces)
    for (const TrimLoop& loop : face.loops) count += loop.curves.size();
  return count;
}

// Points along the trim curves: they catch parts that are thinner than the grid of rays.
void add_trim_points(const Placed& placed, int per_curve, std::vector<Vec3>& points) {
  for (const Face& face : placed.part->faces)
    for (const TrimLoop& loop : face.loops)
      for (const TrimCurve& piece : loop.curves)
        for (int i = 0; i < per_curve; ++i) {
          const double t = piece.t0 + (piece.t1 - piece.t0) * i / per_curve;
          points.push_back(placed.to_world.point(point(face.surface, jet(piece.curve, t).C)));
        }
}

// Points seen through a coarse grid: they catch the silhouettes of bulging faces.
void add_seen_points(const Tracer& tracer, const Camera& camera, std::vector<Vec3>& points) {
  constexpr ImageSize kGrid{160, 160};
  std::vector<Ray> rays;
  for (int y = 0; y < kGrid.height; ++y)
    for (int x = 0; x < kGrid.width; ++x) rays.push_back(camera_ray(camera, kGrid, x + 0.5, y + 0.5));
  std::vector<Hit> hits(rays.size());
  SolverStats stats;  // not part of the picture's own statistics
  tracer.nearest(rays, hits, Tracer::Order::coherent, stats);
  for (const Hit& hit : hits)
    if (hit) points.push_back(tracer.surface_point(hit).p);
}

}  // namespace

Camera frame_model(const Tracer& tracer, View view, Projection projection, double fov_degrees, const ImageSize& size) {
  const TraceScene& scene = tracer.scene();
  const std::vector<Vec3> corners = box_corners(scene);
  if (corners.empty()) return frame(std::vector{Vec3(0.0)}, view, projection, fov_degrees, size);

  // Large assemblies get fewer points per curve: they have enough of them.
  constexpr std::size_t kManyCurves = 50000;
  std::size_t curves = 0;
  for (const Placed& placed : scene.placed) curves += count_curves(*placed.part);
  std::vector<Vec3> points;
  for (const Placed& placed : scene.placed) add_trim_points(placed, curves < kManyCurves ? 8 : 1, points);
  add_seen_points(tracer, frame(corners, view, projection, fov_degrees, {1, 1}), points);

  // A curve may leave the face it bounds by a file's fault; nothing outside the box is real.
  const Box3 box = scene.box();
  std::erase_if(points, [&](const Vec3& p) { return !box.contains(p); });
  return frame(points.empty() ? corners : points, view, projection, fov_degrees, size);
}

}  // namespace iso
