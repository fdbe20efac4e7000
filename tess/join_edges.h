// Sewing [Safko 2022, 4.3], on curves: edges of faces that share none, though they run along each other, become one edge before anything is
// sampled. So the mesh closes there by construction, as with edges that the file itself shares, and its distance stays proven: what the
// faces' own curves are apart is what FaceReport::offset measures.
//
// Safko sews triangle meshes afterwards, since surfaces may come into contact and out of it anywhere, and must then take care not to
// smooth normals across sharp angles. Here nodes belong to faces and only points are shared: no normal is merged, and no rule is needed.
// What stays open: borders that run together for a part of their length without a vertex of either at the ends of that part.
#pragma once

#include <vector>

#include "patches/brep.h"

namespace iso {

struct Boundary;

// A piece of border that no other face's border meets.
struct OpenBorder {
  int face = -1;
  int part_edge = -1;  // index into Part::edges, -1 for sides of a domain
  int edge = -1;       // index into Boundary::edges
  Point3 from{0.0}, to{0.0};
  double length = 0;  // about
  double width = 0;   // largest distance to the nearest other open border, as far as looked (JoinReport::looked); else infinite
};

struct JoinReport {
  int free_edges = 0;    // used once, points left out, before joining
  int joined = 0;        // pairs of edges, or pieces of them, that became one
  int split = 0;         // places where edges were split, for a vertex of others lies there
  int collapsed = 0;     // edges shorter than the tolerance that became points: their ends are one vertex, or move farther than that
  double tolerance = 0;  // world units: the largest used
  double widest = 0;     // largest distance between curves that were joined
  double looked = 0;     // how far from open borders others were looked for
  std::vector<OpenBorder> open;  // in the order of faces
};

// Joins the free edges (one use, no point in space) of a boundary whose vertices are not numbered yet. Edges are the same if their ends and
// all places between lie within the tolerance of each other: the largest that the file states for any free edge (never less than
// kSameBorder, never more than kMostStated, of the part's size), or `sew` if that is more; negative: nothing is joined. The distance
// allowed grows in rounds up to the tolerance, so that what lies near is joined before what lies far, and of several an edge takes the
// nearest, of equally near ones one that runs against it, of those one that needs no split; each takes one partner only (where the file
// does not share it, a third sheet stays open), and none of another solid. An end of one edge within the tolerance of the interior of
// another splits it, where that helps. Last, edges with the same ends may be farther apart between them, by 1e-4 of the part's size and
// 1e-3 of their length: hammer.iges has ends that agree within 2e-10, and 4.5e-5 between. The order of faces and edges does not matter.
// Deterministic; about n log n in the number of free edges.
//
// Why not each edge's own tolerance: readers state it of an edge's curves on its own face. With each edge's own, 30 of 208 edges of
// hammer.iges stay open; with the largest 4, which are the ones with those gaps.
JoinReport join_edges(const Part& part, Boundary& boundary, double sew);

inline constexpr double kSameBorder = 1e-9;  // rounding of curves and surfaces that are meant to be equal
inline constexpr double kMostStated = 1e-4;  // larger statements are not believed

}  // namespace iso
