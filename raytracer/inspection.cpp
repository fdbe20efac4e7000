// Shades that show numbers instead of light. One formula a shade; colours are linear.
#include <cstdlib>

#include "raytracer/shading.h"

namespace iso {
namespace {

// Colours chosen to look as written on an sRGB screen.
constexpr float from_srgb(int level) {
  // A cubic near the sRGB curve, since std::pow is not constexpr; good enough for labels.
  const float x = static_cast<float>(level) / 255;
  return x * (x * (x * 0.305306011f + 0.682171111f) + 0.012522878f);
}
constexpr Colour rgb(int r, int g, int b) { return {from_srgb(r), from_srgb(g), from_srgb(b)}; }

// One colour per surface kind, in the order of AnySurface.
constexpr std::array kKindColours{rgb(158, 188, 218),   // plane
                                  rgb(253, 174, 97),    // cylinder
                                  rgb(215, 80, 70),     // cone
                                  rgb(120, 198, 121),   // sphere
                                  rgb(190, 130, 200),   // torus
                                  rgb(110, 205, 200),   // extrusion
                                  rgb(245, 225, 110),   // revolution
                                  rgb(70, 120, 200),    // NURBS
                                  rgb(240, 130, 175)};  // charts of n-sided patches
static_assert(kKindColours.size() == std::variant_size_v<AnySurface>);

// A stable, bright colour per face: hue by the golden ratio, so that neighbouring numbers differ well, lightness by a hash.
Colour face_colour(std::int32_t placed, std::int32_t face) {
  const std::uint64_t h = hash_mix(static_cast<std::uint64_t>(placed));
  const double hue = std::fmod(face * 0.6180339887498949 + static_cast<double>(h % 1024) / 1024, 1.0);
  const float light = 0.75f + 0.25f * static_cast<float>(hash_mix(h, static_cast<std::uint64_t>(face)) % 256) / 255;
  Colour c;
  for (int i = 0; i < 3; ++i) {
    const double wave = 0.5 + 0.5 * std::cos(kTwoPi * (hue - i / 3.0));
    c[i] = light * (0.10f + 0.75f * static_cast<float>(wave * wave));
  }
  return c;
}

// Blue (hollow) over white (flat) to red (bulging): mean curvature seen from outside, times the scene's size.
Colour curvature_colour(const Curvatures& k, double diagonal) {
  constexpr double kHalfWay = 8;  // mean curvature in 1 / diagonal at which the colour is half saturated
  const double bulge = -0.5 * (k.k1 + k.k2) * diagonal;
  if (!std::isfinite(bulge)) return rgb(255, 220, 60);
  const float s = static_cast<float>(std::abs(bulge) / (std::abs(bulge) + kHalfWay));
  const Colour end = bulge > 0 ? rgb(178, 24, 43) : rgb(33, 102, 172);
  return glm::mix(rgb(247, 247, 247), end, s);
}

// Dark to light blue by the work spent; strong colours for the rare branches.
Colour solver_colour(const Hit& hit) {
  if (hit.status == HitStatus::tangent) return rgb(255, 0, 200);
  if (hit.status == HitStatus::fallback) return rgb(255, 140, 0);
  if (hit.by_tolerance) return rgb(0, 255, 220);
  const float s = std::min(1.0f, static_cast<float>(hit.steps) / 16);
  return glm::mix(rgb(25, 30, 70), rgb(190, 215, 255), s);
}

float fraction(double x, double lo, double hi) { return hi > lo ? static_cast<float>(std::clamp((x - lo) / (hi - lo), 0.0, 1.0)) : 0.0f; }

class Inspection {
 public:
  Inspection(const Tracer& tracer, Shade shade, const InspectionView& view)
      : tracer_(&tracer), shade_(shade), view_(view), diagonal_(tracer.scene().box().diagonal()) {}

  void operator()(const PrimaryHits& batch, std::span<glm::vec4> out, SolverStats&) const {
    for (std::size_t i = 0; i < batch.hits.size(); ++i)
      if (batch.hits[i]) out[i] = glm::vec4(colour(batch.rays[i], batch.hits[i]), 1.0f);
  }

 private:
  Colour colour(const Ray& ray, const Hit& hit) const {
    const SurfacePoint at = tracer_->surface_point(hit);
    const Face& face = tracer_->face(hit);
    // Labels are modelled a little by the angle to the line of sight, so that form stays visible; measured values are not.
    const float facing = 0.45f + 0.55f * static_cast<float>(std::abs(glm::dot(at.n, glm::normalize(ray.d))));
    switch (shade_) {
      case Shade::normals:
        return Colour(0.5 * (at.n + Vec3(1.0)));
      case Shade::uv:
        return {fraction(hit.uv.x, face.domain.lo.x, face.domain.hi.x), fraction(hit.uv.y, face.domain.lo.y, face.domain.hi.y), 0.0f};
      case Shade::faces:
        return facing * face_colour(hit.placed, hit.face);
      case Shade::kinds:
        return facing * kKindColours[face.surface.index()];
      case Shade::curvature:
        return facing * curvature_colour(tracer_->curvatures(hit), diagonal_);
      case Shade::depth:
        return Colour(1 - 0.95f * fraction(glm::dot(at.p - view_.eye, view_.forward), view_.depth.lo, view_.depth.hi));
      case Shade::solver:
        return solver_colour(hit);
      case Shade::clay:
      case Shade::zebra:
      case Shade::reflection_lines:
      case Shade::isophotes:
      case Shade::mean_curvature:
      case Shade::gauss_curvature:
        break;  // have integrators of their own
    }
    ISO_CHECK(!"an inspection shade");
  }

  const Tracer* tracer_;
  Shade shade_;
  InspectionView view_;
  double diagonal_;
};

}  // namespace

std::optional<Shade> shade_named(std::string_view name) {
  for (std::size_t i = 0; i < kShadeNames.size(); ++i)
    if (name == kShadeNames[i]) return static_cast<Shade>(i);
  return {};
}

Integrator inspection(const Tracer& tracer, Shade shade, const InspectionView& view) { return Inspection(tracer, shade, view); }

}  // namespace iso
