// Whether two edges of faces that do not know each other run along one curve in space, and which places on them belong together.
#pragma once

#include <optional>
#include <vector>

#include "tess/boundary.h"

namespace iso {

// Parts into which a piece is divided, evenly in its parameter, to be compared: at least kTraced, and kTracedOfSpan for each span of the
// curve and of the surface, in which it may turn anywhere; never more than kMostTraced.
inline constexpr int kTraced = 32, kTracedOfSpan = 4, kMostTraced = 1024;

// The part [a, b] of a use's shares, with places on it.
struct EdgePiece {
  const Face* face = nullptr;
  int origin = -1;            // the use, of Boundary
  double a = 0, b = 1;        // shares of it
  EdgeUse use;                // that part as a use of its own
  std::vector<Point3> at;     // places at even shares, both ends included
  std::vector<double> along;  // length of the polyline through them up to each
  double sag = 0;             // about how far the curve strays from that polyline
  Box3 box;                   // of the polyline, inflated by `sag`

  double length() const { return along.back(); }
};

EdgePiece trace(const Part& part, const std::vector<EdgeUse>& uses, int use, double a, double b);

struct NearPlace {
  double share = 0, distance = kInf;
};

// The place of the piece nearest to p, looked for where the polyline is nearest, among lengths between those shares of the whole length;
// distance infinite if the polyline is farther than `within` beyond the sag.
NearPlace nearest_place(const EdgePiece& piece, const Point3& p, double within, double from_length = 0, double to_length = 1);

struct EdgeMatch {
  bool reversed = false;       // the first end of one belongs to the second end of the other
  double apart = 0;            // largest distance measured
  bool even = false;           // equal shares are as near as the nearest places
  std::vector<double> shares;  // of the second piece, in the direction of the first, at the first's even shares; rising from 0 to 1
};

struct MatchPolicy {
  double ends = 0;     // world units: allowed between ends, twice, for each may have been set by a neighbour's
  double between = 0;  // and between the curves
};

// The match of two pieces that lie within the policy's distances of each other all along; none for edges of a few tolerances only. Measured
// at the first piece's places: what lies between them counts into FaceReport::offset, whatever it is.
std::optional<EdgeMatch> match(const EdgePiece& first, const EdgePiece& second, const MatchPolicy& policy);

}  // namespace iso
