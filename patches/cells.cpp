#include "patches/cells.h"

#include <array>

#include "patches/base/bspline_basis.h"

namespace iso {

namespace {

// One subpatch on the way down.
struct Node {
  BezierPatch patch;
  Vec2 lo{0.0}, hi{1.0};
  int levels = 0;
};

// How far a derivative strays from that of the linear model, in all and by its parts along and square to the model's normal.
struct Stray {
  double length = 0, normal = 0, tangential = 0;

  void include(const Vec3& v, const Vec3& n) {
    const double along = glm::dot(v, n);
    length = std::max(length, glm::length(v));
    normal = std::max(normal, std::abs(along));
    tangential = std::max(tangential, glm::length(v - along * n));
  }
  Stray& operator*=(double by) {
    length *= by;
    normal *= by;
    tangential *= by;
    return *this;
  }
};
constexpr Stray kUnbounded{kInf, kInf, kInf};

// Tangents at a smaller angle span no slab.
constexpr double kLeastSine = 1e-6;

// The linear model of a subpatch about its middle, and how far its derivatives stray from it.
struct LinearModel {
  Point3 centre{0.0};
  Vec3 A{0.0}, B{0.0};
  Vec3 normal{0.0};  // of unit length; zero where A and B are all but parallel: then nothing is certain
  Stray stray_a, stray_b;
  double along_s = 0, along_t = 0;  // how much the derivatives vary when moving in s, in t, as shares of |A| and |B|
  int split_direction() const { return along_s >= along_t ? 0 : 1; }
};

bool is_rational(const BezierPatch& patch) {
  for (const Vec4& h : patch.net)
    if (h.w != patch.net.front().w) return true;
  return false;
}

// Polynomial patches: the derivatives lie in the hulls of the difference nets.
void bound_polynomial(const BezierPatch& patch, LinearModel& m) {
  const int pu = patch.pu, pv = patch.pv;
  const double scale = 0.5 / patch.net.front().w;
  for (int i = 0; i < pu; ++i)
    for (int j = 0; j <= pv; ++j) m.stray_a.include(scale * pu * Vec3(patch.at(i + 1, j) - patch.at(i, j)) - m.A, m.normal);
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j < pv; ++j) m.stray_b.include(scale * pv * Vec3(patch.at(i, j + 1) - patch.at(i, j)) - m.B, m.normal);
}

// Binomial coefficients as doubles.
const std::array<double, 2 * kMaxDegree + 1>& binomials(int n) {
  static const auto kTable = [] {
    std::array<std::array<double, 2 * kMaxDegree + 1>, 2 * kMaxDegree + 1> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      t[i][0] = 1;
      for (std::size_t j = 1; j <= i; ++j) t[i][j] = t[i - 1][j - 1] + (j < i ? t[i - 1][j] : 0.0);
    }
    return t;
  }();
  return kTable[static_cast<std::size_t>(n)];
}

// Rational patches: dS/ds - A = ((P_s w - P w_s) - A w^2) / w^2, with P about the middle. Numerator and denominator are polynomials of
// degree (2p, 2q), multiplied out in Bernstein form (coefficients times binomials multiply like power series); their coefficients bound the
// quotient.
Stray bound_rational(const BezierPatch& patch, const LinearModel& m, int direction) {
  const int pu = patch.pu, pv = patch.pv;
  const Vec3 mean = direction == 0 ? m.A : m.B;
  // Differences of one degree less in `direction`, then one elevation back, so that all sums have degree (2 pu, 2 pv).
  const int ru = direction == 0 ? pu - 1 : pu, rv = direction == 0 ? pv : pv - 1;
  if (ru < 0 || rv < 0) return {};
  const auto shifted = [&](int i, int j) { return Vec4(Vec3(patch.at(i, j)) - patch.at(i, j).w * m.centre, patch.at(i, j).w); };
  std::vector<Vec4> net, difference;
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j) net.push_back(shifted(i, j));
  const auto at = [&](int i, int j) -> const Vec4& { return net[static_cast<std::size_t>(i) * (pv + 1) + j]; };
  for (int i = 0; i <= ru; ++i)
    for (int j = 0; j <= rv; ++j)
      difference.push_back(direction == 0 ? 0.5 * pu * (at(i + 1, j) - at(i, j)) : 0.5 * pv * (at(i, j + 1) - at(i, j)));
  const int du = ru + pu, dv = rv + pv;
  std::vector<Vec3> product(static_cast<std::size_t>(du + 1) * (dv + 1), Vec3(0.0));
  const auto &cu = binomials(pu), &cv = binomials(pv), &eu = binomials(ru), &ev = binomials(rv);
  for (int i = 0; i <= ru; ++i)
    for (int j = 0; j <= rv; ++j) {
      const Vec4 d = difference[static_cast<std::size_t>(i) * (rv + 1) + j] * (eu[i] * ev[j]);
      for (int k = 0; k <= pu; ++k)
        for (int l = 0; l <= pv; ++l)
          product[static_cast<std::size_t>(i + k) * (dv + 1) + j + l] += (Vec3(d) * at(k, l).w - Vec3(at(k, l)) * d.w) * (cu[k] * cv[l]);
    }
  std::vector<double> square(static_cast<std::size_t>(2 * pu + 1) * (2 * pv + 1), 0.0);
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j)
      for (int k = 0; k <= pu; ++k)
        for (int l = 0; l <= pv; ++l)
          square[static_cast<std::size_t>(i + k) * (2 * pv + 1) + j + l] += at(i, j).w * at(k, l).w * cu[i] * cv[j] * cu[k] * cv[l];
  const auto &fu = binomials(2 * pu), &fv = binomials(2 * pv);
  Stray worst;
  double least = kInf;
  for (int i = 0; i <= 2 * pu; ++i)
    for (int j = 0; j <= 2 * pv; ++j) {
      // Scaled coefficients (with the binomials in them) are raised a degree by adding their lower neighbour.
      Vec3 raised{0.0};
      const int bi = direction == 0 ? i - 1 : i, bj = direction == 0 ? j : j - 1;
      if (i <= du && j <= dv) raised += product[static_cast<std::size_t>(i) * (dv + 1) + j];
      if (bi >= 0 && bj >= 0) raised += product[static_cast<std::size_t>(bi) * (dv + 1) + bj];
      const double w2 = square[static_cast<std::size_t>(i) * (2 * pv + 1) + j];
      worst.include((raised - mean * w2) / (fu[i] * fv[j]), m.normal);
      least = std::min(least, w2 / (fu[i] * fv[j]));
    }
  return least > 0 ? worst *= 1 / least : kUnbounded;
}

// Half-width derivatives of S.
struct Slopes {
  Vec3 a, b;
};
Slopes slopes(const BezierPatch& patch, const Vec2& st) {
  const HomogeneousJet j = homogeneous_jet(patch, st);
  const Vec3 S = project(j.H);
  return {0.5 * (Vec3(j.Hs) - j.Hs.w * S) / j.H.w, 0.5 * (Vec3(j.Ht) - j.Ht.w * S) / j.H.w};
}

// The model over [-kCellMargin, kCellMargin]^2, for a patch over that square; all derivatives count in the cell's own parameters. The
// strays are those of five samples: the bounds cannot be smaller.
LinearModel model_of(const BezierPatch& patch) {
  LinearModel m;
  m.centre = project(homogeneous_jet(patch, {0.5, 0.5}).H);
  const auto slopes_at = [&](const Vec2& st) {
    const Slopes at = slopes(patch, st);
    return Slopes{at.a / kCellMargin, at.b / kCellMargin};
  };
  const Slopes middle = slopes_at({0.5, 0.5});
  m.A = middle.a;
  m.B = middle.b;
  const Vec3 cross = glm::cross(m.A, m.B);
  if (glm::length(cross) > kLeastSine * glm::length(m.A) * glm::length(m.B)) m.normal = glm::normalize(cross);
  const double a = std::max(glm::length(m.A), 1e-300), b = std::max(glm::length(m.B), 1e-300);
  const auto variation = [&](const Vec2& st) {
    const Slopes at = slopes_at(st);
    m.stray_a.include(at.a - m.A, m.normal);
    m.stray_b.include(at.b - m.B, m.normal);
    return glm::length(at.a - m.A) / a + glm::length(at.b - m.B) / b;
  };
  m.along_s = variation({0, 0.5}) + variation({1, 0.5});
  m.along_t = variation({0.5, 0}) + variation({0.5, 1});
  return m;
}

// Puts proven bounds in the place of the samples.
void bound_strays(const BezierPatch& patch, LinearModel& m) {
  LinearModel wide = m;  // counts in the parameters of the margin
  wide.A *= kCellMargin;
  wide.B *= kCellMargin;
  wide.stray_a = wide.stray_b = {};
  if (is_rational(patch)) {
    wide.stray_a = bound_rational(patch, wide, 0);
    wide.stray_b = bound_rational(patch, wide, 1);
    for (const Vec4& h : patch.net)
      if (!(h.w > 0)) wide.stray_a = wide.stray_b = kUnbounded;  // beyond its border a rational patch may have a pole
  } else {
    bound_polynomial(patch, wide);
  }
  m.stray_a = wide.stray_a *= 1 / kCellMargin;
  m.stray_b = wide.stray_b *= 1 / kCellMargin;
}

// The patch beyond its borders by the margin.
BezierPatch with_margin(const BezierPatch& patch) {
  constexpr double kBeyond = 0.5 * (kCellMargin - 1);
  BezierPatch wide = part_of(patch, Vec2(-kBeyond), Vec2(1 + kBeyond));
  if (!is_rational(patch))
    for (Vec4& h : wide.net) h.w = patch.net.front().w;  // rounding must not make it rational
  return wide;
}

Slab slab_of(const BezierPatch& patch, const LinearModel& m) {
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
  for (const Vec4& h : patch.net)
    for (int k = 0; k < 3; ++k) slab.reach[k].include(glm::dot(slab.row[k], project(h) - m.centre));
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
Vec3 curls_of(const BezierPatch& patch, const Point3& centre, double radius) {
  const auto difference = [&](int i, int j, int di, int dj) { return patch.at(i + di, j + dj) - patch.at(i, j); };
  const auto size = [&](const Vec4& h) { return glm::length(Vec3(h) - h.w * centre) + radius * std::abs(h.w); };
  const int pu = patch.pu, pv = patch.pv;
  Vec3 most{0.0};
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j) {
      if (i + 2 <= pu) most.x = std::max(most.x, pu * (pu - 1) * size(difference(i + 1, j, 1, 0) - difference(i, j, 1, 0)));
      if (i < pu && j < pv) most.y = std::max(most.y, pu * pv * size(difference(i, j + 1, 1, 0) - difference(i, j, 1, 0)));
      if (j + 2 <= pv) most.z = std::max(most.z, pv * (pv - 1) * size(difference(i, j + 1, 0, 1) - difference(i, j, 0, 1)));
    }
  return most / (4 * kCellMargin * kCellMargin);  // the patch's unit square spans 2 kCellMargin of the cell's parameters
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
    const BezierPatch wide = with_margin(node.patch);
    LinearModel m = model_of(wide);
    const Slab slab = slab_of(node.patch, m);
    const bool last = node.levels >= policy.most_levels || (node.levels >= 6 && box.diagonal() < policy.small);
    double tilt = tilt_of(m, slab);
    if (last || tilt <= policy.bend) {
      bound_strays(wide, m);
      tilt = tilt_of(m, slab);
    }
    if (last || tilt <= policy.bend) {
      const Vec3 curls = curls_of(wide, m.centre, radius_of(slab));
      cells.push_back(
          {piece_index, node.lo, node.hi, m.centre, m.A, m.B, m.stray_a.length, m.stray_b.length, tilt, curls, box, slab, kind});
      continue;
    }
    const Vec2 width = node.hi - node.lo;
    int direction = m.split_direction();
    if (width[direction] < 2 * kLeastWidth) direction = 1 - direction;
    Node low{{}, node.lo, node.hi, node.levels + 1}, high = low;
    split_in_half(node.patch, direction, low.patch, high.patch);
    const double middle = 0.5 * (node.lo[direction] + node.hi[direction]);
    low.hi[direction] = middle;
    high.lo[direction] = middle;
    stack.push_back(std::move(high));
    stack.push_back(std::move(low));
  }
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
  return box;
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
