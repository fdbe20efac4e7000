// The trimmed region of a face: which points of its parameter plane belong to it.
//
// The loops become monotone rational Bezier pieces (exact for every pcurve kind), clipped to the cells of a grid. A cell without pieces is
// inside or outside as a whole. In a crossing cell a query walks from the cell's lower left corner, whose side is stored, up the left edge
// and then right to the query point, and counts the pieces it crosses (even-odd rule). Clipped ends are snapped to the grid lines and
// shared by neighbours, and intervals are half open, so the count is consistent to the last bit wherever curves meet grid lines.
//
// A point outside but within `Edge::closing` of an edge belongs to the face too: it closes the gap that is measured between the two faces
// of that edge, and no more, so that loose files get neither cracks nor fins.
#pragma once

#include <cstdint>
#include <vector>

#include "patches/brep.h"

namespace iso {

// A piece of a trim curve, monotone in u and in v; `first` indexes `points` (homogeneous, degree + 1 of them).
struct TrimPiece {
  std::uint32_t first = 0;
  std::int32_t degree = 1;
  std::int32_t edge = -1;
  double tolerance = 0;  // world units; points this near to the piece count as inside
  Box2 box;
  Box2 near_box;  // holds all points that the tolerance can let in
};

class TrimRegion {
 public:
  enum class Kind : std::uint8_t { outside, inside, crossing };

  // A face without loops: everything inside its domain.
  TrimRegion() = default;

  // `least_tolerance`: world units, closes what rounding leaves between faces (a small multiple of the part's size times epsilon).
  TrimRegion(const Face& face, const std::vector<Edge>& edges, double least_tolerance);

  bool untrimmed() const { return pieces_.empty(); }

  // What is known of all points of a box; `crossing` when in doubt.
  Kind classify(const Box2& uv) const;

  // uv may be off by whole periods of the surface, which gives the metric for the tolerance. `direction`: of the ray that asks, zero if
  // none. A ray that grazes the surface could slip between two sheets that lie a gap apart, so for it the tolerance grows by the inverse of
  // the cosine, up to kMostStretch times.
  struct Answer {
    bool inside = true;
    bool by_tolerance = false;
  };
  Answer contains(UV uv, const AnySurface& surface, const Vec3& direction = Vec3(0.0)) const;

  // World distance of S(uv) from the nearest piece that belongs to an edge of Part::edges; infinite if the face has no such piece.
  double distance_to_edge(UV uv, int edge, const AnySurface& surface) const;

  // The boxes of all cells that are not outside: a cover of the face in the parameter plane.
  std::vector<Box2> cover() const;

  // Points of the parameter plane whose hull holds the face (the control points of its loops).
  std::vector<UV> hull() const;

  // The largest tolerance of a piece, stretched as far as it may be: the face ends at most this far beyond its loops.
  double largest_reach() const;

  // How much more than its tolerance an edge lets in for a ray that grazes the surface.
  static constexpr double kMostStretch = 8;

  // The periods of the face's surface (0: none).
  const Vec2& period() const { return period_; }
  std::size_t piece_count() const { return pieces_.size(); }
  std::size_t bytes() const;

 private:
  struct Clip {
    std::uint32_t piece;
    double t0, t1;  // along the piece
    UV p0, p1;      // its points at t0 and t1, snapped to the cell's borders
  };
  struct Cell {
    std::uint32_t clips_begin = 0, near_begin = 0;
    Kind kind = Kind::outside;
    bool corner_inside = false;  // just left of and just above the lower left corner
  };

  void add_curve(const TrimCurve& curve, const TrimPiece& like, std::vector<UV>& ends);
  void add_segment(const UV& from, const UV& to, const TrimPiece& like);
  void add_monotone(const std::vector<Vec3>& points, const TrimPiece& like);
  void make_grid(const AnySurface& surface);
  void fill_cells();
  double distance_in_world(UV uv, const TrimPiece& piece, const Jet2& metric) const;
  bool crosses_left_of(const Clip& clip, UV uv) const;
  Answer contains_here(UV uv, const AnySurface& surface, const Vec3& direction) const;
  int column(double u) const;
  int row(double v) const;
  Vec2 point_at(const TrimPiece& piece, double t) const;

  std::vector<TrimPiece> pieces_;
  std::vector<Vec3> points_;
  std::vector<Clip> clips_;
  std::vector<std::uint32_t> near_;
  std::vector<Cell> cells_;  // row-major, one extra at the end for the list ends
  Box2 box_;                 // of the grid
  Box2 loops_box_;
  Box2 reach_box_;  // of the loops and their tolerances
  Vec2 step_{0.0}, period_{0.0};
  int columns_ = 0, rows_ = 0;
};

}  // namespace iso
