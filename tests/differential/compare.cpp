#include "tests/differential/compare.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "patches/io/read_model.h"

namespace iso::test {
namespace {

class Stopwatch {
 public:
  double ms() {
    const auto now = std::chrono::steady_clock::now();
    const double passed = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return passed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Parallel rays of unit direction that hold the mesh's box, so that t is depth. Framed on their mesh, not on our model.
std::vector<Ray> camera_rays(const Box3& box, View view, const ImageSize& size) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z});
  const Camera camera = frame(corners, view, Projection::orthographic, kDefaultFov, size);
  std::vector<Ray> rays;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) rays.push_back(camera_ray(camera, size, x + 0.5, y + 0.5));
  return rays;
}

Vec3 normal_of(const OcctMesh& mesh, const MeshTriangle& t) {
  return glm::normalize(
      glm::cross(mesh.points[t.corners[1]] - mesh.points[t.corners[0]], mesh.points[t.corners[2]] - mesh.points[t.corners[0]]));
}

double cosine(double c) { return std::isnan(c) ? kLeastCosine : std::max(kLeastCosine, std::abs(c)); }

// How far the two depths of a pixel may be apart: what the mesh is off, along the ray.
double allowed_difference(const OcctMesh& mesh, const MeshScene& scene, const Tracer& tracer, const Ray& ray, const PixelPair& pixel) {
  const MeshTriangle& t = mesh.triangles[std::size_t(pixel.theirs.triangle)];
  const double along = std::min(cosine(glm::dot(normal_of(mesh, t), ray.d)), cosine(glm::dot(tracer.surface_point(pixel.ours).n, ray.d)));
  return (kDeviationFactor * std::max(double(t.deviation), mesh.deflection) + scene.rounding()) / along;
}

// What a pixel and its eight neighbours show in one of the two pictures.
struct Around {
  Range depth;
  bool miss = false;
};
template <class Depth>
Around around(const ImageSize& size, int x, int y, Depth&& depth) {
  Around seen;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= size.width || y + dy >= size.height) continue;
      const double t = depth(std::size_t(y + dy) * std::size_t(size.width) + std::size_t(x + dx));
      if (t < kInf)
        seen.depth.include(t);
      else
        seen.miss = true;
    }
  return seen;
}

// A silhouette, a border, or the edge of a face behind which another one shows, moved by less than a pixel, makes single rays differ. There,
// and only there, both pictures show both sides of the rim in the nine pixels.
Verdict judge(const Comparison& c, int x, int y) {
  const PixelPair& pixel = c.pixels[std::size_t(y) * std::size_t(c.size.width) + std::size_t(x)];
  if (!pixel.ours && !pixel.theirs) return Verdict::both_miss;
  if (pixel.ours && pixel.theirs && std::abs(pixel.ours.t - pixel.theirs.t) <= pixel.allowed) return Verdict::same_depth;
  const Around ours = around(c.size, x, y, [&](std::size_t i) { return c.pixels[i].ours.t; });
  const Around theirs = around(c.size, x, y, [&](std::size_t i) { return c.pixels[i].theirs.t; });
  if (pixel.ours && pixel.theirs) {
    const auto holds = [&](const Around& seen, double t) { return seen.depth.lo - pixel.allowed <= t && t <= seen.depth.hi + pixel.allowed; };
    return holds(ours, pixel.theirs.t) && holds(theirs, pixel.ours.t) ? Verdict::rim_depth : Verdict::depth;
  }
  const bool rim = ours.miss && theirs.miss && !ours.depth.empty() && !theirs.depth.empty();
  return rim ? Verdict::rim_hit_miss : Verdict::hit_miss;
}

void count(Comparison& c) {
  for (int y = 0; y < c.size.height; ++y)
    for (int x = 0; x < c.size.width; ++x) {
      PixelPair& pixel = c.pixels[std::size_t(y) * std::size_t(c.size.width) + std::size_t(x)];
      pixel.verdict = judge(c, x, y);
      const Verdict v = pixel.verdict;
      c.hits += v != Verdict::both_miss;
      c.hit_miss += v == Verdict::hit_miss || v == Verdict::rim_hit_miss;
      c.hit_miss_off_rim += v == Verdict::hit_miss;
      c.depth += v == Verdict::depth || v == Verdict::rim_depth;
      c.depth_off_rim += v == Verdict::depth;
      c.loose += pixel.loose;
      if (v == Verdict::depth) c.worst_depth = std::max(c.worst_depth, std::abs(pixel.ours.t - pixel.theirs.t) / pixel.allowed);
    }
}

}  // namespace

Comparison compare_with_occt(const std::string& path, const MeshFineness& fineness, View view) {
  Comparison c;
  c.file = std::filesystem::path(path).filename().string();
  Stopwatch watch;
  OcctMesh mesh;
  try {
    mesh = mesh_with_occt(path, fineness);
  } catch (const OcctFailure& failure) {
    c.refused = failure.what();
    return c;
  }
  c.mesh_ms = watch.ms();
  c.faces = mesh.faces;
  c.triangles = mesh.triangles.size();
  c.unmeshed = mesh.unmeshed;
  c.mesh_status = mesh.status;
  c.diagonal = mesh.box.diagonal();
  c.deflection = mesh.deflection;

  auto model = read_model(path);
  if (!model) {
    c.refused = "ours: " + model.error().text();
    return c;
  }
  c.read_ms = watch.ms();
  for (const Instance& instance : model->instances) c.our_faces += int(model->parts[std::size_t(instance.part)].faces.size());
  TraceScene trace_scene;
  add_model(trace_scene, std::make_shared<const Model>(std::move(*model)), Affine3{});
  const Tracer tracer(std::move(trace_scene));
  c.build_ms = watch.ms();
  const MeshScene scene(mesh);

  // The same rays through both, one thread each.
  const std::vector<Ray> rays = camera_rays(mesh.box, view, c.size);
  c.pixels.resize(rays.size());
  watch.ms();
  for (std::size_t i = 0; i < rays.size(); ++i) c.pixels[i].theirs = scene.nearest(rays[i]);
  c.their_ms = watch.ms();
  std::vector<Hit> hits(rays.size());
  SolverStats stats;
  tracer.nearest(rays, hits, Tracer::Order::coherent, stats);
  c.our_ms = watch.ms();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    PixelPair& pixel = c.pixels[i];
    pixel.ours = hits[i];
    if (pixel.theirs) pixel.loose = double(mesh.triangles[std::size_t(pixel.theirs.triangle)].deviation) > 2 * mesh.deflection;
    if (pixel.ours && pixel.theirs) pixel.allowed = allowed_difference(mesh, scene, tracer, rays[i], pixel);
  }
  count(c);
  return c;
}

std::string table_head() {
  return fmt::format("{:<46}{:>6}{:>9}{:>8}{:>9}{:>9}{:>8}{:>9}{:>8}{:>9}{:>9}{:>8}", "file", "faces", "triangles", "hits", "hit/miss",
                     "off rim", "depth", "off rim", "loose", "mesh ms", "ours ms", "tri ms");
}

std::string table_row(const Comparison& c) {
  if (!c.refused.empty()) return fmt::format("{:<46}{}", c.file, c.refused);
  return fmt::format("{:<46}{:>6}{:>9}{:>8}{:>9}{:>9}{:>8}{:>9}{:>8}{:>9.0f}{:>9.0f}{:>8.0f}", c.file, c.faces, c.triangles, c.hits,
                     c.hit_miss, c.hit_miss_off_rim, c.depth, c.depth_off_rim, c.loose, c.mesh_ms, c.our_ms, c.their_ms);
}

}  // namespace iso::test
