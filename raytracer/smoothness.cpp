#include "raytracer/smoothness.h"

#include "raytracer/filter.h"

namespace iso {
namespace {

// Looks of stripe and ground; grey levels are light.
struct Look {
  Colour stripe, ground;
};
Look look_of(StripeKind kind) {
  switch (kind) {
    case StripeKind::zebra:
      return {Colour(0.012f), Colour(0.86f)};
    case StripeKind::reflection_lines:  // light tubes over dark paint
      return {Colour(0.95f), {0.028f, 0.036f, 0.052f}};
    case StripeKind::isophotes:
      return {{0.03f, 0.12f, 0.30f}, {0.84f, 0.82f, 0.76f}};
  }
  ISO_CHECK(!"a kind of stripes");
}

StripeKind kind_of(Shade shade) {
  ISO_CHECK(has_stripes(shade));
  return shade == Shade::zebra ? StripeKind::zebra : shade == Shade::isophotes ? StripeKind::isophotes : StripeKind::reflection_lines;
}

// Of the variance of the picture's filter: what each sample's own window has.
double window_share(int samples) { return 1 / std::sqrt(double(samples)); }

class StripeIntegrator {
 public:
  StripeIntegrator(const Tracer& tracer, const Stripes& stripes, const StripeView& view)
      : tracer_(&tracer),
        stripes_(stripes),
        view_(view),
        look_(look_of(stripes.kind)),
        // A triangle of half-width h has the variance h^2 / 6.
        pixels_(PixelFilter::kDeviation * std::sqrt(6 * window_share(view.samples))) {}

  void operator()(const PrimaryHits& batch, std::span<glm::vec4> out, SolverStats&) const {
    for (std::size_t i = 0; i < batch.hits.size(); ++i)
      if (batch.hits[i]) out[i] = glm::vec4(colour(batch.rays[i], batch.hits[i]), 1.0f);
  }

 private:
  Colour colour(const Ray& ray, const Hit& hit) const {
    const SeenNormal seen = seen_normal(*tracer_, ray, hit, ray_differential(view_.camera, view_.size, ray));
    const StripePhase phase = phase_of(stripes_, seen);
    const double share = filtered_stripe(phase.at, stripes_.width, pixels_ * phase.per_pixel);
    return glm::mix(look_.ground, look_.stripe, static_cast<float>(share));
  }

  const Tracer* tracer_;
  Stripes stripes_;
  StripeView view_;
  Look look_;
  double pixels_;
};

// The part of `direction` at right angles to the axis, of unit length; nothing if there is little of it.
std::optional<Vec3> beside(const Vec3& axis, const Vec3& direction) {
  constexpr double kLittle = 0.1;  // radians: nearer, the lines would turn fast with the axis
  const Vec3 part = direction - glm::dot(direction, axis) * axis;
  const double length = glm::length(part);
  return length > kLittle ? std::optional<Vec3>(part / length) : std::nullopt;
}

}  // namespace

bool has_stripes(Shade shade) { return shade == Shade::zebra || shade == Shade::reflection_lines || shade == Shade::isophotes; }
bool has_scale(Shade shade) { return shade == Shade::mean_curvature || shade == Shade::gauss_curvature; }

std::optional<ShadeOption> meaningless_option(const ShadeOptions& options, Shade shade) {
  if (!has_stripes(shade)) {
    if (options.direction) return ShadeOption::direction;
    if (options.lines) return ShadeOption::lines;
    if (options.line_width) return ShadeOption::line_width;
  }
  if (!has_scale(shade)) {
    if (options.range) return ShadeOption::range;
    if (options.legend) return ShadeOption::legend;
  }
  return {};
}

const char* shades_with(ShadeOption option) {
  const bool scale = option == ShadeOption::range || option == ShadeOption::legend;
  return scale ? "mean-curvature and gauss-curvature" : "zebra, reflection-lines and isophotes";
}

Stripes stripes_for(Shade shade, const ShadeOptions& options, const Camera& camera) {
  Stripes stripes;
  stripes.kind = kind_of(shade);
  const bool lines = stripes.kind == StripeKind::reflection_lines;
  const bool isophotes = stripes.kind == StripeKind::isophotes;
  stripes.axis = options.direction.value_or(isophotes ? default_lights(camera.right, camera.up, camera.back).key.from : camera.right);
  stripes.zero = beside(stripes.axis, camera.up).value_or(camera.back);
  if (const auto zero = beside(stripes.axis, stripes.zero)) stripes.zero = *zero;
  stripes.lines = options.lines.value_or(lines ? 36 : 12);
  stripes.width = options.line_width.value_or(lines ? 0.25 : 0.5);
  return stripes;
}

SeenNormal seen_normal(const Tracer& tracer, const Ray& ray, const Hit& hit, const RayDifferential& differential) {
  const SurfacePoint at = tracer.surface_point(hit);
  SeenNormal seen{.d = ray.d, .n = at.n, .d_x = differential.d_x, .d_y = differential.d_y};
  if (glm::dot(at.n, at.n) < 0.5) seen.n = Vec3(std::nan(""));

  // Where the neighbouring rays meet the tangent plane, and how the normal turns on the way there.
  const bool turns =
      !tracer.scene().placed[static_cast<std::size_t>(hit.placed)].mesh || tracer.scene().mesh_shading == MeshShading::smooth;
  if (!turns) return seen;
  const Mat3 S = tracer.shape_operator(hit);
  const double t = glm::dot(at.p - ray.o, ray.d), facing = glm::dot(ray.d, at.ng);
  const auto turned = [&](const Vec3& o1, const Vec3& d1) {
    const Vec3 moved = o1 + t * d1;
    return -(S * (moved - glm::dot(moved, at.ng) / facing * ray.d));
  };
  const Vec3 n_x = turned(differential.o_x, differential.d_x), n_y = turned(differential.o_y, differential.d_y);
  if (finite(n_x) && finite(n_y)) {
    seen.n_x = n_x;
    seen.n_y = n_y;
  }
  return seen;
}

double stripe_spread(int samples) { return std::sqrt(1 - window_share(samples)); }

Integrator stripes(const Tracer& tracer, const Stripes& stripes, const StripeView& view) { return StripeIntegrator(tracer, stripes, view); }

}  // namespace iso
