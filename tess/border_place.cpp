#include "tess/border_place.h"

namespace iso {

namespace {

// A knot nearer than this share of the domain is met; so far beyond it derivatives are taken.
constexpr double kAtKnot = 1e-9;

// Where a speed falls below this share of the other one or of the edge's length, or the sine of the angle between both below it, the first
// derivatives span no plane that second ones could be related to: curvatures would be rounding.
constexpr double kSingular = 1e-6;

const std::vector<double>* knots_of(const Curve3& profile) {
  const auto* nurbs = std::get_if<NurbsCurve<Vec3>>(&profile);
  return nurbs ? &nurbs->knots : nullptr;
}

const std::vector<double>* knots_of(const AnySurface& surface, int axis) {
  if (const auto* s = std::get_if<NurbsSurface>(&surface)) return axis == 0 ? &s->knots_u : &s->knots_v;
  if (const auto* s = std::get_if<Extrusion>(&surface)) return axis == 0 ? knots_of(s->profile) : nullptr;
  if (const auto* s = std::get_if<Revolution>(&surface)) return axis == 1 ? knots_of(s->profile) : nullptr;
  return nullptr;
}

// To which side of knots in u and in v derivatives are taken: where the border crosses them, on along it, on both faces alike; where it
// runs along them, into the face. Lengths are measured in domains.
Vec2 side_of_knots(const Vec2& rising, const Vec2& size, const BorderSide& side) {
  constexpr double kAlong = 1e-3;  // of the border's direction: less is rounding of trim curves that follow knots
  const Vec2 r = rising / size;
  const Vec2 inward = (side.left ? 1.0 : -1.0) * Vec2(-r.y, r.x);
  Vec2 direction;
  for (const int axis : {0, 1}) direction[axis] = std::abs(r[axis]) > kAlong * glm::length(r) ? side.ahead * r[axis] : inward[axis];
  return direction;
}

// The step that leads off the knots inside the domain that (u, v) lies on, zero where it lies on none.
Vec2 step_off_knots(const Face& face, const UV& uv, const Vec2& direction) {
  Vec2 step{0.0};
  for (const int axis : {0, 1}) {
    const std::vector<double>* knots = knots_of(face.surface, axis);
    if (!knots || direction[axis] == 0) continue;
    const double near = kAtKnot * (knots->back() - knots->front());
    const auto knot = std::lower_bound(knots->begin(), knots->end(), uv[axis] - near);
    if (knot == knots->end() || *knot > uv[axis] + near || *knot == knots->front() || *knot == knots->back()) continue;
    step[axis] = *knot - uv[axis] + std::copysign(near, direction[axis]);
  }
  return step;
}

// The limit of the derivatives at (u, v) from the side to which the step leads: their line through one step and two, drawn back.
Jet2 one_sided_jet(const AnySurface& surface, const UV& uv, const Vec2& step) {
  if (step == Vec2(0.0)) return jet2(surface, uv);
  const Jet2 one = jet2(surface, uv + step), two = jet2(surface, uv + 2.0 * step);
  const auto back = [](const Vec3& a, const Vec3& b) { return 2.0 * a - b; };
  return {back(one.S, two.S),     back(one.Su, two.Su),   back(one.Sv, two.Sv),
          back(one.Suu, two.Suu), back(one.Suv, two.Suv), back(one.Svv, two.Svv)};
}

bool is_regular(const Jet2& j, const Vec2& size, double length) {
  const double u = size.x * glm::length(j.Su), v = size.y * glm::length(j.Sv);
  return std::min(u, v) > kSingular * std::max({u, v, length}) &&
         glm::length(glm::cross(j.Su, j.Sv)) > kSingular * glm::length(j.Su) * glm::length(j.Sv);
}

// II / I in the direction of the unit tangent vector d.  [do Carmo 1976, 3-2]
double normal_curvature(const Jet2& j, const Vec3& n, const Vec3& d) {
  const double E = glm::dot(j.Su, j.Su), F = glm::dot(j.Su, j.Sv), G = glm::dot(j.Sv, j.Sv);
  const double along_u = glm::dot(d, j.Su), along_v = glm::dot(d, j.Sv), det = E * G - F * F;
  const double a = (G * along_u - F * along_v) / det, b = (E * along_v - F * along_u) / det;
  return glm::dot(n, a * a * j.Suu + 2 * a * b * j.Suv + b * b * j.Svv);
}

}  // namespace

BorderPlace border_place(const Face& face, const EdgeUse& use, double share, const BorderSide& side) {
  const auto [left, ahead, length] = side;
  BorderPlace place;
  const auto curve = jet(use.curve.curve, parameter_at(use, share));
  const Vec2 rising = (parameter_at(use, 1) - parameter_at(use, 0)) * curve.Ct;
  place.uv = curve.C;

  const Vec2 size = face.domain.size();
  const Vec2 step = step_off_knots(face, place.uv, side_of_knots(rising, size, side));
  const Jet2 j = one_sided_jet(face.surface, place.uv, step);
  place.S = point(face.surface, place.uv);
  place.regular = is_regular(j, size, length);
  const Vec3 normal = place.regular ? glm::normalize(glm::cross(j.Su, j.Sv)) : unit_normal(face.surface, place.uv + step, face.domain);
  place.normal = (left ? 1.0 : -1.0) * normal;
  place.tangent = rising.x * j.Su + rising.y * j.Sv;
  const double speed = glm::length(place.tangent);
  if (!place.regular || !(speed > 0)) return place;
  place.curvature = normal_curvature(j, place.normal, glm::cross(place.normal, place.tangent / speed));
  return place;
}

double distance_to_surface(const AnySurface& surface, UV uv, const Point3& p) {
  constexpr int kSteps = 20;
  const Box2 domain = natural_domain(surface);
  const Vec2 period = periods(surface);
  double least = glm::length(point(surface, uv) - p);
  for (int i = 0; i < kSteps && least > 0; ++i) {
    const Jet2 j = jet2(surface, uv);
    const Vec3 r = p - j.S;
    const double E = glm::dot(j.Su, j.Su), F = glm::dot(j.Su, j.Sv), G = glm::dot(j.Sv, j.Sv), det = E * G - F * F;
    if (!(det > kEps * E * G)) break;
    const double along_u = glm::dot(r, j.Su), along_v = glm::dot(r, j.Sv);
    Vec2 step{(G * along_u - F * along_v) / det, (E * along_v - F * along_u) / det};
    // Uphill steps are halved; when no part of one leads down, this is the foot.
    bool downhill = false;
    for (int halving = 0; halving < 4 && !downhill; ++halving, step *= 0.5) {
      UV next = uv + step;
      for (const int axis : {0, 1})
        if (period[axis] == 0) next[axis] = std::clamp(next[axis], domain.lo[axis], domain.hi[axis]);
      const double distance = glm::length(point(surface, next) - p);
      downhill = distance < least;
      if (downhill) uv = next, least = distance;
    }
    if (!downhill) break;
  }
  return least;
}

}  // namespace iso
