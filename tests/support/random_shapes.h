// Random curves and surfaces of every kind, for properties that hold for all of them.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "patches/surface/surface.h"

namespace iso::test {

using Random = std::mt19937_64;

inline double between(Random& random, double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }
inline int whole(Random& random, int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(random); }
inline Vec2 point_in(Random& random, const Box2& box) { return {between(random, box.lo.x, box.hi.x), between(random, box.lo.y, box.hi.y)}; }

template <class V>
V random_vector(Random& random, double size) {
  V v;
  for (int c = 0; c < V::length(); ++c) v[c] = between(random, -size, size);
  return v;
}

// Orthonormal, right- or left-handed, in any position.
inline Frame random_frame(Random& random) {
  Frame f;
  f.O = random_vector<Vec3>(random, 5);
  std::normal_distribution<double> normal;
  f.X = glm::normalize(Vec3(normal(random), normal(random), normal(random) + 1e-3));
  f.Y = glm::normalize(glm::cross(f.X, Vec3(normal(random), normal(random), normal(random) - 1e-3)));
  f.Z = glm::cross(f.X, f.Y);
  if (whole(random, 0, 1)) f.Y = -f.Y;
  return f;
}

enum class Knots { smooth, c0, unclamped, bezier };
inline constexpr std::array<const char*, 4> kKnotNames{"smooth", "C0", "unclamped", "Bezier"};

// A knot vector of this style for `count` poles (which is changed to fit).
inline std::vector<double> random_knots(Random& random, Knots style, int degree, int& count) {
  std::vector<double> inner;
  const int spans = style == Knots::bezier ? 1 : whole(random, 2, 5);
  double at = between(random, -2, 2);
  std::vector<double> distinct{at};
  for (int i = 0; i < spans; ++i) distinct.push_back(at += between(random, 0.3, 1.5));
  std::vector<double> knots;
  if (style == Knots::unclamped) {  // simple knots, also beyond both ends of the domain
    for (int i = 0; i < degree; ++i) knots.push_back(distinct.front() - 0.7 * (degree - i));
    knots.insert(knots.end(), distinct.begin(), distinct.end());
    for (int i = 0; i < degree; ++i) knots.push_back(distinct.back() + 0.6 * (i + 1));
  } else {
    knots.assign(static_cast<std::size_t>(degree) + 1, distinct.front());
    for (std::size_t i = 1; i + 1 < distinct.size(); ++i)
      knots.insert(knots.end(), static_cast<std::size_t>(style == Knots::c0 ? degree : whole(random, 1, std::max(1, degree - 1))),
                   distinct[i]);
    knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, distinct.back());
  }
  count = static_cast<int>(knots.size()) - degree - 1;
  return knots;
}

template <class V>
NurbsCurve<V> random_nurbs_curve(Random& random, Knots style, int degree, bool rational) {
  NurbsCurve<V> c;
  c.degree = degree;
  int count = 0;
  c.knots = random_knots(random, style, degree, count);
  for (int i = 0; i < count; ++i) c.poles.push_back(homogeneous(random_vector<V>(random, 3), rational ? between(random, 0.3, 3) : 1.0));
  return c;
}

inline NurbsSurface random_nurbs(Random& random, Knots style_u, Knots style_v, int degree_u, int degree_v, bool rational) {
  NurbsSurface s;
  s.degree_u = degree_u;
  s.degree_v = degree_v;
  s.knots_u = random_knots(random, style_u, degree_u, s.count_u);
  s.knots_v = random_knots(random, style_v, degree_v, s.count_v);
  const Vec3 shift = random_vector<Vec3>(random, 3);
  for (int i = 0; i < s.count_u; ++i)
    for (int j = 0; j < s.count_v; ++j)
      s.poles.push_back(homogeneous(shift + Vec3(i, j, 0) + random_vector<Vec3>(random, 1), rational ? between(random, 0.3, 3) : 1.0));
  return s;
}

// A curve together with a range of its parameter.
template <class V>
struct CurveCase {
  std::string name;
  Curve<V> curve;
  Range t;
};

// One curve of every kind; NURBS polynomial and rational, of each knot style, degrees as they come.
template <class V>
std::vector<CurveCase<V>> random_curves(Random& random) {
  const auto some = [&] { return random_vector<V>(random, 3); };
  const double a = between(random, -4, 4);
  std::vector<CurveCase<V>> out;
  out.push_back({"line", Line<V>{some(), some()}, {a, a + between(random, 0.5, 5)}});
  out.push_back({"ellipse", Ellipse<V>{some(), some(), some()}, {a, a + between(random, 0.3, kTwoPi)}});
  out.push_back({"parabola", Parabola<V>{some(), some(), some()}, {a, a + between(random, 0.5, 5)}});
  out.push_back({"hyperbola", Hyperbola<V>{some(), some(), some()}, {0.5 * a, 0.5 * a + between(random, 0.3, 3)}});
  for (const Knots style : {Knots::smooth, Knots::c0, Knots::unclamped, Knots::bezier})
    for (const bool rational : {false, true}) {
      const int degree = whole(random, 1, 12);
      const auto c = random_nurbs_curve<V>(random, style, degree, rational);
      out.push_back({fmt::format("{} {} NURBS of degree {}", kKnotNames[static_cast<std::size_t>(style)],
                                 rational ? "rational" : "polynomial", degree),
                     c,
                     {c.knots[static_cast<std::size_t>(degree)], c.knots[c.poles.size()]}});
    }
  return out;
}

struct SurfaceCase {
  std::string name;
  AnySurface surface;
  Box2 uv;  // finite
};

// One surface of every kind: the five elementary ones, extrusions and revolutions of every curve kind, NURBS of every knot style.
inline std::vector<SurfaceCase> random_surfaces(Random& random) {
  std::vector<SurfaceCase> out;
  const double u = between(random, -3, 3), v = between(random, -3, 3), du = between(random, 0.3, kTwoPi), dv = between(random, 0.5, 5);
  const Box2 plain{{u, v}, {u + du, v + dv}}, latitude{{u, -kPi / 2}, {u + du, kPi / 2}}, angles{{u, v}, {u + du, v + kTwoPi}};
  out.push_back({"plane", Plane{random_frame(random)}, plain});
  out.push_back({"cylinder", Cylinder{random_frame(random), between(random, 0.1, 4)}, plain});
  out.push_back({"cone", Cone{random_frame(random), between(random, 0.0, 4), between(random, -1.4, 1.4)}, plain});
  out.push_back({"sphere", Sphere{random_frame(random), between(random, 0.1, 4)}, latitude});
  out.push_back({"torus", Torus{random_frame(random), between(random, 1, 4), between(random, 0.1, 1)}, angles});
  out.push_back({"spindle torus", Torus{random_frame(random), between(random, 0, 1), between(random, 1, 2)}, angles});
  for (const auto& c : random_curves<Vec3>(random)) {
    out.push_back({"extrusion of a " + c.name, Extrusion{c.curve, random_vector<Vec3>(random, 2), c.t}, {{c.t.lo, v}, {c.t.hi, v + dv}}});
    const Frame f = random_frame(random);
    out.push_back({"revolution of a " + c.name, Revolution{c.curve, f.O, f.Z, c.t}, {{u, c.t.lo}, {u + du, c.t.hi}}});
  }
  const std::vector<Knots> styles{Knots::smooth, Knots::c0, Knots::unclamped, Knots::bezier};
  for (const Knots su : styles)
    for (const Knots sv : styles)
      for (const bool rational : {false, true}) {
        const int pu = whole(random, 1, 12), pv = whole(random, 1, 12);
        const NurbsSurface s = random_nurbs(random, su, sv, pu, pv, rational);
        out.push_back({fmt::format("{}/{} {} NURBS of degree {} x {}", kKnotNames[static_cast<std::size_t>(su)],
                                   kKnotNames[static_cast<std::size_t>(sv)], rational ? "rational" : "polynomial", pu, pv),
                       s, natural_domain(s)});
      }
  return out;
}
inline constexpr std::size_t kCurveCases = 12, kSurfaceCases = 6 + 2 * kCurveCases + 32;

// The knots where derivatives may jump, in u (0) or v (1); empty for smooth kinds.
inline std::vector<double> breaks(const AnySurface& surface, int direction) {
  const auto of_curve = [](const Curve3& c) {
    const auto* n = std::get_if<NurbsCurve<Vec3>>(&c);
    return n ? breakpoints(n->knots, n->degree) : std::vector<double>{};
  };
  if (const auto* n = std::get_if<NurbsSurface>(&surface))
    return direction == 0 ? breakpoints(n->knots_u, n->degree_u) : breakpoints(n->knots_v, n->degree_v);
  if (const auto* e = std::get_if<Extrusion>(&surface)) return direction == 0 ? of_curve(e->profile) : std::vector<double>{};
  if (const auto* r = std::get_if<Revolution>(&surface)) return direction == 1 ? of_curve(r->profile) : std::vector<double>{};
  return {};
}

// A parameter in [lo, hi] at least `clear` away from each break.
inline double away_from(Random& random, const std::vector<double>& at, double lo, double hi, double clear) {
  for (;;) {
    const double t = between(random, lo, hi);
    bool good = true;
    for (const double b : at) good = good && std::abs(t - b) > clear;
    if (good) return t;
  }
}

}  // namespace iso::test
