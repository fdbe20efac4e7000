// Points and tangents of one surface, prepared for millions of calls. What the B-spline basis functions are over a span is written out once
// per direction, as powers about the middle of the span; a point then costs a Horner scheme in each direction and a sum over the poles, no
// division. The same values as jet2, but for rounding.
#pragma once

#include <vector>

#include "patches/surface/surface.h"

namespace iso {

// Place and first derivatives; world units, per parameter unit.
struct TangentJet {
  Point3 S{0.0};
  Vec3 Su{0.0}, Sv{0.0};
};

// The basis functions of one knot vector and their first derivatives.
class BasisPowers {
 public:
  // Powers about the middle lose digits with the degree, half a decimal each: none are made above it.
  static constexpr int kMostDegree = 8;

  BasisPowers() = default;
  BasisPowers(const std::vector<double>& knots, int degree);

  int degree() const { return degree_; }

  // Values N[0..degree] and derivatives D[0..degree] of the functions that are not zero at t; returns the index of the first. End spans
  // also serve what lies beyond the domain; at a knot, the span to the right.
  int values(double t, double* N, double* D) const;

 private:
  struct Span {
    double begin = 0, middle = 0, per_half = 0;  // per_half: 1 / half of the width
    int first = 0;
  };
  int degree_ = 0;
  double at_ = 0, buckets_per_unit_ = 0;
  std::vector<Span> spans_;
  std::vector<double> powers_;  // of each span, of each power from the highest down: one coefficient per function
  std::vector<int> bucket_;     // the first span that reaches into each of some even intervals of the domain
};

class SurfaceEval {
 public:
  // The surface must stay where it is.
  explicit SurfaceEval(const AnySurface& surface);

  TangentJet at(UV uv) const;
  Point3 point(UV uv) const { return at(uv).S; }

 private:
  TangentJet of_nurbs(const NurbsSurface& s, UV uv) const;
  CurveJet<Vec3> profile(const Curve3& curve, double t) const;

  const AnySurface* surface_;
  BasisPowers u_, v_;  // of a NURBS; of the profile of an extrusion or revolution `u_` alone
  bool prepared_ = false, rational_ = false;
  double weight_ = 1;  // of all poles, where they have the same
};

}  // namespace iso
