// The linear model of a subpatch on the way to its cells (cells.h), and proven bounds on how far its derivatives stray from it.
//
// Polynomial patches: the derivatives lie in the hulls of the difference nets. Rational ones: numerator and denominator of the derivative
// are multiplied out in Bernstein form, and the quotients of their coefficients bound the quotient. Products cost the square of the number
// of control points, so patches of high degree go through one of low degree that lies near: what it leaves out is bounded and added.
#pragma once

#include <vector>

#include "patches/base/four.h"
#include "patches/surface/bezier_patch.h"

namespace iso {

// How far a derivative strays from that of the linear model, in all and by its parts along and square to the model's normal.
struct Stray {
  double length = 0, normal = 0, tangential = 0;

  // Takes in squares; `take_roots` ends it.
  void include_square(const Vec3& v, const Vec3& n) {
    const double along = glm::dot(v, n);
    const Vec3 rest = v - along * n;
    length = std::max(length, glm::dot(v, v));
    normal = std::max(normal, along * along);
    tangential = std::max(tangential, glm::dot(rest, rest));
  }
  void take_roots() { *this = {std::sqrt(length), std::sqrt(normal), std::sqrt(tangential)}; }
  Stray& operator*=(double by) {
    length *= by;
    normal *= by;
    tangential *= by;
    return *this;
  }
  Stray& operator+=(double by) {
    length += by;
    normal += by;
    tangential += by;
    return *this;
  }
};
inline constexpr Stray kUnboundedStray{kInf, kInf, kInf};

// The linear model of a subpatch about its middle, and how far its derivatives stray from it, a quarter of its half width beyond its
// borders included (kCellMargin). All derivatives count in the cell's own parameters, which are half widths.
struct LinearModel {
  Point3 centre{0.0};
  Vec3 A{0.0}, B{0.0};
  Vec3 normal{0.0};  // of unit length; zero where A and B are all but parallel: then nothing is certain
  Stray stray_a, stray_b;
  double along_s = 0, along_t = 0;  // how much the derivatives vary when moving in s, in t, as shares of |A| and |B|
  int split_direction() const { return along_s >= along_t ? 0 : 1; }
};

// Whether the weights differ.
bool is_rational(const BezierPatch& patch);

// The model with the strays of four samples at the margin: the bounds cannot be smaller.
LinearModel sampled_model(const BezierPatch& patch, bool rational);

// The patch beyond its borders by the margin.
void extend_to_margin(const BezierPatch& patch, bool rational, BezierPatch& wide);

// Makes bounds of one cell after the other; keeps its work space.
class StrayBounds {
 public:
  // Puts proven bounds in the place of the samples. `wide`: the patch up to the margin.
  void bound(const BezierPatch& wide, bool rational, LinearModel& m);

 private:
  // Sums of products that meet in one coefficient of the numerators of dS/ds and dS/dt; the last of s: half the denominator's.
  struct Bin {
    Four s{}, t{};
  };
  void bound_rational(const BezierPatch& wide, LinearModel& m);
  bool bound_reduced(LinearModel& m);
  void multiply_out(const BezierPatch& net);
  void bound_quotients(const BezierPatch& net, LinearModel& m);

  BezierPatch centred_, reduced_, rest_, work_;
  std::vector<Vec4> points_;
  std::vector<Bin> bins_;
};

}  // namespace iso
