// A number with its first and second derivatives in two parameters, so that a formula written once gives them all; and
// the jets of surfaces and curves that the program hands around.
#pragma once

#include <cmath>

#include "patches/base/vec.h"

namespace iso {

// A surface point with its derivatives; world units per parameter unit.
struct Jet2 {
  Vec3 S{0.0}, Su{0.0}, Sv{0.0}, Suu{0.0}, Suv{0.0}, Svv{0.0};
};

// A curve point with its derivatives.
template <class V>
struct CurveJet {
  V C{0.0}, Ct{0.0}, Ctt{0.0};
};

// f, f_u, f_v of a scalar function of (u, v), over doubles or packs of them. Nothing is set by default.
template <class R>
struct Dual1 {
  R f, u, v;

  Dual1() = default;
  Dual1(double constant) : f(constant), u(0.0), v(0.0) {}
  Dual1(const R& f_, const R& u_, const R& v_) : f(f_), u(u_), v(v_) {}

  friend Dual1 operator+(const Dual1& a, const Dual1& b) { return {a.f + b.f, a.u + b.u, a.v + b.v}; }
  friend Dual1 operator-(const Dual1& a, const Dual1& b) { return {a.f - b.f, a.u - b.u, a.v - b.v}; }
  friend Dual1 operator*(const Dual1& a, const Dual1& b) { return {a.f * b.f, a.u * b.f + a.f * b.u, a.v * b.f + a.f * b.v}; }
  friend Dual1 operator/(const Dual1& a, const Dual1& b) { return a.over(b, R(1.0) / b.f); }
  friend Dual1 operator+(const Dual1& a, double b) { return {a.f + R(b), a.u, a.v}; }
  friend Dual1 operator*(const Dual1& a, double by) { return {a.f * R(by), a.u * R(by), a.v * R(by)}; }
  friend Dual1 operator*(double by, const Dual1& a) { return a * by; }

  // a / b with the inverse of b.f.
  Dual1 over(const Dual1& b, const R& inverse) const {
    const R q = f * inverse;
    return {q, (u - q * b.u) * inverse, (v - q * b.v) * inverse};
  }
};

// f, f_u, f_v, f_uu, f_uv, f_vv of a scalar function of (u, v).
struct Dual2 {
  double f = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;

  Dual2() = default;
  Dual2(double constant) : f(constant) {}
  Dual2(double f_, double u_, double v_, double uu_, double uv_, double vv_) : f(f_), u(u_), v(v_), uu(uu_), uv(uv_), vv(vv_) {}
  static Dual2 variable_u(double x) { return {x, 1, 0, 0, 0, 0}; }
  static Dual2 variable_v(double x) { return {x, 0, 1, 0, 0, 0}; }
};

inline Dual2 operator+(const Dual2& a, const Dual2& b) { return {a.f + b.f, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv}; }
inline Dual2 operator*(const Dual2& a, const Dual2& b) {
  return {a.f * b.f,
          a.u * b.f + a.f * b.u,
          a.v * b.f + a.f * b.v,
          a.uu * b.f + 2 * a.u * b.u + a.f * b.uu,
          a.uv * b.f + a.u * b.v + a.v * b.u + a.f * b.uv,
          a.vv * b.f + 2 * a.v * b.v + a.f * b.vv};
}
inline Dual2 operator-(const Dual2& a) { return {-a.f, -a.u, -a.v, -a.uu, -a.uv, -a.vv}; }
inline Dual2 operator-(const Dual2& a, const Dual2& b) { return a + -b; }
// g(a) by the chain rule, from g, g' and g'' at a.f.
inline Dual2 chain(const Dual2& a, double g, double g1, double g2) {
  return {g, g1 * a.u, g1 * a.v, g2 * a.u * a.u + g1 * a.uu, g2 * a.u * a.v + g1 * a.uv, g2 * a.v * a.v + g1 * a.vv};
}
inline Dual2 operator/(const Dual2& a, const Dual2& b) {
  const double inverse = 1 / b.f;
  return a * chain(b, inverse, -inverse * inverse, 2 * inverse * inverse * inverse);
}
inline Dual2 sqrt(const Dual2& a) {
  const double root = std::sqrt(a.f);
  return chain(a, root, 0.5 / root, -0.25 / (root * a.f));
}
inline Dual2 sin(const Dual2& a) {
  const double s = std::sin(a.f), c = std::cos(a.f);
  return chain(a, s, c, -s);
}
inline Dual2 cos(const Dual2& a) {
  const double s = std::sin(a.f), c = std::cos(a.f);
  return chain(a, c, -s, -c);
}

}  // namespace iso
