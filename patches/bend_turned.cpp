// Bounds of surfaces of revolution from balls about the profile's point and derivatives, and bounds of curvatures.
#include "patches/base/bernstein.h"
#include "patches/bend_cell.h"

namespace iso {

// In coordinates in which (Su, Sv) is orthonormal the first form is at least (1 - stray)^2, and the curvature at most the norm of the
// second form over it. Where the strays are large a bound from lengths and angle alone may be better.
double curvature_bound(const Vec3& Su, const Vec3& Sv, double stray_u, double stray_v, const Bend& bend) {
  const double lu = glm::length(Su);
  if (!(lu > 0)) return kInf;
  const Vec3 e = Su / lu, across = Sv - glm::dot(Sv, e) * e;
  const double lv = glm::length(across);
  if (!(lv > 0)) return kInf;
  const double skew = glm::dot(Sv, e) / lv;  // the second axis is (-skew / lu, 1 / lv) in (u, v)
  const double left = 1 - std::hypot(stray_u / lu, std::abs(skew) * stray_u / lu + stray_v / lv) - 64 * kEps * (1 + std::abs(skew));
  if (!(left > 0)) return kInf;
  const auto half = [](const Range& r) { return 0.5 * r.width(); };
  const double uu = bend.uu.middle() / (lu * lu), uv = bend.uv.middle() / (lu * lv), vv = bend.vv.middle() / (lv * lv);
  const double ruu = half(bend.uu) / (lu * lu), ruv = half(bend.uv) / (lu * lv), rvv = half(bend.vv) / (lv * lv), k = std::abs(skew);
  const double pq = uv - skew * uu, qq = skew * skew * uu - 2 * skew * uv + vv;
  const double norm = 0.5 * std::abs(uu + qq) + std::hypot(0.5 * (uu - qq), pq);
  const double rpq = ruv + k * ruu, rqq = k * k * ruu + 2 * k * ruv + rvv;
  const double most = norm + std::sqrt(ruu * ruu + 2 * rpq * rpq + rqq * rqq);
  return (1 + 64 * kEps) * most / (left * left);
}

// The larger root of det(K - k I) with the second form K of absolute values and the first form I with the worst sign of its cosine, both by
// lengths.
double curvature_bound(double least_u, double least_v, double cosine, const Bend& bend) {
  const auto most = [](const Range& r) { return std::max(std::abs(r.lo), std::abs(r.hi)); };
  const double uu = most(bend.uu) / (least_u * least_u), uv = most(bend.uv) / (least_u * least_v), vv = most(bend.vv) / (least_v * least_v);
  const double area2 = 1 - cosine * cosine;
  if (!(area2 > 0)) return kInf;
  const double mean = 0.5 * (uu + vv + 2 * cosine * uv) / area2, gauss = (uu * vv - uv * uv) / area2;
  return (1 + 64 * kEps / area2) * (mean + std::sqrt(std::max(0.0, mean * mean - gauss)));
}

namespace {

// A conic by its derivatives in the middle and a bound of the next higher one.
CurveBalls balls_of(const CurveJet<Vec3>& middle, double half, double first, double second, double third) {
  const double by = 16 * kEps;
  return {middle.C,
          middle.Ct,
          middle.Ctt,
          half * first + by * (glm::length(middle.C) + first),
          half * second + by * (first + second),
          half * third + by * (second + third)};
}

// The largest singular value of the matrix of two columns.
double norm(const Vec3& X, const Vec3& Y) {
  const double xx = glm::dot(X, X), yy = glm::dot(Y, Y);
  return std::sqrt(0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), glm::dot(X, Y)));
}

struct Derivatives {
  Range t;

  Vec3 operator()(const Line<Vec3>& c) const { return {glm::length(c.direction), 0, 0}; }
  Vec3 operator()(const Ellipse<Vec3>& c) const { return Vec3(norm(c.X, c.Y)); }
  Vec3 operator()(const Parabola<Vec3>& c) const {
    const double at = std::max(std::abs(t.lo), std::abs(t.hi)), a = 2 * glm::length(c.A);
    return {a * at + glm::length(c.B), a, 0};
  }
  // cosh t X + sinh t Y = e^t (X + Y)/2 + e^-t (X - Y)/2: convex in t, so the ends decide.
  Vec3 operator()(const Hyperbola<Vec3>& c) const {
    const auto at = [&](double x) { return 0.5 * (std::exp(x) * glm::length(c.X + c.Y) + std::exp(-x) * glm::length(c.X - c.Y)); };
    return Vec3(std::max(at(t.lo), at(t.hi)));
  }
  Vec3 operator()(const NurbsCurve<Vec3>&) const { return Vec3(kInf); }
};

}  // namespace

CurveBalls curve_balls(const Curve3& curve, const Range& t) {
  const Vec3 d = std::visit(Derivatives{t}, curve);
  return balls_of(jet(curve, t.middle()), 0.5 * t.width() * (1 + 8 * kEps), d.x, d.y, d.z);
}

namespace {

// The same polynomial with as many coefficients as wanted.
std::vector<Vec4> raised(std::vector<Vec4> f, std::size_t size) {
  while (f.size() < size) {
    const auto m = static_cast<double>(f.size());
    f.push_back(f.back());
    for (std::size_t i = f.size() - 2; i > 0; --i) f[i] = (static_cast<double>(i) / m) * f[i - 1] + (1 - static_cast<double>(i) / m) * f[i];
  }
  return f;
}

// Holds f / w, of one degree with the points whose weights are w: quotients of coefficients.
struct Ball {
  Vec3 centre{0.0};
  double radius = 0;
};
Ball ball_of(const std::vector<Vec4>& f, const std::vector<Vec4>& points) {
  Ball ball;
  for (std::size_t i = 0; i < f.size(); ++i) ball.centre += Vec3(f[i]) / points[i].w / static_cast<double>(f.size());
  for (std::size_t i = 0; i < f.size(); ++i) ball.radius = std::max(ball.radius, glm::length(Vec3(f[i]) / points[i].w - ball.centre));
  return ball;
}

// The supremum of the weights of f over those of the points.
double share_of_weights(const std::vector<Vec4>& f, const std::vector<Vec4>& points) {
  double most = 0;
  for (std::size_t i = 0; i < f.size(); ++i) most = std::max(most, std::abs(f[i].w / points[i].w));
  return most;
}

}  // namespace

// About the middle: C' = (H' - w' C) / w and C'' = (H'' - 2 w' C' - w'' C) / w.
CurveBalls curve_balls(const std::vector<Vec4>& bezier, double width) {
  const Vec3 middle = project(bernstein_value(bezier, 0.5));
  double rounding = 0;
  std::vector<Vec4> points = bezier;
  for (Vec4& h : points) {
    rounding = std::max(rounding, 16 * kEps * glm::length(project(h)));
    h -= Vec4(h.w * middle, 0.0);
  }
  const auto p = static_cast<double>(points.size()) - 1;
  const std::vector<Vec4> slopes = bernstein_derivative(points);
  std::vector<Vec4> second = raised(bernstein_derivative(slopes), points.size());
  const std::vector<Vec4> first = raised(slopes, points.size());
  const Ball C = ball_of(points, points);
  const double radius = glm::length(C.centre) + C.radius, w1 = share_of_weights(first, points), w2 = share_of_weights(second, points);
  Ball tangent = ball_of(first, points);
  tangent.radius += w1 * radius + 2 * p * rounding;
  for (std::size_t i = 0; i < second.size(); ++i) second[i] -= Vec4(2 * first[i].w * tangent.centre, 0.0);
  Ball bending = ball_of(second, points);
  bending.radius += 2 * w1 * tangent.radius + w2 * radius + (p > 1 || w1 > 0 ? 4 * p * p * rounding : 0.0);
  return {middle + C.centre,   tangent.centre / width, bending.centre / (width * width),
          C.radius + rounding, tangent.radius / width, bending.radius / (width * width)};
}

// At u = 0: Su = Z x C, Sv = C', Suu = -r with r the part of C away from the axis, Suv = Z x C', Svv = C''. Of n . X to first order only
// what of X is tangential counts.
Bend turned_bend(const CurveBalls& c, const Vec3& Z) {
  const auto radial = [&](const Vec3& p) { return p - glm::dot(p, Z) * Z; };
  const Vec3 r = radial(c.C), Su = glm::cross(Z, r), N = glm::cross(Su, c.Ct), bent = glm::cross(Z, c.Ct);
  const double lr = glm::length(r), lt = glm::length(c.Ct);
  Bend b;
  b.Muu = lr + c.stray;
  b.Muv = glm::length(bent) + c.stray_t;
  b.Mvv = glm::length(c.Ctt) + c.stray_tt;
  const double off = lr * c.stray_t + c.stray * (lt + c.stray_t) + 16 * kEps * lr * lt, area = glm::length(N);
  if (!(off < 0.99 * area)) {
    b.uu = b.uv = b.vv = kEverything;
    b.curvature = kInf;
    return b;
  }
  const Vec3 n = N / area;
  const double sine = off / area, shortened = 1 - std::sqrt(1 - sine * sine);
  const auto range = [&](const Vec3& X, double stray) {
    const double along = glm::dot(n, X), across = glm::length(X - along * n);
    const double by = stray + sine * across + shortened * std::abs(along) + 16 * kEps * glm::length(X);
    return Range{along - by, along + by};
  };
  b.uu = range(-r, c.stray);
  b.uv = range(bent, c.stray_t);
  b.vv = range(c.Ctt, c.stray_tt);
  b.curvature = curvature_bound(Su, c.Ct, c.stray, c.stray_t, b);
  return b;
}

}  // namespace iso
