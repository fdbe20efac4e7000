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
LaneMask with_avx512(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots);
LaneMask with_avx2(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots);
LaneMask with_any(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots);
}  // namespace iso::chart_lanes
#endif

// Highway picks the set at run time, as for the other kernels; the packs are the compiler's own.
HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {

LaneMask chart_newton(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots) {
#if HWY_TARGET <= HWY_AVX3
  return chart_lanes::with_avx512(chart, rays, roots);
#elif HWY_TARGET <= HWY_AVX2
  return chart_lanes::with_avx2(chart, rays, roots);
#else
  return chart_lanes::with_any(chart, rays, roots);
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
constexpr int kMostSteps = 6;
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

// What a pack of rays is on its way with.
struct PackedRays {
  Pack n1[3], n2[3], d1, d2, o[3], d[3], inverse_dd, scale;
};

inline Pack load(const double* at) {
  Pack p;
  for (int k = 0; k < kPack; ++k) p.v[k] = at[k];
  return p;
}

inline Pack dot(const Pack* a, const Pack* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline PackedRays pack_rays(const LocalRays& rays, int first) {
  PackedRays p;
  for (int c = 0; c < 3; ++c) {
    p.n1[c] = load(rays.planes.n1[c] + first);
    p.n2[c] = load(rays.planes.n2[c] + first);
    p.o[c] = load(rays.o[c] + first);
    p.d[c] = load(rays.d[c] + first);
  }
  p.d1 = load(rays.planes.d1 + first);
  p.d2 = load(rays.planes.d2 + first);
  p.inverse_dd = load(rays.inverse_dd + first);
  p.scale = load(rays.scale + first);
  return p;
}

using Number = Dual1<Pack>;

// Newton on one pack; bits of `wanted` that end are returned, and their roots written.
template <class Basis>
inline LaneMask newton(const PatchChart& chart, const Basis& basis, const LocalRays& rays, int first, LaneMask wanted, LeafRoots& roots) {
  const PackedRays ray = pack_rays(rays, first);
  Pack s = load(roots.s + first), t = load(roots.t + first);
  Number W[kMostPoints];
  const int count = static_cast<int>(chart.points.size());
  const Vec3* points = chart.points.data();
  LaneMask done = 0;
  for (int step = 0; step < kMostSteps && done != wanted; ++step) {
    patch_weights<Number>(basis, Number(s, 1.0, 0.0), Number(t, 0.0, 1.0), W);
    Pack S[3] = {0.0, 0.0, 0.0}, Ss[3] = {0.0, 0.0, 0.0}, St[3] = {0.0, 0.0, 0.0};
    for (int m = 0; m < count; ++m)
      for (int c = 0; c < 3; ++c) {
        const double p = points[m][c];
        S[c] = S[c] + W[m].f * p;
        Ss[c] = Ss[c] + W[m].u * p;
        St[c] = St[c] + W[m].v * p;
      }
    const Pack f = dot(ray.n1, S) - ray.d1, g = dot(ray.n2, S) - ray.d2;
    const Pack a = dot(ray.n1, Ss), b = dot(ray.n1, St), c = dot(ray.n2, Ss), d = dot(ray.n2, St);
    const Pack inverse = inverse_or_zero(a * d - b * c);
    const Pack ds = (b * g - d * f) * inverse, dt = (c * f - a * g) * inverse;
    Pack distance = 0.0;
    for (int k = 0; k < 3; ++k) distance = distance + (S[k] + ds * Ss[k] + dt * St[k] - ray.o[k]) * ray.d[k];
    distance = distance * ray.inverse_dd;
    for (int k = 0; k < kPack; ++k) {
      const LaneMask bit = LaneMask{1} << (first + k);
      if (!(wanted & bit) || (done & bit)) continue;
      const double size = std::max(std::abs(ds.v[k]), std::abs(dt.v[k]));
      // A singular Jacobian (inverse 0) is not the end of anything.
      if (inverse.v[k] == 0 || !(size < kLastChartStep)) continue;
      done |= bit;
      roots.s[first + k] = s.v[k] + ds.v[k];
      roots.t[first + k] = t.v[k] + dt.v[k];
      roots.distance[first + k] = distance.v[k];
      roots.steps[first + k] += static_cast<float>(step + 1);
    }
    const Pack::Eight lo = Pack::Eight{} - kBeyondChart, hi = Pack::Eight{} + (1 + kBeyondChart);
    const Pack next_s = s + ds, next_t = t + dt;
    s.v = next_s.v < lo ? lo : next_s.v > hi ? hi : next_s.v;
    t.v = next_t.v < lo ? lo : next_t.v > hi ? hi : next_t.v;
  }
  return done;
}

template <class Basis>
inline LaneMask all_packs(const PatchChart& chart, const Basis& basis, const LocalRays& rays, LeafRoots& roots) {
  constexpr LaneMask kFirst = (LaneMask{1} << kPack) - 1;
  LaneMask done = 0;
  for (int first = 0; first < kWidth; first += kPack)
    if (const LaneMask wanted = roots.found & (kFirst << first)) done |= newton(chart, basis, rays, first, wanted, roots);
  return roots.found & ~done;
}

}  // namespace

// All calls inlined, for one instruction set. Not with the sanitizers, which would take minutes to compile that: there all three are one.
#if defined(__SANITIZE_ADDRESS__)
#define ISOPHOTE_COMPILED_FOR(set)
#else
#define ISOPHOTE_COMPILED_FOR(set) __attribute__((target(set), flatten))
#endif
ISOPHOTE_COMPILED_FOR("arch=x86-64-v4") LaneMask with_avx512(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots) {
  return all_packs(chart, chart.basis, rays, roots);
}
ISOPHOTE_COMPILED_FOR("arch=x86-64-v3") LaneMask with_avx2(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots) {
  return all_packs(chart, chart.basis, rays, roots);
}
LaneMask with_any(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots) { return all_packs(chart, chart.basis, rays, roots); }

}  // namespace chart_lanes

HWY_EXPORT(chart_newton);
LaneMask roots_on_chart(const PatchChart& chart, const LocalRays& rays, LeafRoots& roots) {
  if (chart.points.size() > chart_lanes::kMostPoints) return roots.found;
  return HWY_DYNAMIC_DISPATCH(chart_newton)(chart, rays, roots);
}

}  // namespace iso
#endif
