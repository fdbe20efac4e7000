// Step 1 of leaf_kernel.h: the slab test, and Newton in float. Compiled once per instruction set (Highway's per-target header).
#include <hwy/highway.h>

#include "raytracer/leaf_kernel.h"

#if defined(ISOPHOTE_PROPOSAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ISOPHOTE_PROPOSAL_INL_H_
#undef ISOPHOTE_PROPOSAL_INL_H_
#else
#define ISOPHOTE_PROPOSAL_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE LaneMask lanes_from(std::size_t first, std::size_t count) { return ((LaneMask{1} << count) - 1) << first; }

template <class D>
HWY_INLINE hn::Mask<D> lanes_of(D d, LaneMask mask, std::size_t first) {
  const std::uint8_t bits[8] = {static_cast<std::uint8_t>(mask >> first), static_cast<std::uint8_t>(mask >> first >> 8)};
  return hn::LoadMaskBits(d, bits);
}
template <class D>
HWY_INLINE LaneMask bits_of(D d, hn::Mask<D> mask, std::size_t first) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  return (bits[0] | static_cast<LaneMask>(bits[1]) << 8) << first & lanes_from(first, hn::Lanes(d));
}

// The same address, about which the compiler knows nothing: else it takes a patch's coefficients, which do not change from step to step,
// out of the loop, and there are more of them than registers.
template <class T>
HWY_INLINE const T* read_again(const T* at) {
  asm volatile("" : "+r"(at));
  return at;
}

// A point of a patch with its derivatives, homogeneous where the patch is rational.
template <class V, int kComponents>
struct PatchJet {
  V P[kComponents], Ps[kComponents], Pt[kComponents];
};

// Horner in both directions at (x, y) = (s - 1/2, t - 1/2). `kDegree` > 0: of both directions; 0: `pu` and `pv` say.
template <int kDegree, int kComponents, class D, class V = hn::Vec<D>, class T = hn::TFromD<D>>
HWY_INLINE void evaluate(D d, const T* HWY_RESTRICT powers, int pu, int pv, V x, V y, PatchJet<V, kComponents>& jet) {
  const int du = kDegree ? kDegree : pu, dv = kDegree ? kDegree : pv;
  const int row_length = (dv + 1) * kComponents;
  const auto row = [&](int i, int c, V& value, V& slope) HWY_ATTR {
    const T* at = powers + i * row_length + dv * kComponents + c;
    value = hn::Set(d, *at);
    slope = hn::Zero(d);
    for (int j = dv - 1; j >= 0; --j) {
      at -= kComponents;
      slope = hn::MulAdd(slope, y, value);
      value = hn::MulAdd(value, y, hn::Set(d, *at));
    }
  };
  for (int c = 0; c < kComponents; ++c) {
    V value, slope;
    row(du, c, jet.P[c], jet.Pt[c]);
    jet.Ps[c] = hn::Zero(d);
    for (int i = du - 1; i >= 0; --i) {
      row(i, c, value, slope);
      jet.Ps[c] = hn::MulAdd(jet.Ps[c], x, jet.P[c]);
      jet.P[c] = hn::MulAdd(jet.P[c], x, value);
      jet.Pt[c] = hn::MulAdd(jet.Pt[c], x, slope);
    }
  }
}

// The planes of the rays.
template <class V>
struct Planes {
  V n1[3], n2[3], d1, d2;
};

// The plane equations n . P - d w of both planes, with their derivatives.
template <class V>
struct PlaneJet {
  V f, g, fs, ft, gs, gt;
};
template <class V, int kComponents>
HWY_INLINE PlaneJet<V> plane_jet(const PatchJet<V, kComponents>& jet, const Planes<V>& planes) {
  const auto dot = [](const V n[3], const V P[kComponents])
                       HWY_ATTR { return hn::MulAdd(n[0], P[0], hn::MulAdd(n[1], P[1], hn::Mul(n[2], P[2]))); };
  const auto value = [&](const V n[3], V offset) HWY_ATTR {
    if constexpr (kComponents == 4)
      return hn::NegMulAdd(offset, jet.P[3], dot(n, jet.P));
    else
      return hn::Sub(dot(n, jet.P), offset);
  };
  const auto slope = [&](const V n[3], V offset, const V P[kComponents]) HWY_ATTR {
    if constexpr (kComponents == 4)
      return hn::NegMulAdd(offset, P[3], dot(n, P));
    else
      return dot(n, P);
  };
  return {value(planes.n1, planes.d1),         value(planes.n2, planes.d2),         slope(planes.n1, planes.d1, jet.Ps),
          slope(planes.n1, planes.d1, jet.Pt), slope(planes.n2, planes.d2, jet.Ps), slope(planes.n2, planes.d2, jet.Pt)};
}

// Newton's step on both; `inverse` of the determinant.
template <class V>
HWY_INLINE void newton_step(const PlaneJet<V>& p, V inverse, V& dx, V& dy) {
  dx = hn::Mul(hn::NegMulAdd(p.gt, p.f, hn::Mul(p.ft, p.g)), inverse);
  dy = hn::Mul(hn::NegMulAdd(p.fs, p.g, hn::Mul(p.gs, p.f)), inverse);
}
template <class V>
HWY_INLINE V inverse_determinant(const PlaneJet<V>& p) {
  return hn::Div(hn::Set(hn::DFromV<V>(), 1), hn::NegMulAdd(p.ft, p.gs, hn::Mul(p.fs, p.gt)));
}
template <class V, int kComponents>
HWY_INLINE void newton_step(const PatchJet<V, kComponents>& jet, const Planes<V>& planes, V& dx, V& dy) {
  const PlaneJet<V> p = plane_jet(jet, planes);
  newton_step(p, inverse_determinant(p), dx, dy);
}

// What the proposal leaves for the polish: parameters about the middle of the leaf, in half widths.
struct Proposal {
  alignas(64) Lanes<float> a, b;
  LaneMask live = 0;     // in the slab
  LaneMask certain = 0;  // and steep enough for the certificate
};

// How far beyond the leaf Newton may go on its way.
inline constexpr float kLeash = 1.3f;
inline constexpr int kFloatSteps = 3;
inline constexpr float kCloseEnough = 4e-3f;  // a float step this small (in half widths) is followed by steps in double

template <class D, class V = hn::Vec<D>>
HWY_INLINE void test_slab(D d, const Leaf& leaf, const LocalRays& rays, LaneMask lanes, std::size_t first, Proposal& out) {
  const V ox = hn::Load(d, rays.fo[0] + first), oy = hn::Load(d, rays.fo[1] + first), oz = hn::Load(d, rays.fo[2] + first);
  const V dx = hn::Load(d, rays.fd[0] + first), dy = hn::Load(d, rays.fd[1] + first), dz = hn::Load(d, rays.fd[2] + first);
  // What is nearer already decides who is live, not where Newton starts: a root must not depend on what was found before.
  const V far = hn::Load(d, rays.far + first);
  V enter = hn::Zero(d), leave = hn::Set(d, 3e38f);
  const V one = hn::Set(d, 1.0f);
  const auto across = [&](const float row[4], V& start, V& speed) HWY_ATTR {
    const V x = hn::Set(d, row[0]), y = hn::Set(d, row[1]), z = hn::Set(d, row[2]);
    start = hn::MulAdd(x, ox, hn::MulAdd(y, oy, hn::MulAdd(z, oz, hn::Set(d, row[3]))));
    speed = hn::MulAdd(x, dx, hn::MulAdd(y, dy, hn::Mul(z, dz)));
    // Parallel rays: a tiny speed in place of none keeps every quotient a number.
    const V safe = hn::IfThenElse(hn::Gt(hn::Abs(speed), hn::Set(d, 1e-18f)), speed, hn::Set(d, 1e-18f));
    const V inverse = hn::Div(one, safe);
    const V middle = hn::Neg(hn::Mul(start, inverse)), half = hn::Abs(inverse);
    enter = hn::Max(enter, hn::Sub(middle, half));
    leave = hn::Min(leave, hn::Add(middle, half));
    return middle;
  };
  V a0, av, b0, bv, h0, hv;
  across(leaf.a, a0, av);
  across(leaf.b, b0, bv);
  const V crossing = across(leaf.h, h0, hv);
  const auto live = hn::And(lanes_of(d, lanes, first), hn::Le(enter, hn::Min(leave, far)));
  out.live |= bits_of(d, live, first);
  out.certain |= bits_of(d, hn::And(live, hn::Gt(hn::Abs(hv), hn::Set(d, leaf.steep))), first);
  const V t = hn::Min(hn::Max(crossing, enter), leave);
  hn::Store(hn::MulAdd(t, av, a0), d, out.a + first);
  hn::Store(hn::MulAdd(t, bv, b0), d, out.b + first);
}

template <class D, class T, class V = hn::Vec<D>>
HWY_INLINE Planes<V> load_planes(D d, const PlaneLanes<T>& lanes, std::size_t first) {
  Planes<V> p;
  for (int c = 0; c < 3; ++c) {
    p.n1[c] = hn::Load(d, lanes.n1[c] + first);
    p.n2[c] = hn::Load(d, lanes.n2[c] + first);
  }
  p.d1 = hn::Load(d, lanes.d1 + first);
  p.d2 = hn::Load(d, lanes.d2 + first);
  return p;
}

template <int kDegree, int kComponents, class D, class V = hn::Vec<D>>
HWY_INLINE void newton_in_float(D d, const float* powers, int pu, int pv, const LeafBox& box, const LocalRays& rays, std::size_t first,
                                Proposal& out) {
  const Planes<V> planes = load_planes(d, rays.float_planes, first);
  const V x0 = hn::Set(d, static_cast<float>(box.x)), y0 = hn::Set(d, static_cast<float>(box.y));
  const V half_x = hn::Set(d, static_cast<float>(box.half_x)), half_y = hn::Set(d, static_cast<float>(box.half_y));
  const V to_a = hn::Set(d, static_cast<float>(box.to_a)), to_b = hn::Set(d, static_cast<float>(box.to_b));
  const V leash = hn::Set(d, kLeash), back = hn::Neg(leash);
  V a = hn::Load(d, out.a + first), b = hn::Load(d, out.b + first);
  auto going = lanes_of(d, out.certain, first);
  for (int step = 0; step < kFloatSteps; ++step) {
    PatchJet<V, kComponents> jet;
    evaluate<kDegree, kComponents>(d, read_again(powers), pu, pv, hn::MulAdd(half_x, a, x0), hn::MulAdd(half_y, b, y0), jet);
    V da, db;
    newton_step(jet, planes, da, db);
    da = hn::Mul(da, to_a);
    db = hn::Mul(db, to_b);
    a = hn::IfThenElse(going, hn::Min(hn::Max(hn::Add(a, da), back), leash), a);
    b = hn::IfThenElse(going, hn::Min(hn::Max(hn::Add(b, db), back), leash), b);
    going = hn::And(going, hn::Gt(hn::Max(hn::Abs(da), hn::Abs(db)), hn::Set(d, kCloseEnough)));
    if (hn::AllFalse(d, going)) break;
  }
  hn::Store(a, d, out.a + first);
  hn::Store(b, d, out.b + first);
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
