// Step 4 of leaf_kernel.h: a ray that grazes a leaf against eight windows of the leaf at a time. Compiled once per instruction set.
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
inline constexpr int kMostLevels = 3;
inline constexpr int kMostDivisions = 12;
inline constexpr int kParts = 8;  // of a window, at each division
// Newton's map must contract by this for a certificate.
inline constexpr double kCertain = 0.75;

// A window of a leaf, in the leaf's parameters.
struct GrazedWindow {
  double a = 0, b = 0, half_a = 1, half_b = 1;
  int level = 0;
};

// What the plane equations may do over a window beside their linear model.
struct WindowBounds {
  double bend;              // |f - linear model| over the window, of the leaf and of what it stands for
  double stray_a, stray_b;  // of the derivatives, kCellMargin beyond it; in the window's own parameters
};
HWY_INLINE WindowBounds bounds_of(const LeafCurls& curls, const GrazedWindow& w) {
  const double aa = curls.aa * w.half_a * w.half_a, ab = curls.ab * w.half_a * w.half_b, bb = curls.bb * w.half_b * w.half_b;
  return {0.5 * (aa + bb) + ab + curls.apart, kCellMargin * (aa + ab), kCellMargin * (ab + bb)};
}

// Eight parts of a window: halved three times, each time where the strays are larger.
struct Parts {
  double half_a, half_b;
  alignas(64) double a[kParts], b[kParts];
};
HWY_INLINE Parts parts_of(const LeafCurls& curls, GrazedWindow w) {
  Parts parts;
  int across = 1;  // parts along a
  const double a0 = w.a - w.half_a, b0 = w.b - w.half_b;
  for (int k = 0; k < 3; ++k) {
    const WindowBounds bounds = bounds_of(curls, w);
    if (bounds.stray_a >= bounds.stray_b) {
      w.half_a *= 0.5;
      across *= 2;
    } else {
      w.half_b *= 0.5;
    }
  }
  parts.half_a = w.half_a;
  parts.half_b = w.half_b;
  for (int k = 0; k < kParts; ++k) {
    parts.a[k] = a0 + (2 * (k % across) + 1) * w.half_a;
    parts.b[k] = b0 + (2 * (k / across) + 1) * w.half_b;
  }
  return parts;
}

// Which windows the ray surely misses, and for which it is certified; those get their linear root.
template <class D, class V = hn::Vec<D>>
struct Verdict {
  hn::Mask<D> missed, certain;
  V a, b;
};
template <int kComponents, class D, class V = hn::Vec<D>>
HWY_INLINE Verdict<D> judge(D d, const PatchJet<V, kComponents>& jet, const WindowBounds& bounds, const Planes<V>& planes, double scale) {
  const auto set = [&](double x) HWY_ATTR { return hn::Set(d, x); };
  const PlaneJet<V> p = plane_jet(jet, planes);

  // (f, g) of a grazing ray runs along a narrow band beside its longer column: does the origin lie across it or beyond its ends?
  V rounding = set(32 * kEps * scale);
  if constexpr (kComponents == 4) rounding = hn::Mul(rounding, jet.P[3]);
  const V bend = hn::Add(set(bounds.bend), rounding);
  const V size_a = hn::MulAdd(p.fs, p.fs, hn::Mul(p.gs, p.gs)), size_b = hn::MulAdd(p.ft, p.ft, hn::Mul(p.gt, p.gt));
  const auto a_longer = hn::Ge(size_a, size_b);
  const V lx = hn::IfThenElse(a_longer, p.fs, p.ft), ly = hn::IfThenElse(a_longer, p.gs, p.gt);
  const V sx = hn::IfThenElse(a_longer, p.ft, p.fs), sy = hn::IfThenElse(a_longer, p.gt, p.gs);
  const V length = hn::Sqrt(hn::Max(size_a, size_b));
  const auto across = [&](V x, V y) HWY_ATTR { return hn::Abs(hn::NegMulAdd(ly, x, hn::Mul(lx, y))); };
  const auto along = [&](V x, V y) HWY_ATTR { return hn::Abs(hn::MulAdd(ly, y, hn::Mul(lx, x))); };
  const auto beside = hn::Gt(across(p.f, p.g), hn::MulAdd(length, bend, across(sx, sy)));
  const auto beyond = hn::Gt(along(p.f, p.g), hn::MulAdd(length, hn::Add(length, bend), along(sx, sy)));

  const V inverse = inverse_determinant(p);
  const V reach_a = hn::Mul(hn::Sqrt(size_b), hn::Abs(inverse)), reach_b = hn::Mul(hn::Sqrt(size_a), hn::Abs(inverse));
  const V contraction = hn::MulAdd(reach_a, set(bounds.stray_a), hn::Mul(reach_b, set(bounds.stray_b)));
  const V border = hn::Mul(rounding, hn::Max(reach_a, reach_b));
  const auto certain = hn::And(hn::Lt(contraction, set(kCertain)), hn::Lt(border, set(0.25 * kDoubtful)));

  // A root in the window lies at most this far from the linear root.
  V a, b;
  newton_step(p, inverse, a, b);
  const V one = set(1 + kDoubtful);
  const auto off = hn::Or(hn::Gt(hn::Abs(a), hn::MulAdd(reach_a, bend, one)), hn::Gt(hn::Abs(b), hn::MulAdd(reach_b, bend, one)));
  const auto missed = hn::Or(hn::Or(beside, beyond), hn::And(certain, off));
  const auto clamp = [&](V x) HWY_ATTR { return hn::Min(hn::Max(x, set(-kCellMargin)), set(kCellMargin)); };
  return {missed, hn::AndNot(missed, certain), clamp(a), clamp(b)};
}

// One ray on its way through the windows of a leaf.
template <int kDegree, int kComponents>
class GrazingRay {
 public:
  GrazingRay(const LeafCurls& curls, const double* powers, int pu, int pv, const LeafBox& leaf, const LocalRays& rays, int lane,
             RootSink& sink)
      : curls_(curls), powers_(powers), pu_(pu), pv_(pv), leaf_(leaf), lane_(lane), scale_(rays.scale[lane]), sink_(sink) {
    const auto set = [&](double x) HWY_ATTR { return hn::Set(D(), x); };
    for (int c = 0; c < 3; ++c) {
      ray_.planes.n1[c] = set(rays.planes.n1[c][lane]);
      ray_.planes.n2[c] = set(rays.planes.n2[c][lane]);
      ray_.o[c] = set(rays.o[c][lane]);
      ray_.d[c] = set(rays.d[c][lane]);
    }
    ray_.planes.d1 = set(rays.planes.d1[lane]);
    ray_.planes.d2 = set(rays.planes.d2[lane]);
    ray_.inverse_dd = set(rays.inverse_dd[lane]);
  }

  void run() {
    count_ = 1;
    for (int divisions = 0; count_ > 0; ++divisions) {
      const GrazedWindow w = stack_[--count_];
      if (w.level >= kMostLevels || divisions >= kMostDivisions) {
        // Roots met twice are removed by who counts.
        sink_.undecided(LaneMask{1} << lane_, leaf_.window());
        return;
      }
      const Parts parts = parts_of(curls_, w);
      for (std::size_t first = 0; first < kParts; first += hn::Lanes(D())) visit(parts, first, w.level + 1);
    }
  }

 private:
  using D = hn::CappedTag<double, kParts>;
  using V = hn::Vec<D>;

  void visit(const Parts& parts, std::size_t first, int level) {
    const D d;
    const GrazedWindow part{0, 0, parts.half_a, parts.half_b, level};
    const double half_x = leaf_.half_x * parts.half_a, half_y = leaf_.half_y * parts.half_b;
    const V x = hn::MulAdd(hn::Set(d, leaf_.half_x), hn::Load(d, parts.a + first), hn::Set(d, leaf_.x));
    const V y = hn::MulAdd(hn::Set(d, leaf_.half_y), hn::Load(d, parts.b + first), hn::Set(d, leaf_.y));
    PatchJet<V, kComponents> jet;
    evaluate<kDegree, kComponents>(d, powers_, pu_, pv_, x, y, jet);
    for (int c = 0; c < kComponents; ++c) {
      jet.Ps[c] = hn::Mul(jet.Ps[c], hn::Set(d, half_x));
      jet.Pt[c] = hn::Mul(jet.Pt[c], hn::Set(d, half_y));
    }
    const Verdict<D> verdict = judge(d, jet, bounds_of(curls_, part), ray_.planes, scale_);
    LaneMask open = ~bits_of(d, verdict.missed, 0) & lanes_from(0, hn::Lanes(d));
    if (!hn::AllFalse(d, verdict.certain)) {
      const Boxes<V> box{x, y, hn::Set(d, half_x), hn::Set(d, half_y), hn::Set(d, 1 / half_x), hn::Set(d, 1 / half_y)};
      const Polished<D> p = polish<kDegree, kComponents>(d, powers_, pu_, pv_, ray_, box, verdict.a, verdict.b, verdict.certain);
      const LaneMask found = bits_of(d, p.inside, 0);
      if (found) tell(d, p, box, found, bits_of(d, p.turned, 0));
      open &= ~(found | bits_of(d, p.beside, 0));  // a root at the very border stays: smaller windows, then subdivision
    }
    for_each_lane(open, [&](int k) {
      stack_[count_++] = {parts.a[first + static_cast<std::size_t>(k)], parts.b[first + static_cast<std::size_t>(k)], parts.half_a,
                          parts.half_b, level};
    });
  }

  void tell(D d, const Polished<D>& p, const Boxes<V>& box, LaneMask found, LaneMask turned) {
    alignas(64) double s[kParts], t[kParts], distance[kParts], steps[kParts];
    const V half = hn::Set(d, 0.5);
    hn::Store(hn::Add(half, hn::MulAdd(box.half_x, p.a, box.x)), d, s);
    hn::Store(hn::Add(half, hn::MulAdd(box.half_y, p.b, box.y)), d, t);
    hn::Store(p.distance, d, distance);
    hn::Store(p.steps, d, steps);
    LeafRoots roots;
    roots.found = LaneMask{1} << lane_;
    for_each_lane(found, [&](int k) {
      roots.s[lane_] = s[k];
      roots.t[lane_] = t[k];
      roots.distance[lane_] = distance[k];
      roots.steps[lane_] = static_cast<float>(steps[k]);
      roots.turned = (turned >> k & 1) << lane_;
      sink_.found(roots);
    });
  }

  const LeafCurls& curls_;
  const double* powers_;
  int pu_, pv_;
  const LeafBox& leaf_;
  int lane_;
  double scale_;
  RootSink& sink_;
  RayLanes<V> ray_;
  GrazedWindow stack_[kParts * kMostLevels + 1];
  int count_ = 0;
};

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
