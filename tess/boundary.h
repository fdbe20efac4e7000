// The boundaries of a part's faces as the tessellator walks them: every face has loops of uses, every use runs along an edge, every edge
// runs between two vertices. Edges that faces have in common without the file saying so are joined first (join_edges.h). Faces without
// loops get the sides of their domain as edges of their own; sides that meet (seams) are one edge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "patches/brep.h"
#include "tess/join_edges.h"

namespace iso {

// An edge as one face sees it. A place on the edge is its share s in [0, 1] from its first end to its second.
struct EdgeUse {
  int face = 0;
  int edge = 0;  // of Boundary
  TrimCurve curve;
  bool forward = true;            // the loop runs from the first end to the second
  bool shares_parameter = true;   // share and parameter run alike for all uses; else places are matched by distance
  std::vector<double> matched{};  // without that, if known: own shares at even shares of the edge's first use, rising from 0 to 1
};

struct BoundaryEdge {
  std::vector<int> uses;        // of Boundary
  std::array<int, 2> vertex{};  // of its ends; equal on closed edges
  int part_edge = -1;           // index into Part::edges, -1 for sides of a domain and pieces without an edge
  bool degenerate = false;      // a point in space
};

struct Boundary {
  std::vector<EdgeUse> uses;
  std::vector<BoundaryEdge> edges;
  int vertex_count = 0;
  std::vector<std::vector<std::vector<int>>> loops;  // uses of each loop of each face, end to end

  JoinReport joins;

  // `sew`: see join_edges. Faces whose `copy_of` is not negative are left out: they have no loops.
  explicit Boundary(const Part& part, double sew = 0, const std::vector<int>& copy_of = {});
};

// The parameter of the use's curve at a share of its range, in the edge's direction.
double parameter_at(const EdgeUse& use, double share);

// The place in (u, v) at that share.
UV uv_at(const EdgeUse& use, double share);

// The part of a use between two shares.
EdgeUse part_of(const EdgeUse& use, double a, double b);

// The share of the use whose place is nearest to p, downhill from the share `from`, within [lo, hi].
double slide_share(const Face& face, const EdgeUse& use, const Point3& p, double from, double lo, double hi);

// The use's own share for the place p, at that share of the edge's first use; for uses that do not share the parameter.
double own_share(const Face& face, const EdgeUse& use, const Point3& p, double share);

// The way back: the share of the edge's first use for the place p, at the share `own` of the use.
double first_share(const Face& face, const EdgeUse& first, const EdgeUse& use, const Point3& p, double own);

}  // namespace iso
