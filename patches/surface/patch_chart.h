// An n-sided patch as a surface of CAD faces has (u, v): by charts, one a corner, each over [0, 1]^2 (patch_basis.h).
//
// Formulas of blended kinds are no polynomials that can be divided. Beside each chart lies a biquintic spline, tangent and curvature
// continuous, equal to it where the chart's cells meet and on the patch's boundary curves, with a proven distance: rays and triangles are
// sorted by the spline, and what is stored and shown is the point of the chart itself.
#pragma once

#include <memory>
#include <vector>

#include "patches/surface/patch_basis.h"

namespace iso {

struct NurbsSurface;

// A whole patch. points.size() == point_count(basis).
struct NSidedPatch {
  PatchBasis basis;
  std::vector<Vec3> points;
  std::vector<double> weights;  // rational Bezier triangles: positive; empty: all one
};

// Says what is wrong with the data (see PatchBasis; sizes, non-finite numbers, weights), or nothing (empty).
std::string problem_of(const NSidedPatch& patch);

struct PatchChart {
  PatchBasis basis;
  std::vector<Vec3> points;  // as seen from this chart's corner
  std::vector<double> weights;
  int patch = 0, corner = 0;                 // its number in the file, and which of its corners
  std::shared_ptr<const NurbsSurface> near;  // over [0, 1]^2
  double error = 0;                          // no point of the chart is farther from the spline's at the same (s, t); 0: they are one
};

// The chart of a corner, 0 <= corner < sides.
PatchChart chart_of(const NSidedPatch& patch, int corner);

// A spline beside a chart at most this far from it, if there is one: its own, the coarsest that will do, or the finest that is made.
struct ChartSpline {
  std::shared_ptr<const NurbsSurface> near;
  double error = 0;
};
ChartSpline spline_beside(const PatchChart& chart, double most);

// See surface.h. A little beyond [0, 1]^2 the formulas continue.
Point3 point_of(const PatchChart& chart, const Vec2& st);
Jet2 jet_of(const PatchChart& chart, const Vec2& st);
struct Tangents {
  Vec3 S{0.0}, Ss{0.0}, St{0.0};
};
Tangents tangents_of(const PatchChart& chart, const Vec2& st);
void translate(PatchChart& chart, const Vec3& by);

}  // namespace iso
