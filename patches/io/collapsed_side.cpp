#include "patches/io/collapsed_side.h"

#include <array>

namespace iso {
namespace {

// A point this near to the border lies on it; as a share of the domain.
constexpr double kOnBorder = 1e-6;
// The way along the border must stray less by this factor.
constexpr double kGain = 0.1;
constexpr int kSamples = 16;  // per straight piece

double stray(const AnySurface& surface, const std::vector<UV>& points) {
  const Point3 start = point(surface, points.front()), end = point(surface, points.back());
  double most = 0;
  for (size_t i = 1; i < points.size(); ++i)
    for (int k = 0; k <= kSamples; ++k) {
      const Point3 p = point(surface, glm::mix(points[i - 1], points[i], double(k) / kSamples));
      most = std::max(most, std::min(glm::length(p - start), glm::length(p - end)));
    }
  return most;
}

// How far around the border, counter-clockwise from the lower left corner, each side of length 1; nothing if the point is not on it.
std::optional<double> place_on_border(const Box2& domain, const UV& p) {
  const Vec2 q = (p - domain.lo) / domain.size();
  if (std::abs(q.y) <= kOnBorder && q.x < 1 - kOnBorder) return q.x;
  if (std::abs(q.x - 1) <= kOnBorder && q.y < 1 - kOnBorder) return 1 + q.y;
  if (std::abs(q.y - 1) <= kOnBorder && q.x > kOnBorder) return 3 - q.x;
  if (std::abs(q.x) <= kOnBorder) return 4 - q.y;
  return std::nullopt;
}

// The corners passed on the way around the border from one place to the other, against the clock.
std::vector<UV> corners_between(const Box2& domain, double from, double to) {
  const std::array<UV, 4> corners{domain.lo, {domain.hi.x, domain.lo.y}, domain.hi, {domain.lo.x, domain.hi.y}};
  if (to < from) to += 4;
  std::vector<UV> passed;
  for (int k = static_cast<int>(std::floor(from)) + 1; k < to - kOnBorder; ++k)
    if (k > from + kOnBorder) passed.push_back(corners[static_cast<size_t>(k % 4)]);
  return passed;
}

std::vector<UV> way_through(const UV& from, const std::vector<UV>& corners, const UV& to) {
  std::vector<UV> way{from};
  way.insert(way.end(), corners.begin(), corners.end());
  way.push_back(to);
  return way;
}

}  // namespace

std::optional<BorderWay> border_way(const AnySurface& surface, const UV& from, const UV& to, double allowed) {
  const Box2 domain = natural_domain(surface);
  if (!finite(domain.lo) || !finite(domain.hi)) return std::nullopt;
  const auto start = place_on_border(domain, from), end = place_on_border(domain, to);
  if (!start || !end) return std::nullopt;
  // Two points of one side have the straight line for their way.
  const std::vector<UV> forward = corners_between(domain, *start, *end);
  std::vector<UV> back = corners_between(domain, *end, *start);
  std::reverse(back.begin(), back.end());
  if (forward.empty() || back.empty()) return std::nullopt;
  const double straight = stray(surface, {from, to});
  if (straight <= allowed) return std::nullopt;

  BorderWay best{{}, kGain * straight, straight};
  for (const auto& corners : {forward, back})
    if (auto way = way_through(from, corners, to); stray(surface, way) < best.strays) best = {way, stray(surface, way), straight};
  if (best.points.empty()) return std::nullopt;
  return best;
}

}  // namespace iso
