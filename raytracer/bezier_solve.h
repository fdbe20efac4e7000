// All meets of a ray with a window of a rational Bezier patch, by subdivision: slow, and never wrong.
//
// The two plane equations of the ray (leaf_kernel.h) are Bernstein polynomials over the window. They are subdivided until every part is
// empty (the origin lies outside the hull of its coefficients), certified, or as small as rounding. A part is certified where its Jacobian
// differs from that of its linear model by E with |J0^-1| E < 1: the map is one-to-one there, so the part has at most one root, and Newton
// finds it or proves that there is none. No root is lost: grazing rays, silhouettes, poles and several roots at once end here.
#pragma once

#include <vector>

#include "raytracer/leaf_kernel.h"

namespace iso {

struct Root {
  Vec2 st{0.0};  // in the patch's unit square
  double t = 0;
  HitStatus status = HitStatus::converged;
  std::uint16_t steps = 0;
};

// Where a ray misses a patch by less than `within` beside a fold, as the ray sees it: what the patch stands for may be met there, twice.
// Places near them, of the patch's unit square; one fold may have several.
struct PassedFolds {
  double within = 0;
  std::vector<Vec2> at;
};

// A root may lie beyond the border of its window by this share of the window: what is met twice is removed by whoever counts, and
// neighbours that are a little apart are closed. Neighbours that share their border bit for bit need no more than rounding.
inline constexpr double kOverlap = 1e-9, kOverlapOfShared = 1e-12;

// Appends the roots in the window (and within rounding of its border), in no order, whatever their t; and what is passed, where that is
// asked for.
void roots_in_window(const BezierPatch& patch, const Window& window, const LocalRay& ray, SolverStats& stats, std::vector<Root>& roots,
                     double overlap = kOverlap, PassedFolds* passed = nullptr);

}  // namespace iso
