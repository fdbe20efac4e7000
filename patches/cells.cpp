#include "patches/cells.h"

namespace iso {

namespace {

// One subpatch on the way down.
struct Node {
  BezierPatch patch;
  Vec2 lo{0.0}, hi{1.0};
  int levels = 0;
};

// The subpatch shifted to the cell's middle and scaled to weight 1 there: rows of (P, w).
struct Centred {
  Point3 centre{0.0};
  Vec4 Da{0.0}, Db{0.0};  // derivatives of (P, w) at the middle, per half width
  std::vector<Vec4> net;
};

Centred centred(const BezierPatch& patch) {
  const HomogeneousJet j = homogeneous_jet(patch, {0.5, 0.5});
  Centred c;
  c.centre = project(j.H);
  const auto shifted = [&](const Vec4& h) { return Vec4(Vec3(h) - h.w * c.centre, h.w) / j.H.w; };
  c.Da = 0.5 * shifted(j.Hs);
  c.Db = 0.5 * shifted(j.Ht);
  c.net.reserve(patch.net.size());
  for (const Vec4& h : patch.net) c.net.push_back(shifted(h));
  return c;
}

// Bounds of the derivative nets against the middle's derivative, and the variation along each parameter.
struct Strays {
  double a = 0, b = 0, weight_a = 0, weight_b = 0;
  double along_s = 0, along_t = 0;  // variation of both derivatives when moving in s, in t
};

Strays strays_of(const BezierPatch& patch, const Centred& c) {
  Strays out;
  const int pu = patch.pu, pv = patch.pv;
  const auto at = [&](int i, int j) -> const Vec4& { return c.net[static_cast<std::size_t>(i) * (pv + 1) + j]; };
  const auto ds = [&](int i, int j) { return 0.5 * pu * (at(i + 1, j) - at(i, j)); };
  const auto dt = [&](int i, int j) { return 0.5 * pv * (at(i, j + 1) - at(i, j)); };
  for (int i = 0; i < pu; ++i)
    for (int j = 0; j <= pv; ++j) {
      const Vec4 d = ds(i, j);
      out.a = std::max(out.a, glm::length(Vec3(d) - Vec3(c.Da)));
      out.weight_a = std::max(out.weight_a, std::abs(d.w));
      if (i + 1 < pu) out.along_s = std::max(out.along_s, pu * glm::length(Vec3(ds(i + 1, j) - d)));
      if (j < pv) out.along_t = std::max(out.along_t, pv * glm::length(Vec3(ds(i, j + 1) - d)));
    }
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j < pv; ++j) {
      const Vec4 d = dt(i, j);
      out.b = std::max(out.b, glm::length(Vec3(d) - Vec3(c.Db)));
      out.weight_b = std::max(out.weight_b, std::abs(d.w));
      if (j + 1 < pv) out.along_t = std::max(out.along_t, pv * glm::length(Vec3(dt(i, j + 1) - d)));
      if (i < pu) out.along_s = std::max(out.along_s, pu * glm::length(Vec3(dt(i + 1, j) - d)));
    }
  return out;
}

// Stray derivatives against the lengths of A and B at right angles to each other: the contraction of Newton's map for a head-on ray.
double bend_of(const Centred& c, const Strays& strays, double radius) {
  const Vec3 A(c.Da), B(c.Db);
  const double cross = glm::length(glm::cross(A, B));
  const double stray = strays.a + strays.b + radius * (strays.weight_a + strays.weight_b);
  const double longest = std::max(glm::length(A), glm::length(B));
  return cross > 0 ? stray * longest / cross : kInf;
}

Box2 native_box(const BezierPiece& piece, const Node& node) { return {piece.to_native(node.lo), piece.to_native(node.hi)}; }

}  // namespace

void divide(const BezierPiece& piece, int piece_index, const TrimRegion& trim, const CellPolicy& policy, std::vector<FaceCell>& cells) {
  std::vector<Node> stack;
  stack.push_back({piece.patch, {0, 0}, {1, 1}, 0});
  while (!stack.empty()) {
    const Node node = std::move(stack.back());
    stack.pop_back();
    const TrimRegion::Kind kind = trim.classify(native_box(piece, node));
    if (kind == TrimRegion::Kind::outside) continue;
    const Box3 box = hull_box(node.patch);
    const Centred c = centred(node.patch);
    const Strays strays = strays_of(node.patch, c);
    const double radius = 0.5 * box.diagonal();
    const bool bends = bend_of(c, strays, radius) > policy.bend;
    const bool last = node.levels >= policy.most_levels || (node.levels >= 6 && box.diagonal() < policy.small);
    if (!bends || last) {
      cells.push_back({piece_index, node.lo, node.hi, c.centre, Vec3(c.Da), Vec3(c.Db), strays.a, strays.b, strays.weight_a, strays.weight_b, box, kind});
      continue;
    }
    const Vec2 width = node.hi - node.lo;
    int direction = strays.along_s >= strays.along_t ? 0 : 1;
    if (width[direction] < 1.0 / 4096) direction = 1 - direction;  // dyadic boxes hold twelve levels a direction
    Node low{{}, node.lo, node.hi, node.levels + 1}, high = low;
    split_in_half(node.patch, direction, low.patch, high.patch);
    const double middle = 0.5 * (node.lo[direction] + node.hi[direction]);
    low.hi[direction] = middle;
    high.lo[direction] = middle;
    stack.push_back(std::move(high));
    stack.push_back(std::move(low));
  }
}

}  // namespace iso
