#include "tess/triangulation.h"

#include <algorithm>

#include "patches/base/check.h"
#include "tess/predicates.h"

namespace iso {
namespace {

using Index = std::uint32_t;

// A triangle whose height is below this share of its longest edge has points that were meant to lie on one line: coordinates that went
// through a few dozen operations are off by 1e-14 of a face's size, and edges are shorter than that size.
constexpr double kNeedle = 1e-10;

bool is_needle(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 ab = b - a, bc = c - b, ca = a - c;
  const double area = ab.x * bc.y - ab.y * bc.x;
  return std::abs(area) < kNeedle * std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)});
}

}  // namespace

Triangulation::Triangulation(const Box2& box) {
  ISO_CHECK(finite(box.lo) && finite(box.hi) && !box.empty());
  const Vec2 size = box.size();
  const Vec2 largest = glm::max(glm::abs(box.lo), glm::abs(box.hi));
  const double magnitude = std::max(largest.x, largest.y);
  ISO_CHECK(magnitude == 0 || (magnitude > 1e-28 && magnitude < 1e70));

  // A margin as wide as the box keeps the corners out of most circles; eight roundings keep a box without width off its margin.
  double margin = std::max({size.x, size.y, 8 * kEps * magnitude});
  if (margin == 0) margin = 1;
  smallest_ = std::ldexp(magnitude, -120);
  outer_ = box.inflated(margin);
  points_ = {outer_.lo, {outer_.hi.x, outer_.lo.y}, outer_.hi, {outer_.lo.x, outer_.hi.y}};
  triangles_.resize(2);
  triangles_[0].v = {0, 1, 2};
  triangles_[0].next = {kNone, 1, kNone};
  triangles_[1].v = {0, 2, 3};
  triangles_[1].next = {kNone, kNone, 0};
  at_vertex_ = {0, 0, 0, 1};
}

void Triangulation::reserve(std::size_t points) {
  points_.reserve(points + 4);
  at_vertex_.reserve(points + 4);
  triangles_.reserve(2 * points + 2);
}

Triangulation::Side Triangulation::side(Index triangle, int k) const {
  const Triangle& t = triangles_[triangle];
  return {t.next[k], (t.constrained >> k & 1) != 0, (t.wall >> k & 1) != 0};
}

void Triangulation::set_side(Index triangle, int k, const Side& s) {
  Triangle& t = triangles_[triangle];
  const unsigned bit = 1u << k;
  t.next[k] = s.next;
  t.constrained = static_cast<std::uint8_t>((t.constrained & ~bit) | (s.constrained ? bit : 0));
  t.wall = static_cast<std::uint8_t>((t.wall & ~bit) | (s.wall ? bit : 0));
}

void Triangulation::set_triangle(Index triangle, const std::array<Index, 3>& v, const std::array<Side, 3>& sides) {
  Triangle& t = triangles_[triangle];
  t.v = v;
  unsigned constrained = 0, wall = 0;
  for (int k = 0; k < 3; ++k) {
    t.next[k] = sides[k].next;
    constrained |= unsigned(sides[k].constrained) << k;
    wall |= unsigned(sides[k].wall) << k;
  }
  t.constrained = static_cast<std::uint8_t>(constrained);
  t.wall = static_cast<std::uint8_t>(wall);
}

// Tells the triangle `outer` that its neighbour `from` is now `to`.
void Triangulation::join(Index outer, Index from, Index to) {
  if (outer == kNone || from == to) return;
  Triangle& t = triangles_[outer];
  t.next[index_of(t.next, from)] = to;
}

// Coordinates so close to 0 that products of four would have no exact double.
Vec2 Triangulation::without_dust(const Vec2& p) const {
  return {std::abs(p.x) < smallest_ ? 0.0 : p.x, std::abs(p.y) < smallest_ ? 0.0 : p.y};
}

// A walk: cross any edge that has p on its far side. Which edge is asked first is as good as random, so that the walk cannot go round in
// circles where the triangulation is not Delaunay [Devillers, Pion and Teillaud 2001]; the same p takes the same walk.
Triangulation::Location Triangulation::locate_from(const Vec2& point, Index triangle) const {
  const Vec2 p = without_dust(point);
  Location at{triangle, Place::Inside, 0, 0};
  std::uint32_t random = 1;
  for (Index last = kNone;; ++at.steps) {
    const Triangle& t = triangles_[at.triangle];
    random = random * 1664525u + 1013904223u;
    int k = static_cast<int>((std::uint64_t(random) * 3) >> 32), on = 0, tested = 0;
    for (; tested < 3; ++tested, k = kAfter[k]) {
      if (last != kNone && t.next[k] == last) continue;
      const int o = orientation(points_[t.v[kAfter[k]]], points_[t.v[kBefore[k]]], p);
      if (o < 0) break;
      if (o == 0) on |= 1 << k;
    }
    if (tested == 3) {
      // On two edges is at the vertex between, which is opposite of the third.
      at.place = on == 0 ? Place::Inside : (on & (on - 1)) == 0 ? Place::Edge : Place::Vertex;
      const int edge = at.place == Place::Vertex ? 7 & ~on : on;
      at.k = edge >> 1;
      return at;
    }
    last = at.triangle;
    at.triangle = t.next[k];
    if (at.triangle == kNone) return {kNone, Place::Outside, 0, at.steps};
  }
}

// Without a hint: from the nearest of the last vertex and of a cube root of all, taken at random [Mucke, Saias and Zhu 1999].
Triangulation::Location Triangulation::locate(const Vec2& p, Index near) const {
  if (near != kNone) return locate_from(p, at_vertex_[near]);
  const std::size_t n = points_.size();
  Index best = static_cast<Index>(n - 1), random = best;
  double least = glm::dot(points_[best] - p, points_[best] - p);
  for (std::size_t i = 1; i * i * i <= n; ++i) {
    random = random * 1664525u + 1013904223u;
    const Index v = static_cast<Index>((std::uint64_t(random) * n) >> 32);
    const double squared = glm::dot(points_[v] - p, points_[v] - p);
    if (squared < least) least = squared, best = v;
  }
  return locate_from(p, at_vertex_[best]);
}

Index Triangulation::insert(const Vec2& p, Index near) {
  const Location at = locate(p, near);
  walk_steps_ += at.steps;
  return insert_at(p, at);
}

Index Triangulation::insert_at(const Vec2& point, const Location& at) {
  const Vec2 p = without_dust(point);
  changed_.clear();
  ISO_CHECK(at.place != Place::Outside);
  if (at.place == Place::Vertex) return triangles_[at.triangle].v[at.k];
  ISO_CHECK(p.x > outer_.lo.x && p.x < outer_.hi.x && p.y > outer_.lo.y && p.y < outer_.hi.y);
  const Index vertex = static_cast<Index>(points_.size());
  points_.push_back(p);
  at_vertex_.push_back(at.triangle);
  if (at.place == Place::Edge)
    split_edge(vertex, at.triangle, at.k);
  else
    split_triangle(vertex, at.triangle);
  settle_around();
  return vertex;
}

// Makes the triangles ids[i] = (p, ring[i], ring[i + 1]) with sides[i] across; unconstrained between each other.
void Triangulation::fan(Index p, std::span<const Index> ids, std::span<const Index> ring, std::span<const Side> sides) {
  const std::size_t n = ids.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t after = i + 1 == n ? 0 : i + 1, before = i == 0 ? n - 1 : i - 1;
    set_triangle(ids[i], {p, ring[i], ring[after]}, {sides[i], Side{ids[after]}, Side{ids[before]}});
    at_vertex_[ring[i]] = ids[i];
    changed_.push_back(ids[i]);
    stack_.push_back(ids[i]);
  }
  at_vertex_[p] = ids[0];
}

void Triangulation::split_triangle(Index p, Index triangle) {
  const Triangle old = triangles_[triangle];
  const Index made = static_cast<Index>(triangles_.size());
  const std::array<Side, 3> sides{side(triangle, 2), side(triangle, 0), side(triangle, 1)};
  triangles_.resize(made + 2, old);
  const std::array<Index, 3> ids{triangle, made, made + 1};
  for (int i = 1; i < 3; ++i) join(sides[i].next, triangle, ids[i]);
  fan(p, ids, old.v, sides);
}

// With the edge b c between (a, b, c) and (d, c, b), the four triangles around p run over the ring a, b, d, c.
void Triangulation::split_edge(Index p, Index triangle, int k) {
  const Triangle t = triangles_[triangle];
  const Side split = side(triangle, k);
  const Index other = split.next;
  ISO_CHECK(other != kNone);
  const Triangle u = triangles_[other];
  const int j = index_of(u.next, triangle);
  const std::array<Index, 4> ring{t.v[k], t.v[kAfter[k]], u.v[j], t.v[kBefore[k]]};
  const std::array<Side, 4> sides{side(triangle, kBefore[k]), side(other, kAfter[j]), side(other, kBefore[j]), side(triangle, kAfter[k])};

  const Index made = static_cast<Index>(triangles_.size());
  triangles_.push_back(u);
  triangles_.push_back(t);
  const std::array<Index, 4> ids{triangle, other, made, made + 1};
  join(sides[2].next, other, made);
  join(sides[3].next, triangle, made + 1);
  fan(p, ids, ring, sides);

  // The halves b p and p c are what the whole was.
  set_side(ids[0], 1, {ids[1], split.constrained, split.wall});
  set_side(ids[1], 2, {ids[0], split.constrained, split.wall});
  set_side(ids[2], 1, {ids[3], split.constrained, split.wall});
  set_side(ids[3], 2, {ids[2], split.constrained, split.wall});
}

// (p, b, c) and (d, c, b) become (p, b, d) and (p, d, c); p = v[k].
void Triangulation::swap(Index triangle, int k) {
  const Index other = triangles_[triangle].next[k];
  const std::array<Index, 3> t = triangles_[triangle].v, u = triangles_[other].v;
  const int j = index_of(triangles_[other].next, triangle);
  const Index p = t[k], b = t[kAfter[k]], c = t[kBefore[k]], d = u[j];
  const Side cp = side(triangle, kAfter[k]), pb = side(triangle, kBefore[k]);
  const Side bd = side(other, kAfter[j]), dc = side(other, kBefore[j]);
  set_triangle(triangle, {p, b, d}, {bd, Side{other}, pb});
  set_triangle(other, {p, d, c}, {dc, cp, Side{triangle}});
  join(bd.next, other, triangle);
  join(cp.next, triangle, other);
  at_vertex_[b] = triangle;
  at_vertex_[c] = other;
  ++swaps_;
}

// Whether the edge opposite of v[k] may be swapped and is not Delaunay. All swaps lower the lifted surface (in truth, not only by
// rounding's account), so swapping ends.
bool Triangulation::wants_swap(Index triangle, int k) const {
  const Triangle& t = triangles_[triangle];
  if ((t.constrained >> k & 1) != 0 || t.next[k] == kNone) return false;
  const Triangle& u = triangles_[t.next[k]];
  const Vec2 &a = points_[t.v[0]], &b = points_[t.v[1]], &c = points_[t.v[2]], &d = points_[u.v[index_of(u.next, triangle)]];
  if (const int side = circle_side_or_doubt(a, b, c, d); side != 0) return side > 0;
  if (!is_needle(a, b, c) && !is_needle(points_[u.v[0]], points_[u.v[1]], points_[u.v[2]])) return false;
  return in_circle(a, b, c, d);
}

// After an insertion: the stack holds the triangles around the new vertex, which is their v[0].
void Triangulation::settle_around() {
  while (!stack_.empty()) {
    const Index t = stack_.back();
    stack_.pop_back();
    if (!wants_swap(t, 0)) continue;
    const Index other = triangles_[t].next[0];
    swap(t, 0);
    changed_.push_back(other);
    stack_.push_back(other);
    stack_.push_back(t);
  }
}

bool Triangulation::convex(Index triangle, int k) const {
  const Triangle& t = triangles_[triangle];
  const Triangle& u = triangles_[t.next[k]];
  const Vec2 &p = points_[t.v[k]], &b = points_[t.v[kAfter[k]]], &c = points_[t.v[kBefore[k]]];
  const Vec2& d = points_[u.v[index_of(u.next, triangle)]];
  return orientation(p, b, d) > 0 && orientation(p, d, c) > 0;
}

bool Triangulation::swap_if_legal(Index triangle, int k) {
  changed_.clear();
  const Side s = side(triangle, k);
  if (s.constrained || s.next == kNone || !convex(triangle, k)) return false;
  swap(triangle, k);
  changed_ = {triangle, s.next};
  return true;
}

void Triangulation::make_delaunay(std::span<const Index> around) {
  stack_.assign(around.begin(), around.end());
  changed_.clear();
  settle();
}

// The stack holds triangles whose edges may not be Delaunay.
void Triangulation::settle() {
  while (!stack_.empty()) {
    const Index t = stack_.back();
    stack_.pop_back();
    for (int k = 0; k < 3; ++k) {
      if (!wants_swap(t, k)) continue;
      const Index other = triangles_[t].next[k];
      swap(t, k);
      for (const Index touched : {t, other}) {
        changed_.push_back(touched);
        stack_.push_back(touched);
      }
      break;
    }
  }
}

}  // namespace iso
