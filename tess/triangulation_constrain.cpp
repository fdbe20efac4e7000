// Constraints and what they enclose.
#include <algorithm>

#include "patches/base/check.h"
#include "tess/predicates.h"
#include "tess/triangulation.h"

namespace iso {
namespace {

using Index = std::uint32_t;
int sign(double x) { return (x > 0) - (x < 0); }

// Whether p, on one line with a and b, lies on b's side of a.
bool ahead(const Vec2& a, const Vec2& b, const Vec2& p) { return sign(p.x - a.x) == sign(b.x - a.x) && sign(p.y - a.y) == sign(b.y - a.y); }

}  // namespace

// Visits the triangles around a as (triangle, index of a in it) until `visit` says true; counter-clockwise, and where the outer box's
// border ends that, clockwise from the start.
template <class Visit>
void Triangulation::around(Index a, Visit visit) const {
  const Index start = at_vertex_[a];
  for (const int* turn : {kAfter, kBefore}) {
    Index t = start;
    while (t != kNone) {
      const int k = index_of(triangles_[t].v, a);
      if ((t != start || turn == kAfter) && visit(t, k)) return;
      t = triangles_[t].next[turn[k]];
      if (t == start) return;
    }
  }
}

// The edge between two vertices, from its triangle on the left of a b; that on the right where the border has none on the left.
Triangulation::EdgeAt Triangulation::find_edge(Index a, Index b) const {
  EdgeAt found;
  around(a, [&](Index t, int k) {
    const Triangle& x = triangles_[t];
    if (x.v[kAfter[k]] == b) found = {t, kBefore[k]};
    if (found.triangle == kNone && x.v[kBefore[k]] == b && x.next[kAfter[k]] == kNone) found = {t, kAfter[k]};
    return found.triangle != kNone;
  });
  return found;
}

// Goes from a towards b up to the first vertex on the segment, which is returned. Calls visit(t, k) for each crossed edge, given by the
// triangle before it; it may stop the way by true, the result is then kNone.
template <class Visit>
Index Triangulation::follow(Index a, Index b, Visit visit) const {
  const Vec2 &from = points_[a], &to = points_[b];
  EdgeAt at;
  Index reached = kNone;
  around(a, [&](Index t, int k) {
    const Triangle& x = triangles_[t];
    const Index right = x.v[kAfter[k]], left = x.v[kBefore[k]];
    const int r = orientation(from, to, points_[right]), l = orientation(from, to, points_[left]);
    for (const auto& [v, o] : {std::pair(right, r), std::pair(left, l)})
      if (o == 0 && ahead(from, to, points_[v])) reached = v;
    if (r < 0 && l > 0) at = {t, k};
    return reached != kNone || at.triangle != kNone;
  });
  if (reached != kNone) return reached;
  ISO_CHECK(at.triangle != kNone);
  for (;;) {
    if (visit(at.triangle, at.k)) return kNone;
    const Index beyond = triangles_[at.triangle].next[at.k];
    const Triangle& u = triangles_[beyond];
    const int j = index_of(u.next, at.triangle);
    const int o = orientation(from, to, points_[u.v[j]]);
    if (o == 0) return u.v[j];
    // In u the right end of the crossed edge is v[j - 1], the left one v[j + 1]; the way goes on between the apex and the other side.
    at = {beyond, o > 0 ? kAfter[j] : kBefore[j]};
  }
}

// Collects the vertices on the segment in chain_; or gives the constrained edge in its way.
std::optional<std::array<Index, 2>> Triangulation::trace(Index a, Index b) {
  std::optional<std::array<Index, 2>> wall;
  chain_.assign(1, a);
  while (chain_.back() != b) {
    const Index reached = follow(chain_.back(), b, [&](Index t, int k) {
      const Triangle& x = triangles_[t];
      if ((x.constrained >> k & 1) != 0) wall = {x.v[kAfter[k]], x.v[kBefore[k]]};
      return wall.has_value();
    });
    if (wall) return wall;
    chain_.push_back(reached);
  }
  return std::nullopt;
}

// The edge right-left from one of its triangles: those noted, or else found around a vertex.
Triangulation::EdgeAt Triangulation::find_crossing(const Crossing& c) const {
  for (const Index t : {c.near, c.beyond}) {
    const std::array<Index, 3>& v = triangles_[t].v;
    for (int k = 0; k < 3; ++k) {
      const Index p = v[kAfter[k]], q = v[kBefore[k]];
      if ((p == c.right && q == c.left) || (p == c.left && q == c.right)) return {t, k};
    }
  }
  return find_edge(c.right, c.left);
}

// Swaps the edges that cross the segment a b, which meets no other vertex, until none does. An edge that cannot be swapped yet, or whose
// successor still crosses, goes to the end of the queue [Sloan 1993]; should that order go round in circles, a random one does not.
void Triangulation::clear_way(Index a, Index b) {
  crossings_.clear();
  follow(a, b, [&](Index t, int k) {
    const Triangle& x = triangles_[t];
    crossings_.push_back({x.v[kAfter[k]], x.v[kBefore[k]], t, x.next[k]});
    changed_.push_back(t);
    changed_.push_back(x.next[k]);
    return false;
  });
  const std::size_t patience = 16 * crossings_.size() + 64;
  std::uint32_t random = 1;
  std::size_t tried = 0, first = 0;
  for (; first < crossings_.size(); ++first, ++tried) {
    if (tried > patience) {
      random = random * 1664525u + 1013904223u;
      std::swap(crossings_[first], crossings_[first + ((std::uint64_t(random) * (crossings_.size() - first)) >> 32)]);
    }
    const Crossing c = crossings_[first];
    if (first > 4096 && 2 * first > crossings_.size()) {
      crossings_.erase(crossings_.begin(), crossings_.begin() + static_cast<std::ptrdiff_t>(first));
      first = 0;
    }
    const EdgeAt e = find_crossing(c);
    if (!convex(e.triangle, e.k)) {
      crossings_.push_back({c.right, c.left, e.triangle, triangles_[e.triangle].next[e.k]});
      continue;
    }
    const Index other = triangles_[e.triangle].next[e.k];
    swap(e.triangle, e.k);
    const Index p = triangles_[e.triangle].v[0], d = triangles_[e.triangle].v[2];
    const int at_p = orientation(points_[a], points_[b], points_[p]), at_d = orientation(points_[a], points_[b], points_[d]);
    if (at_p * at_d < 0) crossings_.push_back({at_p < 0 ? p : d, at_p < 0 ? d : p, e.triangle, other});
  }
}

void Triangulation::constrain_edge(Index a, Index b) {
  const EdgeAt e = find_edge(a, b);
  ISO_CHECK(e.triangle != kNone);
  Side s = side(e.triangle, e.k);
  s.constrained = true;
  s.wall = !s.wall;
  set_side(e.triangle, e.k, s);
  changed_.push_back(e.triangle);
  if (s.next == kNone) return;
  const int j = index_of(triangles_[s.next].next, e.triangle);
  set_side(s.next, j, {e.triangle, s.constrained, s.wall});
  changed_.push_back(s.next);
}

std::optional<std::array<Index, 2>> Triangulation::constrain(Index a, Index b) {
  changed_.clear();
  if (const auto wall = trace(a, b)) return wall;
  for (std::size_t i = 0; i + 1 < chain_.size(); ++i) {
    clear_way(chain_[i], chain_[i + 1]);
    constrain_edge(chain_[i], chain_[i + 1]);
  }
  stack_ = changed_;
  settle();
  return std::nullopt;
}

// Level by level: what can be reached from the outer box without crossing a wall, across one wall, and so on.
void Triangulation::mark_inside() {
  std::vector<bool> reached(triangles_.size(), false);
  std::vector<Index> level{at_vertex_[0]}, beyond;
  for (bool inside = false; !level.empty(); inside = !inside, std::swap(level, beyond)) {
    beyond.clear();
    while (!level.empty()) {
      const Index t = level.back();
      level.pop_back();
      if (reached[t]) continue;
      reached[t] = true;
      triangles_[t].inside = inside;
      for (int k = 0; k < 3; ++k) {
        const Side s = side(t, k);
        if (s.next != kNone && !reached[s.next]) (s.wall ? beyond : level).push_back(s.next);
      }
    }
  }
}

}  // namespace iso
