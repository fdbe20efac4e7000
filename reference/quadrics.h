// Rays against whole spheres, cylinders, cones and tori in long double, straight from the textbook: the truth that hits are measured by.
#pragma once

#include <cmath>
#include <vector>

#include "patches/surface/surface.h"

namespace iso::reference {

using LVec3 = glm::vec<3, long double>;

// Coordinates along the axes of a frame.
inline LVec3 in_frame(const Frame& f, const LVec3& p, bool is_point) {
  const LVec3 q = is_point ? p - LVec3(f.O) : p;
  return {glm::dot(q, LVec3(f.X)), glm::dot(q, LVec3(f.Y)), glm::dot(q, LVec3(f.Z))};
}

// Distance of p from the surface along its normal, positive outside. A cone is the nappe with positive radius, extended beyond its apex.
inline long double distance_along_normal(const AnySurface& surface, const LVec3& p) {
  if (const auto* s = std::get_if<Sphere>(&surface)) return glm::length(in_frame(s->frame, p, true)) - s->r;
  if (const auto* s = std::get_if<Cylinder>(&surface)) {
    const LVec3 q = in_frame(s->frame, p, true);
    return std::hypot(q.x, q.y) - s->r;
  }
  if (const auto* s = std::get_if<Cone>(&surface)) {
    const LVec3 q = in_frame(s->frame, p, true);
    const long double a = s->half_angle;
    return (std::hypot(q.x, q.y) - s->r) * std::cos(a) - q.z * std::sin(a);
  }
  if (const auto* s = std::get_if<Torus>(&surface)) {
    const LVec3 q = in_frame(s->frame, p, true);
    return std::hypot(std::hypot(q.x, q.y) - s->R, q.z) - s->r;
  }
  return NAN;
}

// One meeting with the infinite surface: t, the native v there, and the cosine between ray and normal.
struct Meeting {
  long double t, v, cosine;
};

struct Meetings {
  std::vector<Meeting> at;  // two or none, in rising t
  long double half_chord =
      0;  // half their distance along the ray, in t; where there are none, by how much they are missed (imaginary part)
};

// Cones with both nappes (v tells them apart). Sphere, cylinder and cone only.
inline Meetings meetings(const AnySurface& surface, const Vec3& o, const Vec3& d) {
  // q^T diag(1, 1, m) q + linear z + constant = 0 for q = position in the frame.
  long double m = 1, linear = 0, constant = 0;
  Frame f;
  if (const auto* s = std::get_if<Sphere>(&surface)) {
    f = s->frame;
    constant = -static_cast<long double>(s->r) * s->r;
  } else if (const auto* c = std::get_if<Cylinder>(&surface)) {
    f = c->frame;
    m = 0;
    constant = -static_cast<long double>(c->r) * c->r;
  } else if (const auto* k = std::get_if<Cone>(&surface)) {
    f = k->frame;
    const long double slope = std::tan(static_cast<long double>(k->half_angle));
    m = -slope * slope;
    linear = -2 * slope * k->r;
    constant = -static_cast<long double>(k->r) * k->r;
  }
  const LVec3 q = in_frame(f, LVec3(o), true), e = in_frame(f, LVec3(d), false);
  const long double a = e.x * e.x + e.y * e.y + m * e.z * e.z;
  const long double b = q.x * e.x + q.y * e.y + m * q.z * e.z + linear * e.z / 2;
  const long double c = q.x * q.x + q.y * q.y + m * q.z * q.z + linear * q.z + constant;
  const long double discriminant = b * b - a * c;
  Meetings out;
  if (a == 0) return out;
  out.half_chord = std::sqrt(std::abs(discriminant)) / std::abs(a);
  if (!(discriminant >= 0)) return out;
  const long double s = -(b + std::copysign(std::sqrt(discriminant), b));
  for (const long double t : {s / a, s != 0 ? c / s : s / a}) {
    const LVec3 p = q + t * e;
    const LVec3 normal{p.x, p.y, m * p.z + linear / 2};
    long double v = p.z;
    if (std::holds_alternative<Sphere>(surface)) v = std::atan2(p.z, std::hypot(p.x, p.y));
    if (const auto* cone = std::get_if<Cone>(&surface)) v = p.z / std::cos(static_cast<long double>(cone->half_angle));
    out.at.push_back({t, v, glm::dot(normal, e) / (glm::length(normal) * glm::length(e))});
  }
  if (out.at[1].t < out.at[0].t) std::swap(out.at[0], out.at[1]);
  return out;
}

}  // namespace iso::reference
