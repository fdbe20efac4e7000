// Newton on a chart for eight rays at a time. The weights are the templates that give points and derivatives everywhere else; here their
// number is eight doubles side by side, and the whole function is compiled once for each instruction set, all calls inlined.
#include "patches/surface/patch_basis-inl.h"
#include "raytracer/chart_root.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raytracer/chart_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, by its rules.
#include <hwy/highway.h>

#ifndef ISOPHOTE_CHART_LANES_DECLARED
#define ISOPHOTE_CHART_LANES_DECLARED
namespace iso::chart_lanes {
LaneMask with_avx512(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots);
LaneMask with_avx2(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots);
LaneMask with_any(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots);
}  // namespace iso::chart_lanes
#endif

// Highway picks the set at run time, as for the other kernels; the packs are the compiler's own.
HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {

LaneMask chart_newton(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots) {
#if HWY_TARGET <= HWY_AVX3
  return chart_lanes::with_avx512(chart, piece, rays, roots);
#elif HWY_TARGET <= HWY_AVX2
  return chart_lanes::with_avx2(chart, piece, rays, roots);
#else
  return chart_lanes::with_any(chart, piece, rays, roots);
#endif
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#pragma GCC diagnostic ignored "-Wpsabi"  // the packs never cross a call

namespace iso {

namespace chart_lanes {
namespace {

constexpr int kPack = 8;
constexpr int kMostPointSteps = 5, kMostSteps = 6;
// Steps by the spline's derivatives go on while each is at most this share of the last one, until what is left, of the chart's square, is
// less than rounding.
constexpr double kMostShare = 0.05, kLeftOnChart = 1e-15;
constexpr int kMostPoints = 256;

struct Pack {
  typedef double Eight __attribute__((vector_size(kPack * sizeof(double))));
  Eight v;

  Pack() = default;
  Pack(double x) : v(Eight{} + x) {}
  Pack(const Eight& x) : v(x) {}

  friend Pack operator+(const Pack& a, const Pack& b) { return {a.v + b.v}; }
  friend Pack operator-(const Pack& a, const Pack& b) { return {a.v - b.v}; }
  friend Pack operator*(const Pack& a, const Pack& b) { return {a.v * b.v}; }
  friend Pack operator/(const Pack& a, const Pack& b) { return {a.v / b.v}; }
};

inline Pack inverse_or_zero(const Pack& x) {
  const Pack::Eight zero{}, one = zero + 1.0;
  return {x.v != zero ? one / x.v : zero};
}
inline Pack sqrt(const Pack& x) {
  Pack root;
  for (int k = 0; k < kPack; ++k) root.v[k] = std::sqrt(x.v[k]);
  return root;
}

inline Pack where_positive(const Pack& of, const Pack& then, const Pack& otherwise) {
  const Pack::Eight zero{};
  return {of.v > zero ? then.v : otherwise.v};
}

// The root has no limit there or is beyond a border: lanes leave that to doubles (domain-inl.h).
inline Pack blend(const Pack& a, const Pack& b, const Pack& X, const Pack& Y) {
  return (X + Y) * 0.5 + (a - b) * 0.5 * inverse_or_zero(a + b) * (X - Y);
}
inline Pack share(const Pack& a, const Pack& b) { return (a - b) * 0.5 * inverse_or_zero(a + b) + 0.5; }
inline void shares(const Pack& a, const Pack& b, Pack& of_a, Pack& of_b) {
  const Pack beyond_half = (a - b) * 0.5 * inverse_or_zero(a + b);
  of_a = beyond_half + 0.5;
  of_b = Pack(0.5) - beyond_half;
}

// Up to kPack rays that have a root on the spline, gathered from the lanes of a packet: what they are on their way with. Empty places
// repeat the first one.
struct PackedRays {
  int lane[kPack];
  int count = 0;
  Pack n1[3], n2[3], d1, d2, o[3], d[3], inverse_dd;
  Pack s, t, unit_s, unit_t;  // on the chart, and in the unit square of the spline's piece

  void gather(const LocalRays& rays, const SplinePiece& piece, const LeafRoots& roots) {
    for (int k = count; k < kPack; ++k) lane[k] = lane[0];
    const auto take = [&](const double* from, Pack& to) {
      for (int k = 0; k < kPack; ++k) to.v[k] = from[lane[k]];
    };
    for (int c = 0; c < 3; ++c) {
      take(rays.planes.n1[c], n1[c]);
      take(rays.planes.n2[c], n2[c]);
      take(rays.o[c], o[c]);
      take(rays.d[c], d[c]);
    }
    take(rays.planes.d1, d1);
    take(rays.planes.d2, d2);
    take(rays.inverse_dd, inverse_dd);
    take(roots.s, unit_s);
    take(roots.t, unit_t);
    s = unit_s * piece.size.x + Pack(piece.low.x);
    t = unit_t * piece.size.y + Pack(piece.low.y);
  }
};

inline Pack dot(const Pack* a, const Pack* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The derivatives of a surface as a ray sees them: of both plane equations, with the inverse of their determinant, and along the ray.
struct Slopes {
  Pack a, b, c, d, inverse, along_s, along_t;

  Slopes(const PackedRays& ray, const Pack* Ss, const Pack* St)
      : a(dot(ray.n1, Ss)),
        b(dot(ray.n1, St)),
        c(dot(ray.n2, Ss)),
        d(dot(ray.n2, St)),
        inverse(inverse_or_zero(a * d - b * c)),
        along_s(dot(ray.d, Ss)),
        along_t(dot(ray.d, St)) {}
  Pack step_s(const Pack& f, const Pack& g) const { return (b * g - d * f) * inverse; }
  Pack step_t(const Pack& f, const Pack& g) const { return (c * f - a * g) * inverse; }
};

// Where a pack stands, and Newton's step from there.
struct Standing {
  Pack ds, dt, distance;

  Standing(const PackedRays& ray, const Pack* S, const Slopes& slopes) {
    const Pack f = dot(ray.n1, S) - ray.d1, g = dot(ray.n2, S) - ray.d2;
    ds = slopes.step_s(f, g);
    dt = slopes.step_t(f, g);
    const Pack off[3] = {S[0] - ray.o[0], S[1] - ray.o[1], S[2] - ray.o[2]};
    distance = (dot(ray.d, off) + ds * slopes.along_s + dt * slopes.along_t) * ray.inverse_dd;
  }
  double size(int k) const { return std::max(std::abs(ds.v[k]), std::abs(dt.v[k])); }
};

// Horner in both directions.
inline void spline_derivatives(const SplinePiece& piece, const Pack& unit_s, const Pack& unit_t, Pack* Ss, Pack* St) {
  const Pack x = unit_s - Pack(0.5), y = unit_t - Pack(0.5);
  for (int c = 0; c < 3; ++c) {
    Pack value(0.0), by_s(0.0), by_t(0.0);
    for (int i = piece.pu; i >= 0; --i) {
      const double* row = piece.powers + 3 * i * (piece.pv + 1) + c;
      Pack along(0.0), slope(0.0);
      for (int j = piece.pv; j >= 0; --j) {
        slope = slope * y + along;
        along = along * y + Pack(row[3 * j]);
      }
      by_s = by_s * x + value;
      value = value * x + along;
      by_t = by_t * x + slope;
    }
    Ss[c] = by_s * (1 / piece.size.x);
    St[c] = by_t * (1 / piece.size.y);
  }
}

// Newton of one pack. Returns the lanes that end as they should, with their roots.
template <class Basis>
class PackNewton {
 public:
  PackNewton(const PatchChart& chart, const Basis& basis, const SplinePiece& piece, PackedRays& ray, LeafRoots& roots)
      : chart_(chart), basis_(basis), piece_(piece), ray_(ray), roots_(roots), going_((1u << ray.count) - 1) {
    std::fill(last_, last_ + kPack, kBeyondChart / kChartContraction);
  }

  LaneMask run() {
    // Derivatives of these cost little more than those of a spline.
    const bool cheap = chart_.basis.kind == PatchKind::gregory_quad || chart_.basis.kind == PatchKind::gregory_triangle;
    if (!cheap) with_slopes_of_spline();
    with_own_slopes();
    return done_;
  }

 private:
  // The chart lies so close to its spline that the spline's derivatives are nearly its own: each step leaves as small a share of what was
  // left as the last one did, and points are cheap beside derivatives. Lanes for which that does not hold begin again.
  void with_slopes_of_spline() {
    Pack Ss[3], St[3];
    spline_derivatives(piece_, ray_.unit_s, ray_.unit_t, Ss, St);
    const Slopes slopes(ray_, Ss, St);
    const Pack s = ray_.s, t = ray_.t;
    Pack W[kMostPoints];
    unsigned slow = 0;
    for (int step = 0; step < kMostPointSteps && going_ & ~slow; ++step) {
      patch_weights<Pack>(basis_, ray_.s, ray_.t, W);
      ++steps_;
      Pack S[3] = {0.0, 0.0, 0.0};
      for (std::size_t m = 0; m < chart_.points.size(); ++m)
        for (int c = 0; c < 3; ++c) S[c] = S[c] + W[m] * Pack(chart_.points[m][c]);
      const Standing at(ray_, S, slopes);
      for (int k = 0; k < kPack; ++k) {
        if (!((going_ & ~slow) >> k & 1)) continue;
        const double size = at.size(k);
        if (slopes.inverse.v[k] == 0 || !(size <= (step == 0 ? kChartContraction : kMostShare) * last_[k]))
          slow |= 1u << k;
        else if (step > 0 && size * size < kLeftOnChart * last_[k] * scale_of_steps(chart_, ray_.s.v[k], ray_.t.v[k]))
          end(k, at);
        last_[k] = size;
      }
      move(at);
    }
    for (int k = 0; k < kPack; ++k)
      if (slow >> k & 1) {
        ray_.s.v[k] = s.v[k];
        ray_.t.v[k] = t.v[k];
        last_[k] = kBeyondChart / kChartContraction;
      }
  }

  void with_own_slopes() {
    Dual1<Pack> W[kMostPoints];
    for (int step = 0; step < kMostSteps && going_; ++step) {
      patch_weights<Dual1<Pack>>(basis_, {ray_.s, 1.0, 0.0}, {ray_.t, 0.0, 1.0}, W);
      ++steps_;
      Pack S[3] = {0.0, 0.0, 0.0}, Ss[3] = {0.0, 0.0, 0.0}, St[3] = {0.0, 0.0, 0.0};
      for (std::size_t m = 0; m < chart_.points.size(); ++m)
        for (int c = 0; c < 3; ++c) {
          const Pack p(chart_.points[m][c]);
          S[c] = S[c] + W[m].f * p;
          Ss[c] = Ss[c] + W[m].u * p;
          St[c] = St[c] + W[m].v * p;
        }
      const Slopes slopes(ray_, Ss, St);
      const Standing at(ray_, S, slopes);
      for (int k = 0; k < kPack; ++k) {
        if (!(going_ >> k & 1)) continue;
        const double size = at.size(k);
        // The other side of the surface, or (inverse 0) none.
        const bool turned = roots_.turned >> ray_.lane[k] & 1, same_side = turned ? slopes.inverse.v[k] < 0 : slopes.inverse.v[k] > 0;
        if (!same_side || !(size <= kChartContraction * last_[k]))
          going_ &= ~(1u << k);
        else if (size < kLastChartStep * scale_of_steps(chart_, ray_.s.v[k], ray_.t.v[k]))
          end(k, at);
        last_[k] = size;
      }
      move(at);
    }
  }

  void end(int k, const Standing& at) {
    const int lane = ray_.lane[k];
    going_ &= ~(1u << k);
    done_ |= LaneMask{1} << lane;
    roots_.s[lane] = ray_.s.v[k] + at.ds.v[k];
    roots_.t[lane] = ray_.t.v[k] + at.dt.v[k];
    roots_.distance[lane] = at.distance.v[k];
    roots_.steps[lane] += static_cast<float>(steps_);
  }

  void move(const Standing& at) {
    const Pack::Eight lo = Pack::Eight{} - kBeyondChart, hi = Pack::Eight{} + (1 + kBeyondChart);
    const Pack s = ray_.s + at.ds, t = ray_.t + at.dt;
    ray_.s.v = s.v < lo ? lo : s.v > hi ? hi : s.v;
    ray_.t.v = t.v < lo ? lo : t.v > hi ? hi : t.v;
  }

  const PatchChart& chart_;
  const Basis& basis_;
  const SplinePiece& piece_;
  PackedRays& ray_;
  LeafRoots& roots_;
  unsigned going_;      // of the pack
  double last_[kPack];  // steps
  LaneMask done_ = 0;   // of the packet
  unsigned steps_ = 0;
};

template <class Basis>
inline LaneMask all_packs(const PatchChart& chart, const Basis& basis, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots) {
  LaneMask done = 0;
  for (LaneMask left = roots.found; left;) {
    PackedRays ray;
    for (; left && ray.count < kPack; left &= left - 1) ray.lane[ray.count++] = __builtin_ctz(left);
    ray.gather(rays, piece, roots);
    done |= PackNewton<Basis>(chart, basis, piece, ray, roots).run();
  }
  return roots.found & ~done;
}

}  // namespace

// All calls inlined, for one instruction set. Not with the sanitizers, which would take minutes to compile that: there all three are one.
#if defined(__SANITIZE_ADDRESS__)
#define ISOPHOTE_COMPILED_FOR(set)
#else
#define ISOPHOTE_COMPILED_FOR(set) __attribute__((target(set), flatten))
#endif
ISOPHOTE_COMPILED_FOR("arch=x86-64-v4")
LaneMask with_avx512(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots) {
  return all_packs(chart, chart.basis, piece, rays, roots);
}
ISOPHOTE_COMPILED_FOR("arch=x86-64-v3")
LaneMask with_avx2(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots) {
  return all_packs(chart, chart.basis, piece, rays, roots);
}
LaneMask with_any(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots) {
  return all_packs(chart, chart.basis, piece, rays, roots);
}

}  // namespace chart_lanes

HWY_EXPORT(chart_newton);
LaneMask roots_on_chart(const PatchChart& chart, const SplinePiece& piece, const LocalRays& rays, LeafRoots& roots) {
  if (chart.points.size() > chart_lanes::kMostPoints) return roots.found;
  return HWY_DYNAMIC_DISPATCH(chart_newton)(chart, piece, rays, roots);
}

}  // namespace iso
#endif
