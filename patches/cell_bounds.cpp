#include "patches/cell_bounds.h"

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "patches/base/bernstein.h"
#include "patches/base/four.h"
#include "patches/base/per_degree.h"
#include "patches/cells.h"

namespace iso {

namespace {

// Tangents at a smaller angle span no slab.
constexpr double kLeastSine = 1e-6;

// A tangent shorter than this many units in the last place of the points is what rounding leaves of none: some times what sums of
// usual degrees err by, and far below what a leaf can be sure of (kMostRoundingOfRoot in raytracer/leaf.cpp).
constexpr double kRoundedAway = 256;

// The margin in the parameters of the patch's unit square.
constexpr double kBeyond = 0.5 * (kCellMargin - 1);

// Patches of a higher degree are bounded by way of one of this degree.
constexpr int kReducedDegree = 3;

// What the reduction leaves out may make bounds looser by this share; else the full products are worth their time.
constexpr double kMostLoss = 1.0 / 16;

// ---- what depends on the degree alone ----------------------------------------------------------------------------------

// The basis at the low margin, in the middle and at the high margin.
using CrossBasis = std::array<BernsteinBasis, 3>;
CrossBasis make_cross_basis(int degree) {
  CrossBasis cross;
  for (const int k : {0, 1, 2}) bernstein_basis(degree, std::array{-kBeyond, 0.5, 1 + kBeyond}[static_cast<std::size_t>(k)], cross[k]);
  return cross;
}

using Binomials = std::array<double, kMaxDegree + 1>;
Binomials make_binomials(int degree) {
  Binomials row{1.0};
  for (int i = 1; i <= degree; ++i) row[i] = row[i - 1] * (degree + 1 - i) / i;
  return row;
}
const Binomials& binomials(int degree) { return of_degree<Binomials, make_binomials>(degree); }

// A map between Bernstein coefficients, row by row.
struct Matrix {
  int rows = 0, columns = 0;
  std::vector<double> entries;

  double at(int i, int k) const { return entries[static_cast<std::size_t>(i) * columns + k]; }
};

// Onto the coefficients up to the margins: the blossom at both ends.
Matrix make_extension(int degree) {
  Matrix m{degree + 1, degree + 1, {}};
  for (int j = 0; j <= degree; ++j)
    for (int i = 0; i <= degree; ++i) {
      std::array<double, kMaxDegree + 1> work{};
      work[i] = 1;
      for (int level = 1; level <= degree; ++level) {
        const double t = level <= j ? 1 + kBeyond : -kBeyond;
        for (int k = 0; k + level <= degree; ++k) work[k] = (1 - t) * work[k] + t * work[k + 1];
      }
      m.entries.push_back(work[0]);
    }
  return m;
}

// Onto those of the cubic with the same values at the four points of Chebyshev; any cubic near by would do.
Matrix make_reduction(int degree) {
  Matrix m{kReducedDegree + 1, degree + 1, std::vector<double>(static_cast<std::size_t>(kReducedDegree + 1) * (degree + 1))};
  glm::dmat4 values;  // of the cubic basis; columns: basis functions
  std::array<BernsteinBasis, kReducedDegree + 1> high;
  for (int k = 0; k <= kReducedDegree; ++k) {
    const double s = 0.5 - 0.5 * std::cos((2 * k + 1) * kPi / (2 * kReducedDegree + 2));
    BernsteinBasis low;
    bernstein_basis(kReducedDegree, s, low);
    bernstein_basis(degree, s, high[k]);
    for (int i = 0; i <= kReducedDegree; ++i) values[i][k] = low.B[i];
  }
  const glm::dmat4 inverse = glm::inverse(values);
  for (int i = 0; i <= kReducedDegree; ++i)
    for (int j = 0; j <= degree; ++j)
      for (int k = 0; k <= kReducedDegree; ++k) m.entries[static_cast<std::size_t>(i) * m.columns + j] += inverse[k][i] * high[k].B[j];
  return m;
}

// From a cubic's coefficients onto the same polynomial's of `degree`.
Matrix make_elevation(int degree) {
  Matrix m{degree + 1, kReducedDegree + 1, {}};
  const Binomials &all = binomials(degree), &cubic = binomials(kReducedDegree), &rest = binomials(degree - kReducedDegree);
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j <= kReducedDegree; ++j)
      m.entries.push_back(i < j || i - j > degree - kReducedDegree ? 0.0 : cubic[j] * rest[i - j] / all[i]);
  return m;
}

// The nets with `m` applied to every line along s, along t.
void map_along_s(const Matrix& m, const BezierPatch& in, BezierPatch& out) {
  out.pu = m.rows - 1;
  out.pv = in.pv;
  out.net.resize(static_cast<std::size_t>(m.rows) * (in.pv + 1));
  const std::size_t columns = static_cast<std::size_t>(in.pv) + 1;
  for (std::size_t j = 0; j < columns; ++j) {
    const double* factor = m.entries.data();
    for (std::size_t i = 0; i <= static_cast<std::size_t>(out.pu); ++i) {
      Four sum{};
      for (int k = 0; k < m.columns; ++k, ++factor) sum += *factor * Four(in.net[static_cast<std::size_t>(k) * columns + j]);
      sum.store(out.net[i * columns + j]);
    }
  }
}
void map_along_t(const Matrix& m, const BezierPatch& in, BezierPatch& out) {
  out.pu = in.pu;
  out.pv = m.rows - 1;
  out.net.resize(static_cast<std::size_t>(in.pu + 1) * m.rows);
  Vec4* to = out.net.data();
  for (int i = 0; i <= in.pu; ++i) {
    const Vec4* row = &in.at(i, 0);
    const double* factor = m.entries.data();
    for (int j = 0; j < m.rows; ++j, ++to) {
      Four sum{};
      for (int k = 0; k < m.columns; ++k, ++factor) sum += *factor * Four(row[k]);
      sum.store(*to);
    }
  }
}

// ---- samples -----------------------------------------------------------------------------------------------------------

// Half-width derivatives of S.
struct Slopes {
  Vec3 a{0.0}, b{0.0};
};
Slopes slopes_of(const HomogeneousJet& j, bool rational) {
  const double half = 0.5 / j.H.w;
  if (!rational) return {half * Vec3(j.Hs), half * Vec3(j.Ht)};
  const Vec3 S = project(j.H);
  return {half * (Vec3(j.Hs) - j.Hs.w * S), half * (Vec3(j.Ht) - j.Ht.w * S)};
}

// A line of the net's values and slopes across, evaluated along.
struct CrossLine {
  std::array<Four, kMaxDegree + 1> value, slope;

  // Of `lines` lines of degree `across`, from net[0], net[line], ...; their points lie `step` apart.
  CrossLine(const Vec4* net, int lines, std::size_t line, int across, std::size_t step, const BernsteinBasis& basis) {
    for (int i = 0; i < lines; ++i, net += line) {
      Four v{}, d{};
      for (int j = 0; j <= across; ++j) {
        const Four h(net[static_cast<std::size_t>(j) * step]);
        v += basis.B[j] * h;
        d += basis.D[j] * h;
      }
      value[i] = v;
      slope[i] = d;
    }
  }

  HomogeneousJet at(int degree, const BernsteinBasis& basis) const {
    Four H{}, Hs{}, Ht{};
    for (int i = 0; i <= degree; ++i) {
      H += basis.B[i] * value[i];
      Hs += basis.D[i] * value[i];
      Ht += basis.B[i] * slope[i];
    }
    return {Vec4(H), Vec4(Hs), Vec4(Ht)};
  }
};

}  // namespace

bool is_rational(const BezierPatch& patch) {
  for (const Vec4& h : patch.net)
    if (h.w != patch.net.front().w) return true;
  return false;
}

LinearModel sampled_model(const BezierPatch& patch, bool rational) {
  const CrossBasis &bs = of_degree<CrossBasis, make_cross_basis>(patch.pu), &bt = of_degree<CrossBasis, make_cross_basis>(patch.pv);
  const std::size_t columns = static_cast<std::size_t>(patch.pv) + 1;  // lines through the middle
  const CrossLine along_s(patch.net.data(), patch.pu + 1, columns, patch.pv, 1, bt[1]);
  const CrossLine along_t(patch.net.data(), patch.pv + 1, 1, patch.pu, columns, bs[1]);
  LinearModel m;
  const HomogeneousJet middle = along_s.at(patch.pu, bs[1]);
  const Slopes model = slopes_of(middle, rational);
  m.centre = project(middle.H);
  m.A = model.a;
  m.B = model.b;
  const double a = std::max(glm::length(m.A), 1e-300), b = std::max(glm::length(m.B), 1e-300);
  if (std::min(a, b) <= kRoundedAway * kEps * (glm::length(m.centre) + a + b)) {  // a line or a point: shorter is all that parts can be
    m.stray_a = m.stray_b = kUnboundedStray;
    m.along_s = a;
    m.along_t = b;
    return m;
  }
  const Vec3 cross = glm::cross(m.A, m.B);
  if (glm::length(cross) > kLeastSine * glm::length(m.A) * glm::length(m.B)) m.normal = glm::normalize(cross);
  const auto variation = [&](const Slopes& at) {
    m.stray_a.include_square(at.a - m.A, m.normal);
    m.stray_b.include_square(at.b - m.B, m.normal);
    return glm::length(at.a - m.A) / a + glm::length(at.b - m.B) / b;
  };
  for (const int k : {0, 2}) {
    m.along_s += variation(slopes_of(along_s.at(patch.pu, bs[k]), rational));
    const Slopes swapped = slopes_of(along_t.at(patch.pv, bt[k]), rational);
    m.along_t += variation({swapped.b, swapped.a});
  }
  m.stray_a.take_roots();
  m.stray_b.take_roots();
  return m;
}

void extend_to_margin(const BezierPatch& patch, bool rational, BezierPatch& wide) {
  thread_local BezierPatch half;
  map_along_s(of_degree<Matrix, make_extension>(patch.pu), patch, half);
  map_along_t(of_degree<Matrix, make_extension>(patch.pv), half, wide);
  if (!rational)
    for (Vec4& h : wide.net) h.w = patch.net.front().w;  // rounding must not make it rational
}

// ---- bounds ------------------------------------------------------------------------------------------------------------

namespace {

void bound_polynomial(const BezierPatch& patch, LinearModel& m) {
  const int pu = patch.pu, pv = patch.pv;
  const double scale = 0.5 / patch.net.front().w, scale_s = scale * pu, scale_t = scale * pv;
  const Vec3 A = m.A, B = m.B, normal = m.normal;
  Stray a, b;
  const Vec4* net = patch.net.data();
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j, ++net) {
      if (i < pu) a.include_square(scale_s * (Vec3(net[pv + 1]) - Vec3(net[0])) - A, normal);
      if (j < pv) b.include_square(scale_t * (Vec3(net[1]) - Vec3(net[0])) - B, normal);
    }
  a.take_roots();
  b.take_roots();
  m.stray_a = a;
  m.stray_b = b;
}

// Bounds of a net's points and weights, and of their half-width derivatives.
struct Sizes {
  double point = 0, weight = 0, least_weight = kInf;
  double point_s = 0, weight_s = 0, point_t = 0, weight_t = 0;
};
Sizes sizes_of(const BezierPatch& net) {
  Sizes s;
  const auto square = [](const Vec4& h) { return glm::dot(Vec3(h), Vec3(h)); };
  for (int i = 0; i <= net.pu; ++i)
    for (int j = 0; j <= net.pv; ++j) {
      const Vec4& h = net.at(i, j);
      s.point = std::max(s.point, square(h));
      s.weight = std::max(s.weight, std::abs(h.w));
      s.least_weight = std::min(s.least_weight, h.w);
      if (i < net.pu) {
        const Vec4 d = net.at(i + 1, j) - h;
        s.point_s = std::max(s.point_s, square(d));
        s.weight_s = std::max(s.weight_s, std::abs(d.w));
      }
      if (j < net.pv) {
        const Vec4 d = net.at(i, j + 1) - h;
        s.point_t = std::max(s.point_t, square(d));
        s.weight_t = std::max(s.weight_t, std::abs(d.w));
      }
    }
  s.point = std::sqrt(s.point);
  s.point_s = 0.5 * net.pu * std::sqrt(s.point_s);
  s.point_t = 0.5 * net.pv * std::sqrt(s.point_t);
  s.weight_s *= 0.5 * net.pu;
  s.weight_t *= 0.5 * net.pv;
  return s;
}

}  // namespace

// dS/ds - A = (P_s w - P w_s - A w^2) / w^2, with P about the middle. With binomials in them the coefficients of P and w multiply like
// power series in s / (1 - s), and in P_s w - P w_s two control points a, b meet as (i_b - i_a) w_a w_b (S_b - S_a), two degrees lower in s
// than w^2: raising multiplies by (1 + x)^2.
void StrayBounds::multiply_out(const BezierPatch& net) {
  const int pu = net.pu, pv = net.pv, columns = 2 * pv + 1, rows = 2 * pu + 1;
  const Binomials &cu = binomials(pu), &cv = binomials(pv);
  points_.clear();
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j) points_.emplace_back(project(net.at(i, j)), net.at(i, j).w * cu[i] * cv[j]);
  bins_.assign(static_cast<std::size_t>(rows) * columns, {});
  const auto meet = [](const Four& a, double weight, const Four& b, double di, double dj, Bin& bin) {
    const Four between = b - a, d = weight * Four(between.lo, Four::Pair{between.hi[0], 1.0});
    bin.s += Four(di * d.lo, Four::Pair{di, 1.0} * d.hi);
    bin.t += dj * d;
  };
  const Vec4* a = points_.data();
  for (int i = 0; i <= pu; ++i)
    for (int j = 0; j <= pv; ++j, ++a) {
      Bin* bins = &bins_[static_cast<std::size_t>(2 * i) * columns + j];
      const Four here(*a);
      bins[j].s.hi[1] += 0.5 * a->w * a->w;
      for (int l = j + 1; l <= pv; ++l) meet(here, a->w * a[l - j].w, Four(a[l - j]), 0, l - j, bins[l]);
      for (int k = i + 1; k <= pu; ++k) {
        bins += columns;
        const Vec4* b = &points_[static_cast<std::size_t>(k) * (pv + 1)];
        for (int l = 0; l <= pv; ++l) meet(here, a->w * b[l].w, Four(b[l]), k - i, l - j, bins[l]);
      }
    }
}

void StrayBounds::bound_quotients(const BezierPatch& net, LinearModel& m) {
  multiply_out(net);
  const int columns = 2 * net.pv + 1, rows = 2 * net.pu + 1;
  Stray stray_a, stray_b;
  const Vec3 A = m.A, B = m.B, normal = m.normal;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const Bin* bin = &bins_[static_cast<std::size_t>(r) * columns + c];
      Four s = 2.0 * bin->s, t = 2.0 * bin->t;
      if (r > 0) s += bin[-columns].s;
      if (r + 1 < rows) s += bin[columns].s;
      if (c > 0) t += bin[-1].t;
      if (c + 1 < columns) t += bin[1].t;
      const double scale = 0.25 / bin->s.hi[1];
      stray_a.include_square(scale * Vec3(Vec4(s)) - A, normal);
      stray_b.include_square(scale * Vec3(Vec4(t)) - B, normal);
    }
  stray_a.take_roots();
  stray_b.take_roots();
  m.stray_a = stray_a;
  m.stray_b = stray_b;
}

// With P = Q + R and w = v + r, Q and v of low degree: P_s w - P w_s is Q_s v - Q v_s and what R and r bring in.
bool StrayBounds::bound_reduced(LinearModel& m) {
  const bool reduce_s = centred_.pu > kReducedDegree, reduce_t = centred_.pv > kReducedDegree;
  reduced_ = centred_;
  const auto apply = [&](auto map, const Matrix& matrix, BezierPatch& net) {
    map(matrix, net, work_);
    std::swap(net, work_);
  };
  if (reduce_t) apply(map_along_t, of_degree<Matrix, make_reduction>(centred_.pv), reduced_);
  if (reduce_s) apply(map_along_s, of_degree<Matrix, make_reduction>(centred_.pu), reduced_);
  rest_ = reduced_;
  if (reduce_s) apply(map_along_s, of_degree<Matrix, make_elevation>(centred_.pu), rest_);
  if (reduce_t) apply(map_along_t, of_degree<Matrix, make_elevation>(centred_.pv), rest_);
  for (std::size_t i = 0; i < rest_.net.size(); ++i) rest_.net[i] = centred_.net[i] - rest_.net[i];
  const Sizes whole = sizes_of(centred_), low = sizes_of(reduced_), rest = sizes_of(rest_);
  if (!(low.least_weight > 0)) return false;
  const double least = whole.least_weight, scale = 1 / (least * least), weights = whole.weight + low.weight;
  const double loss_a = scale * (rest.point_s * whole.weight + low.point_s * rest.weight + rest.point * whole.weight_s +
                                 low.point * rest.weight_s + glm::length(m.A) * rest.weight * weights);
  const double loss_b = scale * (rest.point_t * whole.weight + low.point_t * rest.weight + rest.point * whole.weight_t +
                                 low.point * rest.weight_t + glm::length(m.B) * rest.weight * weights);
  const double growth = (1 + rest.weight / least) * (1 + rest.weight / least);  // of v^2 / w^2
  if (growth > 1 + kMostLoss) return false;
  bound_quotients(reduced_, m);
  (m.stray_a *= growth) += loss_a;
  (m.stray_b *= growth) += loss_b;
  return loss_a <= kMostLoss * m.stray_a.length && loss_b <= kMostLoss * m.stray_b.length;
}

void StrayBounds::bound_rational(const BezierPatch& wide, LinearModel& m) {
  m.stray_a = m.stray_b = kUnboundedStray;
  for (const Vec4& h : wide.net)
    if (!(h.w > 0)) return;  // beyond its border a rational patch may have a pole
  centred_ = wide;
  for (Vec4& h : centred_.net) h -= Vec4(h.w * m.centre, 0.0);
  if (std::max(wide.pu, wide.pv) > kReducedDegree && bound_reduced(m)) return;
  bound_quotients(centred_, m);
}

void StrayBounds::bound(const BezierPatch& wide, bool rational, LinearModel& m) {
  LinearModel scaled = m;  // counts in the parameters of the margin
  scaled.A *= kCellMargin;
  scaled.B *= kCellMargin;
  scaled.stray_a = scaled.stray_b = {};
  if (rational)
    bound_rational(wide, scaled);
  else
    bound_polynomial(wide, scaled);
  m.stray_a = scaled.stray_a *= 1 / kCellMargin;
  m.stray_b = scaled.stray_b *= 1 / kCellMargin;
}

}  // namespace iso
