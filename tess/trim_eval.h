// A trim curve prepared for many calls: its points, and how far it strays from its chords.
#pragma once

#include <vector>

#include "patches/curve/curve.h"

namespace iso {

class TrimEval {
 public:
  // The curve must stay where it is.
  explicit TrimEval(const Curve2& curve);

  // As jet; but for rounding.
  Vec2 at(double t) const;

  // How far the part between two parameters strays from the line between two points near its ends, as a displacement (|du|, |dv|) measured
  // by `speed`: by the second derivative and the kinks in between where the curve is polynomial, else by the control points of its spans.
  // `a` and `b` are off the ends of the part by (|du|, |dv|) = `moved` at most.
  double sliver(double t0, double t1, const Vec2& a, const Vec2& b, const Vec2& moved, const Vec2& speed) const;

 private:
  struct Span {
    double begin = 0, middle = 0, half = 0;
    Vec2 jump{0.0};  // of the first derivative at the begin, magnitudes
  };
  std::size_t span_at(double t) const;
  Vec2 second_derivative(std::size_t span, double t0, double t1) const;

  const Curve2* curve_;
  int degree_ = -1;  // negative: not prepared
  std::vector<Span> spans_;
  std::vector<Vec2> powers_;  // of each span, from the lowest power of (t - middle) / half
};

}  // namespace iso
