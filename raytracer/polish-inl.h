// Step 2 of leaf_kernel.h: Newton in double to the last digits, and the verdict. Compiled once per instruction set.
#include "raytracer/proposal-inl.h"

#if defined(ISOPHOTE_POLISH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ISOPHOTE_POLISH_INL_H_
#undef ISOPHOTE_POLISH_INL_H_
#else
#define ISOPHOTE_POLISH_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr int kDoubleSteps = 8;
// A step this small (in half widths) is the last: Newton's next one would be its square, below the rounding of the patch.
inline constexpr double kLastStep = 3e-8;

template <int kDegree, int kComponents, class D, class V = hn::Vec<D>>
HWY_INLINE void polish(D d, const double* powers, int pu, int pv, const LeafBox& box, const LocalRays& rays, std::size_t first,
                       const Proposal& start, LeafRoots& roots) {
  const hn::Rebind<float, D> narrow;
  const Planes<V> planes = load_planes(d, rays.planes, first);
  const V x0 = hn::Set(d, box.x), y0 = hn::Set(d, box.y), half_x = hn::Set(d, box.half_x), half_y = hn::Set(d, box.half_y);
  const V to_a = hn::Set(d, 1 / box.half_x), to_b = hn::Set(d, 1 / box.half_y), one = hn::Set(d, 1.0);
  V a = hn::PromoteTo(d, hn::Load(narrow, start.a + first)), b = hn::PromoteTo(d, hn::Load(narrow, start.b + first));
  auto going = lanes_of(d, start.certain, first);
  auto converged = hn::MaskFromVec(hn::Zero(d));
  V distance = hn::Zero(d), steps = hn::Zero(d);
  for (int step = 0; step < kDoubleSteps; ++step) {
    PatchJet<V, kComponents> jet;
    evaluate<kDegree, kComponents>(d, powers, pu, pv, hn::MulAdd(half_x, a, x0), hn::MulAdd(half_y, b, y0), jet);
    V dx, dy;
    newton_step<V, kComponents>(jet, planes, dx, dy);
    const V da = hn::Mul(dx, to_a), db = hn::Mul(dy, to_b);
    a = hn::IfThenElse(going, hn::Add(a, da), a);
    b = hn::IfThenElse(going, hn::Add(b, db), b);
    steps = hn::IfThenElse(going, hn::Add(steps, one), steps);
    const auto last = hn::And(going, hn::Lt(hn::Max(hn::Abs(da), hn::Abs(db)), hn::Set(d, kLastStep)));
    if (!hn::AllFalse(d, last)) {
      // The last step moves the point to first order; t is where the ray is nearest to it.
      V sum = hn::Zero(d);
      V weight = one;
      if constexpr (kComponents == 4) weight = hn::Div(one, hn::MulAdd(dx, jet.Ps[3], hn::MulAdd(dy, jet.Pt[3], jet.P[3])));
      for (int c = 0; c < 3; ++c) {
        V p = hn::MulAdd(dx, jet.Ps[c], hn::MulAdd(dy, jet.Pt[c], jet.P[c]));
        if constexpr (kComponents == 4) p = hn::Mul(p, weight);
        sum = hn::MulAdd(hn::Sub(p, hn::Load(d, rays.o[c] + first)), hn::Load(d, rays.d[c] + first), sum);
      }
      distance = hn::IfThenElse(last, hn::Mul(sum, hn::Load(d, rays.inverse_dd + first)), distance);
      converged = hn::Or(converged, last);
    }
    const V far = hn::Max(hn::Abs(a), hn::Abs(b));
    going = hn::And(hn::AndNot(last, going), hn::Lt(far, hn::Set(d, static_cast<double>(kLeash))));
    if (hn::AllFalse(d, going)) break;
  }
  const V far = hn::Max(hn::Abs(a), hn::Abs(b));
  const auto inside = hn::And(converged, hn::Lt(far, hn::Set(d, 1 - kDoubtful)));
  const auto beside = hn::And(converged, hn::And(hn::Gt(far, hn::Set(d, 1 + kDoubtful)), hn::Lt(far, hn::Set(d, kCellMargin))));
  const LaneMask polished = start.certain & lanes_from(first, hn::Lanes(d));
  roots.found |= bits_of(d, inside, first) & polished;
  roots.none |= bits_of(d, beside, first) & polished;
  const V half = hn::Set(d, 0.5);
  hn::Store(hn::Add(half, hn::MulAdd(half_x, a, x0)), d, roots.s + first);
  hn::Store(hn::Add(half, hn::MulAdd(half_y, b, y0)), d, roots.t + first);
  hn::Store(distance, d, roots.distance + first);
  hn::Store(hn::DemoteTo(narrow, steps), narrow, roots.steps + first);
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
