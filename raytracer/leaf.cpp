#include "raytracer/leaf.h"

namespace iso {

namespace {

// Boxes are larger than the geometry by this share of the part's size.
constexpr double kBoxInflation = 1e-6;

constexpr double kGridUnits = 4096;  // leaves lie on a dyadic grid of 2^12

void store(const Vec3& from, float to[3]) {
  for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(from[c]);
}

Leaf make_leaf(const FaceCell& cell, std::uint32_t patch) {
  Leaf leaf{};
  store(cell.centre, leaf.centre);
  store(cell.A, leaf.A);
  store(cell.B, leaf.B);
  const double rounding = 1e-6 * (glm::length(cell.A) + glm::length(cell.B));
  leaf.stray_a = static_cast<float>(1.000001 * (cell.stray_a + rounding));
  leaf.stray_b = static_cast<float>(1.000001 * (cell.stray_b + rounding));
  leaf.patch = patch;
  const Vec2 lo = cell.lo * kGridUnits, width = (cell.hi - cell.lo) * kGridUnits;
  leaf.corner = (static_cast<std::uint32_t>(lo.x) << 16) | static_cast<std::uint32_t>(lo.y);
  leaf.size[0] = static_cast<std::uint16_t>(width.x);
  leaf.size[1] = static_cast<std::uint16_t>(width.y);
  leaf.crossing = cell.kind == TrimRegion::Kind::crossing ? 1 : 0;
  return leaf;
}

// What the tracer meets in closed form (analytic_solve.h).
bool met_in_closed_form(const AnySurface& s) {
  return std::holds_alternative<Plane>(s) || std::holds_alternative<Cylinder>(s) || std::holds_alternative<Cone>(s) ||
         std::holds_alternative<Sphere>(s);
}

void add_analytic(PartGeometry& geometry, std::uint32_t index, const Face& face, const TrimRegion& trim) {
  const Box3 box = trimmed_box(face, trim).inflated(trim.largest_reach());
  if (!box.empty()) geometry.analytic.push_back({index, box});
}

void add_patches(PartGeometry& geometry, std::uint32_t index, const Face& face, const TrimRegion& trim, double part_size) {
  CellPolicy policy;
  policy.small = 1e-3 * part_size;
  std::vector<FaceCell> cells;
  for (BezierPiece& piece : bezier_pieces(face.surface, face.domain)) {
    const std::uint32_t patch = static_cast<std::uint32_t>(geometry.patches.size());
    cells.clear();
    divide(piece, 0, trim, policy, cells);
    if (cells.empty()) continue;
    for (const FaceCell& cell : cells) {
      geometry.leaves.push_back(make_leaf(cell, patch));
      geometry.leaf_boxes.push_back(cell.box);
    }
    geometry.patches.push_back({std::move(piece), index});
  }
}

}  // namespace

PartGeometry make_geometry(const Part& part) {
  PartGeometry geometry;
  geometry.part = &part;
  const double size = part.box.diagonal();
  for (const Edge& edge : part.edges) geometry.largest_gap = std::max(geometry.largest_gap, edge.closing);
  for (std::uint32_t i = 0; i < part.faces.size(); ++i) {
    const Face& face = part.faces[i];
    geometry.trims.emplace_back(face, part.edges, kTrimRounding * size);
    if (met_in_closed_form(face.surface))
      add_analytic(geometry, i, face, geometry.trims.back());
    else
      add_patches(geometry, i, face, geometry.trims.back(), size);
  }
  for (const Box3& box : geometry.leaf_boxes) geometry.box.include(box);
  for (const AnalyticFace& face : geometry.analytic) geometry.box.include(face.box);
  geometry.size = geometry.box.diagonal();
  for (Box3& box : geometry.leaf_boxes) box = box.inflated(kBoxInflation * geometry.size);
  for (AnalyticFace& face : geometry.analytic) face.box = face.box.inflated(kBoxInflation * geometry.size);
  geometry.box = geometry.box.inflated(kBoxInflation * geometry.size);
  return geometry;
}

std::size_t PartGeometry::bytes() const {
  std::size_t sum = leaves.size() * sizeof(Leaf) + analytic.size() * sizeof(AnalyticFace);
  for (const TrimRegion& trim : trims) sum += trim.bytes();
  for (const LeafPatch& p : patches) sum += sizeof(LeafPatch) + p.piece.patch.net.size() * sizeof(Vec4);
  return sum;
}

}  // namespace iso
