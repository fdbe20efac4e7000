#include "patches/base/barycentric.h"

#include <algorithm>
#include <array>

namespace iso {

namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Twice the area of the triangle.
double area(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

// Whether two closed segments have a point in common.
bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double c_side = area(a, b, c), d_side = area(a, b, d), a_side = area(c, d, a), b_side = area(c, d, b);
  const auto apart = [](double x, double y) { return (x > 0 && y > 0) || (x < 0 && y < 0); };
  if (apart(c_side, d_side) || apart(a_side, b_side)) return false;
  if (c_side != 0 || d_side != 0) return true;
  // On one line: their boxes decide.
  Box2 first, second;
  first.include(a);
  first.include(b);
  second.include(c);
  second.include(d);
  return glm::all(glm::lessThanEqual(first.lo, second.hi)) && glm::all(glm::lessThanEqual(second.lo, first.hi));
}

// The sides that meet where they should not, or side 0 twice.
std::array<std::size_t, 2> crossing_sides(const std::vector<Vec2>& v) {
  const std::size_t n = v.size();
  const auto corner = [&](std::size_t k) { return v[k % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    // A side that turns back over the one before it.
    const Vec2 back = corner(i) - corner(i + 1), on = corner(i + 2) - corner(i + 1);
    if (cross(back, on) == 0 && glm::dot(back, on) > 0) return {i + 1, (i + 1) % n + 1};
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n == i) continue;
      if (meet(corner(i), corner(i + 1), corner(j), corner(j + 1))) return {i + 1, (j + 1) % n};
    }
  }
  return {0, 0};
}

std::string fault_of(BarycentricKind kind, const std::vector<Vec2>& v) {
  const std::size_t n = v.size();
  if (n < 3) return std::to_string(n) + " corners, expected 3 or more";
  double whole = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!finite(v[i])) return "corner " + std::to_string(i) + " is not finite";
    if (v[i] == v[(i + 1) % n]) return "a side of no length after corner " + std::to_string(i);
    whole += area(v[0], v[i], v[(i + 1) % n]);
  }
  if (whole == 0 || !finite(whole)) return "a polygon of no area";
  if (const auto [a, b] = crossing_sides(v); a != b) return "sides " + std::to_string(a) + " and " + std::to_string(b) + " that meet";
  if (kind == BarycentricKind::wachspress)
    for (std::size_t i = 0; i < n; ++i)
      if (!(area(v[i], v[(i + 1) % n], v[(i + 2) % n]) * whole > 0))
        return "a polygon that is not strictly convex at corner " + std::to_string((i + 1) % n);
  return {};
}

struct DualPoint {
  Dual2 x, y;
};
// a - x.
DualPoint to_corner(const Vec2& a, const Vec2& x) { return {{a.x - x.x, -1, 0, 0, 0, 0}, {a.y - x.y, 0, -1, 0, 0, 0}}; }
Dual2 cross(const DualPoint& a, const DualPoint& b) { return a.x * b.y - a.y * b.x; }
Dual2 dot(const DualPoint& a, const DualPoint& b) { return a.x * b.x + a.y * b.y; }

std::vector<Dual2> normalised(std::vector<Dual2> weights) {
  Dual2 sum;
  for (const Dual2& w : weights) sum = sum + w;
  const Dual2 scale = Dual2(1) / sum;
  for (Dual2& w : weights) w = w * scale;
  return weights;
}

// w_i: the triangle at the corner times the distances from all sides but its own two. Nothing is divided, so sides and corners are no
// exceptions.
std::vector<Dual2> wachspress_weights(const BarycentricPolygon& polygon, const Vec2& x) {
  const std::vector<Vec2>& v = polygon.corners;
  const std::size_t n = v.size();
  std::vector<Dual2> distance(n), before(n + 1, Dual2(1)), after(n + 1, Dual2(1)), weights(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 &a = v[(k + n - 1) % n], side = v[k] - a;
    // From the nearer end: exactly zero at both corners.
    const Vec2 from = glm::length(x - a) < glm::length(x - v[k]) ? x - a : x - v[k];
    distance[k] = Dual2(cross(side, from), -side.y, side.x, 0, 0, 0) * polygon.scales[k];
  }
  // Products over sides 1 .. n - 1; side 0 is the last corner's and the first's.
  for (std::size_t k = 1; k < n; ++k) before[k + 1] = before[k] * distance[k];
  for (std::size_t k = n; k-- > 1;) after[k] = distance[k] * after[k + 1];
  for (std::size_t i = 0; i < n; ++i) {
    const double corner = area(v[(i + n - 1) % n], v[i], v[(i + 1) % n]) * polygon.scales[i] * polygon.scales[(i + 1) % n];
    const Dual2 others = i + 1 == n ? before[i] : i == 0 ? after[2] : distance[0] * before[i] * after[i + 2];
    weights[i] = others * corner;
  }
  return weights;
}

// w_i = (T_i + T_(i+1)) / |v_i - x| with T_k the tangent of half the signed angle that side k takes up, from corner k - 1 to k. All are
// multiplied with the area of the side of the largest tangent, which vanishes where that one is infinite: on the side.
std::vector<Dual2> mean_value_weights(const std::vector<Vec2>& v, const Vec2& x) {
  const std::size_t n = v.size();
  std::vector<DualPoint> to(n);
  std::vector<Dual2> length(n), top(n), bottom(n), weights(n);
  for (std::size_t i = 0; i < n; ++i) {
    to[i] = to_corner(v[i], x);
    length[i] = sqrt(dot(to[i], to[i]));
  }
  // tangent = top / bottom, written without cancellation.
  std::size_t steepest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t from = (k + n - 1) % n;
    const Dual2 sine = cross(to[from], to[k]), cosine = dot(to[from], to[k]), product = length[from] * length[k];
    top[k] = cosine.f > 0 ? sine : product - cosine;
    bottom[k] = cosine.f > 0 ? product + cosine : sine;
    if (std::abs(top[k].f * bottom[steepest].f) > std::abs(top[steepest].f * bottom[k].f)) steepest = k;
  }
  const Dual2 scale = bottom[steepest];
  const auto tangent = [&](std::size_t k) { return k == steepest ? top[k] : top[k] / bottom[k] * scale; };
  for (std::size_t i = 0; i < n; ++i) weights[i] = (tangent(i) + tangent((i + 1) % n)) / length[i];
  return weights;
}

}  // namespace

Result<BarycentricPolygon> barycentric_polygon(BarycentricKind kind, std::vector<Vec2> corners) {
  if (std::string fault = fault_of(kind, corners); !fault.empty()) return bad_input({}, {}, fault);
  BarycentricPolygon polygon{.kind = kind, .corners = std::move(corners), .scales = {}};
  const std::vector<Vec2>& v = polygon.corners;
  for (std::size_t k = 0; k < v.size(); ++k) {
    double farthest = 0;
    for (const Vec2& corner : v) {
      const double of_corner = area(v[(k + v.size() - 1) % v.size()], v[k], corner);
      if (std::abs(of_corner) > std::abs(farthest)) farthest = of_corner;
    }
    polygon.scales.push_back(1 / farthest);
  }
  return polygon;
}

std::vector<Dual2> coordinates_at(const BarycentricPolygon& polygon, const Vec2& x) {
  if (polygon.kind == BarycentricKind::wachspress) return normalised(wachspress_weights(polygon, x));
  const auto at = std::find(polygon.corners.begin(), polygon.corners.end(), x);
  if (at == polygon.corners.end()) return normalised(mean_value_weights(polygon.corners, x));
  std::vector<Dual2> delta(polygon.corners.size());
  delta[static_cast<std::size_t>(at - polygon.corners.begin())] = Dual2(1);
  return delta;
}

}  // namespace iso
