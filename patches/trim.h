// The trimmed region of a face: which points of its parameter plane belong to it.
//
// The loops become monotone rational Bezier pieces (exact for every pcurve kind), clipped to the cells of a grid. A cell without pieces is
// inside or outside as a whole. In a crossing cell a query walks from the cell's lower left corner, whose side is stored, up the left edge
// and then right to the query point, and counts the pieces it crosses (even-odd rule). Clipped ends are snapped to the grid lines and
// shared by neighbours, and intervals are half open, so the count is consistent to the last bit wherever curves meet grid lines. A clip
// knows how far its curve strays from its chord: beside that band one product of differences tells its side, and no curve is evaluated.
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
  bool polynomial = true;  // all weights are one
  double tolerance = 0;    // world units; points this near to the piece count as inside
  Box2 box;
  Box2 near_box;    // holds all points that the tolerance can let in
  Vec2 reach{0.0};  // nor can it let in a point farther than this, in u or in v, from all points of the piece
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

  // A box of the parameter plane, grown on all sides by what the tolerances let in beyond the loops, at most a hundredth of its width:
  // where an edge lies on the border of its surface, the surface must go on that far for the gap to be closed.
  Box2 grown(const Box2& domain) const;

  // How much more than its tolerance an edge lets in for a ray that grazes the surface.
  static constexpr double kMostStretch = 8;

  // The periods of the face's surface (0: none).
  const Vec2& period() const { return period_; }
  std::size_t piece_count() const { return pieces_.size(); }
  std::size_t bytes() const;

 private:
  // The part of a piece within one cell, run through upward.
  struct alignas(64) Clip {
    UV p0{0.0}, p1{0.0};    // its ends, snapped to the cell's borders; p0.y <= p1.y
    double t0 = 0, t1 = 0;  // along the piece; t0 > t1 where the piece falls
    float lo = 0, hi = 0;   // of `across` on the curve and what rounding adds
    std::uint32_t piece = 0;
    std::uint8_t enters0 = 0, enters1 = 0;  // whether p0, p1 lie on the left edge of the cell, above its corner

    // Twice the area of the triangle p0, p1, p; it grows with u.
    double across(UV p) const { return (p.x - p0.x) * (p1.y - p0.y) - (p.y - p0.y) * (p1.x - p0.x); }
  };
  // What is known of a cell in two bytes, apart from the lists of the crossing ones: most queries read nothing else.
  struct CellState {
    Kind kind = Kind::outside;
    bool corner_inside = false;  // just left of and just above the lower left corner
  };
  struct CellLists {
    std::uint32_t clips_begin = 0, near_begin = 0;
  };
  struct CellParts;

  void add_curve(const TrimCurve& curve, const TrimPiece& like, std::vector<UV>& ends);
  void add_segment(const UV& from, const UV& to, const TrimPiece& like);
  void add_monotone(const std::vector<Vec3>& points, const TrimPiece& like);
  void make_grid(const AnySurface& surface);
  void fill_cells();
  double crossing(const TrimPiece& piece, int c, double line, const UV& start, const UV& end) const;
  void cut_at_grid(std::uint32_t piece, CellParts& parts) const;
  void bound_clip(Clip& clip) const;
  double distance_in_world(UV uv, const TrimPiece& piece, const Jet2& metric, double t0 = 0, double t1 = 1) const;
  bool crosses_in_band(const Clip& clip, UV uv) const;
  bool comes_near(const Clip& clip, const TrimPiece& piece, UV uv) const;
  bool within(const Clip& clip, const TrimPiece& piece, UV uv, const Jet2& metric, double most) const;
  bool let_in(const CellLists& lists, const CellLists& next, UV uv, const AnySurface& surface, const Vec3& direction) const;
  Answer contains_here(UV uv, const AnySurface& surface, const Vec3& direction) const;
  Answer contains_shifted(UV uv, Answer best, const AnySurface& surface, const Vec3& direction) const;
  int column(double u) const;
  int row(double v) const;
  Vec2 point_at(const TrimPiece& piece, double t) const;

  std::vector<TrimPiece> pieces_;
  std::vector<Vec3> points_;
  std::vector<Clip> clips_;
  std::vector<std::uint32_t> near_;  // clips whose tolerance reaches into the cell
  std::vector<CellState> states_;    // row-major
  std::vector<CellLists> lists_;     // the same, one extra at the end for the list ends
  Box2 box_;                         // of the grid
  Box2 loops_box_;
  Box2 reach_box_;  // of the loops and their tolerances
  Vec2 step_{0.0}, per_step_{0.0}, period_{0.0};
  int columns_ = 0, rows_ = 0;
};

}  // namespace iso
