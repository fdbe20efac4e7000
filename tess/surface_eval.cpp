#include "tess/surface_eval.h"

#include <algorithm>
#include <array>

#include "patches/base/bspline_basis.h"

namespace iso {

namespace {

using Powers = std::array<std::array<long double, BasisPowers::kMostDegree + 1>, BasisPowers::kMostDegree + 1>;

// p += (a + b x) q, of polynomials of at most the degree `most`.
void add_product(std::array<long double, BasisPowers::kMostDegree + 1>& p, long double a, long double b,
                 const std::array<long double, BasisPowers::kMostDegree + 1>& q, int most) {
  for (int k = 0; k <= most; ++k) p[k] += a * q[k] + (k > 0 ? b * q[k - 1] : 0);
}

// Row j: the powers of x of the function span - degree + j, with t = middle + half x.  [Piegl & Tiller, eq. 2.5]
Powers span_powers(const std::vector<double>& knots, int degree, int span, long double middle, long double half) {
  Powers lower{};
  lower[0][0] = 1;
  for (int p = 1; p <= degree; ++p) {
    Powers next{};
    for (int j = 0; j < p; ++j) {
      const long double a = knots[span - p + 1 + j], b = knots[span + 1 + j], width = b - a;
      add_product(next[j], (b - middle) / width, -half / width, lower[j], p);
      add_product(next[j + 1], (middle - a) / width, half / width, lower[j], p);
    }
    lower = next;
  }
  return lower;
}

constexpr int kBucketsPerSpan = 2;

}  // namespace

BasisPowers::BasisPowers(const std::vector<double>& knots, int degree) : degree_(degree) {
  const std::vector<double> breaks = breakpoints(knots, degree);
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double middle = 0.5 * (breaks[i] + breaks[i + 1]), half = 0.5 * (breaks[i + 1] - breaks[i]);
    const int span = knot_span(knots, degree, middle);
    const Powers powers = span_powers(knots, degree, span, middle, half);
    spans_.push_back({breaks[i], middle, 1 / half, span - degree});
    for (int k = degree; k >= 0; --k)
      for (int j = 0; j <= degree; ++j) powers_.push_back(static_cast<double>(powers[j][k]));
  }
  const std::size_t count = kBucketsPerSpan * spans_.size();
  at_ = breaks.front();
  buckets_per_unit_ = static_cast<double>(count) / (breaks.back() - breaks.front());
  for (std::size_t i = 0, span = 0; i < count; ++i) {
    // One bucket lower, against rounding: the search goes up only.
    const double from = at_ + (static_cast<double>(i) - 1) / buckets_per_unit_;
    while (span + 1 < spans_.size() && breaks[span + 1] <= from) ++span;
    bucket_.push_back(static_cast<int>(span));
  }
}

int BasisPowers::values(double t, double* N, double* D) const {
  const double place = (t - at_) * buckets_per_unit_, last = static_cast<double>(bucket_.size() - 1);
  auto i = static_cast<std::size_t>(bucket_[static_cast<std::size_t>(place > 0 ? std::min(place, last) : 0.0)]);
  while (i + 1 < spans_.size() && t >= spans_[i + 1].begin) ++i;
  const Span& span = spans_[i];
  const double x = (t - span.middle) * span.per_half;
  const int n = degree_ + 1;
  const double* c = &powers_[i * static_cast<std::size_t>(n * n)];
  for (int j = 0; j < n; ++j) {
    N[j] = c[j];
    D[j] = 0;
  }
  for (int k = 1; k < n; ++k) {
    c += n;
    for (int j = 0; j < n; ++j) {
      D[j] = D[j] * x + N[j];
      N[j] = N[j] * x + c[j];
    }
  }
  for (int j = 0; j < n; ++j) D[j] *= span.per_half;
  return span.first;
}

SurfaceEval::SurfaceEval(const AnySurface& surface) : surface_(&surface) {
  if (const auto* s = std::get_if<NurbsSurface>(&surface)) {
    if (std::max(s->degree_u, s->degree_v) > BasisPowers::kMostDegree) return;
    u_ = BasisPowers(s->knots_u, s->degree_u);
    v_ = BasisPowers(s->knots_v, s->degree_v);
    rational_ = s->rational();
    weight_ = s->poles.front().w;
    prepared_ = true;
  }
  const auto* extrusion = std::get_if<Extrusion>(&surface);
  const auto* revolution = std::get_if<Revolution>(&surface);
  if (!extrusion && !revolution) return;
  const auto* curve = std::get_if<NurbsCurve<Vec3>>(extrusion ? &extrusion->profile : &revolution->profile);
  if (!curve || curve->degree > BasisPowers::kMostDegree) return;
  u_ = BasisPowers(curve->knots, curve->degree);
  prepared_ = true;
}

namespace {

struct HomogeneousTangents {
  Vec4 h{0.0}, hu{0.0}, hv{0.0};
};

// Degrees known to the compiler are worth a third of the time.
template <int P, int Q>
HomogeneousTangents sum_of(const Vec4* poles, int stride, const double* Nu, const double* Du, const double* Nv, const double* Dv, int p,
                           int q) {
  if (P > 0) p = P;
  if (Q > 0) q = Q;
  HomogeneousTangents sum;
  for (int i = 0; i <= p; ++i, poles += stride) {
    Vec4 value = Nv[0] * poles[0], slope = Dv[0] * poles[0];
    for (int j = 1; j <= q; ++j) {
      value += Nv[j] * poles[j];
      slope += Dv[j] * poles[j];
    }
    sum.h += Nu[i] * value;
    sum.hu += Du[i] * value;
    sum.hv += Nu[i] * slope;
  }
  return sum;
}

}  // namespace

TangentJet SurfaceEval::of_nurbs(const NurbsSurface& s, UV uv) const {
  std::array<double, BasisPowers::kMostDegree + 1> Nu, Du, Nv, Dv;
  const int i = u_.values(uv.x, Nu.data(), Du.data()), j = v_.values(uv.y, Nv.data(), Dv.data());
  const Vec4* poles = &s.poles[static_cast<std::size_t>(i) * static_cast<std::size_t>(s.count_v) + static_cast<std::size_t>(j)];
  const auto sum = s.degree_u == 3 && s.degree_v == 3
                       ? sum_of<3, 3>(poles, s.count_v, Nu.data(), Du.data(), Nv.data(), Dv.data(), 3, 3)
                       : sum_of<0, 0>(poles, s.count_v, Nu.data(), Du.data(), Nv.data(), Dv.data(), s.degree_u, s.degree_v);
  if (!rational_) return {Vec3(sum.h) / weight_, Vec3(sum.hu) / weight_, Vec3(sum.hv) / weight_};
  const double by = 1 / sum.h.w;
  const Point3 S = by * Vec3(sum.h);
  return {S, by * (Vec3(sum.hu) - sum.hu.w * S), by * (Vec3(sum.hv) - sum.hv.w * S)};
}

CurveJet<Vec3> SurfaceEval::profile(const Curve3& curve, double t) const {
  if (!prepared_) return jet(curve, t);
  std::array<double, BasisPowers::kMostDegree + 1> N, D;
  const Vec4* poles = &std::get<NurbsCurve<Vec3>>(curve).poles[static_cast<std::size_t>(u_.values(t, N.data(), D.data()))];
  Vec4 h(0.0), ht(0.0);
  for (int i = 0; i <= u_.degree(); ++i) {
    h += N[static_cast<std::size_t>(i)] * poles[i];
    ht += D[static_cast<std::size_t>(i)] * poles[i];
  }
  const Point3 C = Vec3(h) / h.w;
  return {C, (Vec3(ht) - ht.w * C) / h.w, Vec3(0.0)};
}

TangentJet SurfaceEval::at(UV uv) const {
  if (const auto* s = std::get_if<NurbsSurface>(surface_); s && prepared_) return of_nurbs(*s, uv);
  if (const auto* s = std::get_if<Extrusion>(surface_)) {
    const auto c = profile(s->profile, uv.x);
    return {c.C + uv.y * s->direction, c.Ct, s->direction};
  }
  if (const auto* s = std::get_if<Revolution>(surface_)) {
    const auto c = profile(s->profile, uv.y);
    const double cu = std::cos(uv.x), su = std::sin(uv.x);
    const Vec3 q = c.C - s->O, axis = glm::dot(q, s->Z) * s->Z, r = q - axis, across = glm::cross(s->Z, r);
    const Vec3 axis_t = glm::dot(c.Ct, s->Z) * s->Z, rt = c.Ct - axis_t;
    return {s->O + axis + cu * r + su * across, cu * across - su * r, axis_t + cu * rt + su * glm::cross(s->Z, rt)};
  }
  const Jet2 k = jet2(*surface_, uv);
  return {k.S, k.Su, k.Sv};
}

}  // namespace iso
