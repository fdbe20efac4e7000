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

Vec3 normal_of(const OcctMesh& mesh, const MeshTriangle& t) {
  return glm::normalize(
      glm::cross(mesh.points[t.corners[1]] - mesh.points[t.corners[0]], mesh.points[t.corners[2]] - mesh.points[t.corners[0]]));
}

// Both programs at one pixel, and again at rays beside it.
class Pair {
 public:
  Pair(const OcctMesh& mesh, const Tracer& tracer) : mesh_(mesh), scene_(mesh), tracer_(tracer) {}

  MeshHit theirs(const Ray& ray) const { return scene_.nearest(ray); }
  const MeshTriangle& triangle(const MeshHit& hit) const { return mesh_.triangles[std::size_t(hit.triangle)]; }

  // What the mesh is off: as measured at the triangle, or as asked for where there is none.
  double off(const MeshHit& hit) const {
    return kDeviationFactor * std::max(mesh_.deflection, hit ? double(triangle(hit).deviation) : 0.0) + scene_.rounding();
  }

  // How far a face may reach beyond its trim curves to close the gap to its neighbour, where a hit is due to that.
  double closing(const Hit& ours) const {
    if (!ours.by_tolerance) return 0;
    const Part& part = *tracer_.scene().placed[std::size_t(ours.placed)].part;
    double most = 0;
    for (const TrimLoop& loop : tracer_.face(ours).loops)
      for (const TrimCurve& curve : loop.curves)
        if (curve.edge >= 0) most = std::max(most, part.edges[std::size_t(curve.edge)].closing);
    return most;
  }

  // What the mesh is off, along the ray.
  double allowed(const Ray& ray, const Hit& ours, const MeshHit& theirs) const {
    const double mesh_cosine = glm::dot(normal_of(mesh_, triangle(theirs)), ray.d);
    const double our_cosine = glm::dot(tracer_.surface_point(ours).n, ray.d);
    return off(theirs) / std::min(sane(mesh_cosine), sane(our_cosine));
  }

  bool agree(const Ray& ray, const Hit& ours, const MeshHit& theirs) const {
    if (!ours || !theirs) return !ours && !theirs;
    return std::abs(ours.t - theirs.t) <= allowed(ray, ours, theirs);
  }

  // Whether one of the pictures, moved sideways by at most `by`, agrees with the other.
  bool agree_beside(const Ray& ray, const Hit& ours, const MeshHit& theirs, double by) const {
    constexpr int kDirections = 16;
    const Vec3 right = any_perpendicular(ray.d), up = glm::cross(ray.d, right);
    std::vector<Ray> beside;
    for (const double radius : {by / 3, 2 * by / 3, by})
      for (int i = 0; i < kDirections; ++i) {
        const double angle = kTwoPi * i / kDirections;
        beside.push_back(ray);
        beside.back().o += radius * (std::cos(angle) * right + std::sin(angle) * up);
      }
    std::vector<Hit> hits(beside.size());
    SolverStats stats;
    tracer_.nearest(beside, hits, Tracer::Order::coherent, stats);
    for (std::size_t i = 0; i < beside.size(); ++i)
      if (agree(ray, hits[i], theirs) || agree(ray, ours, scene_.nearest(beside[i]))) return true;
    return false;
  }

 private:
  static double sane(double cosine) { return std::isnan(cosine) ? kLeastCosine : std::max(kLeastCosine, std::abs(cosine)); }

  const OcctMesh& mesh_;
  MeshScene scene_;
  const Tracer& tracer_;
};

Verdict judge(const Pair& pair, const Ray& ray, const PixelPair& pixel) {
  const bool both = pixel.ours && pixel.theirs;
  if (!pixel.ours && !pixel.theirs) return Verdict::both_miss;
  if (both && std::abs(pixel.ours.t - pixel.theirs.t) <= pixel.allowed) return Verdict::same_depth;
  const bool rim = pair.agree_beside(ray, pixel.ours, pixel.theirs, pixel.off + pair.closing(pixel.ours));
  return both ? (rim ? Verdict::rim_depth : Verdict::depth) : (rim ? Verdict::rim_hit_miss : Verdict::hit_miss);
}

void count(const PixelPair& pixel, Picture& c) {
  const Verdict v = pixel.verdict;
  c.hits += v != Verdict::both_miss;
  c.hit_miss += v == Verdict::hit_miss || v == Verdict::rim_hit_miss;
  c.hit_miss_off_rim += v == Verdict::hit_miss;
  c.depth += v == Verdict::depth || v == Verdict::rim_depth;
  c.depth_off_rim += v == Verdict::depth;
  c.loose += pixel.loose;
}

}  // namespace

std::vector<Ray> rays_from_above(const Box3& box, const ImageSize& size) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z});
  const Camera camera = frame(corners, View::iso, Projection::orthographic, kDefaultFov, size);
  std::vector<Ray> rays;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) rays.push_back(camera_ray(camera, size, x + 0.5, y + 0.5));
  return rays;
}

std::vector<Ray> rays_from_below(const Box3& box, const ImageSize& size) {
  std::vector<Ray> rays = rays_from_above(box, size);
  for (Ray& ray : rays) {
    ray.o += 2 * glm::dot(box.middle() - ray.o, ray.d) * ray.d;
    ray.d = -ray.d;
  }
  return rays;
}

Picture compare(const OcctMesh& mesh, const Tracer& tracer, std::span<const Ray> rays, const ImageSize& size) {
  Picture picture;
  picture.size = size;
  picture.pixels.resize(rays.size());
  const Pair pair(mesh, tracer);
  Stopwatch watch;
  for (std::size_t i = 0; i < rays.size(); ++i) picture.pixels[i].theirs = pair.theirs(rays[i]);
  picture.their_ms = watch.ms();
  std::vector<Hit> hits(rays.size());
  SolverStats stats;
  tracer.nearest(rays, hits, Tracer::Order::coherent, stats);
  picture.our_ms = watch.ms();

  for (std::size_t i = 0; i < rays.size(); ++i) {
    PixelPair& pixel = picture.pixels[i];
    pixel.ours = hits[i];
    pixel.off = pair.off(pixel.theirs);
    if (pixel.theirs) {
      pixel.their_face = pair.triangle(pixel.theirs).face;
      pixel.loose = double(pair.triangle(pixel.theirs).deviation) > 2 * mesh.deflection;
    }
    if (pixel.ours && pixel.theirs) pixel.allowed = pair.allowed(rays[i], pixel.ours, pixel.theirs);
    pixel.verdict = judge(pair, rays[i], pixel);
    count(pixel, picture);
  }
  return picture;
}

Comparison compare_with_occt(const std::string& path, const MeshFineness& fineness) {
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
  c.deflection = fineness.deflection;

  auto model = read_model(path);
  if (!model) {
    c.refused = "we refuse it: " + model.error().text();
    return c;
  }
  for (const Instance& instance : model->instances) c.our_faces += int(model->parts[std::size_t(instance.part)].faces.size());
  TraceScene scene;
  add_model(scene, std::make_shared<const Model>(std::move(*model)), Affine3{});
  const Tracer tracer(std::move(scene));
  c.pictures.push_back(compare(mesh, tracer, rays_from_above(mesh.box, kComparedSize), kComparedSize));
  c.pictures.back().from = "above";
  c.pictures.push_back(compare(mesh, tracer, rays_from_below(mesh.box, kComparedSize), kComparedSize));
  c.pictures.back().from = "below";
  return c;
}

std::string table_head() {
  return fmt::format("{:<44}{:>6}{:>6}{:>10}{:>9}{:>8}{:>9}{:>9}{:>7}{:>9}{:>7}{:>9}{:>9}{:>8}", "file", "faces", "ours", "triangles",
                     "mesh ms", "from", "hits", "hit/miss", "unexpl", "depth", "unexpl", "loose", "ours ms", "tri ms");
}

std::string table_rows(const Comparison& c) {
  if (!c.refused.empty()) return fmt::format("{:<44}{}", c.file, c.refused);
  std::string rows;
  for (const Picture& p : c.pictures) {
    if (rows.empty())
      rows = fmt::format("{:<44}{:>6}{:>6}{:>10}{:>9.0f}", c.file, c.faces, c.our_faces, c.triangles, c.mesh_ms);
    else
      rows += fmt::format("\n{:75}", "");
    rows += fmt::format("{:>8}{:>9}{:>9}{:>7}{:>9}{:>7}{:>9}{:>9.0f}{:>8.0f}", p.from, p.hits, p.hit_miss, p.hit_miss_off_rim, p.depth,
                        p.depth_off_rim, p.loose, p.our_ms, p.their_ms);
  }
  return rows;
}

}  // namespace iso::test
