// Second derivatives in closed form.
#include "patches/base/interval.h"
#include "patches/bend_cell.h"

namespace iso {

Bend unbounded_bend() { return {kEverything, kEverything, kEverything, kInf, kInf, kInf, kInf}; }

void Bend::include(const Bend& other) {
  const auto join = [](Range& a, const Range& b) { a = {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; };
  join(uu, other.uu);
  join(uv, other.uv);
  join(vv, other.vv);
  Muu = std::max(Muu, other.Muu);
  Muv = std::max(Muv, other.Muv);
  Mvv = std::max(Mvv, other.Mvv);
  curvature = std::max(curvature, other.curvature);
}

namespace {

// Of the arithmetic below, as a share of the result; frames are orthonormal to 1e-9 at least, to rounding as a rule.
constexpr double kShare = 64 * kEps;

Range rounded(double a, double b) {
  const double lo = std::min(a, b), hi = std::max(a, b);
  const double by = kShare * std::max(std::abs(lo), std::abs(hi));
  return {lo - by, hi + by};
}
double up(double x) { return x + kShare * std::abs(x); }

double largest(const Interval& a) { return std::max(std::abs(a.lo), std::abs(a.hi)); }
double smallest(const Interval& a) { return a.lo <= 0 && a.hi >= 0 ? 0.0 : std::min(std::abs(a.lo), std::abs(a.hi)); }

// +1 if Su x Sv points away from the axis (where the radius is positive).
double sense(const Frame& f) { return glm::dot(glm::cross(f.X, f.Y), f.Z) < 0 ? -1.0 : 1.0; }

// The range of n . Suu and the others is zero.
Bend flat() {
  Bend b;
  b.uu = b.uv = b.vv = {0, 0};
  return b;
}

Bend form(const Plane&, const Box2&) { return flat(); }

Bend form(const Cylinder& s, const Box2&) {
  Bend b = flat();
  b.uu = rounded(-sense(s.frame) * s.r, -sense(s.frame) * s.r);
  b.Muu = up(s.r);
  b.curvature = up(1 / s.r);
  return b;
}

// n = +-(cos a e - sin a Z) with the unit vector e away from the axis, Suu = -rho e, Suv = sin a e', e' at right angles to e and Z.
Bend form(const Cone& s, const Box2& uv) {
  const double slope = std::sin(s.half_angle), c = std::cos(s.half_angle), d = sense(s.frame);
  const Interval rho = Interval(s.r) + Interval(uv.lo.y, uv.hi.y) * Interval(slope);
  Bend b = flat();
  b.Muu = up(largest(rho));
  b.Muv = up(std::abs(slope));
  b.curvature = up(c / smallest(rho));
  const double touch = kShare * (s.r + std::abs(slope) * std::max(std::abs(uv.lo.y), std::abs(uv.hi.y)));
  if (rho.lo < -touch && rho.hi > touch)
    b.uu = b.uv = b.vv = kEverything;
  else
    b.uu = rounded(-d * c * largest(rho), -d * c * smallest(rho));
  return b;
}

Bend form(const Sphere& s, const Box2& uv) {
  const Interval c = cos(Interval(uv.lo.y, uv.hi.y)), t = sin(Interval(uv.lo.y, uv.hi.y));
  const double d = sense(s.frame), least = smallest(c), most = largest(c);
  Bend b = flat();
  b.uu = rounded(-d * s.r * least * least, -d * s.r * most * most);
  b.vv = rounded(-d * s.r, -d * s.r);
  b.Muu = up(s.r * most);
  b.Muv = up(s.r * largest(t));
  b.Mvv = up(s.r);
  b.curvature = up(1 / s.r);
  return b;
}

// n . Suu = -rho c with rho = R + r c and c = cos v: extreme at the ends of c and at -R / 2r; n turns over with the sign of rho.
Bend form(const Torus& s, const Box2& uv) {
  const Interval c = cos(Interval(uv.lo.y, uv.hi.y)), t = sin(Interval(uv.lo.y, uv.hi.y));
  const Interval rho = Interval(s.R) + Interval(s.r) * c;
  const double touch = kShare * (s.R + s.r), d = sense(s.frame);
  Bend b = flat();
  b.Muu = up(largest(rho));
  b.Muv = up(s.r * largest(t));
  b.Mvv = up(s.r);
  const auto bend_at = [&](double x) { return up(std::abs(x) / std::abs(s.R + s.r * x)); };
  b.curvature = rho.lo <= touch && rho.hi >= -touch ? kInf : std::max({up(1 / s.r), bend_at(c.lo), bend_at(c.hi)});
  if (rho.lo < -touch && rho.hi > touch) {
    b.uu = b.uv = b.vv = kEverything;
    return b;
  }
  const double side = rho.hi + rho.lo < 0 ? -d : d;
  Range product;
  for (const double x : {c.lo, c.hi, std::clamp(-0.5 * s.R / s.r, c.lo, c.hi)}) product.include(-side * (s.R + s.r * x) * x);
  const double by = kShare * (s.R + s.r);
  b.uu = {product.lo - by, product.hi + by};
  b.vv = rounded(-side * s.r, -side * s.r);
  return b;
}

// ---- extrusions: n . C'' = det(C', D, C'') / |C' x D|, and the determinant is constant for all conics -------------------------

// Ranges of |C' x D|^2 and |C''|^2, and the constant D . (C'' x C').
struct ConicForms {
  Range area2, second2;
  double det = 0;
};

// |cos t a + sin t b|^2 = (aa + bb)/2 + hypot((aa - bb)/2, ab) cos(2t - phase)
Range squared_on_ellipse(const Vec3& a, const Vec3& b, const Range& t) {
  const double aa = glm::dot(a, a), bb = glm::dot(b, b), ab = glm::dot(a, b);
  const double phase = std::atan2(ab, 0.5 * (aa - bb)), amplitude = std::hypot(0.5 * (aa - bb), ab);
  const Interval turn = cos(Interval(2 * t.lo - phase, 2 * t.hi - phase));
  const double by = kShare * (aa + bb) * (1 + std::abs(t.lo) + std::abs(t.hi));
  return {std::max(0.0, 0.5 * (aa + bb) + amplitude * turn.lo - by), 0.5 * (aa + bb) + amplitude * turn.hi + by};
}

// |t a + b|^2
Range squared_on_line(const Vec3& a, const Vec3& b, const Range& t) {
  Range out;
  const double aa = glm::dot(a, a), lowest = aa > 0 ? std::clamp(-glm::dot(a, b) / aa, t.lo, t.hi) : t.lo;
  for (const double x : {t.lo, t.hi, lowest}) out.include(glm::dot(x * a + b, x * a + b));
  const double most = std::max(std::abs(t.lo), std::abs(t.hi)) * glm::length(a) + glm::length(b);
  return {std::max(0.0, out.lo - kShare * most * most), out.hi + kShare * most * most};
}

// |cosh t a + sinh t b|^2 = |e^t p + e^-t q|^2 with p = (a + b)/2, q = (a - b)/2: lowest where e^4t = qq / pp
Range squared_on_hyperbola(const Vec3& a, const Vec3& b, const Range& t) {
  const Vec3 p = 0.5 * (a + b), q = 0.5 * (a - b);
  const double pp = glm::dot(p, p), qq = glm::dot(q, q);
  const double lowest = pp > 0 && qq > 0 ? std::clamp(0.25 * std::log(qq / pp), t.lo, t.hi) : t.lo;
  Range out;
  double by = 0;
  for (const double x : {t.lo, t.hi, lowest}) {
    const Vec3 at = std::exp(x) * p + std::exp(-x) * q;
    out.include(glm::dot(at, at));
    const double most = std::exp(x) * std::sqrt(pp) + std::exp(-x) * std::sqrt(qq);
    by = std::max(by, kShare * (1 + std::abs(x)) * most * most);
  }
  return {std::max(0.0, out.lo - by), out.hi + by};
}

ConicForms forms(const Line<Vec3>& c, const Vec3& D, const Range&) {
  const double area = glm::length(glm::cross(c.direction, D));
  return {{area * area, area * area}, {0, 0}, 0};
}
ConicForms forms(const Ellipse<Vec3>& c, const Vec3& D, const Range& t) {
  const Vec3 a = glm::cross(c.X, D), b = glm::cross(c.Y, D);
  return {squared_on_ellipse(b, -a, t), squared_on_ellipse(c.X, c.Y, t), -glm::dot(D, glm::cross(c.X, c.Y))};
}
ConicForms forms(const Parabola<Vec3>& c, const Vec3& D, const Range& t) {
  const double most = 2 * glm::length(c.A);
  return {
      squared_on_line(2.0 * glm::cross(c.A, D), glm::cross(c.B, D), t), {most * most, most * most}, 2 * glm::dot(D, glm::cross(c.A, c.B))};
}
ConicForms forms(const Hyperbola<Vec3>& c, const Vec3& D, const Range& t) {
  return {squared_on_hyperbola(glm::cross(c.Y, D), glm::cross(c.X, D), t), squared_on_hyperbola(c.X, c.Y, t),
          glm::dot(D, glm::cross(c.X, c.Y))};
}

template <class C>
Bend extruded(const C& profile, const Vec3& D, const Range& t) {
  const ConicForms f = forms(profile, D, t);
  Bend b = flat();
  b.Muu = up(std::sqrt(f.second2.hi));
  if (f.det == 0 && f.area2.lo > 0) return b;  // straight, or bent in the plane of D only
  const double least = std::sqrt(f.area2.lo), most = std::sqrt(f.area2.hi);
  // The rounding of the determinant counts in the size of its factors.
  const double by = kShare * b.Muu;
  const Range h = rounded(f.det / least, f.det / most);
  b.uu = least > 0 ? Range{h.lo - by, h.hi + by} : kEverything;
  b.uv = b.vv = least > 0 ? Range{0, 0} : kEverything;
  b.curvature = least > 0 ? up(std::max(std::abs(b.uu.lo), std::abs(b.uu.hi)) * glm::dot(D, D) / f.area2.lo) : kInf;
  return b;
}

template <class S>
constexpr bool kSolved = std::is_same_v<S, Plane> || std::is_same_v<S, Cylinder> || std::is_same_v<S, Cone> || std::is_same_v<S, Sphere> ||
                         std::is_same_v<S, Torus>;

}  // namespace

bool has_closed_form_bend(const AnySurface& surface) {
  if (const auto* e = std::get_if<Extrusion>(&surface)) return !std::holds_alternative<NurbsCurve<Vec3>>(e->profile);
  return !std::holds_alternative<Revolution>(surface) && !std::holds_alternative<NurbsSurface>(surface) &&
         !std::holds_alternative<PatchChart>(surface);
}

std::optional<Bend> closed_form_bend(const AnySurface& surface, const Box2& uv) {
  return std::visit(
      [&](const auto& s) -> std::optional<Bend> {
        using S = std::decay_t<decltype(s)>;
        if constexpr (kSolved<S>) {
          return form(s, uv);
        } else if constexpr (std::is_same_v<S, Extrusion>) {
          return std::visit(
              [&](const auto& c) -> std::optional<Bend> {
                if constexpr (std::is_same_v<std::decay_t<decltype(c)>, NurbsCurve<Vec3>>)
                  return {};
                else
                  return extruded(c, s.direction, {uv.lo.x, uv.hi.x});
              },
              s.profile);
        } else {
          return {};
        }
      },
      surface);
}

}  // namespace iso
