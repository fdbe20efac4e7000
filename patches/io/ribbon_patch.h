// One patch from a loop of sides: their boundary curves and, where a file has them, the tangents across.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "patches/curve/curve.h"
#include "patches/io/patch_set.h"

namespace iso {

struct RibbonSide {
  NurbsCurve<Vec3> outer;                 // the boundary, from corner to corner
  std::optional<NurbsCurve<Vec3>> inner;  // over the same knots' range: inner - outer is the derivative across; none: free
  int line = 0;                           // where it stands in the file
};

// A loop of 3 to kMostSides sides, each beginning where the one before ends (else an `Error` with the line; up to kSameSide of the size),
// as one patch that keeps boundary and tangents. `midpoint`: what the centre of the patch is to be.
//
// Degree: the highest of the curves, 3 at least; with a curve of several pieces the lowest up to kMostFitted that fits all curves within
// kWantedFit of the size. Kind: generalised Bezier; of degree 3 with ribbons that turn differently at a corner (the two mixed derivatives
// differ) generalised Gregory, which has two points for them. In higher degrees such corners take the mean, and are reported.
//
// What is free. Without inner curves the derivative across a side goes evenly from that of the side before, at its end, to that of the
// side after, at its start; where two sides want another inner point at a corner it is their mean. Points of inner rows continue the
// ribbons evenly, b_jr = b_j0 + r (b_j1 - b_j0), and are means on the diagonals. The central point is the mean of the innermost ones.
inline constexpr int kMostFitted = 9;
inline constexpr double kWantedFit = 1e-4;
PatchSet patch_of_ribbons(const std::string& path, std::vector<RibbonSide> sides, const std::optional<Vec3>& midpoint);

}  // namespace iso
