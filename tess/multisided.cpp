#include "tess/multisided.h"

#include <cmath>
#include <map>

#include "patches/base/check.h"

namespace iso {
namespace {

constexpr double kOnLine = 1e-12;  // in the polygon's unit: far above rounding, far below the distance of points of the highest level

using Weights = std::array<double, 4>;  // of the corners of a sub-polygon
using Corners = std::array<std::uint32_t, 3>;

// One sub-polygon, divided.
struct Division {
  std::vector<Weights> points;
  std::vector<Corners> triangles;
  std::vector<std::vector<std::uint32_t>> of_edge;  // from corner a to the next one
  std::uint64_t quads = 0;
};

// ---- even grids -----------------------------------------------------------------------------------------------------------

// Points with all barycentric coordinates at least `margin` of m; edge a runs from corner a of the grid to the next one.
Division even_triangle(int m, int margin) {
  Division d;
  const int rows = m - 3 * margin;
  const auto at = [rows](int i, int j) { return static_cast<std::uint32_t>(j * (rows + 1) - j * (j - 1) / 2 + i); };
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i + j <= rows; ++i) {
      const int a = m - 2 * margin - i - j, b = margin + i, c = margin + j;
      d.points.push_back({double(a) / m, double(b) / m, double(c) / m, 0});
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i + j < rows; ++i) {
      d.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < rows) d.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  d.of_edge.resize(3);
  for (int i = 0; i <= rows; ++i) {
    d.of_edge[0].push_back(at(i, 0));
    d.of_edge[1].push_back(at(rows - i, i));
    d.of_edge[2].push_back(at(0, rows - i));
  }
  return d;
}

Division even_quad(int m, int margin) {
  Division d;
  const int rows = m - 2 * margin;
  const auto at = [rows](int i, int j) { return static_cast<std::uint32_t>(j * (rows + 1) + i); };
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= rows; ++i) {
      const double s = double(margin + i) / m, t = double(margin + j) / m;
      d.points.push_back({(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t});
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < rows; ++i) {
      d.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      d.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      ++d.quads;
    }
  d.of_edge.resize(4);
  for (int i = 0; i <= rows; ++i) {
    d.of_edge[0].push_back(at(i, 0));
    d.of_edge[1].push_back(at(rows, i));
    d.of_edge[2].push_back(at(rows - i, rows));
    d.of_edge[3].push_back(at(0, rows - i));
  }
  return d;
}

// ---- sides with levels of their own ------------------------------------------------------------------------------------------

// The strip between two rows of points that run the same way, the first of them to the right: triangles from each segment to a point of the
// other row, both advanced evenly.
void add_strip(const std::vector<std::uint32_t>& outer, const std::vector<std::uint32_t>& inner, std::vector<Corners>& triangles) {
  const std::size_t p = outer.size() - 1, q = inner.size() - 1;
  for (std::size_t i = 0, j = 0; i < p || j < q;) {
    const bool along_outer = j == q || (i < p && (2 * i + 1) * q <= (2 * j + 1) * p);
    if (along_outer)
      triangles.push_back({outer[i], outer[i + 1], inner[j]}), ++i;
    else
      triangles.push_back({outer[i], inner[j + 1], inner[j]}), ++j;
  }
}

// Levels of the edges, from each corner to the next.
Division uneven(int corners, int m, const std::vector<int>& levels) {
  const bool is_quad = corners == 4;
  const bool has_ring = m >= (is_quad ? 2 : 3);
  Division d;
  if (has_ring) {
    d = is_quad ? even_quad(m, 1) : even_triangle(m, 1);
  } else {
    d.points.push_back(is_quad ? Weights{0.25, 0.25, 0.25, 0.25} : Weights{1.0 / 3, 1.0 / 3, 1.0 / 3, 0});
    d.of_edge.assign(static_cast<std::size_t>(corners), {0});
  }
  const auto first = static_cast<std::uint32_t>(d.points.size());
  for (int a = 0; a < corners; ++a) {
    d.points.push_back({});
    d.points.back()[static_cast<std::size_t>(a)] = 1;
  }
  std::vector<std::vector<std::uint32_t>> outer;
  for (int a = 0; a < corners; ++a) {
    const int next = (a + 1) % corners, level = levels[static_cast<std::size_t>(a)];
    std::vector<std::uint32_t> row{first + static_cast<std::uint32_t>(a)};
    for (int i = 1; i < level; ++i) {
      row.push_back(static_cast<std::uint32_t>(d.points.size()));
      Weights w{};
      w[static_cast<std::size_t>(a)] = double(level - i) / level;
      w[static_cast<std::size_t>(next)] = double(i) / level;
      d.points.push_back(w);
    }
    row.push_back(first + static_cast<std::uint32_t>(next));
    add_strip(row, d.of_edge[static_cast<std::size_t>(a)], d.triangles);
    outer.push_back(std::move(row));
  }
  d.of_edge = std::move(outer);
  return d;
}

Division divided(int corners, int m, const std::vector<int>& levels) {
  for (const int level : levels)
    if (level != m) return uneven(corners, m, levels);
  return corners == 4 ? even_quad(m, 0) : even_triangle(m, 0);
}

// ---- sub-polygons ------------------------------------------------------------------------------------------------------------

// Corners of the polygon; `sides`: its centre.
std::vector<std::vector<int>> sub_polygons(Strategy strategy, int n) {
  std::vector<std::vector<int>> all;
  const bool even = n % 2 == 0;
  switch (strategy) {
    case Strategy::fan_triangles:
      for (int k = 1; k + 1 < n; ++k) all.push_back({0, k, k + 1});
      break;
    case Strategy::fan_quads:
      for (int k = 1; k + 2 < n; k += 2) all.push_back({0, k, k + 1, k + 2});
      if (!even) all.push_back({0, n - 2, n - 1});
      break;
    case Strategy::symmetric_quads:
      for (int k = 0; even && k < n; k += 2) all.push_back({n, k, k + 1, (k + 2) % n});
      if (even) break;
      [[fallthrough]];
    case Strategy::symmetric_triangles:
      for (int k = 0; k < n; ++k) all.push_back({n, k, (k + 1) % n});
      break;
  }
  return all;
}

Vec2 corner_point(int n, int corner) { return corner == n ? Vec2(0.0) : domain_corner(n, corner); }

Vec2 turned(int n, const Vec2& p, int corners) {
  const Vec2 by = domain_corner(n, corners);
  return {by.x * p.x - by.y * p.y, by.y * p.x + by.x * p.y};
}

// Side k of the polygon, if these are its ends, or -1.
int side_between(int n, int a, int b) { return a < n && b < n && (a + 1) % n == b ? b : -1; }

class PatternMaker {
 public:
  PatternMaker(Strategy strategy, int n, const PatternLevels& levels)
      : n_(n), levels_(levels), polygons_(sub_polygons(strategy, n)), symmetric_(polygons_[0][0] == n) {
    out_.sides = n;
    out_.of_side.resize(static_cast<std::size_t>(n));
    corner_.assign(static_cast<std::size_t>(n) + 1, kNone);
  }

  DomainPattern run() {
    for (const std::vector<int>& polygon : polygons_) add(polygon);
    return std::move(out_);
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  int level_of(int a, int b) const {
    const int side = side_between(n_, a, b);
    return side < 0 || levels_.of_side.empty() ? levels_.inner : levels_.of_side[static_cast<std::size_t>(side)];
  }

  // In symmetric patterns all are computed as points of the first sub-polygon, and turned.
  std::uint32_t add_point(const std::vector<int>& polygon, const Weights& w) {
    const std::vector<int>& computed = symmetric_ ? polygons_[0] : polygon;
    Vec2 p{0.0};
    for (std::size_t a = 0; a < computed.size(); ++a) p += w[a] * corner_point(n_, computed[a]);
    ChartPlace place = chart_place(n_, p);
    if (symmetric_ && place.st != Vec2(1.0)) {
      place.corner = (place.corner + polygon[1]) % n_;
      p = turned(n_, p, polygon[1]);
    }
    out_.points.push_back(p);
    out_.places.push_back(place);
    return static_cast<std::uint32_t>(out_.points.size() - 1);
  }

  // Points of the polygon's own sides: as many as the level says, their places exact.
  void place_side(int side, const std::vector<std::uint32_t>& row) {
    const int level = static_cast<int>(row.size()) - 1, before = (side + n_ - 1) % n_;
    for (int i = 0; i <= level; ++i) {
      const bool first_half = 2 * i <= level;
      const double along = 2.0 * (first_half ? i : level - i) / level;
      out_.places[row[static_cast<std::size_t>(i)]] = first_half ? ChartPlace{before, {along, 0}} : ChartPlace{side, {0, along}};
    }
    out_.of_side[static_cast<std::size_t>(side)] = row;
  }

  // Corners and the points of edges that another sub-polygon has, too, are shared.
  void share(const std::vector<int>& polygon, const Division& d, std::vector<std::uint32_t>& number) {
    for (std::size_t a = 0; a < polygon.size(); ++a) {
      const int from = polygon[a], to = polygon[(a + 1) % polygon.size()];
      if (const auto known = edges_.find({to, from}); known != edges_.end())
        for (std::size_t i = 0; i < d.of_edge[a].size(); ++i) number[d.of_edge[a][i]] = known->second[known->second.size() - 1 - i];
      if (const std::uint32_t corner = corner_[static_cast<std::size_t>(from)]; corner != kNone) number[d.of_edge[a].front()] = corner;
    }
  }

  void add(const std::vector<int>& polygon) {
    std::vector<int> levels;
    for (std::size_t a = 0; a < polygon.size(); ++a) levels.push_back(level_of(polygon[a], polygon[(a + 1) % polygon.size()]));
    const Division d = divided(static_cast<int>(polygon.size()), levels_.inner, levels);
    std::vector<std::uint32_t> number(d.points.size(), kNone);
    share(polygon, d, number);
    for (std::size_t i = 0; i < d.points.size(); ++i)
      if (number[i] == kNone) number[i] = add_point(polygon, d.points[i]);
    for (const Corners& t : d.triangles) out_.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    out_.quads += d.quads;
    for (std::size_t a = 0; a < polygon.size(); ++a) {
      const int from = polygon[a], to = polygon[(a + 1) % polygon.size()];
      std::vector<std::uint32_t> row;
      for (const std::uint32_t i : d.of_edge[a]) row.push_back(number[i]);
      corner_[static_cast<std::size_t>(from)] = row.front();
      if (const int side = side_between(n_, from, to); side >= 0) place_side(side, row);
      edges_[{from, to}] = std::move(row);
    }
  }

  int n_;
  const PatternLevels& levels_;
  std::vector<std::vector<int>> polygons_;
  bool symmetric_;
  DomainPattern out_;
  std::vector<std::uint32_t> corner_;
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> edges_;
};

double snapped(double x) {
  if (std::abs(x) < kOnLine) return 0;
  return std::abs(x - 1) < kOnLine ? 1 : x;
}

// In the chart of corner 0: x = 1 - sin^2 e + (1 - 2 cos^2) s t, y = cos sin (s - t) with e = s + t and the angle pi / n. With
// 4 s t = e^2 - (s - t)^2 that is a quadratic equation in e, whose smaller root is meant.
Vec2 inverted(int n, const Vec2& p) {
  const double angle = kPi / n, sine2 = std::sin(angle) * std::sin(angle), C = std::cos(2 * angle);
  const double d = p.y / (std::cos(angle) * std::sin(angle));
  const double Q = 1 - p.x + 0.25 * C * d * d;
  const double e = 2 * Q / (sine2 + std::sqrt(std::max(0.0, sine2 * sine2 + C * Q)));
  return {0.5 * (e + d), 0.5 * (e - d)};
}

}  // namespace

const char* name_of(Strategy strategy) {
  constexpr const char* kNames[] = {"fan-triangles", "fan-quads", "symmetric-triangles", "symmetric-quads"};
  return kNames[static_cast<std::size_t>(strategy)];
}

ChartPlace chart_place(int sides, const Vec2& point) {
  if (glm::length(point) < kOnLine) return {0, Vec2(1.0)};
  // The chart of corner k reaches half a turn of the polygon to both sides of it.
  const double turn = std::atan2(point.y, point.x) * sides / kTwoPi;
  int corner = static_cast<int>(std::lround(turn));
  Vec2 st = inverted(sides, turned(sides, point, -corner));
  st = glm::clamp(Vec2(snapped(st.x), snapped(st.y)), 0.0, 1.0);
  corner = (corner + sides) % sides;
  return {corner, st};
}

Vec2 place_in_chart(int sides, int corner, const Vec2& point) {
  const Vec2 st = inverted(sides, turned(sides, point, -corner));
  return glm::clamp(st, 0.0, 1.0);
}

Vec2 seen_from(int sides, const ChartPlace& place, int corner) {
  if (place.corner == corner || place.st == Vec2(1.0)) return place.st;
  const bool before = (place.corner + 1) % sides == corner, after = (corner + 1) % sides == place.corner;
  if (before && place.st.x == 1) return {place.st.y, 1};
  ISO_CHECK(after && place.st.y == 1);
  return {1, place.st.x};
}

DomainPattern domain_pattern(Strategy strategy, int sides, const PatternLevels& levels) {
  ISO_CHECK(sides >= 3 && sides <= kMostSides && levels.inner >= 1 && levels.inner <= kMostLevel);
  ISO_CHECK(levels.of_side.empty() || levels.of_side.size() == static_cast<std::size_t>(sides));
  for (const int level : levels.of_side) ISO_CHECK(level >= 1 && level <= kMostLevel);
  return PatternMaker(strategy, sides, levels).run();
}

}  // namespace iso
