#include "tess/pattern_cuts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace iso {
namespace {

// In the polygon's unit. A point this near to a spoke is on it; of places on a spoke this near to each other one is left.
constexpr double kOnLine = 1e-12, kOnePlace = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// A corner of a piece that is being cut.
struct Corner {
  Vec2 p;
  std::optional<std::uint32_t> known;  // a point of the pattern
};

class Cutter {
 public:
  explicit Cutter(const DomainPattern& pattern) : pattern_(pattern), n_(pattern.sides) {
    // Spoke k goes to the middle of side k, so chart k lies between the spokes k and k + 1.
    for (int k = 0; k < n_; ++k) {
      const double angle = (k - 0.5) * kTwoPi / n_;
      spokes_.emplace_back(std::cos(angle), std::sin(angle));
    }
    spokes_.push_back(spokes_[0]);
    on_spoke_.resize(static_cast<std::size_t>(n_));
    for (const auto& row : pattern.of_side)
      for (std::size_t i = 0; i + 1 < row.size(); ++i) on_side_.emplace(std::minmax(row[i], row[i + 1]), true);
  }

  PatternCuts run() {
    for (std::uint32_t t = 0; t < pattern_.triangles.size(); ++t) {
      const auto& [a, b, c] = pattern_.triangles[t];
      out_.home.push_back(chart_place(n_, (pattern_.points[a] + pattern_.points[b] + pattern_.points[c]) / 3.0).corner);
      if (within(t, out_.home.back())) {
        add_pieces(t, out_.home.back(), {a, b, c}, true);
        continue;
      }
      for (int chart = 0; chart < n_; ++chart) add_part(t, chart);
    }
    return std::move(out_);
  }

 private:
  bool within(std::uint32_t triangle, int chart) const {
    for (const std::uint32_t i : pattern_.triangles[triangle]) {
      const Vec2& p = pattern_.points[i];
      if (cross(spokes_[static_cast<std::size_t>(chart)], p) < -kOnLine) return false;
      if (cross(spokes_[static_cast<std::size_t>(chart) + 1], p) > kOnLine) return false;
    }
    return true;
  }

  // What of the polygon is to the left of a direction from the centre (sign 1), or to the right of it (-1).
  std::vector<Corner> clipped(const std::vector<Corner>& polygon, const Vec2& direction, double sign) const {
    std::vector<Corner> kept;
    const auto side = [&](const Corner& c) {
      const double x = sign * cross(direction, c.p);
      return std::abs(x) < kOnLine ? 0.0 : x;
    };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double x = side(a), y = side(b);
      if (x >= 0) kept.push_back(a);
      if ((x > 0 && y < 0) || (x < 0 && y > 0)) kept.push_back({(y * a.p - x * b.p) / (y - x), {}});
    }
    return kept;
  }

  void add_part(std::uint32_t triangle, int chart) {
    const auto& corners = pattern_.triangles[triangle];
    std::vector<Corner> part;
    for (const std::uint32_t i : corners) part.push_back({pattern_.points[i], i});
    part = clipped(part, spokes_[static_cast<std::size_t>(chart)], 1);
    part = clipped(part, spokes_[static_cast<std::size_t>(chart) + 1], -1);
    std::vector<std::uint32_t> points;
    std::vector<Vec2> at;
    for (const Corner& c : part) {
      const std::uint32_t i = c.known ? *c.known : cut_point(triangle, chart, c.p);
      if (std::find(points.begin(), points.end(), i) != points.end()) continue;
      points.push_back(i);
      at.push_back(c.p);
    }
    double area = 0;
    for (std::size_t i = 1; i + 1 < at.size(); ++i) area += cross(at[i] - at[0], at[i + 1] - at[0]);
    if (area < kOnLine * kOnLine) return;
    const bool whole = std::is_permutation(points.begin(), points.end(), corners.begin(), corners.end());
    add_pieces(triangle, chart, points, whole);
  }

  Vec2 place_of(std::uint32_t point, int chart) const {
    const std::size_t known = pattern_.points.size();
    return seen_from(n_, point < known ? pattern_.places[point] : out_.points[point - known].place, chart);
  }

  // A convex polygon as a fan from the corner from which its least triangle is largest, in the chart.
  void add_pieces(std::uint32_t triangle, int chart, const std::vector<std::uint32_t>& points, bool whole) {
    const std::size_t count = points.size();
    std::vector<Vec2> st;
    for (const std::uint32_t i : points) st.push_back(place_of(i, chart));
    std::size_t best = 0;
    double best_area = -kInf;
    for (std::size_t from = 0; from < count; ++from) {
      double least = kInf;
      for (std::size_t i = 1; i + 1 < count; ++i)
        least = std::min(least, cross(st[(from + i) % count] - st[from], st[(from + i + 1) % count] - st[from]));
      if (least > best_area) best_area = least, best = from;
    }
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const std::size_t b = (best + i) % count, c = (best + i + 1) % count;
      out_.pieces.push_back({triangle, chart, {points[best], points[b], points[c]}, {st[best], st[b], st[c]}, whole});
    }
  }

  // The number of a place on one of the chart's spokes.
  std::uint32_t cut_point(std::uint32_t triangle, int chart, const Vec2& p) {
    if (glm::length(p) < kOnePlace) {
      if (!centre_) centre_ = add_point(triangle, {0, Vec2(1.0)}, p);
      return *centre_;
    }
    const int next = (chart + 1) % n_;
    const int spoke =
        std::abs(cross(spokes_[static_cast<std::size_t>(chart)], p)) <= std::abs(cross(spokes_[static_cast<std::size_t>(next)], p)) ? chart
                                                                                                                                    : next;
    auto& known = on_spoke_[static_cast<std::size_t>(spoke)];
    const double radius = glm::length(p);
    const auto at = known.lower_bound(radius - kOnePlace);
    if (at != known.end() && at->first < radius + kOnePlace) return at->second;
    // Along the spoke the chart's map is linear: s = 1, and t from 0 at the side to 1 at the centre. It belongs to the chart before it.
    const double t = std::clamp(1 - radius / std::cos(kPi / n_), 0.0, 1.0);
    const std::uint32_t made = add_point(triangle, {(spoke + n_ - 1) % n_, {1, t}}, p);
    known.emplace(radius, made);
    return made;
  }

  std::uint32_t add_point(std::uint32_t triangle, const ChartPlace& place, const Vec2& p) {
    const auto& corners = pattern_.triangles[triangle];
    PatternCuts::Point point{place, corners, {}, false};
    // The edge it is on, if it is on one: that with the least height over it.
    double least = kInf;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(corners[k], corners[(k + 1) % 3]);
      const Vec2 along = pattern_.points[b] - pattern_.points[a], from = p - pattern_.points[a];
      const double height = std::abs(cross(along, from)) / glm::length(along);
      if (height >= kOnePlace || height >= least) continue;
      least = height;
      const double share = std::clamp(glm::dot(along, from) / glm::dot(along, along), 0.0, 1.0);
      point.between = {a, b, a};
      point.on_side = on_side_.count({a, b}) != 0;
      point.weights = point.on_side ? Vec3(0.5, 0.5, 0) : Vec3(1 - share, share, 0);
      if (point.on_side) point.place.st = {1, 0};
    }
    if (least == kInf) {
      const Vec2 a = pattern_.points[corners[0]], b = pattern_.points[corners[1]], c = pattern_.points[corners[2]];
      const double all = cross(b - a, c - a);
      point.weights = {cross(b - p, c - p) / all, cross(c - p, a - p) / all, cross(a - p, b - p) / all};
    }
    out_.points.push_back(point);
    return static_cast<std::uint32_t>(pattern_.points.size() + out_.points.size() - 1);
  }

  const DomainPattern& pattern_;
  int n_;
  std::vector<Vec2> spokes_;
  std::vector<std::map<double, std::uint32_t>> on_spoke_;
  std::optional<std::uint32_t> centre_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> on_side_;
  PatternCuts out_;
};

}  // namespace

PatternCuts cut_by_charts(const DomainPattern& pattern) { return Cutter(pattern).run(); }

}  // namespace iso
