#include "patches/surface/chart_spline.h"

#include <array>
#include <span>

#include "patches/base/bernstein.h"
#include "patches/base/corner_series.h"
#include "patches/base/made_once.h"
#include "patches/base/taylor.h"
#include "patches/surface/patch_basis-inl.h"

namespace iso {

namespace {

constexpr int kDegree = kSplineDegree;

// Where the cells of level 0 meet. Toward the corner the blend of two sides changes by the direction alone, whatever the distance: cells
// shrink there. Found by search and trial, for regular patches on a sphere with up to eight sides: few cells, with a proven distance below
// 1e-5 of the patch, of Gregory triangles and quads below 5e-6. The weights of many sides vary quickly, those of Charrot and Gregory also
// about the centre and, on triangles, at the corner.
constexpr double kGregory[] = {0, 0.0546, 0.2108, 0.5973, 1};
constexpr double kGeneralised[] = {0, 0.0307, 0.1734, 0.397, 0.6911, 1};
constexpr double kOfOtherSides[] = {0, 0.0256, 0.06, 0.135, 0.26, 0.43, 0.63, 0.82, 1};
constexpr double kCharrotGregory[] = {0, 0.03, 0.1, 0.22, 0.37, 0.53, 0.69, 0.85, 1};
constexpr double kCharrotTriangle[] = {0, 0.01, 0.035, 0.1, 0.22, 0.37, 0.53, 0.69, 0.85, 1};
// By mean value coordinates already the tangents change by the direction; here the distance is below 3e-5. A cell that is much longer than
// the one before it lets the spline fold, the more so the more sides there are.
constexpr double kMeanValue[] = {0, 2e-5, 1.2e-4, 6e-4, 2.4e-3, 7e-3, 0.018, 0.04, 0.08, 0.15, 0.27, 0.44, 0.68, 1};
constexpr double kMeanValueCharrot[] = {0, 2e-5, 1.2e-4, 6e-4, 2.4e-3, 7e-3, 0.018, 0.04, 0.08, 0.15, 0.27, 0.42, 0.59, 0.79, 1};
constexpr double kMeanValueOfMany[] = {0,    1e-4, 2.5e-4, 6e-4, 1.4e-3, 3e-3, 6.5e-3, 0.0135, 0.027,
                                       0.05, 0.09, 0.15,   0.24, 0.36,   0.52, 0.68,   0.84,   1};

std::span<const double> first_nodes(const PatchBasis& basis) {
  if (basis.parameters == SideParameters::mean_value) {
    if (basis.sides > 6 || basis.degree > kDegree) return kMeanValueOfMany;
    if (basis.kind == PatchKind::charrot_gregory) return kMeanValueCharrot;
    return kMeanValue;
  }
  switch (basis.kind) {
    case PatchKind::gregory_triangle:
    case PatchKind::gregory_quad:
      return kGregory;
    case PatchKind::charrot_gregory:
      if (basis.sides == 3) return kCharrotTriangle;
      return kCharrotGregory;
    default:
      // A quintic reproduces boundary curves up to degree 5. Of higher ones neighbours share what their nodes make of them, so all have the
      // same nodes.
      if (basis.sides < 4 || basis.sides > 6 || basis.degree > kDegree) return kOfOtherSides;
      return kGeneralised;
  }
}

// The first cell of a fine corner.
constexpr double kFineCell = 1.0 / 24 / 64;

std::vector<double> nodes_of(const PatchBasis& basis, const SplineGrid& grid) {
  const std::span<const double> first = first_nodes(basis);
  std::vector<double> nodes(first.begin(), first.end());
  for (int level = grid.level; level > 0; --level) {
    std::vector<double> finer{0.0, 0.25 * nodes[1]};
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      finer.push_back(0.5 * (nodes[k - 1] + nodes[k]));
      finer.push_back(nodes[k]);
    }
    nodes = std::move(finer);
  }
  if (grid.at_corner == AtCorner::fine)
    while (nodes[1] > 1.5 * kFineCell) nodes.insert(nodes.begin() + 1, 0.5 * nodes[1]);
  return nodes;
}

// What the rounding of weights, poles and Taylor coefficients may come to; the weights are of the size of one.
constexpr double kRounding = 1e-13;
// Cells are divided for the proof until what the models do not know is less than this share of the distance, or next to nothing.
constexpr double kUnknownShare = 0.1, kNextToNothing = 1e-11;
constexpr int kMostProofLevels = 14;

// Entry (i, j): the derivative i times in s and j times in t at a node.
using NodeDerivatives = std::array<std::array<double, 3>, 3>;

// The Bernstein coefficients of a cell between two nodes, from the same.
struct HermiteRow {
  int node;  // 0: the lower
  std::array<double, 3> by;
};
HermiteRow hermite_row(int k, double h) {
  const double square = h * h / 20;
  switch (k) {
    case 0:
      return {0, {1, 0, 0}};
    case 1:
      return {0, {1, h / 5, 0}};
    case 2:
      return {0, {1, 2 * h / 5, square}};
    case 3:
      return {1, {1, -2 * h / 5, square}};
    case 4:
      return {1, {1, -h / 5, 0}};
    default:
      return {1, {1, 0, 0}};
  }
}

double combine(const std::array<double, 3>& s, const std::array<double, 3>& t, const NodeDerivatives& D) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += s[i] * t[j] * D[i][j];
  return sum;
}

class SplineMaker {
 public:
  SplineMaker(const PatchBasis& basis, const SplineGrid& grid)
      : basis_(basis), points_(point_count(basis)), at_(nodes_of(basis, grid)), cells_(static_cast<int>(at_.size()) - 1) {
    nodes_.resize(at_.size() * at_.size());
  }

  WeightSplines make() {
    WeightSplines out;
    out.pairs = pairs_of(basis_);
    out.count = 3 * (cells_ + 1);
    for (int n = 0; n <= cells_; ++n) out.knots.insert(out.knots.end(), n == 0 || n == cells_ ? 6 : 3, at_[n]);
    differentiate();
    out.poles.assign(points_, std::vector<double>(static_cast<std::size_t>(out.count) * out.count));
    for (int m = 0; m < points_; ++m)
      for (int a = 0; a < out.count; ++a)
        for (int b = 0; b < out.count; ++b)
          out.poles[m][static_cast<std::size_t>(a) * out.count + b] =
              combine(pole_row(a / 3, a % 3), pole_row(b / 3, b % 3), at(a / 3, b / 3)[m]);
    out.cells = cells_ * cells_;
    out.error.assign(static_cast<std::size_t>(out.cells) * points_, kRounding);
    out.error_of_sum.assign(out.cells * out.pairs.size(), kRounding);
    out.error_of_difference.assign(out.cells * out.pairs.size(), kRounding);
    for (int i = 0; i < cells_; ++i)
      for (int j = 0; j < cells_; ++j) prove_cell(i, j, out);
    for (int k = 0; k < cells_; ++k) {
      const Range along{at_[k], at_[k + 1]}, across{-0.5 * at_[1], 0.5 * at_[1]};
      out.slopes.push_back(slopes_amid(k, 0, {{along.lo, across.lo}, {along.hi, across.hi}}));
      out.slopes.push_back(slopes_amid(0, k, {{across.lo, along.lo}, {across.hi, along.hi}}));
      out.slopes.push_back(slopes_amid(k, k, {Vec2(along.lo), Vec2(along.hi)}));
    }
    return out;
  }

 private:
  // Pole p of a node, from the function and its first two derivatives there: the blossoms of the quintic on either side at (left, left, x,
  // x, x), (left, x, x, x, right) and (x, x, x, right, right). At the ends of the knots those of the one side.
  std::array<double, 3> pole_row(int node, int p) const {
    const double x = at_[node];
    const double before = node > 0 ? x - at_[node - 1] : 0, after = node < cells_ ? at_[node + 1] - x : 0;
    if (node == 0) return {1, p * after / 5, p == 2 ? after * after / 20 : 0};
    if (node == cells_) return {1, -(2 - p) * before / 5, p == 0 ? before * before / 20 : 0};
    if (p == 0) return {1, -2 * before / 5, before * before / 20};
    if (p == 1) return {1, (after - before) / 5, -before * after / 20};
    return {1, 2 * after / 5, after * after / 20};
  }

  const std::vector<NodeDerivatives>& at(int a, int b) const { return nodes_[a * (cells_ + 1) + b]; }

  void differentiate() {
    std::vector<Series> W(points_);
    for (int a = 0; a <= cells_; ++a)
      for (int b = 0; b <= cells_; ++b) {
        std::vector<NodeDerivatives>& to = nodes_[a * (cells_ + 1) + b];
        to.resize(points_);
        if (a == 0 && b == 0 && no_slope_at_corner()) continue;
        patch_weights(basis_, Series(at_[a], 1, 0), Series(at_[b], 0, 1), W.data());
        constexpr double kFactorial[] = {1, 1, 2};
        for (int m = 0; m < points_; ++m)
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) to[m][i][j] = W[m].c[Series::index(i, j)] * kFactorial[i] * kFactorial[j];
      }
    set_boundary_at_corner();
  }

  // Mean value coordinates change at a corner by the direction.
  bool no_slope_at_corner() const { return basis_.parameters == SideParameters::mean_value; }

  // At the corner the second derivatives of a formula may depend on the direction, by mean value coordinates the first do, too. Those along
  // the borders are the boundary curves', Bernstein polynomials of s / 2 and of t / 2: so the spline meets them.
  void set_boundary_at_corner() {
    const std::vector<int> next = points_of_side(basis_, 1), back = points_of_side(basis_, 0);
    const auto of_next = [&](std::size_t j) -> NodeDerivatives& { return nodes_[0][static_cast<std::size_t>(next[j])]; };
    const auto of_back = [&](std::size_t j) -> NodeDerivatives& { return nodes_[0][static_cast<std::size_t>(back[back.size() - 1 - j])]; };
    if (no_slope_at_corner()) {
      const double first = 0.5 * basis_.degree;
      of_next(0) = {{{1, -first, 0}, {-first, 0, 0}, {0, 0, 0}}};
      of_next(1)[1][0] = of_back(1)[0][1] = first;
      // Beside the corner the tangents across the borders are others at once: with this the spline turns toward them within the first fifth
      // or so of its cell, and does not fold where there are many sides.
      const double rate = 1 / at_[1];
      for (std::size_t m = 0; m < nodes_[0].size(); ++m) {
        const NodeDerivatives &ahead = at(1, 0)[m], &aside = at(0, 1)[m];
        NodeDerivatives& here = nodes_[0][m];
        here[1][1] = rate * (ahead[0][1] - here[0][1] + aside[1][0] - here[1][0]);
      }
    }
    const double second = 0.25 * basis_.degree * (basis_.degree - 1);
    for (NodeDerivatives& D : nodes_[0]) D[2][0] = D[0][2] = 0;
    constexpr double kDifference[] = {1, -2, 1};
    for (std::size_t j = 0; j < 3; ++j) {
      of_next(j)[2][0] = second * kDifference[j];
      of_back(j)[0][2] = second * kDifference[j];
    }
  }

  // The quintic of a weight over a cell, as powers of its middle's (a, b) over a box of the unit square.
  Taylor quintic(int i, int j, int m, const Box2& box) const {
    constexpr int n = kDegree + 1;
    const double hs = at_[i + 1] - at_[i], ht = at_[j + 1] - at_[j];
    std::array<double, n * n> c;
    for (int k = 0; k < n; ++k)
      for (int l = 0; l < n; ++l) {
        const HermiteRow s = hermite_row(k, hs), t = hermite_row(l, ht);
        c[k * n + l] = combine(s.by, t.by, at(i + s.node, j + t.node)[m]);
      }
    const Vec2 lo = (box.lo - Vec2(at_[i], at_[j])) / Vec2(hs, ht), hi = (box.hi - Vec2(at_[i], at_[j])) / Vec2(hs, ht);
    for (int k = 0; k < n; ++k) bernstein_restrict(&c[k], n, kDegree, lo.x, hi.x);
    for (int k = 0; k < n; ++k) bernstein_restrict(&c[k * n], 1, kDegree, lo.y, hi.y);
    // With a in [-1, 1]: sum_k c_k B_k((1 + a) / 2), first in a, then in b.
    static const std::array<double, n* n> kPowers = powers_of_bernstein();
    Taylor p;
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y) {
        double sum = 0;
        for (int k = 0; k < n; ++k)
          for (int l = 0; l < n; ++l) sum += c[k * n + l] * kPowers[k * n + x] * kPowers[l * n + y];
        p.c[Taylor::index(x, y)] = sum;
      }
    return p;
  }

  // Row k: B_k((1 + a) / 2) in powers of a.
  static std::array<double, (kDegree + 1) * (kDegree + 1)> powers_of_bernstein() {
    std::array<double, (kDegree + 1) * (kDegree + 1)> rows{};
    double binomial = 1;
    for (int k = 0; k <= kDegree; ++k) {
      std::array<double, kDegree + 1> row{binomial};
      for (int f = 0; f < kDegree; ++f)
        for (int p = kDegree; p >= 0; --p) row[p] = 0.5 * (row[p] + (f < k ? 1 : -1) * (p > 0 ? row[p - 1] : 0.0));
      for (int p = 0; p <= kDegree; ++p) rows[k * (kDegree + 1) + p] = row[p];
      binomial = binomial * (kDegree - k) / (k + 1);
    }
    return rows;
  }

  // In the middle of a box about which the spline is that of the cell.
  SampledSlopes slopes_amid(int i, int j, const Box2& box) const {
    const Vec2 st = box.middle(), half = 0.5 * box.size();
    std::vector<Dual1<double>> W(points_);
    patch_weights<Dual1<double>>(basis_, {st.x, 1.0, 0.0}, {st.y, 0.0, 1.0}, W.data());
    SampledSlopes slopes;
    for (int m = 0; m < points_; ++m) {
      const Taylor spline = quintic(i, j, m, box);
      slopes.s.push_back(W[m].u);
      slopes.t.push_back(W[m].v);
      slopes.spline_s.push_back(spline.c[Taylor::index(1, 0)] / half.x);
      slopes.spline_t.push_back(spline.c[Taylor::index(0, 1)] / half.y);
    }
    return slopes;
  }

  void prove_cell(int i, int j, WeightSplines& out) {
    if (i + j > 0 || !no_slope_at_corner()) return prove(i, j, {{at_[i], at_[j]}, {at_[i + 1], at_[j + 1]}}, 0, out);
    for (const bool swapped : {false, true}) prove_corner(swapped, {Vec2(0.0), {at_[1], 1}}, 0, out);
  }

  void prove(int i, int j, const Box2& box, int level, WeightSplines& out) {
    const Vec2 middle = box.middle(), half = 0.5 * box.size();
    std::vector<Taylor> difference(points_);
    patch_weights(basis_, Taylor(middle.x, half.x, 0), Taylor(middle.y, 0, half.y), difference.data());
    for (int m = 0; m < points_; ++m) difference[m] = difference[m] - quintic(i, j, m, box);
    if (level < kMostProofLevels && !settled(difference)) {
      for (const Box2& part : divided(box)) prove(i, j, part, level + 1, out);
      return;
    }
    include(i, j, difference, out);
  }

  // Across their length those that are long: weights vary as much along both sides.
  static std::vector<Box2> divided(const Box2& box) {
    const Vec2 size = box.size();
    std::vector<Box2> parts{box};
    for (const int c : {0, 1}) {
      if (size[c] < 0.6 * size[1 - c]) continue;
      for (std::size_t k = parts.size(); k-- > 0;) {
        Box2 upper = parts[k];
        parts[k].hi[c] = upper.lo[c] = box.middle()[c];
        parts.push_back(upper);
      }
    }
    return parts;
  }

  // The cell at the corner, in halves (s, t) = (r, r w) and (r w, r): a box of (r, w).
  void prove_corner(bool swapped, const Box2& box, int level, WeightSplines& out) {
    using Corner = CornerSeries<Taylor>;
    const Vec2 middle = box.middle(), half = 0.5 * box.size();
    const Taylor r(middle.x, half.x, 0), w(middle.y, 0, half.y), rw = r * w;
    const Corner far(1.0, 1, middle.x, half.x), near(w, 1, middle.x, half.x);
    std::vector<Corner> W(points_);
    patch_weights(basis_, swapped ? near : far, swapped ? far : near, W.data());
    const std::vector<Taylor> spline = quintics_at_corner(swapped ? rw : r, swapped ? r : rw);
    std::vector<Taylor> difference(points_);
    for (int m = 0; m < points_; ++m) difference[m] = W[m].value() - spline[m];
    if (level < kMostProofLevels && !settled(difference)) {
      const Vec2 amid = box.lo + half;
      for (const double x : {box.lo.x, amid.x})
        for (const double y : {box.lo.y, amid.y}) prove_corner(swapped, {{x, y}, Vec2(x, y) + half}, level + 1, out);
      return;
    }
    include(0, 0, difference, out);
  }

  // The quintics of the first cell as functions of s and t, which are powers of others.
  std::vector<Taylor> quintics_at_corner(const Taylor& s, const Taylor& t) const {
    constexpr int n = kDegree + 1;
    const double h = at_[1];
    std::array<Taylor, n * n> bernstein;
    std::array<Taylor, n> in_s, in_t;
    const Taylor x = s * (1 / h), y = t * (1 / h);
    bernstein_weights(kDegree, x, 1.0 - x, in_s.data());
    bernstein_weights(kDegree, y, 1.0 - y, in_t.data());
    for (int k = 0; k < n; ++k)
      for (int l = 0; l < n; ++l) bernstein[k * n + l] = in_s[k] * in_t[l];
    std::vector<Taylor> sums(points_);
    for (int m = 0; m < points_; ++m)
      for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l) {
          const HermiteRow of_s = hermite_row(k, h), of_t = hermite_row(l, h);
          sums[m] = sums[m] + bernstein[k * n + l] * combine(of_s.by, of_t.by, at(of_s.node, of_t.node)[m]);
        }
    return sums;
  }

  void include(int i, int j, const std::vector<Taylor>& difference, WeightSplines& out) const {
    const std::size_t cell = static_cast<std::size_t>(i) * cells_ + j, of_points = cell * points_, of_pairs = cell * out.pairs.size();
    for (int m = 0; m < points_; ++m) raise(out.error[of_points + m], difference[m]);
    for (std::size_t p = 0; p < out.pairs.size(); ++p) {
      const Taylor &a = difference[out.pairs[p].first], &b = difference[out.pairs[p].second];
      raise(out.error_of_sum[of_pairs + p], a + b);
      raise(out.error_of_difference[of_pairs + p], 0.5 * (a - b));
    }
  }

  // To what bounds e, too; by quarters, since a sum of many terms is seldom reached.
  static void raise(double& worst, const Taylor& e, int quarters = 3) {
    const double size = e.magnitude() + kRounding;
    if (size <= worst) return;
    if (!finite(size))
      worst = kInf;
    else if (quarters == 0 || e.spread() - e.radius <= kUnknownShare * size)
      worst = size;
    else
      for (const double a : {-0.5, 0.5})
        for (const double b : {-0.5, 0.5}) raise(worst, e.quarter(a, b), quarters - 1);
  }

  static bool settled(const std::vector<Taylor>& difference) {
    double unknown = 0, most = 0;
    for (const Taylor& e : difference) {
      if (!finite(e.radius)) return false;
      unknown = std::max(unknown, e.radius);
      most = std::max(most, e.magnitude() - e.radius);
    }
    return unknown <= std::max(kUnknownShare * most, kNextToNothing);
  }

  PatchBasis basis_;
  int points_;
  std::vector<double> at_;  // where the cells meet
  int cells_;
  std::vector<std::vector<NodeDerivatives>> nodes_;
};

}  // namespace

std::shared_ptr<const WeightSplines> weight_splines(const PatchBasis& basis, const SplineGrid& grid) {
  static MadeOnce<std::pair<PatchBasis, SplineGrid>, WeightSplines> kept;
  return kept.of({basis, grid}, [&] { return SplineMaker(basis, grid).make(); });
}

}  // namespace iso
