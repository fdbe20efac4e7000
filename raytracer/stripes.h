// Stripes whose run over a surface shows how smooth it is: they jump where normals do (G0), kink where curvatures jump (G1), and run on
// smoothly from G2. A phase counts them; the picture shows its fraction, filtered over the pixel before it is sampled.
//
//   zebra             the angle between r and a: bands about a direction, seen by mirror reflection
//   reflection lines  the angle of r about a: straight light lines parallel to a, at infinity all around, seen by mirror reflection
//                     [Klass 1980; lines at infinity as Tosun et al. 2007]
//   isophotes         n . a, whoever looks [Poeschl 1984]
//
// d: unit direction of the line of sight, n: unit normal, r = d - 2 (n . d) n, a: unit axis in world coordinates. Both sides of a surface
// look alike: r does not ask for the sign of n, and the stripes of isophotes lie evenly about n . a = 0. Phases count in periods.
#pragma once

#include "patches/base/vec.h"

namespace iso {

enum class StripeKind { zebra, reflection_lines, isophotes };

inline constexpr int kMaxLines = 1000;

struct Stripes {
  StripeKind kind = StripeKind::zebra;
  Vec3 axis{0, 0, 1};  // a, unit
  Vec3 zero{1, 0, 0};  // reflection lines only: where the first line lies; unit, at right angles to the axis
  int lines = 16;      // periods in half a turn (zebra), a full turn (reflection lines), n . a from 0 to 1 (isophotes); 1 ... kMaxLines
  double width = 0.5;  // of a stripe, in periods; in (0, 1)
};

// What is seen along a ray, and how it changes per pixel to the right (x) and down (y).
struct SeenNormal {
  Vec3 d{0, 0, -1}, n{0, 0, 1};
  Vec3 d_x{0.0}, d_y{0.0}, n_x{0.0}, n_y{0.0};
};

struct StripePhase {
  double at = 0;         // whole numbers are the middles of stripes
  double per_pixel = 0;  // length of its gradient in the picture; infinite where the phase has no value (reflection lines along the axis)
};
StripePhase phase_of(const Stripes& stripes, const SeenNormal& seen);

// How much of a stripe is seen, 0 to 1, through a triangular window that reaches `reach` periods to each side of the phase: a closed form,
// by the second integral of the stripes. `width` where the reach or the phase is not finite; no window at all if it is 0.
double filtered_stripe(double phase, double width, double reach);

}  // namespace iso
