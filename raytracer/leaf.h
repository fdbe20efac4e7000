// What the tracer keeps of a face: 64-byte leaves over its Bezier patches, or the closed-form surface itself.
//
// A leaf holds the linear model of its cell in float, with proven bounds on the strays of the derivatives: enough to tell almost every ray
// that misses, to start Newton next to the root, and to know when that root is the only one (see bezier_solve.h). The nets stand once per
// patch.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "patches/cells.h"

namespace iso {

struct Leaf {
  float centre[3];
  float A[3], B[3];        // dS/da, dS/db at the centre; the cell is |a|, |b| <= 1
  float stray_a, stray_b;  // |dS/da - A| <= stray_a and |dS/db - B| <= stray_b over the cell; the rounding of this record is included
  float spare;             // fills the cache line
  std::uint32_t patch;     // index into PartGeometry::patches
  std::uint32_t corner;    // lower corner of the dyadic box: s in the high, t in the low 16 bits, in units of 2^-12
  std::uint16_t size[2];   // extent of the box in the same unit
  std::uint32_t crossing;  // 1: hits must be tested against the trim loops
};
static_assert(sizeof(Leaf) == 64);

struct LeafPatch {
  BezierPiece piece;
  std::uint32_t face = 0;
};

// A face met in closed form: plane, cylinder, cone or sphere.
struct AnalyticFace {
  std::uint32_t face = 0;
  Box3 box;
};

struct PartGeometry {
  const Part* part = nullptr;
  std::vector<TrimRegion> trims;  // per face
  std::vector<LeafPatch> patches;
  std::vector<Leaf> leaves;
  std::vector<Box3> leaf_boxes;  // outward; only while the acceleration structure is built
  std::vector<AnalyticFace> analytic;
  Box3 box;
  double size = 0;         // diagonal of the box
  double largest_gap = 0;  // largest Edge::closing

  std::size_t bytes() const;
};

// Divides all faces. Boxes are inflated for the float rounding of rays that start on the part's box.
PartGeometry make_geometry(const Part& part);

// Smallest trim tolerance, as a share of the part's size: closes what rounding leaves between two faces that share an edge.
inline constexpr double kTrimRounding = 1e-12;

}  // namespace iso
