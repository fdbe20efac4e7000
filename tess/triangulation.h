// Constrained Delaunay triangulation in the plane [Lawson 1972; Vigo Anglada and Pla Garcia 2000; Safko 2022, 4.3], built point by point:
// each insertion splits a triangle or an edge and swaps edges until the neighbourhood is Delaunay again; constrained edges are never
// swapped. Orientation is decided exactly, so the triangles never overlap and never fold, whatever the input.
//
// Points are doubles; callers scale them so that the plane's metric suits the mesh they want. All points must lie in the box given at the
// start. Equal points are one vertex. The four corners of a larger box are vertices 0..3 and are part of the triangulation.
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

  struct Triangle {
    std::array<std::uint32_t, 3> v{};                        // counter-clockwise
    std::array<std::uint32_t, 3> next{kNone, kNone, kNone};  // neighbour across the edge opposite of v[k]
    std::uint8_t constrained = 0;                            // bit k: the edge opposite of v[k]
    bool inside = false;                                     // set by mark_inside
  };

  explicit Triangulation(const Box2& box);

  // Adds a point and gives its vertex; the old vertex if there is one at p. `near`: any vertex close by, makes the search short.
  // A point on a constrained edge splits it into two constrained edges.
  std::uint32_t insert(const Vec2& p, std::uint32_t near = kNone);

  // Makes the segment from a to b an edge that no swap removes. It goes through vertices that lie exactly on it. Where it would cross a
  // constrained edge nothing is changed and that edge is returned as its two vertices.
  std::optional<std::array<std::uint32_t, 2>> constrain(std::uint32_t a, std::uint32_t b);

  // Marks the triangles inside the constrained loops: those separated from the outer box by an odd number of constrained edges. An edge
  // constrained twice (a seam run through both ways) counts as none if `constrain` was called for it an even number of times.
  void mark_inside();

  // Swaps unconstrained edges until all are Delaunay (already so after `insert` and `constrain`); for use after a change from outside.
  std::span<const Triangle> triangles() const { return triangles_; }
  std::span<const Vec2> points() const { return points_; }

 private:
  std::vector<Vec2> points_;
  std::vector<Triangle> triangles_;
};

}  // namespace iso
