#include "raytracer/analytic_solve.h"

namespace iso {

namespace {

double angle_of(double y, double x) {
  const double a = std::atan2(y, x);
  return a < 0 ? a + kTwoPi : a;
}

// A ray in the coordinates of a frame.
struct FrameRay {
  Vec3 o, d;
};
FrameRay in_frame(const Frame& f, const LocalRay& r) {
  const Vec3 q = r.o - f.O;
  return {{glm::dot(q, f.X), glm::dot(q, f.Y), glm::dot(q, f.Z)}, {glm::dot(r.d, f.X), glm::dot(r.d, f.Y), glm::dot(r.d, f.Z)}};
}

// a t^2 + 2 b t + c = 0 where the caller chose the origin so that |b| is small. `doubtful`: how large b^2 - a c may be by rounding alone.
int quadratic(double a, double b, double c, double doubtful, double t[2], HitStatus& status) {
  status = HitStatus::converged;
  if (std::abs(a) < 1e-300) {
    if (b == 0) return 0;
    t[0] = -0.5 * c / b;
    return 1;
  }
  const double discriminant = b * b - a * c;
  if (std::abs(discriminant) <= doubtful) {
    t[0] = -b / a;
    status = HitStatus::tangent;
    return 1;
  }
  if (discriminant < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  t[0] = q / a;
  t[1] = c / q;
  if (t[1] < t[0]) std::swap(t[0], t[1]);
  return 2;
}

int solve(const Plane& s, const LocalRay& ray, AnalyticRoot roots[2]) {
  const FrameRay r = in_frame(s.frame, ray);
  if (r.d.z == 0) return 0;
  const double t = -r.o.z / r.d.z;
  if (!finite(t)) return 0;
  roots[0] = {{r.o.x + t * r.d.x, r.o.y + t * r.d.y}, t, HitStatus::converged};
  return 1;
}

int solve(const Cylinder& s, const LocalRay& ray, AnalyticRoot roots[2]) {
  const FrameRay r = in_frame(s.frame, ray);
  const double a = r.d.x * r.d.x + r.d.y * r.d.y;
  if (!(a * ray.inverse_dd > 1e-30)) return 0;
  const double nearest = -(r.o.x * r.d.x + r.o.y * r.d.y) / a;
  const Vec3 q = r.o + nearest * r.d;
  // Distance to the axis as a cross product: no digits lost to a far origin.
  const double distance = (r.o.x * r.d.y - r.o.y * r.d.x) / std::sqrt(a);
  double t[2];
  HitStatus status;
  const int n = quadratic(a, 0.0, (distance - s.r) * (distance + s.r), 8 * kEps * a * s.r * (s.r + ray.scale), t, status);
  for (int i = 0; i < n; ++i) {
    double x = q.x + t[i] * r.d.x, y = q.y + t[i] * r.d.y;
    const double slope = x * r.d.x + y * r.d.y;
    if (status == HitStatus::converged && slope != 0) t[i] -= 0.5 * (std::hypot(x, y) - s.r) * (std::hypot(x, y) + s.r) / slope;
    x = q.x + t[i] * r.d.x;
    y = q.y + t[i] * r.d.y;
    roots[i] = {{angle_of(y, x), q.z + t[i] * r.d.z}, nearest + t[i], status};
  }
  return n;
}

int solve(const Sphere& s, const LocalRay& ray, AnalyticRoot roots[2]) {
  const FrameRay r = in_frame(s.frame, ray);
  const double a = glm::dot(r.d, r.d), nearest = -glm::dot(r.o, r.d) / a;
  const double distance = glm::length(glm::cross(r.o, r.d)) / std::sqrt(a);
  const Vec3 q = r.o + nearest * r.d;
  double t[2];
  HitStatus status;
  const int n = quadratic(a, 0.0, (distance - s.r) * (distance + s.r), 8 * kEps * a * s.r * (s.r + ray.scale), t, status);
  for (int i = 0; i < n; ++i) {
    Vec3 p = q + t[i] * r.d;
    const double slope = glm::dot(p, r.d);
    if (status == HitStatus::converged && slope != 0) t[i] -= 0.5 * (glm::length(p) - s.r) * (glm::length(p) + s.r) / slope;
    p = q + t[i] * r.d;
    roots[i] = {{angle_of(p.y, p.x), std::atan2(p.z, std::hypot(p.x, p.y))}, nearest + t[i], status};
  }
  return n;
}

// From the apex: x^2 + y^2 = k^2 z^2. Both nappes are met; v tells them apart, as the surface's own formula does (radius r + v sin a < 0).
int solve(const Cone& s, const LocalRay& ray, AnalyticRoot roots[2]) {
  if (s.half_angle == 0) return solve(Cylinder{s.frame, s.r}, ray, roots);
  FrameRay r = in_frame(s.frame, ray);
  const double k = std::tan(s.half_angle), cosine = std::cos(s.half_angle), apex = -s.r / k;
  r.o.z -= apex;
  const double nearest = -glm::dot(r.o, r.d) * ray.inverse_dd;  // to the apex
  const Vec3 q = r.o + nearest * r.d;
  const double a = r.d.x * r.d.x + r.d.y * r.d.y - k * k * r.d.z * r.d.z;
  const double b = q.x * r.d.x + q.y * r.d.y - k * k * q.z * r.d.z;
  const double c = q.x * q.x + q.y * q.y - k * k * q.z * q.z;
  const double size = glm::dot(q, q) + k * k * q.z * q.z;
  const double steep = (1 + k * k) / ray.inverse_dd;
  double t[2];
  HitStatus status;
  const int n =
      quadratic(std::abs(a) < 4 * kEps * steep ? 0.0 : a, b, c, 8 * kEps * steep * (size + kEps * ray.scale * ray.scale), t, status);
  for (int i = 0; i < n; ++i) {
    Vec3 p = q + t[i] * r.d;
    const double slope = p.x * r.d.x + p.y * r.d.y - k * k * p.z * r.d.z;
    const double radius = std::hypot(p.x, p.y), wanted = std::abs(k * p.z);
    if (status == HitStatus::converged && slope != 0) {
      const double step = 0.5 * (radius - wanted) * (radius + wanted) / slope;
      if (std::abs(step) < 1e-3 * std::abs(t[i]) + 1e-6 * ray.scale * std::sqrt(ray.inverse_dd)) t[i] -= step;
    }
    p = q + t[i] * r.d;
    const double side = k * p.z >= 0 ? 1 : -1;
    roots[i] = {{angle_of(side * p.y, side * p.x), (p.z + apex) / cosine}, nearest + t[i], status};
  }
  return n;
}

template <class S>
int solve(const S&, const LocalRay&, AnalyticRoot[2]) {
  return 0;  // not a closed-form kind: goes through its Bezier pieces
}

}  // namespace

int analytic_roots(const AnySurface& surface, const LocalRay& ray, AnalyticRoot roots[2]) {
  return std::visit([&](const auto& s) { return solve(s, ray, roots); }, surface);
}

}  // namespace iso
