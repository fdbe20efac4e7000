// How smoothly the faces of a part meet: along every edge that two of them share, the gap, the jump of the normal and the jump of the
// curvature. Measured at samples and climbed to where it is worst, not proven: what lies between samples may be larger.
//
// Edges are those of Boundary (boundary.h): shared by the file, or joined there because they run along each other, in whole or in part;
// seams, where a face meets itself, are edges too. At a place of the border of the edge's first face, with the nearest place of the other's
// border beside it:
//
//   gap        the distance between the two, world units. Not between equal parameters; and open along the surface counts as well.
//   off        the distance from that place to the other's surface, by Newton steps, however that is trimmed; world units, never more.
//   normal     the angle between the tangent planes, radians: pi less the angle at which the faces leave the edge, so that smooth is 0 and
//              a fold back onto itself pi. It comes from the sides of their borders on which the faces lie (face_side.h); which way their
//              normals look is of no account.
//   curvature  |kA - kB|, per world unit: the normal curvatures of the faces in the tangent direction square to the edge, with one normal
//              carried through it. Where the tangent planes agree along a smooth edge, the faces join with continuous curvature (G2) there
//              if and only if it is 0 [Pegna and Wolter 1992, Geometrical criteria to guarantee curvature continuity of blend surfaces,
//              J. Mechanical Design 114, the linkage curve theorem]. Across a sharp edge it says little.
//
// Derivatives are exact; at knots they are those of the piece inside each face.
#pragma once

#include <array>
#include <vector>

#include "tess/boundary.h"

namespace iso {

enum class Measure { gap, off, normal, curvature };
inline constexpr std::array<const char*, 4> kMeasureNames{"gap", "off", "normal", "curvature"};

enum class EdgeKind { shared, seam, free, non_manifold, degenerate };
inline constexpr std::array<const char*, 5> kEdgeKindNames{"shared", "seam", "free", "non-manifold", "degenerate"};

// One measure along an edge; NaN where it is not known anywhere.
struct Jump {
  double max = std::nan("");
  double rms = std::nan("");  // over the length of the edge, from the samples
  double share = 0;           // where the maximum is: of the edge's first use,
  UV uv{0.0};                 // in the parameters of its face,
  Point3 place{0.0};          // and in the coordinates of the part

  bool known() const { return max == max; }
};

// A place that was measured on the way; NaN where a measure is not known.
struct ContinuitySample {
  double share = 0;
  Point3 place{0.0};
  std::array<double, 4> value{std::nan(""), std::nan(""), std::nan(""), std::nan("")};  // by Measure
};

struct EdgeContinuity {
  // A face along the edge, and the part of its trim curve, from the edge's first end to its second.
  struct Side {
    int face = 0;
    int part_edge = -1;  // index into Part::edges, -1 for the sides of a domain
    double from = 0, to = 0;
  };
  EdgeKind kind = EdgeKind::free;
  std::vector<Side> sides;      // as many as uses; a seam has its face twice
  bool sewn = false;            // the file does not share it: found by where it runs
  bool misoriented = false;     // the faces' outward normals look to different sides of the surface that goes on through the edge
  double length = 0;            // about
  int evaluations = 0;          // places that were measured, those of climbing included
  std::array<Jump, 4> jumps{};  // by Measure. Of non-manifold edges only gap and off are known, the largest from the first use to any
                                // other; of free and degenerate ones nothing
  std::vector<ContinuitySample> samples;  // at even shares of the first use, both ends included; none on degenerate edges

  const Jump& operator[](Measure m) const { return jumps[static_cast<std::size_t>(m)]; }
};

struct Continuity {
  std::vector<EdgeContinuity> edges;  // those of the boundary, in its order
  JoinReport joins;
  int copies = 0;  // faces that repeat others (copied_faces.h) and were left out
};

struct ContinuityOptions {
  double sew = 0;          // world units: see join_edges; negative: only what the file shares
  int least_samples = 33;  // of an edge; 2 or more
};

// Each edge has `least_samples` places, more where its curves or surfaces have many spans (edge_match.h, trace), at most kMostTraced; the
// highest kClimbed of the local maxima of each measure among them are climbed by golden section [Kiefer 1953], kClimbSteps places each.
// Places where a face's first derivatives vanish or run along each other (poles) have no curvature, and a normal only if all places of the
// edge are such. Deterministic, for any number of threads.
Continuity measure_continuity(const Part& part, const ContinuityOptions& options = {});

inline constexpr int kClimbed = 2, kClimbSteps = 24;

}  // namespace iso
