#include "tess/patch_bounds.h"

#include <algorithm>

#include "tess/triangle_distance.h"

namespace iso {
namespace {

constexpr int kMostDivisions = 5;  // of a piece: sides 32 times shorter

// Where a bound cannot be as sharp as wanted, the next try wants so much less.
constexpr double kNextAim = 1.3;
constexpr int kMostAims = 12;

std::vector<ChartPlace> chart_places(const PatternCuts& cuts) {
  std::vector<ChartPlace> places;
  for (const PatternCuts::Point& point : cuts.points) places.push_back(point.place);
  return places;
}

Point3 nearest_on(const Point3& p, const Point3& a, const Point3& b) {
  const Vec3 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  return length2 > 0 ? a + std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) * ab : a;
}

// A corner of a piece: bit e of `edges` tells that it is on the triangle's edge from corner e to the next one.
struct PieceCorner {
  SurfaceCorner at;
  unsigned edges = 0;
};

// One triangle in space, and the proof of its pieces.
class TriangleProof {
 public:
  TriangleProof(const FaceShape& shape, const std::array<Point3, 3>& corners) : shape_(shape), corners_(corners) {}

  double bound(const std::array<PieceCorner, 3>& piece, double aim, int divisions = kMostDivisions) const {
    double off = 0;
    for (const PieceCorner& c : piece) off = std::max(off, distance(c));
    const double whole = off + shape_.triangle_bound(piece[0].at, piece[1].at, piece[2].at);
    if (whole <= aim || off > aim) return whole;
    // Beside corners by mean value derivatives say next to nothing: there a small piece may do.
    if (divisions == 0) return std::min(whole, off + shape_.box_bound({piece[0].at, piece[1].at, piece[2].at}, whole));
    const PieceCorner ab = between(piece[0], piece[1]), bc = between(piece[1], piece[2]), ca = between(piece[2], piece[0]);
    double parts = 0;
    for (const auto& part :
         {std::array{piece[0], ab, ca}, std::array{ab, piece[1], bc}, std::array{ca, bc, piece[2]}, std::array{ab, bc, ca}}) {
      parts = std::max(parts, bound(part, aim, divisions - 1));
      if (parts >= whole) return whole;
    }
    return parts;
  }

 private:
  double distance(const PieceCorner& c) const {
    const Point3& p = c.at.S;
    const auto edge_from = [&](std::size_t e) { return nearest_on(p, corners_[e], corners_[(e + 1) % 3]); };
    switch (c.edges) {
      case 0: {
        const Vec3 l = nearest_in_triangle(p, corners_[0], corners_[1], corners_[2]);
        return glm::length(l.x * corners_[0] + l.y * corners_[1] + l.z * corners_[2] - p);
      }
      case 1:
        return glm::length(edge_from(0) - p);
      case 2:
        return glm::length(edge_from(1) - p);
      case 4:
        return glm::length(edge_from(2) - p);
      default:
        // A corner, between the edges 2 and 0, 0 and 1, 1 and 2.
        return glm::length(corners_[c.edges == 5 ? 0 : c.edges == 3 ? 1 : 2] - p);
    }
  }

  PieceCorner between(const PieceCorner& a, const PieceCorner& b) const {
    const UV uv = 0.5 * (a.at.uv + b.at.uv);
    return {{uv, shape_.eval().point(uv)}, a.edges & b.edges};
  }

  const FaceShape& shape_;
  const std::array<Point3, 3>& corners_;
};

// The corners of a piece, with the edges of its triangle that they are on.
std::array<PieceCorner, 3> corners_of(const PatternTables& tables, const PatternCuts::Piece& piece, const std::vector<Vec3>& places) {
  constexpr unsigned kOfCorner[] = {5, 3, 6};
  const auto& triangle = tables.pattern.triangles[piece.triangle];
  const std::size_t known = tables.pattern.points.size();
  std::array<PieceCorner, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t i = piece.points[k];
    out[k].at = {piece.st[k], places[i]};
    for (std::size_t e = 0; e < 3; ++e) {
      if (i < known && triangle[e] == i) out[k].edges = kOfCorner[e];
      if (i < known || tables.cuts.points[i - known].weights.z != 0) continue;
      const auto& between = tables.cuts.points[i - known].between;
      const auto [low, high] = std::minmax(triangle[e], triangle[(e + 1) % 3]);
      if (between[0] == low && between[1] == high) out[k].edges |= 1u << e;
    }
  }
  return out;
}

std::array<Point3, 3> triangle_of(const PatternTables& tables, const PatternCuts::Piece& piece, const std::vector<Vec3>& places) {
  const auto& t = tables.pattern.triangles[piece.triangle];
  return {places[t[0]], places[t[1]], places[t[2]]};
}

}  // namespace

PatternTables::PatternTables(const PatchBasis& basis, Strategy strategy, const PatternLevels& levels)
    : pattern(domain_pattern(strategy, basis.sides, levels)),
      cuts(cut_by_charts(pattern)),
      at_points(basis, pattern.places),
      at_cuts(basis, chart_places(cuts)) {}

std::vector<Vec3> places_of(const PatternTables& tables, const NSidedPatch& patch) {
  std::vector<Vec3> places = tables.at_points.places(patch.points, patch.weights);
  const std::vector<Vec3> cuts = tables.at_cuts.places(patch.points, patch.weights);
  places.insert(places.end(), cuts.begin(), cuts.end());
  return places;
}

double PatchBounds::reached(std::span<const Face> charts) const {
  double most = 0;
  for (const PatternCuts::Piece& piece : tables_.cuts.pieces) {
    const std::array<Point3, 3> t = triangle_of(tables_, piece, places_);
    const Point3 p = point(charts[static_cast<std::size_t>(piece.corner)].surface, (piece.st[0] + piece.st[1] + piece.st[2]) / 3.0);
    const Vec3 l = nearest_in_triangle(p, t[0], t[1], t[2]);
    most = std::max(most, glm::length(l.x * t[0] + l.y * t[1] + l.z * t[2] - p));
  }
  return most;
}

std::vector<double> PatchBounds::proven(std::span<const FaceShape> shapes, double aim) const {
  std::vector<double> of_chart(shapes.size(), 0.0);
  for (const PatternCuts::Piece& piece : tables_.cuts.pieces) {
    double& bound = of_chart[static_cast<std::size_t>(piece.corner)];
    const auto t = triangle_of(tables_, piece, places_);
    const TriangleProof proof(shapes[static_cast<std::size_t>(piece.corner)], t);
    const auto corners = corners_of(tables_, piece, places_);
    double wanted = std::max(aim, bound), found = proof.bound(corners, wanted);
    for (int i = 0; i < kMostAims && found > wanted; ++i) found = std::min(found, proof.bound(corners, wanted *= kNextAim));
    bound = std::max(bound, found);
  }
  return of_chart;
}

bool PatchBounds::within(std::span<const FaceShape> shapes, double most) const {
  for (const PatternCuts::Piece& piece : tables_.cuts.pieces) {
    const auto t = triangle_of(tables_, piece, places_);
    const TriangleProof proof(shapes[static_cast<std::size_t>(piece.corner)], t);
    if (!(proof.bound(corners_of(tables_, piece, places_), most) <= most)) return false;
  }
  return true;
}

}  // namespace iso
