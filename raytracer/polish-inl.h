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

// Where the rays are, and what turns a point into a distance along them.
template <class V>
struct RayLanes {
  Planes<V> planes;
  V o[3], d[3], inverse_dd;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE RayLanes<V> load_rays(D d, const LocalRays& rays, std::size_t first) {
  RayLanes<V> r;
  r.planes = load_planes(d, rays.planes, first);
  for (int c = 0; c < 3; ++c) {
    r.o[c] = hn::Load(d, rays.o[c] + first);
    r.d[c] = hn::Load(d, rays.d[c] + first);
  }
  r.inverse_dd = hn::Load(d, rays.inverse_dd + first);
  return r;
}

// Boxes of the patch's parameters, about its middle: one a lane, all of one size.
template <class V>
struct Boxes {
  V x, y, half_x, half_y, to_a, to_b;
};
template <class D, class V = hn::Vec<D>>
struct Polished {
  V a, b;  // in half widths of the box
  V distance, steps;
  hn::Mask<D> inside, beside;  // a root in the box; one in the margin, so none in the box
  hn::Mask<D> turned;          // LeafRoots::turned
};

// Newton from (a, b) for the lanes that are `going`.
template <int kDegree, int kComponents, class D, class V = hn::Vec<D>>
HWY_INLINE Polished<D> polish(D d, const double* powers, int pu, int pv, const RayLanes<V>& rays, const Boxes<V>& box, V a, V b,
                              hn::Mask<D> going) {
  const V one = hn::Set(d, 1.0);
  auto converged = hn::MaskFromVec(hn::Zero(d)), turned = converged;
  V distance = hn::Zero(d), steps = hn::Zero(d);
  for (int step = 0; step < kDoubleSteps; ++step) {
    PatchJet<V, kComponents> jet;
    evaluate<kDegree, kComponents>(d, read_again(powers), pu, pv, hn::MulAdd(box.half_x, a, box.x), hn::MulAdd(box.half_y, b, box.y), jet);
    const PlaneJet<V> planes = plane_jet(jet, rays.planes);
    const V inverse = inverse_determinant(planes);
    V dx, dy;
    newton_step(planes, inverse, dx, dy);
    const V da = hn::Mul(dx, box.to_a), db = hn::Mul(dy, box.to_b);
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
        sum = hn::MulAdd(hn::Sub(p, rays.o[c]), rays.d[c], sum);
      }
      distance = hn::IfThenElse(last, hn::Mul(sum, rays.inverse_dd), distance);
      converged = hn::Or(converged, last);
      turned = hn::Or(turned, hn::And(last, hn::Lt(inverse, hn::Zero(d))));
    }
    const V far = hn::Max(hn::Abs(a), hn::Abs(b));
    going = hn::And(hn::AndNot(last, going), hn::Lt(far, hn::Set(d, static_cast<double>(kLeash))));
    if (hn::AllFalse(d, going)) break;
  }
  const V far = hn::Max(hn::Abs(a), hn::Abs(b));
  const auto inside = hn::And(converged, hn::Lt(far, hn::Set(d, 1 - kDoubtful)));
  const auto beside = hn::And(converged, hn::And(hn::Gt(far, hn::Set(d, 1 + kDoubtful)), hn::Lt(far, hn::Set(d, kCellMargin))));
  return {a, b, distance, steps, inside, beside, turned};
}

// The lanes of a packet that have a proposal, in their leaf.
template <int kDegree, int kComponents, class D, class V = hn::Vec<D>>
HWY_INLINE void polish_lanes(D d, const double* powers, int pu, int pv, const LeafBox& leaf, const LocalRays& rays, std::size_t first,
                             const Proposal& start, LeafRoots& roots) {
  const hn::Rebind<float, D> narrow;
  const auto set = [&](double x) HWY_ATTR { return hn::Set(d, x); };
  const Boxes<V> box{set(leaf.x), set(leaf.y), set(leaf.half_x), set(leaf.half_y), set(leaf.to_a), set(leaf.to_b)};
  const V a = hn::PromoteTo(d, hn::Load(narrow, start.a + first)), b = hn::PromoteTo(d, hn::Load(narrow, start.b + first));
  const Polished<D> p =
      polish<kDegree, kComponents>(d, powers, pu, pv, load_rays(d, rays, first), box, a, b, lanes_of(d, start.certain, first));
  const LaneMask polished = start.certain & lanes_from(first, hn::Lanes(d));
  roots.found |= bits_of(d, p.inside, first) & polished;
  roots.none |= bits_of(d, p.beside, first) & polished;
  roots.turned |= bits_of(d, p.turned, first) & polished;
  const V half = hn::Set(d, 0.5);
  hn::Store(hn::Add(half, hn::MulAdd(box.half_x, p.a, box.x)), d, roots.s + first);
  hn::Store(hn::Add(half, hn::MulAdd(box.half_y, p.b, box.y)), d, roots.t + first);
  hn::Store(p.distance, d, roots.distance + first);
  hn::Store(hn::DemoteTo(narrow, p.steps), narrow, roots.steps + first);
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
