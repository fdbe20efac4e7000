// Bounds over a Bezier patch. A bilinear field m of unit normals at the corners stands for the normal n: m . Suu and the others are
// polynomials whose coefficients bound them, and m . Su, m . Sv tell how far m is from being normal, which is of second order in the size
// of the patch. So the bounds close in quadratically.
//
// Rational patches: with H = (P - c w, w) and c the middle, w Suu = Huu - 2 wu Su - wuu (S - c) and so on, where all terms but the first
// are nearly tangential. Quotients of polynomials of one degree lie between the quotients of their coefficients, as the weights are
// positive.
#include "patches/bend_cell.h"

#include "patches/base/bspline_basis.h"

namespace iso {

namespace {

// Corner normals from tangents at a smaller angle are noise.
constexpr double kLeastSine = 1e-9;

void difference(const HomogeneousNet& f, int direction, HomogeneousNet& out) {
  const int degree = direction == 0 ? f.pu : f.pv;
  out.pu = direction == 0 ? std::max(0, f.pu - 1) : f.pu;
  out.pv = direction == 0 ? f.pv : std::max(0, f.pv - 1);
  out.c.resize(static_cast<std::size_t>(out.pu + 1) * (out.pv + 1));
  const std::size_t step = direction == 0 ? static_cast<std::size_t>(f.pv) + 1 : 1;
  std::size_t k = 0;
  for (int i = 0; i <= out.pu; ++i)
    for (int j = 0; j <= out.pv; ++j) {
      const std::size_t at = static_cast<std::size_t>(i) * (f.pv + 1) + j;
      out.c[k++] = degree == 0 ? Vec4(0.0) : static_cast<double>(degree) * (f.c[at + step] - f.c[at]);
    }
}

// The same polynomial of higher degree, in place.
void raise(HomogeneousNet& f, int pu, int pv) {
  for (; f.pv < pv; ++f.pv) {
    std::vector<Vec4> c;
    for (int i = 0; i <= f.pu; ++i)
      for (int j = 0; j <= f.pv + 1; ++j) {
        const double share = static_cast<double>(j) / (f.pv + 1);
        const Vec4* row = &f.c[static_cast<std::size_t>(i) * (f.pv + 1)];
        c.push_back((j > 0 ? share * row[j - 1] : Vec4(0.0)) + (j <= f.pv ? (1 - share) * row[j] : Vec4(0.0)));
      }
    f.c = std::move(c);
  }
  for (; f.pu < pu; ++f.pu) {
    std::vector<Vec4> c;
    for (int i = 0; i <= f.pu + 1; ++i)
      for (int j = 0; j <= pv; ++j) {
        const double share = static_cast<double>(i) / (f.pu + 1);
        const std::size_t at = static_cast<std::size_t>(i) * (pv + 1) + j, above = at - (static_cast<std::size_t>(pv) + 1);
        c.push_back((i > 0 ? share * f.c[above] : Vec4(0.0)) + (i <= f.pu ? (1 - share) * f.c[at] : Vec4(0.0)));
      }
    f.c = std::move(c);
  }
}

const Vec4& corner(const HomogeneousNet& f, int k) {
  const std::size_t i = k & 2 ? static_cast<std::size_t>(f.pu) : 0, j = k & 1 ? static_cast<std::size_t>(f.pv) : 0;
  return f.c[i * (f.pv + 1) + j];
}

double largest(const Range& r) { return std::max(std::abs(r.lo), std::abs(r.hi)); }

}  // namespace

void PatchBend::load(const BezierPatch& patch) {
  S_.pu = patch.pu;
  S_.pv = patch.pv;
  S_.c = patch.net;
  if (rational_) {
    const Vec3 middle = project(homogeneous_jet(patch, {0.5, 0.5}).H);
    for (Vec4& h : S_.c) h -= Vec4(h.w * middle, 0.0);
  }
  difference(S_, 0, Su_);
  difference(S_, 1, Sv_);
  difference(Su_, 0, Suu_);
  difference(Su_, 1, Suv_);
  difference(Sv_, 1, Svv_);
  if (!rational_) return;
  for (HomogeneousNet* f : {&Su_, &Sv_, &Suu_, &Suv_, &Svv_}) raise(*f, patch.pu, patch.pv);
  set_weights();
}

void PatchBend::set_weights() {
  w_.clear();
  raised_w_.clear();
  radius_ = wu_ = wv_ = wuu_ = wuv_ = wvv_ = 0;
  for (const Vec4& h : S_.c) {
    w_.push_back(h.w);
    radius_ = std::max(radius_, glm::length(project(h)));
  }
  HomogeneousNet one_more = S_;
  raise(one_more, S_.pu + 1, S_.pv + 1);
  for (const Vec4& h : one_more.c) raised_w_.push_back(h.w);
  for (std::size_t i = 0; i < w_.size(); ++i) {
    wu_ = std::max(wu_, std::abs(Su_.c[i].w / w_[i]));
    wv_ = std::max(wv_, std::abs(Sv_.c[i].w / w_[i]));
    wuu_ = std::max(wuu_, std::abs(Suu_.c[i].w / w_[i]));
    wuv_ = std::max(wuv_, std::abs(Suv_.c[i].w / w_[i]));
    wvv_ = std::max(wvv_, std::abs(Svv_.c[i].w / w_[i]));
  }
}

// w Su = Hu - wu (S - c)
PatchBend::Tangents PatchBend::tangents(const HomogeneousNet& net, double slope, double rounding) const {
  Tangents t;
  const double ball = slope * radius_ + rounding;
  const auto at = [&](std::size_t i) { return Vec3(net.c[i]) / (rational_ ? w_[i] : 1.0); };
  for (std::size_t i = 0; i < net.c.size(); ++i) t.centre += at(i);
  t.centre /= static_cast<double>(net.c.size());
  const double length = glm::length(t.centre);
  if (length > 0) t.axis = t.centre / length;
  t.least = kInf;
  double across = 0;
  for (std::size_t i = 0; i < net.c.size(); ++i) {
    const Vec3 x = at(i);
    const double along = glm::dot(x, t.axis);
    t.stray = std::max(t.stray, glm::length(x - t.centre));
    t.least = std::min(t.least, along);
    across = std::max(across, glm::length(x - along * t.axis));
  }
  t.stray += ball;
  t.least -= ball;
  t.tangent = t.least > 0 ? (across + ball) / t.least : kInf;
  return t;
}

// Of |H - wa A - wb B| / w over the coefficients.
double PatchBend::supremum(const HomogeneousNet& net, const HomogeneousNet& wa, const Vec3& A, const HomogeneousNet& wb,
                           const Vec3& B) const {
  double most = 0;
  for (std::size_t i = 0; i < net.c.size(); ++i) {
    Vec3 x(net.c[i]);
    if (rational_) x = (x - wa.c[i].w * A - wb.c[i].w * B) / w_[i];
    most = std::max(most, glm::dot(x, x));
  }
  return std::sqrt(most);
}

void PatchBend::bound_lengths(const Tangents& u, const Tangents& v, double rounding, Bend& bend) const {
  bend.Muu = supremum(Suu_, Su_, u.centre, Su_, u.centre) + 2 * wu_ * u.stray + wuu_ * radius_;
  bend.Muv = supremum(Suv_, Su_, v.centre, Sv_, u.centre) + wu_ * v.stray + wv_ * u.stray + wuv_ * radius_;
  bend.Mvv = supremum(Svv_, Sv_, v.centre, Sv_, v.centre) + 2 * wv_ * v.stray + wvv_ * radius_;
  const int pu = S_.pu, pv = S_.pv;
  if (pu > 1 || rational_) bend.Muu += 4 * pu * pu * rounding;
  if (pu > 0 && pv > 0) bend.Muv += 4 * pu * pv * rounding;
  if (pv > 1 || rational_) bend.Mvv += 4 * pv * pv * rounding;
}

// The normals at the corners; one that vanishes is taken from the others.
bool PatchBend::set_normals() {
  bool found[4];
  Vec3 mean{0.0};
  for (int k = 0; k < 4; ++k) {
    const Vec4 &h = corner(S_, k), &hu = corner(Su_, k), &hv = corner(Sv_, k);
    Vec3 a(hu), b(hv);
    if (rational_) {
      const Vec3 S = project(h);
      a -= hu.w * S;
      b -= hv.w * S;
    }
    const Vec3 n = glm::cross(a, b);
    const double area = glm::length(n);
    found[k] = area > kLeastSine * glm::length(a) * glm::length(b);
    if (found[k]) mean += normals_[k] = n / area;
  }
  const double length = glm::length(mean);
  if (!(length > 0)) return false;
  for (int k = 0; k < 4; ++k)
    if (!found[k]) normals_[k] = mean / length;
  return true;
}

// The range of m . f over w: coefficients of the product of a bilinear field with a polynomial.
Range PatchBend::along_normal(const HomogeneousNet& f) {
  const std::size_t n = f.c.size(), row = static_cast<std::size_t>(f.pv) + 1;
  dots_.resize(4 * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 4; ++k) dots_[k * n + i] = glm::dot(normals_[k], Vec3(f.c[i]));
  const double scale = 1.0 / ((f.pu + 1) * (f.pv + 1));
  Range range;
  std::size_t out = 0;
  for (int k = 0; k <= f.pu + 1; ++k)
    for (int l = 0; l <= f.pv + 1; ++l, ++out) {
      const double* at = &dots_[0] + static_cast<std::ptrdiff_t>(k * row) + l;
      double sum = 0;
      const auto add = [&](int which, int i, int j) {
        return at[which * static_cast<std::ptrdiff_t>(n) - i * static_cast<std::ptrdiff_t>(row) - j];
      };
      if (k <= f.pu && l <= f.pv) sum += (f.pu + 1 - k) * (f.pv + 1 - l) * add(0, 0, 0);
      if (k <= f.pu && l > 0) sum += (f.pu + 1 - k) * l * add(1, 0, 1);
      if (k > 0 && l <= f.pv) sum += k * (f.pv + 1 - l) * add(2, 1, 0);
      if (k > 0 && l > 0) sum += k * l * add(3, 1, 1);
      range.include(rational_ ? scale * sum / raised_w_[out] : scale * sum);
    }
  return range;
}

// n = (m - mT) / (m . n), where the tangential part mT of m follows from m . Su and m . Sv.
bool PatchBend::bound_second_form(const Tangents& u, const Tangents& v, double rounding, Bend& bend) {
  if (!(u.least > 0) || !(v.least > 0) || !set_normals()) return false;
  const int pu = S_.pu, pv = S_.pv;
  const double s = rational_ ? largest(along_normal(S_)) + 2 * rounding : 0.0;
  const double a = largest(along_normal(Su_)) + wu_ * s + 2 * pu * rounding;
  const double b = largest(along_normal(Sv_)) + wv_ * s + 2 * pv * rounding;
  // The cosine between Su and Sv: that of their axes, moved by the half angles of their cones.
  const double c0 = std::min(1.0, std::abs(glm::dot(u.axis, v.axis))), s0 = glm::length(glm::cross(u.axis, v.axis));
  const double open = 1 - u.tangent * v.tangent;
  if (!(open > 0)) return false;
  const double tangent = (u.tangent + v.tangent) / open;  // of both half angles together
  if (!(s0 > c0 * tangent)) return false;                 // they may meet
  const double c = std::min(1.0, (c0 + s0 * tangent) / std::sqrt(1 + tangent * tangent));
  const double alpha = a / u.least, beta = b / v.least;
  const double slip2 = (alpha * alpha + beta * beta + 2 * alpha * beta * c) / (1 - c * c);
  double least2 = 1;  // of |m|^2: a coefficient of its square is a mean of products of two of the normals
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < k; ++l) least2 = std::min(least2, glm::dot(normals_[k], normals_[l]));
  if (!(least2 - slip2 > 0.01)) return false;
  const double slip = std::sqrt(slip2), least = std::sqrt(least2 - slip2) * (1 - 8 * kEps);
  const auto range = [&](const HomogeneousNet& net, double extra, double M, double error) {
    Range r = along_normal(net);
    const double by = extra + slip * M + error;
    r = {r.lo - by, r.hi + by};
    return Range{r.lo < 0 ? r.lo / least : r.lo, r.hi > 0 ? r.hi / least : r.hi};
  };
  bend.uu = range(Suu_, 2 * wu_ * a + wuu_ * s, bend.Muu, pu > 1 || rational_ ? 4 * pu * pu * rounding : 0.0);
  bend.uv = range(Suv_, wu_ * b + wv_ * a + wuv_ * s, bend.Muv, pu > 0 && pv > 0 ? 4 * pu * pv * rounding : 0.0);
  bend.vv = range(Svv_, 2 * wv_ * b + wvv_ * s, bend.Mvv, pv > 1 || rational_ ? 4 * pv * pv * rounding : 0.0);
  return true;
}

// How much the forms and the tangents differ between opposite sides.
void PatchBend::promise(Result& result) const {
  const Bend& b = result.bend;
  const auto differences = [&](auto value, double& s, double& t) {
    s += glm::length(value(2) - value(0)) + glm::length(value(3) - value(1));
    t += glm::length(value(1) - value(0)) + glm::length(value(3) - value(2));
  };
  const auto tangent = [&](const HomogeneousNet& f, int k) {
    const Vec4 &h = corner(S_, k), &d = corner(f, k);
    return rational_ ? (Vec3(d) - d.w * project(h)) / h.w : Vec3(d);
  };
  if (!result.bounded) {
    const double u = std::max(1e-300, glm::length(tangent(Su_, 0)) + glm::length(tangent(Su_, 3)));
    const double v = std::max(1e-300, glm::length(tangent(Sv_, 0)) + glm::length(tangent(Sv_, 3)));
    differences([&](int k) { return tangent(Su_, k) / u; }, result.along_s, result.along_t);
    differences([&](int k) { return tangent(Sv_, k) / v; }, result.along_s, result.along_t);
    return;
  }
  double turn_s = 0, turn_t = 0;
  differences([&](int k) { return normals_[k]; }, turn_s, turn_t);
  for (const HomogeneousNet* f : {&Suu_, &Suv_, &Suv_, &Svv_})
    differences([&](int k) { return Vec3(glm::dot(normals_[k], Vec3(corner(*f, k))) / corner(S_, k).w, 0, 0); }, result.along_s,
                result.along_t);
  const double size = b.Muu + 2 * b.Muv + b.Mvv;
  result.along_s += 0.5 * turn_s * turn_s * size;
  result.along_t += 0.5 * turn_t * turn_t * size;
}

PatchBend::Result PatchBend::bound(const BezierPatch& patch, bool rational, double rounding) {
  rational_ = rational;
  if (!rational) radius_ = wu_ = wv_ = wuu_ = wuv_ = wvv_ = 0;
  load(patch);
  Result result;
  const Tangents u = tangents(Su_, wu_, 2 * S_.pu * rounding), v = tangents(Sv_, wv_, 2 * S_.pv * rounding);
  bound_lengths(u, v, rounding, result.bend);
  result.bounded = bound_second_form(u, v, rounding, result.bend);
  if (result.bounded)
    result.bend.curvature = curvature_bound(u.centre, v.centre, u.stray, v.stray, result.bend);
  else
    result.bend.uu = result.bend.uv = result.bend.vv = kEverything, result.bend.curvature = kInf;
  promise(result);
  return result;
}

}  // namespace iso
