// Vectors, boxes and intervals: GLM's types under names that say what they hold.
// Geometry is double everywhere; float appears only beside Embree and in pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>

namespace iso {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;  // homogeneous point (w x, w y, w z, w)
using Mat3 = glm::dmat3;
using Point3 = glm::dvec3;
using UV = glm::dvec2;     // a point of a surface's parameter domain
using Colour = glm::vec3;  // linear, Rec. 709 primaries

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kEps = std::numeric_limits<double>::epsilon();
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2 * kPi;

// A closed interval; empty when lo > hi (the default).
struct Range {
  double lo = kInf;
  double hi = -kInf;

  bool empty() const { return lo > hi; }
  double width() const { return hi - lo; }
  double middle() const { return 0.5 * (lo + hi); }
  double magnitude() const { return std::max(std::abs(lo), std::abs(hi)); }  // the largest in it; not of an empty one
  bool contains(double x) const { return lo <= x && x <= hi; }
  void include(double x) {
    lo = std::min(lo, x);
    hi = std::max(hi, x);
  }
};

// An axis-aligned box of vectors V; empty when some lo > hi (the default).
template <class V>
struct Box {
  V lo{kInf};
  V hi{-kInf};

  bool empty() const {
    for (int i = 0; i < V::length(); ++i)
      if (!(lo[i] <= hi[i])) return true;
    return false;
  }
  void include(const V& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  void include(const Box& b) {
    lo = glm::min(lo, b.lo);
    hi = glm::max(hi, b.hi);
  }
  V middle() const { return 0.5 * (lo + hi); }
  V size() const { return hi - lo; }
  double diagonal() const { return empty() ? 0.0 : glm::length(hi - lo); }
  bool contains(const V& p) const {
    for (int i = 0; i < V::length(); ++i)
      if (!(lo[i] <= p[i] && p[i] <= hi[i])) return false;
    return true;
  }
  Box inflated(double by) const { return {lo - V(by), hi + V(by)}; }
};
using Box2 = Box<Vec2>;
using Box3 = Box<Vec3>;

inline bool finite(double x) { return std::isfinite(x); }
inline bool finite(const Vec2& v) { return finite(v.x) && finite(v.y); }
inline bool finite(const Vec3& v) { return finite(v.x) && finite(v.y) && finite(v.z); }

// Any unit vector at right angles to the unit vector n.  [Duff et al. 2017, a sign-stable frame]
inline Vec3 any_perpendicular(const Vec3& n) {
  const double s = std::copysign(1.0, n.z);
  const double a = -1.0 / (s + n.z);
  return {1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x};
}

}  // namespace iso
