// Constrained Delaunay triangulation in the plane [Lawson 1977; Sloan 1993; Safko 2022, 4.3], built point by point: each insertion splits
// a triangle or an edge and swaps edges until the neighbourhood is Delaunay again; constrained edges are never swapped. Orientation is
// decided exactly, so the triangles never overlap and never fold, whatever the input.
//
// Edges are swapped where floating point is sure that they are not Delaunay, so grids, whose points lie on common circles, cost no exact
// arithmetic, and a circle may hold a point by a few roundings. Where a triangle is a needle as thin as rounding the exact test decides, so
// that no sliver stays that a swap could remove.
//
// A point costs a constant number of steps and swaps if points come in an order like Hilbert's curve; a grid inserted row by row costs
// about the square root of a row's length, because each point sees that much of the row before.
//
// Points are doubles; callers scale them so that the plane's metric suits the mesh they want. All points must lie in the box given at the
// start (checked). Equal points are one vertex. The four corners of a larger box are vertices 0..3 and are part of the triangulation.
// Same calls, same triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

class Triangulation {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr int kAfter[3] = {1, 2, 0}, kBefore[3] = {2, 0, 1};  // the indices that follow and precede k

  struct alignas(32) Triangle {
    std::array<std::uint32_t, 3> v{};                        // counter-clockwise
    std::array<std::uint32_t, 3> next{kNone, kNone, kNone};  // neighbour across the edge opposite of v[k]
    std::uint8_t constrained = 0;                            // bit k: the edge opposite of v[k] is never swapped
    std::uint8_t wall = 0;                                   // bit k: that edge was constrained an odd number of times
    bool inside = false;                                     // set by mark_inside
  };

  // The index of the vertex or neighbour `one` among the three; it must be there.
  static int index_of(const std::array<std::uint32_t, 3>& all, std::uint32_t one) { return all[0] == one ? 0 : all[1] == one ? 1 : 2; }

  // Where a point lies: strictly inside a triangle, on its edge opposite of v[k], at its vertex v[k], or outside of the larger box.
  enum class Place : std::uint8_t { Inside, Edge, Vertex, Outside };
  struct Location {
    std::uint32_t triangle = kNone;
    Place place = Place::Outside;
    int k = 0;
    std::uint32_t steps = 0;  // triangles that the search left behind
  };

  // A finite box of magnitude 1e-28 to 1e70; it may have no width. Coordinates below 2^-120 of its magnitude are taken as 0.
  explicit Triangulation(const Box2& box);
  void reserve(std::size_t points);

  // Adds a point and gives its vertex; the old vertex if there is one at p. `near`: any vertex close by, makes the search short; without
  // it the search starts at the best of a few. A point on a constrained edge splits it into two constrained edges. Allowed at any time;
  // triangles inherit `inside` from the triangle that is split.
  std::uint32_t insert(const Vec2& p, std::uint32_t near = kNone);

  // insert in two steps, for callers that look before they add, e.g. refuse a vertex that exists: `at` is what locate gave for the same p,
  // with no change since.
  Location locate(const Vec2& p, std::uint32_t near = kNone) const;
  Location locate_from(const Vec2& p, std::uint32_t triangle) const;
  std::uint32_t insert_at(const Vec2& p, const Location& at);

  // Makes the segment from a to b an edge that no swap removes. It goes through vertices that lie exactly on it. Where it would cross a
  // constrained edge nothing is changed and that edge is returned as its two vertices.
  std::optional<std::array<std::uint32_t, 2>> constrain(std::uint32_t a, std::uint32_t b);

  // Marks the triangles inside the constrained loops: those separated from the outer box by an odd number of walls. An edge constrained
  // twice (a seam run through both ways) is no wall, but is still not swapped. Constraints that close no loop separate nothing.
  void mark_inside();

  // Swaps the edge opposite of v[k] if the two triangles form a strictly convex quadrilateral and the edge is not constrained, whether or
  // not it is Delaunay. With triangles (p, b, c) and (d, c, b) these then are (p, b, d) and (p, d, c), in the old places and in this order.
  bool swap_if_legal(std::uint32_t triangle, int k);

  // Restores the Delaunay property (constrained edges excepted) after such swaps, around these triangles and as far as it takes.
  void make_delaunay(std::span<const std::uint32_t> around);

  // The triangles that the last insert, constrain, swap_if_legal or make_delaunay made or changed, unsorted; some may repeat. Empty if
  // nothing happened, e.g. when insert met an old vertex.
  std::span<const std::uint32_t> changed() const { return changed_; }

  std::span<const Triangle> triangles() const { return triangles_; }
  std::span<const Vec2> points() const { return points_; }
  std::uint32_t triangle_at(std::uint32_t vertex) const { return at_vertex_[vertex]; }  // one of those around it
  std::uint64_t walk_steps() const { return walk_steps_; }                              // of all searches of insert so far
  std::uint64_t swaps() const { return swaps_; }

 private:
  // What lies across an edge.
  struct Side {
    std::uint32_t next = kNone;
    bool constrained = false, wall = false;
  };
  Side side(std::uint32_t triangle, int k) const;
  void set_side(std::uint32_t triangle, int k, const Side& s);
  void set_triangle(std::uint32_t triangle, const std::array<std::uint32_t, 3>& v, const std::array<Side, 3>& sides);
  void join(std::uint32_t outer, std::uint32_t from, std::uint32_t to);
  void fan(std::uint32_t p, std::span<const std::uint32_t> ids, std::span<const std::uint32_t> ring, std::span<const Side> sides);
  void split_triangle(std::uint32_t p, std::uint32_t triangle);
  void split_edge(std::uint32_t p, std::uint32_t triangle, int k);
  void swap(std::uint32_t triangle, int k);
  bool wants_swap(std::uint32_t triangle, int k) const;
  bool convex(std::uint32_t triangle, int k) const;
  void settle_around();
  void settle();
  Vec2 without_dust(const Vec2& p) const;

  struct Crossing {
    std::uint32_t right, left;   // the crossed edge, seen along the segment
    std::uint32_t near, beyond;  // its two triangles, unless a swap nearby has moved it
  };
  struct EdgeAt {
    std::uint32_t triangle = kNone;
    int k = 0;
  };
  template <class Visit>
  void around(std::uint32_t a, Visit visit) const;
  EdgeAt find_edge(std::uint32_t a, std::uint32_t b) const;
  EdgeAt find_crossing(const Crossing& c) const;
  template <class Visit>
  std::uint32_t follow(std::uint32_t a, std::uint32_t b, Visit visit) const;
  std::optional<std::array<std::uint32_t, 2>> trace(std::uint32_t a, std::uint32_t b);
  void clear_way(std::uint32_t a, std::uint32_t b);
  void constrain_edge(std::uint32_t a, std::uint32_t b);

  Box2 outer_;
  double smallest_ = 0;  // coordinates below are 0
  std::vector<Vec2> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> at_vertex_;  // a triangle of each vertex
  std::uint64_t walk_steps_ = 0, swaps_ = 0;

  // Kept between calls so that they need no memory of their own.
  std::vector<std::uint32_t> changed_, stack_, chain_;
  std::vector<Crossing> crossings_;
};

}  // namespace iso
