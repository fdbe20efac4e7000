#include "raytracer/all_hits.h"

#include "raytracer/packet.h"
#include "raytracer/triangle_hits.h"

namespace iso {

void sort_and_remove_doubles(const Tracer& tracer, const Ray& ray, double size, std::vector<Hit>& hits) {
  std::sort(hits.begin(), hits.end(), comes_first);
  if (hits.size() < 2) return;
  struct Seen {
    Hit hit;
    SurfacePoint at;
    bool entering;
  };
  std::vector<Seen> kept;
  const double length = glm::length(ray.d);
  for (const Hit& hit : hits) {
    const SurfacePoint at = tracer.surface_point(hit);
    const bool entering = glm::dot(at.ng, ray.d) < 0;
    const Placed& placed = tracer.scene().placed[static_cast<std::size_t>(hit.placed)];
    bool twice = false;
    for (auto k = kept.rbegin(); k != kept.rend() && !twice; ++k) {
      const double apart = (hit.t - k->hit.t) * length;
      if (apart > 1e-3 * size) break;
      if (k->hit.placed != hit.placed) continue;
      // One root found twice differs by rounding, which grazing stretches along the ray.
      const double cosine = std::max(std::abs(glm::dot(at.ng, ray.d)) / length, 1e-3);
      if (placed.mesh) {
        const double flatter = std::min(cosine, std::max(std::abs(glm::dot(k->at.ng, ray.d)) / length, 1e-3));
        twice = k->entering == entering && cross_at_shared_corner(placed, k->hit, hit, apart, flatter);
        continue;
      }
      const double rounding = 32 * (at.error_bound + k->at.error_bound) / cosine;
      const bool same_face = k->hit.face == hit.face && glm::length(k->at.p - at.p) <= rounding;
      const bool touching = hit.status == HitStatus::tangent || k->hit.status == HitStatus::tangent;
      if (same_face && (k->entering == entering || touching)) twice = true;
    }
    // Two sheets that overlap at a loose edge count as one where a ray passes both in the same sense.
    if (!twice && !kept.empty() && kept.back().entering == entering && tracer.meet_at_loose_edge(kept.back().hit, hit)) twice = true;
    if (!twice) kept.push_back({hit, at, entering});
  }
  hits.clear();
  for (const Seen& k : kept) hits.push_back(k.hit);
}

}  // namespace iso
