// The clay look: what makes form read without any set-up.
#include "raytracer/shading.h"

namespace iso {
namespace {

constexpr Colour kClay{0.93f, 0.885f, 0.82f};  // a light, slightly warm neutral
constexpr float kWhite = 0.62f;                // albedo of the colour 1: lit fully, a face shows about the colour its file gives, unclipped
constexpr float kBounce = 0.35f;               // radiance of what hides the sky, over albedo and sky: stands for light between surfaces
constexpr float kGloss = 0.05f;                // share of the key light in the highlight
constexpr float kGlossExponent = 36;

// Irradiance over pi of the whole sky on a surface with normal n: the linear gradient, flattened by 2/3.
Colour sky_light(const Sky& sky, const Vec3& n) {
  const float h = static_cast<float>(0.5 + glm::dot(n, sky.up) / 3);
  return sky.ground * (1 - h) + sky.zenith * h;
}

// One visible point, waiting for its occlusion rays.
struct Visible {
  std::size_t out;  // index into the batch
  Vec3 n;           // turned toward the viewer
  Colour albedo;
  std::int64_t key_ray = -1;  // index of its ray toward the key light, -1: turned away
  bool sky_under = false;     // its ray into the sky goes under the triangle it is on
};

struct Work {
  std::vector<Visible> points;
  std::vector<Ray> sky_rays, key_rays;  // one sky ray per point
  std::vector<std::uint8_t> sky_blocked, key_blocked;
};

class Clay {
 public:
  Clay(const Tracer& tracer, const Lights& lights, const Sampler& sampler) : tracer_(&tracer), lights_(lights), sampler_(sampler) {}

  void operator()(const PrimaryHits& batch, std::span<glm::vec4> out, SolverStats& stats) const {
    Work work;
    for (std::size_t i = 0; i < batch.hits.size(); ++i)
      if (batch.hits[i]) enqueue(batch, i, work);

    // Rays to the small key light stay neighbours; those into the sky scatter.
    work.sky_blocked.resize(work.sky_rays.size());
    work.key_blocked.resize(work.key_rays.size());
    tracer_->occluded(work.sky_rays, work.sky_blocked, Tracer::Order::coherent, stats);
    tracer_->occluded(work.key_rays, work.key_blocked, Tracer::Order::coherent, stats);
    for (std::size_t k = 0; k < work.points.size(); ++k)
      out[work.points[k].out] = glm::vec4(radiance(work, k, batch.rays[work.points[k].out].d), 1.0f);
  }

 private:
  void enqueue(const PrimaryHits& batch, std::size_t i, Work& work) const {
    // The normal turned to the viewer; where a surface has none, the line of sight stands in.
    const Ray& ray = batch.rays[i];
    const SurfacePoint at = tracer_->surface_point(batch.hits[i]);
    Vec3 n = at.n;
    if (!finite(n) || !(glm::dot(n, n) > 0.5)) n = -glm::normalize(ray.d);
    // The side is what is met, not what shading shows.
    const double facing = glm::dot(at.ng, ray.d) > 0 ? -1 : 1;
    n *= facing;
    const auto under = [&](const Vec3& direction) { return facing * glm::dot(at.side, direction) < 0; };

    Visible point{.out = i, .n = n, .albedo = kWhite * base_colour(*tracer_, batch.hits[i])};
    const Vec3 to_sky = cosine_hemisphere(n, sampler_.pair(batch.samples[i], Dimension::sky));
    point.sky_under = under(to_sky);
    work.sky_rays.push_back(secondary_ray(batch.hits[i], at, to_sky, point.sky_under ? -1 : kInf));

    const double cos_radius = std::cos(0.5 * lights_.key.angle);
    const Vec3 to_key = uniform_cone(lights_.key.from, cos_radius, sampler_.pair(batch.samples[i], Dimension::key));
    if (glm::dot(n, to_key) > 0 && !under(to_key)) {
      point.key_ray = static_cast<std::int64_t>(work.key_rays.size());
      work.key_rays.push_back(secondary_ray(batch.hits[i], at, to_key));
    }
    work.points.push_back(point);
  }

  Colour radiance(const Work& work, std::size_t k, const Vec3& direction) const {
    const Visible& point = work.points[k];
    const Colour sky = sky_light(lights_.sky, point.n);
    Colour sum = point.albedo * sky * (work.sky_blocked[k] || point.sky_under ? kBounce * point.albedo : Colour(1.0f));
    if (point.key_ray < 0 || work.key_blocked[static_cast<std::size_t>(point.key_ray)]) return sum;

    // Lambert, and a highlight about the half vector, scaled so that its energy does not depend on the exponent.
    const Vec3 to_key = work.key_rays[static_cast<std::size_t>(point.key_ray)].d;
    const float cosine = static_cast<float>(glm::dot(point.n, to_key));
    const float half = static_cast<float>(std::max(0.0, glm::dot(point.n, glm::normalize(to_key - glm::normalize(direction)))));
    const float highlight = kGloss * (kGlossExponent + 8) / 8 * std::pow(half, kGlossExponent);
    return sum + lights_.key.irradiance * cosine * (point.albedo + Colour(highlight));
  }

  const Tracer* tracer_;
  Lights lights_;
  Sampler sampler_;
};

}  // namespace

Lights default_lights(const Vec3& right, const Vec3& up, const Vec3& back) {
  Lights lights;
  lights.sky.up = glm::normalize(up + 0.6 * back);
  lights.key.from = glm::normalize(-0.55 * right + 0.75 * up + 0.7 * back);
  lights.key.irradiance = {0.92f, 0.87f, 0.80f};
  return lights;
}

Colour base_colour(const Tracer& tracer, const Hit& hit) {
  const Placed& placed = tracer.scene().placed[static_cast<std::size_t>(hit.placed)];
  if (placed.colour_overrides && placed.colour) return *placed.colour;
  const Face& face = tracer.face(hit);
  if (face.colour) return *face.colour;
  return placed.colour.value_or(kClay);
}

Integrator clay(const Tracer& tracer, const Lights& lights, const Sampler& sampler) { return Clay(tracer, lights, sampler); }

}  // namespace iso
