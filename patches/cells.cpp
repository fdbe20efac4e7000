#include "patches/cells.h"

#include <array>

#include "patches/cell_bounds.h"

namespace iso {

namespace {

// The rows alone: all that `tilt_of` asks for.
Slab slab_rows(const LinearModel& m) {
  const auto unit_or = [](const Vec3& v, const Vec3& other) { return glm::length(v) > 0 ? glm::normalize(v) : other; };
  const Vec3 cross = glm::cross(m.A, m.B);
  const double area = glm::length(cross);
  Slab slab;
  if (m.normal != Vec3(0.0)) {
    slab.row[0] = glm::cross(m.B, cross) / (area * area);
    slab.row[1] = glm::cross(cross, m.A) / (area * area);
    slab.row[2] = cross / area;
  } else {  // a collapsed cell: any box will do
    const Vec3 along = glm::length(m.A) >= glm::length(m.B) ? m.A : m.B;
    const double inverse = 1 / std::max(glm::length(along), 1e-300);
    const Vec3 unit = unit_or(along, {1, 0, 0}), across = any_perpendicular(unit);
    slab.row[0] = unit * inverse;
    slab.row[1] = across * inverse;
    slab.row[2] = glm::cross(unit, across);
  }
  return slab;
}

// FaceCell::tilt. In the tangent plane Newton's map strays from the identity by what the ray moves there of the strays of the derivatives,
// v_a row[0]^T + v_b row[1]^T with the rows of the slab. Their tangential parts stay; the parts along the normal slide by the tangent of
// the ray's angle, times the vector n . v_a row[0] + n . v_b row[1]. Below one, in the spectral norm, the map contracts.
double tilt_of(const LinearModel& m, const Slab& slab) {
  if (m.normal == Vec3(0.0)) return kInf;
  const Vec3 a = m.stray_a.normal * slab.row[0], b = m.stray_b.normal * slab.row[1];
  const double left = 1 - m.stray_a.tangential * glm::length(slab.row[0]) - m.stray_b.tangential * glm::length(slab.row[1]);
  return left > 0 ? std::max(glm::length(a + b), glm::length(a - b)) / left : kInf;
}

// FaceCell::curls of a patch that reaches kCellMargin beyond the cell; f = n . (P - c w) - (d - n . c) w with |d - n . c| <= radius.
Vec3 curls_of(const BezierPatch& patch, bool rational, const Point3& centre, double radius) {
  const auto difference = [&](int i, int j, int di, int dj) { return patch.at(i + di, j + dj) - patch.at(i, j); };
  // Polynomial patches have second differences without weight; their squares do.
  const auto size = [&](const Vec4& h) {
    return rational ? glm::length(Vec3(h) - h.w * centre) + radius * std::abs(h.w) : glm::dot(Vec3(h), Vec3(h));
  };
  const int pu = patch.pu, pv = patch.pv;
  Vec3 most{0.0};
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j) {
      if (i + 2 <= pu) most.x = std::max(most.x, size(difference(i + 1, j, 1, 0) - difference(i, j, 1, 0)));
      if (i < pu && j < pv) most.y = std::max(most.y, size(difference(i, j + 1, 1, 0) - difference(i, j, 1, 0)));
      if (j + 2 <= pv) most.z = std::max(most.z, size(difference(i, j + 1, 0, 1) - difference(i, j, 0, 1)));
    }
  if (!rational) most = glm::sqrt(most);
  // The patch's unit square spans 2 kCellMargin of the cell's parameters.
  return Vec3(pu * (pu - 1), pu * pv, pv * (pv - 1)) * most / (4 * kCellMargin * kCellMargin);
}

// How far from the centre the slab reaches, and a little more.
double radius_of(const Slab& slab) {
  const double volume = std::abs(glm::dot(slab.row[0], glm::cross(slab.row[1], slab.row[2])));
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double edge = glm::length(glm::cross(slab.row[(k + 1) % 3], slab.row[(k + 2) % 3])) / volume;
    sum += edge * std::max(std::abs(slab.reach[k].lo), std::abs(slab.reach[k].hi));
  }
  return 1.05 * sum;
}

// Dyadic boxes hold twelve levels in a direction (see Leaf): none may get thinner than this.
constexpr double kLeastWidth = 1.0 / 4096;

// The way down through one piece, depth first.
class Division {
 public:
  Division(const BezierPiece& piece, int index, const TrimRegion& trim, const CellPolicy& policy, std::vector<FaceCell>& cells)
      : piece_(piece), index_(index), trim_(trim), policy_(policy), rational_(is_rational(piece.patch)), cells_(cells) {
    nodes_.reserve(static_cast<std::size_t>(policy.most_levels) + 2);
    nodes_.push_back({piece.patch, {0, 0}, {1, 1}, 0});
    count_ = 1;
  }

  void run() {
    while (count_ > 0) visit(nodes_[count_ - 1]);
  }

 private:
  // One subpatch; those beyond `count_` keep their memory.
  struct Node {
    BezierPatch patch;
    Vec2 lo{0.0}, hi{1.0};
    int levels = 0;
  };

  void visit(const Node& node) {
    const TrimRegion::Kind kind = trim_.classify({piece_.to_native(node.lo), piece_.to_native(node.hi)});
    if (kind == TrimRegion::Kind::outside) {
      --count_;
      return;
    }
    LinearModel m = sampled_model(node.patch, rational_);
    const bool last = node.levels >= policy_.most_levels || (node.levels >= 6 && hull_box(node.patch).diagonal() < policy_.small);
    if (add_if_flat(node, kind, last, m)) {
      --count_;
      return;
    }
    const Vec2 width = node.hi - node.lo;
    const int direction = m.split_direction();
    split(width[direction] < 2 * kLeastWidth ? 1 - direction : direction);
  }

  // The samples decide first: the bounds cannot be smaller.
  bool add_if_flat(const Node& node, TrimRegion::Kind kind, bool last, LinearModel& m) {
    Slab slab = slab_rows(m);
    if (!last && tilt_of(m, slab) > policy_.bend) return false;
    extend_to_margin(node.patch, rational_, wide_);
    bounds_.bound(wide_, rational_, m);
    const double tilt = tilt_of(m, slab);
    if (!last && tilt > policy_.bend) return false;
    Box3 box;
    const bool plain = !rational_ && node.patch.net.front().w == 1;
    for (const Vec4& h : node.patch.net) {
      const Point3 p = plain ? Vec3(h) : project(h);
      box.include(p);
      for (int k = 0; k < 3; ++k) slab.reach[k].include(glm::dot(slab.row[k], p - m.centre));
    }
    const Vec3 curls = curls_of(wide_, rational_, m.centre, radius_of(slab));
    cells_.push_back({index_, node.lo, node.hi, m.centre, m.A, m.B, m.stray_a.length, m.stray_b.length, tilt, curls, box, slab, kind});
    return true;
  }

  // The low half comes on top of the high one, which takes the place of the whole.
  void split(int direction) {
    if (nodes_.size() == count_) nodes_.emplace_back();
    Node &high = nodes_[count_ - 1], &low = nodes_[count_++];
    ++high.levels;
    low.lo = high.lo;
    low.hi = high.hi;
    low.levels = high.levels;
    low.hi[direction] = high.lo[direction] = 0.5 * (high.lo[direction] + high.hi[direction]);
    split_in_half(high.patch, direction, low.patch, high.patch);
  }

  const BezierPiece& piece_;
  int index_;
  const TrimRegion& trim_;
  const CellPolicy& policy_;
  bool rational_;
  std::vector<FaceCell>& cells_;
  std::vector<Node> nodes_;
  std::size_t count_ = 0;
  BezierPatch wide_;
  StrayBounds bounds_;
};

}  // namespace

void divide(const BezierPiece& piece, int piece_index, const TrimRegion& trim, const CellPolicy& policy, std::vector<FaceCell>& cells) {
  Division(piece, piece_index, trim, policy, cells).run();
}

namespace {

Box3 box_of_cells(const Face& face, const TrimRegion& trim) {
  CellPolicy coarse;
  coarse.bend = 0.5;
  coarse.most_levels = 8;
  std::vector<FaceCell> cells;
  for (const BezierPiece& piece : bezier_pieces(face.surface, face.domain)) divide(piece, 0, trim, coarse, cells);
  Box3 box;
  for (const FaceCell& cell : cells) box.include(cell.box);
  return box.inflated(distance_of_pieces(face.surface));
}

}  // namespace

Box3 trimmed_box(const Face& face, const TrimRegion& trim) {
  if (!has_closed_form_bounds(face.surface)) return box_of_cells(face, trim);
  if (trim.untrimmed()) return bounds(face.surface, face.domain);
  Box3 box;
  if (std::holds_alternative<Plane>(face.surface)) {
    for (const UV& uv : trim.hull()) box.include(point(face.surface, uv));
  } else {
    for (const Box2& cell : trim.cover()) box.include(bounds(face.surface, cell));
  }
  return box;
}

}  // namespace iso
