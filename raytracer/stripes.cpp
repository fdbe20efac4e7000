#include "raytracer/stripes.h"

#include "patches/base/check.h"

namespace iso {
namespace {

double fraction(double x) { return x - std::floor(x); }

// The second integral of the periodic stripes less their mean, itself without mean: stripes are the difference of two sawtooth waves, and
// these integrate to Bernoulli polynomials, B3(t) / 6 in the end.
double twice_integrated(double phase, double width) {
  const auto b3 = [](double t) { return t * (t - 0.5) * (t - 1); };
  return (b3(fraction(phase - 0.5 * width)) - b3(fraction(phase + 0.5 * width))) / 6;
}

struct Reflected {
  Vec3 r, r_x, r_y;
};

Reflected reflected(const SeenNormal& s) {
  const double nd = glm::dot(s.n, s.d);
  const auto change = [&](const Vec3& d1, const Vec3& n1) { return d1 - 2.0 * ((glm::dot(n1, s.d) + glm::dot(s.n, d1)) * s.n + nd * n1); };
  return {s.d - 2.0 * nd * s.n, change(s.d_x, s.n_x), change(s.d_y, s.n_y)};
}

// Bands at even angles to the axis. At the axis itself the angle has a kink, but no more than r turns it changes anywhere.
StripePhase zebra_phase(const Stripes& stripes, const SeenNormal& seen) {
  const Reflected m = reflected(seen);
  const double scale = stripes.lines / kPi;
  const double along = glm::dot(m.r, stripes.axis), across = glm::length(glm::cross(m.r, stripes.axis));
  const double turn = std::hypot(glm::length(m.r_x), glm::length(m.r_y));
  const double slope = std::hypot(glm::dot(m.r_x, stripes.axis), glm::dot(m.r_y, stripes.axis));
  return {scale * std::atan2(across, along), scale * (slope < turn * across ? slope / across : turn)};
}

StripePhase reflection_line_phase(const Stripes& stripes, const SeenNormal& seen) {
  const Reflected m = reflected(seen);
  const Vec3 other = glm::cross(stripes.axis, stripes.zero);
  const double x = glm::dot(m.r, stripes.zero), y = glm::dot(m.r, other), square = x * x + y * y;
  const double scale = stripes.lines / kTwoPi;
  if (!(square > 0)) return {0, kInf};
  const auto change = [&](const Vec3& r1) { return (x * glm::dot(r1, other) - y * glm::dot(r1, stripes.zero)) / square; };
  return {scale * std::atan2(y, x), scale * std::hypot(change(m.r_x), change(m.r_y))};
}

StripePhase isophote_phase(const Stripes& stripes, const SeenNormal& seen) {
  return {stripes.lines * glm::dot(seen.n, stripes.axis),
          stripes.lines * std::hypot(glm::dot(seen.n_x, stripes.axis), glm::dot(seen.n_y, stripes.axis))};
}

}  // namespace

StripePhase phase_of(const Stripes& stripes, const SeenNormal& seen) {
  switch (stripes.kind) {
    case StripeKind::zebra:
      return zebra_phase(stripes, seen);
    case StripeKind::reflection_lines:
      return reflection_line_phase(stripes, seen);
    case StripeKind::isophotes:
      return isophote_phase(stripes, seen);
  }
  ISO_CHECK(!"a kind of stripes");
}

double filtered_stripe(double phase, double width, double reach) {
  if (!finite(phase) || !finite(reach)) return width;
  // Below this the second difference would lose more to rounding, eps / reach^2, than the window takes from a sharp edge.
  constexpr double kSharp = 1e-5;
  if (reach < kSharp) return std::abs(fraction(phase + 0.5) - 0.5) <= 0.5 * width ? 1.0 : 0.0;
  const double bend = twice_integrated(phase + reach, width) - 2 * twice_integrated(phase, width) + twice_integrated(phase - reach, width);
  return std::clamp(width + bend / (reach * reach), 0.0, 1.0);
}

}  // namespace iso
