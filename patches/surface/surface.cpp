#include "patches/surface/surface.h"

#include <glm/matrix.hpp>

#include "patches/base/bspline_basis.h"
#include "patches/base/interval.h"
#include "patches/curve/bspline_tools.h"
#include "patches/surface/bezier_patch.h"

namespace iso {

bool NurbsSurface::rational() const {
  for (const Vec4& h : poles)
    if (h.w != poles.front().w) return true;
  return false;
}

const char* kind_name(const AnySurface& surface) {
  static constexpr const char* kNames[] = {"plane", "cylinder", "cone", "sphere", "torus", "extrusion", "revolution", "nurbs"};
  if (const auto* chart = std::get_if<PatchChart>(&surface)) return name_of(chart->basis.kind);
  return kNames[surface.index()];
}

// ---- the formulas, generic over their number type ----------------------------------------------------------------------

namespace {

using std::cos;
using std::sin;

template <class T>
struct Triple {
  T x, y, z;  // coordinates along X, Y, Z of the frame
};

template <class T>
Triple<T> local_point(const Plane&, const T& u, const T& v) {
  return {u, v, T(0.0)};
}
// The surfaces of revolution among them: radius and height over v.
template <class T>
struct Profile {
  T radius, height;
};
template <class T>
Profile<T> profile(const Cylinder& s, const T& v) {
  return {T(s.r), v};
}
template <class T>
Profile<T> profile(const Cone& s, const T& v) {
  return {T(s.r) + v * T(std::sin(s.half_angle)), v * T(std::cos(s.half_angle))};
}
template <class T>
Profile<T> profile(const Sphere& s, const T& v) {
  return {T(s.r) * cos(v), T(s.r) * sin(v)};
}
template <class T>
Profile<T> profile(const Torus& s, const T& v) {
  return {T(s.R) + T(s.r) * cos(v), T(s.r) * sin(v)};
}

template <class S>
concept Turned = requires(const S& s) {
  profile(s, 0.0);
};

template <Turned S, class T>
Triple<T> local_point(const S& s, const T& u, const T& v) {
  const Profile<T> p = profile(s, v);
  return {p.radius * cos(u), p.radius * sin(u), p.height};
}

template <class S>
concept Framed = requires(const S& s) {
  s.frame;
};

template <Framed S>
Jet2 jet_of(const S& s, UV uv) {
  const auto p = local_point(s, Dual2::variable_u(uv.x), Dual2::variable_v(uv.y));
  const auto combine = [&](double Dual2::*part) { return p.x.*part * s.frame.X + p.y.*part * s.frame.Y + p.z.*part * s.frame.Z; };
  return {s.frame.O + combine(&Dual2::f),
          combine(&Dual2::u),
          combine(&Dual2::v),
          combine(&Dual2::uu),
          combine(&Dual2::uv),
          combine(&Dual2::vv)};
}

template <Framed S>
Vec3 point_of(const S& s, UV uv) {
  const auto p = local_point(s, uv.x, uv.y);
  return s.frame.O + (p.x * s.frame.X + p.y * s.frame.Y + p.z * s.frame.Z);
}

Box3 bounds_of(const Plane& s, const Box2& uv) {
  Box3 box;
  for (int c = 0; c < 3; ++c) {
    const Interval along =
        Interval(s.frame.O[c]) + Interval(uv.lo.x, uv.hi.x) * Interval(s.frame.X[c]) + Interval(uv.lo.y, uv.hi.y) * Interval(s.frame.Y[c]);
    box.lo[c] = along.lo;
    box.hi[c] = along.hi;
  }
  return box;
}

// cos u X + sin u Y has the c-th component A cos(u - phase): bounded without loss in u.
template <Turned S>
Box3 bounds_of(const S& s, const Box2& uv) {
  const Profile<Interval> p = profile(s, Interval(uv.lo.y, uv.hi.y));
  Box3 box;
  for (int c = 0; c < 3; ++c) {
    const double amplitude = std::hypot(s.frame.X[c], s.frame.Y[c]), phase = std::atan2(s.frame.Y[c], s.frame.X[c]);
    const Interval turn = Interval(amplitude) * cos(Interval(uv.lo.x - phase, uv.hi.x - phase));
    const Interval along = Interval(s.frame.O[c]) + p.radius * turn + p.height * Interval(s.frame.Z[c]);
    box.lo[c] = along.lo;
    box.hi[c] = along.hi;
  }
  return box;
}

Jet2 jet_of(const Extrusion& s, UV uv) {
  const auto c = jet(s.profile, uv.x);
  return {c.C + uv.y * s.direction, c.Ct, s.direction, c.Ctt, Vec3(0.0), Vec3(0.0)};
}

// Rodrigues: p turned by u = axis part + cos u r + sin u (Z x r), linear in p - O.
Jet2 jet_of(const Revolution& s, UV uv) {
  const auto c = jet(s.profile, uv.y);
  const double cu = std::cos(uv.x), su = std::sin(uv.x);
  const auto turn = [&](const Vec3& q) {
    const Vec3 axis = glm::dot(q, s.Z) * s.Z, r = q - axis;
    return axis + cu * r + su * glm::cross(s.Z, r);
  };
  const auto turn_u = [&](const Vec3& q) {
    const Vec3 r = q - glm::dot(q, s.Z) * s.Z;
    return cu * glm::cross(s.Z, r) - su * r;
  };
  const Vec3 q = c.C - s.O, radial_turned = turn(q) - glm::dot(q, s.Z) * s.Z;
  return {s.O + turn(q), turn_u(q), turn(c.Ct), -radial_turned, turn_u(c.Ct), turn(c.Ctt)};
}

// Derivatives of the quotient from homogeneous derivatives.  [Piegl & Tiller, eq. 4.20]
Jet2 jet_of(const NurbsSurface& s, UV uv) {
  const int iu = knot_span(s.knots_u, s.degree_u, uv.x), iv = knot_span(s.knots_v, s.degree_v, uv.y);
  const BasisDerivatives bu = basis_derivatives(s.knots_u, s.degree_u, iu, uv.x), bv = basis_derivatives(s.knots_v, s.degree_v, iv, uv.y);
  Vec4 h00{0.0}, h10{0.0}, h01{0.0}, h20{0.0}, h11{0.0}, h02{0.0};
  for (int i = 0; i <= s.degree_u; ++i) {
    const Vec4* row = &s.poles[static_cast<std::size_t>(iu - s.degree_u + i) * s.count_v + (iv - s.degree_v)];
    Vec4 r0{0.0}, r1{0.0}, r2{0.0};
    for (int j = 0; j <= s.degree_v; ++j) {
      r0 += bv.N[0][j] * row[j];
      r1 += bv.N[1][j] * row[j];
      r2 += bv.N[2][j] * row[j];
    }
    h00 += bu.N[0][i] * r0;
    h10 += bu.N[1][i] * r0;
    h20 += bu.N[2][i] * r0;
    h01 += bu.N[0][i] * r1;
    h11 += bu.N[1][i] * r1;
    h02 += bu.N[0][i] * r2;
  }
  const double w = h00.w;
  Jet2 k;
  k.S = Vec3(h00) / w;
  k.Su = (Vec3(h10) - h10.w * k.S) / w;
  k.Sv = (Vec3(h01) - h01.w * k.S) / w;
  k.Suu = (Vec3(h20) - 2 * h10.w * k.Su - h20.w * k.S) / w;
  k.Suv = (Vec3(h11) - h10.w * k.Sv - h01.w * k.Su - h11.w * k.S) / w;
  k.Svv = (Vec3(h02) - 2 * h01.w * k.Sv - h02.w * k.S) / w;
  return k;
}

}  // namespace

Jet2 jet2(const AnySurface& surface, UV uv) {
  return std::visit([&](const auto& s) { return jet_of(s, uv); }, surface);
}

Point3 point(const AnySurface& surface, UV uv) {
  return std::visit(
      [&](const auto& s) {
        if constexpr (requires { point_of(s, uv); })
          return point_of(s, uv);
        else
          return jet_of(s, uv).S;
      },
      surface);
}

namespace {

double size_of_terms(const Curve3& curve) {
  return std::visit(
      [](const auto& c) {
        if constexpr (requires { c.origin; })
          return glm::length(c.origin);
        else if constexpr (requires { c.centre; })
          return glm::length(c.centre) + glm::length(c.X) + glm::length(c.Y);
        else if constexpr (requires { c.vertex; })
          return glm::length(c.vertex);
        else
          return 0.0;
      },
      curve);
}

}  // namespace

double size_of_terms(const AnySurface& surface, const Point3& S) {
  const auto about = [&](const Vec3& O) { return glm::length(O) + glm::length(S - O); };
  return std::visit(
      [&](const auto& s) {
        using Kind = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<Kind, Cone>)
          return about(s.frame.O) + s.r;
        else if constexpr (Framed<Kind>)
          return about(s.frame.O);
        else if constexpr (std::is_same_v<Kind, Revolution>)
          return about(s.O) + size_of_terms(s.profile);
        else if constexpr (std::is_same_v<Kind, Extrusion>)
          return size_of_terms(s.profile);
        else
          return 0.0;
      },
      surface);
}

bool has_closed_form_bounds(const AnySurface& surface) {
  return std::visit([](const auto& s) { return Framed<std::decay_t<decltype(s)>>; }, surface);
}

double distance_of_pieces(const AnySurface& surface) {
  const auto* chart = std::get_if<PatchChart>(&surface);
  return chart ? chart->error : 0.0;
}

Box3 bounds(const AnySurface& surface, const Box2& uv) {
  return std::visit(
      [&](const auto& s) -> Box3 {
        if constexpr (Framed<std::decay_t<decltype(s)>>) {
          return bounds_of(s, uv);
        } else {
          Box3 box;
          for (const BezierPiece& piece : bezier_pieces(surface, uv)) box.include(hull_box(piece.patch));
          // Against the rounding of evaluation, which counts in the size of the coordinates.
          return box.inflated(distance_of_pieces(surface) + 1e-14 * glm::length(glm::max(glm::abs(box.lo), glm::abs(box.hi))));
        }
      },
      surface);
}

// ---- domains -----------------------------------------------------------------------------------------------------------

Box2 natural_domain(const AnySurface& surface) {
  struct Visitor {
    Box2 operator()(const Plane&) const { return {{-kInf, -kInf}, {kInf, kInf}}; }
    Box2 operator()(const Cylinder&) const { return {{0, -kInf}, {kTwoPi, kInf}}; }
    Box2 operator()(const Cone&) const { return {{0, -kInf}, {kTwoPi, kInf}}; }
    Box2 operator()(const Sphere&) const { return {{0, -kPi / 2}, {kTwoPi, kPi / 2}}; }
    Box2 operator()(const Torus&) const { return {{0, 0}, {kTwoPi, kTwoPi}}; }
    Box2 operator()(const Extrusion& s) const { return {{s.u.lo, -kInf}, {s.u.hi, kInf}}; }
    Box2 operator()(const Revolution& s) const { return {{0, s.v.lo}, {kTwoPi, s.v.hi}}; }
    Box2 operator()(const NurbsSurface& s) const {
      return {{s.knots_u[s.degree_u], s.knots_v[s.degree_v]}, {s.knots_u[s.count_u], s.knots_v[s.count_v]}};
    }
    Box2 operator()(const PatchChart&) const { return {{0, 0}, {1, 1}}; }
  };
  return std::visit(Visitor{}, surface);
}

namespace {

// The width of a profile's domain if the profile closes there.
double profile_period(const Curve3& profile, const Range& domain) {
  if (std::holds_alternative<Ellipse<Vec3>>(profile)) return kTwoPi;
  if (std::holds_alternative<NurbsCurve<Vec3>>(profile) && finite(domain.lo) && finite(domain.hi)) {
    const Vec3 a = jet(profile, domain.lo).C, b = jet(profile, domain.hi).C;
    const Vec3 m = jet(profile, domain.middle()).C;
    if (glm::length(a - b) <= 1e-9 * glm::length(m - a)) return domain.width();
  }
  return 0;
}

}  // namespace

Vec2 periods(const AnySurface& surface) {
  struct Visitor {
    Vec2 operator()(const Plane&) const { return {0, 0}; }
    Vec2 operator()(const Cylinder&) const { return {kTwoPi, 0}; }
    Vec2 operator()(const Cone&) const { return {kTwoPi, 0}; }
    Vec2 operator()(const Sphere&) const { return {kTwoPi, 0}; }
    Vec2 operator()(const Torus&) const { return {kTwoPi, kTwoPi}; }
    Vec2 operator()(const Extrusion& s) const { return {profile_period(s.profile, s.u), 0}; }
    Vec2 operator()(const Revolution& s) const { return {kTwoPi, profile_period(s.profile, s.v)}; }
    Vec2 operator()(const NurbsSurface& s) const {
      return {s.closed_u ? s.knots_u[s.count_u] - s.knots_u[s.degree_u] : 0.0,
              s.closed_v ? s.knots_v[s.count_v] - s.knots_v[s.degree_v] : 0.0};
    }
    Vec2 operator()(const PatchChart&) const { return {0, 0}; }
  };
  return std::visit(Visitor{}, surface);
}

void translate(AnySurface& surface, const Vec3& by) {
  const auto move_curve = [&](Curve3& curve) {
    struct Mover {
      Vec3 d;
      void operator()(Line<Vec3>& c) const { c.origin += d; }
      void operator()(Ellipse<Vec3>& c) const { c.centre += d; }
      void operator()(Parabola<Vec3>& c) const { c.vertex += d; }
      void operator()(Hyperbola<Vec3>& c) const { c.centre += d; }
      void operator()(NurbsCurve<Vec3>& c) const {
        for (Vec4& h : c.poles) h = homogeneous(project(h) + d, h.w);
      }
    };
    std::visit(Mover{by}, curve);
  };
  std::visit(
      [&](auto& s) {
        using S = std::decay_t<decltype(s)>;
        if constexpr (Framed<S>) {
          s.frame.O += by;
        } else if constexpr (std::is_same_v<S, Extrusion>) {
          move_curve(s.profile);
        } else if constexpr (std::is_same_v<S, Revolution>) {
          s.O += by;
          move_curve(s.profile);
        } else if constexpr (std::is_same_v<S, PatchChart>) {
          translate(s, by);
        } else {
          for (Vec4& h : s.poles) h = homogeneous(project(h) + by, h.w);
        }
      },
      surface);
}

// ---- checks ------------------------------------------------------------------------------------------------------------

namespace {

std::string frame_problem(const Frame& f) {
  for (const Vec3& v : {f.O, f.X, f.Y, f.Z})
    if (!finite(v) || glm::length(v) > 1e15) return "a placement that is not finite or larger than 1e15";
  if (std::abs(glm::dot(f.X, f.Y)) > 1e-9 || std::abs(glm::length(f.X) - 1) > 1e-9 || std::abs(glm::length(f.Y) - 1) > 1e-9)
    return "a placement whose axes are not orthonormal";
  return {};
}

std::string curve_problem(const Curve3& curve) {
  if (const auto* n = std::get_if<NurbsCurve<Vec3>>(&curve)) return problem_of(*n);
  const auto j = jet(curve, 0.5);
  return finite(j.C) && finite(j.Ct) ? std::string{} : "a profile curve that is not finite";
}

struct ProblemOf {
  std::string operator()(const Plane& s) const { return frame_problem(s.frame); }
  std::string operator()(const Cylinder& s) const { return radius(s.frame, s.r > 0, s.r); }
  std::string operator()(const Cone& s) const {
    if (!(std::abs(s.half_angle) < kPi / 2)) return "a cone with a half angle of 90 degrees or more";
    return radius(s.frame, s.r >= 0, s.r);
  }
  std::string operator()(const Sphere& s) const { return radius(s.frame, s.r > 0, s.r); }
  std::string operator()(const Torus& s) const { return radius(s.frame, s.r > 0 && s.R >= 0 && finite(s.R), s.r); }
  std::string operator()(const Extrusion& s) const {
    if (!finite(s.direction) || glm::length(s.direction) == 0) return "an extrusion without a direction";
    return curve_problem(s.profile);
  }
  std::string operator()(const Revolution& s) const {
    if (!finite(s.O) || !(std::abs(glm::length(s.Z) - 1) < 1e-9)) return "a revolution without an axis";
    return curve_problem(s.profile);
  }
  std::string operator()(const NurbsSurface& s) const {
    if (s.count_u < 2 || s.count_v < 2 || s.poles.size() != static_cast<std::size_t>(s.count_u) * static_cast<std::size_t>(s.count_v))
      return "a pole count that does not match the grid";
    if (std::string p = nurbs_problem(s.knots_u, s.degree_u, static_cast<std::size_t>(s.count_u)); !p.empty()) return "u: " + p;
    if (std::string p = nurbs_problem(s.knots_v, s.degree_v, static_cast<std::size_t>(s.count_v)); !p.empty()) return "v: " + p;
    return poles_problem4(s.poles);
  }
  std::string operator()(const PatchChart& s) const { return problem_of(NSidedPatch{s.basis, s.points, s.weights}); }
  static std::string radius(const Frame& f, bool valid, double r) {
    if (!valid || !finite(r) || r > 1e15) return "a radius of " + std::to_string(r);
    return frame_problem(f);
  }
};

}  // namespace

std::string problem_of(const AnySurface& surface) { return std::visit(ProblemOf{}, surface); }

// ---- normals and curvatures --------------------------------------------------------------------------------------------

namespace {

// Su x Sv counts as vanishing below this share of |Su| |Sv| + what their second derivatives could make of a unit step.
constexpr double kSingular = 1e-10;

bool regular(const Jet2& j, const Vec3& cross, const Vec2& size) {
  const double a = size.x * (glm::length(j.Su) + size.x * glm::length(j.Suu) + size.y * glm::length(j.Suv));
  const double b = size.y * (glm::length(j.Sv) + size.y * glm::length(j.Svv) + size.x * glm::length(j.Suv));
  return glm::length(cross) * size.x * size.y > kSingular * a * b;
}

}  // namespace

Vec3 unit_normal(const AnySurface& surface, UV uv, const Box2& domain) {
  const Vec2 size = domain.size();
  const auto* chart = std::get_if<PatchChart>(&surface);
  const auto jet_at = [&](const UV& at) {
    Jet2 jet = jet2(surface, at);
    // By mean value coordinates these grow without limit toward a corner, and do not tell where the tangents vanish.
    if (chart && chart->basis.parameters == SideParameters::mean_value) jet.Suu = jet.Suv = jet.Svv = Vec3(0.0);
    return jet;
  };
  const Jet2 j = jet_at(uv);
  const Vec3 cross = glm::cross(j.Su, j.Sv);
  if (regular(j, cross, size)) return glm::normalize(cross);
  // The limit from inside: step from uv toward the middle of the domain. To first order the normal there is
  // Su x Sv + h (a (Suu x Sv + Su x Suv) + b (Suv x Sv + Su x Svv)); the step itself is evaluated where that vanishes too.
  const Vec2 inward{uv.x <= domain.middle().x ? size.x : -size.x, uv.y <= domain.middle().y ? size.y : -size.y};
  const Vec3 first =
      inward.x * (glm::cross(j.Suu, j.Sv) + glm::cross(j.Su, j.Suv)) + inward.y * (glm::cross(j.Suv, j.Sv) + glm::cross(j.Su, j.Svv));
  const double scale =
      (size.x * glm::length(j.Su) + size.x * size.y * glm::length(j.Suv)) * size.y * (glm::length(j.Sv) + size.x * glm::length(j.Suv));
  if (glm::length(first) * std::min(size.x, size.y) > 1e-7 * scale && glm::length(first) > 0) return glm::normalize(first);
  for (const double step : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
    const Jet2 k = jet_at(uv + step * inward);
    const Vec3 c = glm::cross(k.Su, k.Sv);
    if (regular(k, c, size)) return glm::normalize(c);
  }
  return Vec3(0.0);
}

// Su and Sv whose squared sine is smaller span no plane: 1e-10 radians, where rounding has taken what curvature needs.
constexpr double kNoPlane = 1e-20;

Curvatures principal_curvatures(const Jet2& j, const Vec3& n) {
  const double E = glm::dot(j.Su, j.Su), F = glm::dot(j.Su, j.Sv), G = glm::dot(j.Sv, j.Sv);
  const double L = glm::dot(j.Suu, n), M = glm::dot(j.Suv, n), N = glm::dot(j.Svv, n);
  const double det = E * G - F * F;
  if (!(det > kNoPlane * E * G)) return {std::nan(""), std::nan("")};
  const double mean = 0.5 * (E * N - 2 * F * M + G * L) / det, gauss = (L * N - M * M) / det;
  const double root = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + root, mean - root};
}

Mat3 shape_operator(const Jet2& j, const Vec3& n) {
  const double E = glm::dot(j.Su, j.Su), F = glm::dot(j.Su, j.Sv), G = glm::dot(j.Sv, j.Sv);
  const double det = E * G - F * F;
  if (!(det > kNoPlane * E * G)) return Mat3(std::nan(""));
  // The second fundamental form on the dual basis: a step dp is du = gu . dp and dv = gv . dp.
  const Vec3 gu = (G * j.Su - F * j.Sv) / det, gv = (E * j.Sv - F * j.Su) / det;
  const double L = glm::dot(j.Suu, n), M = glm::dot(j.Suv, n), N = glm::dot(j.Svv, n);
  const Vec3 lu = L * gu + M * gv, lv = M * gu + N * gv;
  return glm::outerProduct(lu, gu) + glm::outerProduct(lv, gv);
}

}  // namespace iso
