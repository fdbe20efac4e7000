// Step 4 of leaf_kernel.h: windows of a leaf against all rays that graze it. Compiled once per instruction set.
#include "raytracer/polish-inl.h"

#if defined(ISOPHOTE_GRAZING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ISOPHOTE_GRAZING_INL_H_
#undef ISOPHOTE_GRAZING_INL_H_
#else
#define ISOPHOTE_GRAZING_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A ray that still wants smaller windows touches the surface, or all but, or looks at a pole: subdivision takes it over.
inline constexpr int kMostHalvings = 9;
inline constexpr int kMostWindows = 100;
// Newton's map must contract by this for a certificate.
inline constexpr double kCertain = 0.75;

// A window of a leaf, in the leaf's parameters, and the rays that may meet it.
struct GrazedWindow {
  double a = 0, b = 0, half_a = 1, half_b = 1;
  LaneMask lanes = 0;
  int halvings = 0;
};

// What the plane equations may do over a window beside their linear model, for all rays.
struct WindowBounds {
  double bend;              // |f - linear model| over the window
  double stray_a, stray_b;  // of the derivatives, kCellMargin beyond it; in the window's own parameters
};
HWY_INLINE WindowBounds bounds_of(const LeafCurls& curls, const GrazedWindow& w) {
  const double aa = curls.aa * w.half_a * w.half_a, ab = curls.ab * w.half_a * w.half_b, bb = curls.bb * w.half_b * w.half_b;
  return {0.5 * (aa + bb) + ab, kCellMargin * (aa + ab), kCellMargin * (ab + bb)};
}

// Which of a window's rays surely miss it, and for which it is certified; those get their linear root as a proposal.
template <int kComponents, class D, class V = hn::Vec<D>>
HWY_INLINE void judge(D d, const PatchJet<V, kComponents>& jet, const WindowBounds& bounds, const LocalRays& rays, std::size_t first,
                      LaneMask lanes, LaneMask& missed, Proposal& out) {
  const Planes<V> planes = load_planes(d, rays.planes, first);
  const auto set = [&](double x) HWY_ATTR { return hn::Set(d, x); };
  const auto side = [&](const V n[3], V offset, const V P[kComponents], bool point) HWY_ATTR {
    const V sum = hn::MulAdd(n[0], P[0], hn::MulAdd(n[1], P[1], hn::Mul(n[2], P[2])));
    if constexpr (kComponents == 4)
      return hn::NegMulAdd(offset, P[3], sum);
    else
      return point ? hn::Sub(sum, offset) : sum;
  };
  const V f = side(planes.n1, planes.d1, jet.P, true), g = side(planes.n2, planes.d2, jet.P, true);
  const V fa = side(planes.n1, planes.d1, jet.Ps, false), fb = side(planes.n1, planes.d1, jet.Pt, false);
  const V ga = side(planes.n2, planes.d2, jet.Ps, false), gb = side(planes.n2, planes.d2, jet.Pt, false);

  // (f, g) of a grazing ray runs along a narrow band beside its longer column: does the origin lie across it or beyond its ends?
  V weight = set(1);
  if constexpr (kComponents == 4) weight = jet.P[3];
  const V rounding = hn::Mul(hn::Mul(set(32 * kEps), hn::Load(d, rays.scale + first)), weight);
  const V bend = hn::Add(set(bounds.bend), rounding);
  const V size_a = hn::MulAdd(fa, fa, hn::Mul(ga, ga)), size_b = hn::MulAdd(fb, fb, hn::Mul(gb, gb));
  const auto a_longer = hn::Ge(size_a, size_b);
  const V lx = hn::IfThenElse(a_longer, fa, fb), ly = hn::IfThenElse(a_longer, ga, gb);
  const V sx = hn::IfThenElse(a_longer, fb, fa), sy = hn::IfThenElse(a_longer, gb, ga);
  const V length = hn::Sqrt(hn::Max(size_a, size_b));
  const auto across = [&](V x, V y) HWY_ATTR { return hn::Abs(hn::NegMulAdd(ly, x, hn::Mul(lx, y))); };
  const auto along = [&](V x, V y) HWY_ATTR { return hn::Abs(hn::MulAdd(ly, y, hn::Mul(lx, x))); };
  const auto beside = hn::Gt(across(f, g), hn::MulAdd(length, bend, across(sx, sy)));
  const auto beyond = hn::Gt(along(f, g), hn::MulAdd(length, hn::Add(length, bend), along(sx, sy)));
  missed |= bits_of(d, hn::Or(beside, beyond), first);

  const V determinant = hn::NegMulAdd(fb, ga, hn::Mul(fa, gb)), inverse = hn::Div(set(1), determinant);
  const V reach_a = hn::Mul(hn::Sqrt(size_b), hn::Abs(inverse)), reach_b = hn::Mul(hn::Sqrt(size_a), hn::Abs(inverse));
  const V contraction = hn::MulAdd(reach_a, set(bounds.stray_a), hn::Mul(reach_b, set(bounds.stray_b)));
  const V border = hn::Mul(rounding, hn::Max(reach_a, reach_b));
  const auto certain = hn::And(hn::Lt(contraction, set(kCertain)), hn::Lt(border, set(0.25 * kDoubtful)));
  out.certain |= bits_of(d, certain, first) & lanes;

  // The linear root is at most this far from a root in the window.
  const V a = hn::Mul(hn::NegMulAdd(gb, f, hn::Mul(fb, g)), inverse), b = hn::Mul(hn::NegMulAdd(fa, g, hn::Mul(ga, f)), inverse);
  const V one = set(1 + kDoubtful);
  const auto off = hn::Or(hn::Gt(hn::Abs(a), hn::MulAdd(reach_a, bend, one)), hn::Gt(hn::Abs(b), hn::MulAdd(reach_b, bend, one)));
  missed |= bits_of(d, hn::And(certain, off), first);
  const hn::Rebind<float, D> narrow;
  const auto clamp = [&](V x) HWY_ATTR { return hn::DemoteTo(narrow, hn::Min(hn::Max(x, set(-kCellMargin)), set(kCellMargin))); };
  hn::Store(clamp(a), narrow, out.a + first);
  hn::Store(clamp(b), narrow, out.b + first);
}

template <int kDegree, int kComponents>
void meet_grazing(const LeafCurls& curls, const double* powers, int pu, int pv, const LeafBox& leaf, const LocalRays& rays, LaneMask lanes,
                  RootSink& sink) {
  using Some = hn::CappedTag<double, 8>;
  using V = hn::Vec<Some>;
  const Some d;
  GrazedWindow stack[2 * kMostHalvings + 2];
  int count = 1;
  stack[0].lanes = lanes;
  for (int windows = 1; count > 0; ++windows) {
    GrazedWindow w = stack[--count];
    w.lanes &= lanes;
    if (!w.lanes) continue;
    LeafBox box{leaf.x + leaf.half_x * w.a, leaf.y + leaf.half_y * w.b, leaf.half_x * w.half_a, leaf.half_y * w.half_b};
    PatchJet<V, kComponents> jet;
    evaluate<kDegree, kComponents>(d, powers, pu, pv, hn::Set(d, box.x), hn::Set(d, box.y), jet);
    for (int c = 0; c < kComponents; ++c) {
      jet.Ps[c] = hn::Mul(jet.Ps[c], hn::Set(d, box.half_x));
      jet.Pt[c] = hn::Mul(jet.Pt[c], hn::Set(d, box.half_y));
    }
    const WindowBounds bounds = bounds_of(curls, w);
    LaneMask missed = 0;
    Proposal proposal;
    for (std::size_t first = 0; first < kWidth; first += hn::Lanes(d))
      if (w.lanes & lanes_from(first, hn::Lanes(d))) judge(d, jet, bounds, rays, first, w.lanes, missed, proposal);
    w.lanes &= ~missed;
    proposal.certain &= w.lanes;
    if (proposal.certain) {
      LeafRoots roots;
      for (std::size_t first = 0; first < kWidth; first += hn::Lanes(d))
        if (proposal.certain & lanes_from(first, hn::Lanes(d)))
          polish<kDegree, kComponents>(d, powers, pu, pv, box, rays, first, proposal, roots);
      if (roots.found) sink.found(roots);
      w.lanes &= ~(roots.found | roots.none);  // a root at the very border stays: smaller windows, then subdivision
    }
    if (!w.lanes) continue;
    if (w.halvings >= kMostHalvings || windows >= kMostWindows) {
      sink.undecided(w.lanes, {{leaf.x + 0.5, leaf.y + 0.5}, {leaf.half_x, leaf.half_y}});  // roots met twice are removed by who counts
      lanes &= ~w.lanes;
      continue;
    }
    GrazedWindow low = w, high = w;
    low.halvings = ++high.halvings;
    if (bounds.stray_a >= bounds.stray_b) {
      low.half_a = high.half_a = 0.5 * w.half_a;
      low.a -= low.half_a;
      high.a += high.half_a;
    } else {
      low.half_b = high.half_b = 0.5 * w.half_b;
      low.b -= low.half_b;
      high.b += high.half_b;
    }
    stack[count++] = high;
    stack[count++] = low;
  }
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
