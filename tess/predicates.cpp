#include "tess/predicates.h"

#include <cmath>

#include "tess/expansion.h"

namespace iso {
namespace {

constexpr double kRounding = 0.5 * kEps;  // the largest relative error of one operation

// Each product of two differences has three roundings, their difference a fourth that cannot change its sign; the second term covers the
// rounding of the bound itself [Shewchuk 1997, section 4.3, bound A].
constexpr double kOrientationBound = (3 + 16 * kRounding) * kRounding;
// The same for the three products of a length squared and a minor [Shewchuk 1997, section 4.4, bound A].
constexpr double kCircleBound = (10 + 96 * kRounding) * kRounding;

int sign(double x) { return (x > 0) - (x < 0); }

int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const auto acx = exact_difference(a.x, c.x), acy = exact_difference(a.y, c.y);
  const auto bcx = exact_difference(b.x, c.x), bcy = exact_difference(b.y, c.y);
  return (acx * bcy + -(acy * bcx)).sign();
}

int exact_circle_side(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto ax = exact_difference(a.x, d.x), ay = exact_difference(a.y, d.y);
  const auto bx = exact_difference(b.x, d.x), by = exact_difference(b.y, d.y);
  const auto cx = exact_difference(c.x, d.x), cy = exact_difference(c.y, d.y);
  const auto at_a = (ax * ax + ay * ay) * (bx * cy + -(by * cx));
  const auto at_b = (bx * bx + by * by) * (cx * ay + -(cy * ax));
  const auto at_c = (cx * cx + cy * cy) * (ax * by + -(ay * bx));
  return (at_a + at_b + at_c).sign();
}

}  // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double area = left - right;
  if (std::abs(area) > kOrientationBound * (std::abs(left) + std::abs(right))) return sign(area);
  return exact_orientation(a, b, c);
}

int circle_side_or_doubt(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 ad = a - d, bd = b - d, cd = c - d;
  const double bc = bd.x * cd.y, cb = bd.y * cd.x;
  const double ca = cd.x * ad.y, ac = cd.y * ad.x;
  const double ab = ad.x * bd.y, ba = ad.y * bd.x;
  const double aa = ad.x * ad.x + ad.y * ad.y, bb = bd.x * bd.x + bd.y * bd.y, cc = cd.x * cd.x + cd.y * cd.y;
  const double determinant = aa * (bc - cb) + bb * (ca - ac) + cc * (ab - ba);
  const double all = aa * (std::abs(bc) + std::abs(cb)) + bb * (std::abs(ca) + std::abs(ac)) + cc * (std::abs(ab) + std::abs(ba));
  return std::abs(determinant) > kCircleBound * all ? sign(determinant) : 0;
}

bool in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int side = circle_side_or_doubt(a, b, c, d);
  return (side != 0 ? side : exact_circle_side(a, b, c, d)) > 0;
}

}  // namespace iso
