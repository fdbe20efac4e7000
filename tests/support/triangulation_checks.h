// What must hold for every triangulation, checked one by one and exactly. Each check gives what is wrong, or an empty text.
#pragma once

#include <fmt/format.h>

#include <string>

#include "tess/predicates.h"
#include "tess/triangulation.h"

namespace iso::test {

using Vertex = std::uint32_t;

inline int shared_index(const Triangulation& all, Vertex t, Vertex neighbour) {
  for (int k = 0; k < 3; ++k)
    if (all.triangles()[t].next[k] == neighbour) return k;
  return -1;
}

// Counter-clockwise triangles whose neighbours know each other and agree on the edge between, as many as Euler's formula asks for: with
// these the triangles cover the larger box once.
inline std::string unsound(const Triangulation& all) {
  const auto triangles = all.triangles();
  const auto points = all.points();
  if (triangles.size() != 2 * points.size() - 6)
    return fmt::format("{} triangles of {} points are not what Euler asks for", triangles.size(), points.size());
  int outer = 0;
  for (Vertex i = 0; i < triangles.size(); ++i) {
    const Triangulation::Triangle& t = triangles[i];
    if (orientation(points[t.v[0]], points[t.v[1]], points[t.v[2]]) <= 0) return fmt::format("triangle {} does not run left", i);
    for (int k = 0; k < 3; ++k) {
      if (t.next[k] == Triangulation::kNone) {
        ++outer;
        continue;
      }
      const Triangulation::Triangle& u = triangles[t.next[k]];
      const int j = shared_index(all, t.next[k], i);
      if (j < 0) return fmt::format("triangle {} is not known to its neighbour {}", i, t.next[k]);
      if (u.v[(j + 1) % 3] != t.v[(k + 2) % 3] || u.v[(j + 2) % 3] != t.v[(k + 1) % 3])
        return fmt::format("triangles {} and {} share no edge", i, t.next[k]);
      if ((u.constrained >> j & 1) != (t.constrained >> k & 1) || (u.wall >> j & 1) != (t.wall >> k & 1))
        return fmt::format("triangles {} and {} do not agree on their edge", i, t.next[k]);
      if (t.constrained >> 3 || (t.wall & ~t.constrained)) return fmt::format("triangle {} has walls that are not constrained", i);
    }
  }
  if (outer != 4) return fmt::format("{} edges on the border, not 4", outer);
  for (Vertex v = 0; v < points.size(); ++v) {
    const auto& t = triangles[all.triangle_at(v)].v;
    if (t[0] != v && t[1] != v && t[2] != v) return fmt::format("vertex {} is not at its triangle", v);
  }
  return {};
}

// How a quadrilateral's circle test comes out: the determinant as a share of the sum of its terms' magnitudes.
inline double circle_share(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 corners[3] = {a - d, b - d, c - d};
  double sum = 0, magnitudes = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec2 &p = corners[i], &q = corners[(i + 1) % 3], &r = corners[(i + 2) % 3];
    sum += glm::dot(p, p) * (q.x * r.y - q.y * r.x);
    magnitudes += glm::dot(p, p) * (std::abs(q.x * r.y) + std::abs(q.y * r.x));
  }
  return sum / magnitudes;
}

// The height of a triangle over its longest edge as a share of that edge.
inline double thinness(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 ab = b - a, ac = c - a, bc = c - b;
  return std::abs(ab.x * ac.y - ab.y * ac.x) / std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
}

// Unconstrained edges are Delaunay: exactly, or but for a few roundings where no needle is concerned. One swap left undone in doubt can
// make its neighbours wrong by a few times as much; 5e-15 was seen.
enum class Delaunay { Exactly, ButForRounding };
constexpr double kCircleRounding = 1e-13, kNeedle = 1e-11;

inline std::string not_delaunay(const Triangulation& all, Delaunay wanted) {
  const auto points = all.points();
  for (Vertex i = 0; i < all.triangles().size(); ++i) {
    const Triangulation::Triangle& t = all.triangles()[i];
    for (int k = 0; k < 3; ++k) {
      if (t.next[k] == Triangulation::kNone || (t.constrained >> k & 1)) continue;
      const auto& u = all.triangles()[t.next[k]].v;
      const Vec2 &a = points[t.v[0]], &b = points[t.v[1]], &c = points[t.v[2]], &d = points[u[shared_index(all, t.next[k], i)]];
      if (!in_circle(a, b, c, d)) continue;
      const double share = circle_share(a, b, c, d);
      const double thin = std::min(thinness(a, b, c), thinness(points[u[0]], points[u[1]], points[u[2]]));
      if (wanted == Delaunay::Exactly || share > kCircleRounding || thin < kNeedle)
        return fmt::format("triangle {} holds its neighbour {} by {}, height {}", i, t.next[k], share, thin);
    }
  }
  return {};
}

inline bool on_segment(const Vec2& a, const Vec2& b, const Vec2& p) {
  return orientation(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

// The segments cross in a point that is an end of neither.
inline bool cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

// The segments are chains of constrained edges, and all constrained edges come from them; an edge is a wall if an odd number covers it.
inline std::string not_constrained(const Triangulation& all, std::span<const std::array<Vertex, 2>> segments) {
  const auto points = all.points();
  std::vector<double> covered(segments.size(), 0);
  for (const Triangulation::Triangle& t : all.triangles())
    for (int k = 0; k < 3; ++k) {
      const Vertex u = t.v[(k + 1) % 3], v = t.v[(k + 2) % 3];
      if (t.next[k] != Triangulation::kNone && u > v) continue;  // each edge once
      int times = 0;
      for (std::size_t s = 0; s < segments.size(); ++s) {
        const Vec2 &a = points[segments[s][0]], &b = points[segments[s][1]];
        if (segments[s][0] == segments[s][1] || !on_segment(a, b, points[u]) || !on_segment(a, b, points[v])) continue;
        ++times;
        covered[s] += glm::length(points[u] - points[v]) / glm::length(b - a);
      }
      if ((times > 0) != bool(t.constrained >> k & 1)) return fmt::format("edge {} {} lies on {} segments", u, v, times);
      if ((times & 1) != (t.wall >> k & 1)) return fmt::format("edge {} {} with {} segments: wrong wall", u, v, times);
    }
  for (std::size_t s = 0; s < segments.size(); ++s)
    if (segments[s][0] != segments[s][1] && std::abs(covered[s] - 1) > 1e-9)
      return fmt::format("segment {} {} is covered by {}", segments[s][0], segments[s][1], covered[s]);
  return {};
}

// The area of the inside.
inline double inside_area(const Triangulation& all) {
  double area = 0;
  for (const Triangulation::Triangle& t : all.triangles()) {
    const Vec2 ab = all.points()[t.v[1]] - all.points()[t.v[0]], ac = all.points()[t.v[2]] - all.points()[t.v[0]];
    if (t.inside) area += 0.5 * (ab.x * ac.y - ab.y * ac.x);
  }
  return area;
}

}  // namespace iso::test
