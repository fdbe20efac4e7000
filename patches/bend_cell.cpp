// Bounds over a Bezier patch. A bilinear field m of unit normals at the corners stands for the normal n: m . Suu and the others are
// polynomials whose coefficients bound them, and m . Su, m . Sv tell how far m is from being normal, which is of second order in the size
// of the patch. So the bounds close in quadratically.
//
// Rational patches: with L = c + s A + t B, the linear model about the middle, and H = (P - L w, w):
//   w Su = (Hu + A w) - wu (S - L)      w Suu = (Huu + 2 wu A) - 2 wu Su - wuu (S - L)      and so on;
// S - L is small of second order, and Su nearly tangential. Quotients of polynomials of one degree lie between the quotients of their
// coefficients, as the weights are positive.
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

// The same polynomial of higher degree, in place: rows grow from their ends, so that nothing is overwritten before it is used.
void raise(HomogeneousNet& f, int pu, int pv) {
  const auto lerp = [](const Vec4& before, const Vec4& at, int i, int degree) {
    const double share = static_cast<double>(i) / degree;
    return share * before + (1 - share) * at;
  };
  for (; f.pv < pv; ++f.pv) {
    const std::size_t old = static_cast<std::size_t>(f.pv) + 1;
    f.c.resize((static_cast<std::size_t>(f.pu) + 1) * (old + 1));
    for (std::size_t i = static_cast<std::size_t>(f.pu) + 1; i-- > 0;) {
      const Vec4* from = &f.c[i * old];
      Vec4* to = &f.c[i * (old + 1)];
      to[old] = from[old - 1];
      for (std::size_t j = old - 1; j > 0; --j) to[j] = lerp(from[j - 1], from[j], static_cast<int>(j), f.pv + 1);
      to[0] = from[0];
    }
  }
  const std::size_t row = static_cast<std::size_t>(f.pv) + 1;
  for (; f.pu < pu; ++f.pu) {
    const std::size_t old = static_cast<std::size_t>(f.pu) + 1;
    f.c.resize((old + 1) * row);
    for (std::size_t j = 0; j < row; ++j) {
      f.c[old * row + j] = f.c[(old - 1) * row + j];
      for (std::size_t i = old - 1; i > 0; --i)
        f.c[i * row + j] = lerp(f.c[(i - 1) * row + j], f.c[i * row + j], static_cast<int>(i), f.pu + 1);
    }
  }
}

const Vec4& corner(const HomogeneousNet& f, int k) {
  const std::size_t i = k & 2 ? static_cast<std::size_t>(f.pu) : 0, j = k & 1 ? static_cast<std::size_t>(f.pv) : 0;
  return f.c[i * (f.pv + 1) + j];
}

}  // namespace

void PatchBend::load(const BezierPatch& patch) {
  S_.pu = patch.pu;
  S_.pv = patch.pv;
  S_.c = patch.net;
  Vec3 A{0.0}, B{0.0};
  if (rational_) subtract_model(patch, A, B);
  difference(S_, 0, Su_);
  difference(S_, 1, Sv_);
  difference(Su_, 0, Suu_);
  difference(Su_, 1, Suv_);
  difference(Sv_, 1, Svv_);
  if (!rational_) return;
  for (HomogeneousNet* f : {&Su_, &Sv_, &Suu_, &Suv_, &Svv_}) raise(*f, S_.pu, S_.pv);
  set_weights();
  for (std::size_t i = 0; i < S_.c.size(); ++i) {
    const double w = S_.c[i].w, wu = Su_.c[i].w, wv = Sv_.c[i].w;
    Su_.c[i] += Vec4(w * A, 0.0);
    Sv_.c[i] += Vec4(w * B, 0.0);
    Suu_.c[i] += Vec4(2 * wu * A, 0.0);
    Suv_.c[i] += Vec4(wu * B + wv * A, 0.0);
    Svv_.c[i] += Vec4(2 * wv * B, 0.0);
  }
}

// S_ becomes that of S - L, one degree higher.
void PatchBend::subtract_model(const BezierPatch& patch, Vec3& A, Vec3& B) {
  const HomogeneousJet j = homogeneous_jet(patch, {0.5, 0.5});
  const Vec3 middle = project(j.H);
  A = (Vec3(j.Hs) - j.Hs.w * middle) / j.H.w;
  B = (Vec3(j.Ht) - j.Ht.w * middle) / j.H.w;
  for (Vec4& h : S_.c) h -= Vec4(h.w * (middle - 0.5 * (A + B)), 0.0);
  raise(S_, patch.pu + 1, patch.pv + 1);
  // Coefficients of s w and of t w, with weights raised in the other direction.
  const auto weight = [&](int i, int k) { return i < 0 || k < 0 || i > patch.pu || k > patch.pv ? 0.0 : patch.at(i, k).w; };
  const double pu = patch.pu + 1, pv = patch.pv + 1;
  std::size_t at = 0;
  for (int i = 0; i <= S_.pu; ++i)
    for (int k = 0; k <= S_.pv; ++k, ++at) {
      const double a = i / pu, b = k / pv;
      const double sw = a * (b * weight(i - 1, k - 1) + (1 - b) * weight(i - 1, k));
      const double tw = b * (a * weight(i - 1, k - 1) + (1 - a) * weight(i, k - 1));
      S_.c[at] -= Vec4(sw * A + tw * B, 0.0);
    }
}

void PatchBend::set_weights() {
  inverse_w_.clear();
  inverse_raised_w_.clear();
  radius_ = wu_ = wv_ = wuu_ = wuv_ = wvv_ = 0;
  for (const Vec4& h : S_.c) {
    inverse_w_.push_back(1 / h.w);
    radius_ = std::max(radius_, glm::length(project(h)));
  }
  raised_ = S_;
  raise(raised_, S_.pu + 1, S_.pv + 1);
  for (const Vec4& h : raised_.c) inverse_raised_w_.push_back(1 / h.w);
  for (std::size_t i = 0; i < inverse_w_.size(); ++i) {
    wu_ = std::max(wu_, std::abs(Su_.c[i].w) * inverse_w_[i]);
    wv_ = std::max(wv_, std::abs(Sv_.c[i].w) * inverse_w_[i]);
    wuu_ = std::max(wuu_, std::abs(Suu_.c[i].w) * inverse_w_[i]);
    wuv_ = std::max(wuv_, std::abs(Suv_.c[i].w) * inverse_w_[i]);
    wvv_ = std::max(wvv_, std::abs(Svv_.c[i].w) * inverse_w_[i]);
  }
}

// w Su = (Hu + A w) - wu (S - L)
PatchBend::Tangents PatchBend::tangents(const HomogeneousNet& net, double slope, double rounding) {
  Tangents t;
  const double ball = slope * radius_ + rounding;
  points_.clear();
  for (std::size_t i = 0; i < net.c.size(); ++i) points_.push_back(rational_ ? Vec3(net.c[i]) * inverse_w_[i] : Vec3(net.c[i]));
  for (const Vec3& x : points_) t.centre += x;
  t.centre /= static_cast<double>(points_.size());
  const double length = glm::length(t.centre);
  if (length > 0) t.axis = t.centre / length;
  double stray2 = 0, across2 = 0;
  t.least = kInf;
  for (const Vec3& x : points_) {
    const double along = glm::dot(x, t.axis);
    const Vec3 off = x - t.centre, across = x - along * t.axis;
    stray2 = std::max(stray2, glm::dot(off, off));
    across2 = std::max(across2, glm::dot(across, across));
    t.least = std::min(t.least, along);
  }
  t.stray = std::sqrt(stray2) + ball;
  t.least -= ball;
  t.tangent = t.least > 0 ? (std::sqrt(across2) + ball) / t.least : kInf;
  return t;
}

// Of |H - wa A - wb B| / w over the coefficients.
double PatchBend::supremum(const HomogeneousNet& net, const HomogeneousNet& wa, const Vec3& A, const HomogeneousNet& wb,
                           const Vec3& B) const {
  double most = 0;
  for (std::size_t i = 0; i < net.c.size(); ++i) {
    Vec3 x(net.c[i]);
    if (rational_) x = (x - wa.c[i].w * A - wb.c[i].w * B) * inverse_w_[i];
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

// The range of m . f over w: coefficients of the product of a bilinear field with a polynomial; first along rows, then across them.
Range PatchBend::along_normal(const HomogeneousNet& f) {
  const auto pu = static_cast<std::size_t>(f.pu), pv = static_cast<std::size_t>(f.pv), row = pv + 2;
  // Rows multiplied by the fields at s = 0 and at s = 1.
  rows_.assign(2 * (pu + 1) * row, 0.0);
  double *low = rows_.data(), *high = low + (pu + 1) * row;
  const double share_v = 1.0 / static_cast<double>(pv + 1), share_u = 1.0 / static_cast<double>(pu + 1);
  for (std::size_t i = 0; i <= pu; ++i)
    for (std::size_t j = 0; j <= pv; ++j) {
      const Vec3 c(f.c[i * (pv + 1) + j]);
      const double later = static_cast<double>(j + 1) * share_v, same = static_cast<double>(pv + 1 - j) * share_v;
      const std::size_t at = i * row + j;
      low[at] += same * glm::dot(normals_[0], c);
      low[at + 1] += later * glm::dot(normals_[1], c);
      high[at] += same * glm::dot(normals_[2], c);
      high[at + 1] += later * glm::dot(normals_[3], c);
    }
  Range range;
  for (std::size_t k = 0; k <= pu + 1; ++k) {
    const double* a = k <= pu ? low + k * row : nullptr;
    const double* b = k > 0 ? high + (k - 1) * row : nullptr;
    const double same = static_cast<double>(pu + 1 - k) * share_u, later = static_cast<double>(k) * share_u;
    for (std::size_t l = 0; l < row; ++l) {
      const double sum = (a ? same * a[l] : 0.0) + (b ? later * b[l] : 0.0);
      range.include(rational_ ? sum * inverse_raised_w_[k * row + l] : sum);
    }
  }
  return range;
}

// n = (m - mT) / (m . n), where the tangential part mT of m follows from m . Su and m . Sv.
bool PatchBend::bound_second_form(const Tangents& u, const Tangents& v, double rounding, Bend& bend) {
  if (!(u.least > 0) || !(v.least > 0) || !set_normals()) return false;
  const int pu = S_.pu, pv = S_.pv;
  const double s = rational_ ? along_normal(S_).magnitude() + 2 * rounding : 0.0;
  const double a = along_normal(Su_).magnitude() + wu_ * s + 2 * pu * rounding;
  const double b = along_normal(Sv_).magnitude() + wv_ * s + 2 * pv * rounding;
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
  bend.curvature = curvature_bound(u.least, v.least, c, bend);
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
  result.turn = std::max(u.tangent, v.tangent);
  bound_lengths(u, v, rounding, result.bend);
  result.bounded = bound_second_form(u, v, rounding, result.bend);
  if (result.bounded)
    result.bend.curvature = std::min(result.bend.curvature, curvature_bound(u.centre, v.centre, u.stray, v.stray, result.bend));
  else
    result.bend.uu = result.bend.uv = result.bend.vv = kEverything, result.bend.curvature = kInf;
  promise(result);
  return result;
}

}  // namespace iso
