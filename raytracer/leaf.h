// What the tracer keeps of a face: 64-byte leaves over its Bezier patches, or the closed-form surface itself.
//
// A leaf is a slab around a piece of a patch, in the frame dual to the piece's tangents: it tells most rays that miss, and gives the
// parameters at which the rest start Newton. `steep` is the certificate that there is only one root (see leaf_kernel.h). The patches'
// polynomials stand once per patch, in float for the proposal and in double for the polish, as powers about the middle of the unit square.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "patches/cells.h"

namespace iso {

struct Leaf {
  // Rows (x y z offset) of an affine map into the slab, which is [-1, 1]^3: along the piece's two parameters, and along its normal.
  float a[4], b[4], h[4];
  std::uint32_t patch;    // index into PartGeometry::patches
  std::uint32_t corner;   // lower corner of the dyadic box: s in the high, t in the low 16 bits, in units of 2^-12
  std::uint8_t level[2];  // the box is 2^-level[0] by 2^-level[1]
  std::uint8_t crossing;  // 1: hits must be tested against the trim loops
  std::uint8_t spare;
  // A ray (of unit length) that crosses h faster than this has at most one root within kCellMargin of the leaf.
  float steep;
};
static_assert(sizeof(Leaf) == 64);

// FaceCell::curls of a leaf, and how far the surface that it stands for may be from it (PatchChart::error), rounded up; asked for grazing
// rays only.
struct LeafCurls {
  float aa, ab, bb, apart;
};

inline constexpr double kLeafGrid = 4096;  // leaves lie on a dyadic grid of 2^12

struct LeafPatch {
  BezierPiece piece;  // its net is kept only where there are no powers (`bernstein_form`)
  std::uint32_t face = 0;
  std::uint32_t powers = kNoPowers;  // index into PartGeometry::powers and float_powers
  bool rational = false;             // four components (x y z w) a coefficient, else three

  static constexpr std::uint32_t kNoPowers = 0xffffffffu;
};

// A face met in closed form: plane, cylinder, cone or sphere.
enum class AnalyticKind : std::uint8_t { plane, cylinder, cone, sphere };
struct AnalyticFace {
  std::uint32_t face = 0;
  AnalyticKind kind = AnalyticKind::plane;
  Frame frame;
  double radius = 0;                   // of cylinders and spheres
  double k = 0, cosine = 1, apex = 0;  // of cones: tangent and cosine of the half angle, height of the apex
  Box3 box;                            // of the trimmed face
};

struct PartGeometry {
  const Part* part = nullptr;
  std::vector<TrimRegion> trims;  // per face
  std::vector<LeafPatch> patches;
  std::vector<Leaf> leaves;
  std::vector<LeafCurls> curls;  // per leaf
  std::vector<Box3> leaf_boxes;  // outward; only while the acceleration structure is built
  std::vector<AnalyticFace> analytic;
  // Coefficients of (s - 1/2)^i (t - 1/2)^j at (i (pv + 1) + j) times the number of components.
  std::vector<float> float_powers;
  std::vector<double> powers;
  Box3 box;
  double size = 0;         // diagonal of the box
  double largest_gap = 0;  // largest Edge::closing

  std::size_t bytes() const;
};

// The net of a patch for the solver of last resort, from the powers: each coefficient to some units in the last place of the
// largest.
void bernstein_form(const PartGeometry& geometry, const LeafPatch& patch, BezierPatch& net);

// Divides all faces, in parallel. Boxes are inflated for the float rounding of rays that start on the part's box.
PartGeometry make_geometry(const Part& part);

// Smallest trim tolerance, as a share of the part's size: closes what rounding leaves between two faces that share an edge.
inline constexpr double kTrimRounding = 1e-12;

}  // namespace iso
