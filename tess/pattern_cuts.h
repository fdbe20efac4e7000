// The triangles of a pattern, cut where they pass from one chart of the polygon to the next: along the spokes, from the middles of the
// sides to the centre. It depends on the pattern only.
#pragma once

#include "tess/multisided.h"

namespace iso {

struct PatternCuts {
  // Where a spoke crosses an edge, or the centre of the polygon; numbered after the pattern's points.
  struct Point {
    ChartPlace place;
    std::array<std::uint32_t, 3> between{};  // points of the pattern: the edge, the smaller first, or the triangle around the centre
    Vec3 weights{0.0};                       // of those; of an edge the third is 0
    bool on_side = false;                    // the middle of a side
  };
  std::vector<Point> points;
  // A part of a triangle, counter-clockwise.
  struct Piece {
    std::uint32_t triangle = 0;
    int corner = 0;  // of its chart
    std::array<std::uint32_t, 3> points{};
    std::array<Vec2, 3> st{};  // their places in that chart
    bool whole = false;        // all of the triangle
  };
  std::vector<Piece> pieces;  // in the order of triangles
  std::vector<int> home;      // of each triangle: the chart that holds its middle
};

PatternCuts cut_by_charts(const DomainPattern& pattern);

}  // namespace iso
