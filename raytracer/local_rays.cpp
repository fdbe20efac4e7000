// Moving the rays of a packet into a part's coordinates, several at a time.
#include "raytracer/packet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raytracer/local_rays.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, by its rules.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class V = hn::Vec<D>>
HWY_INLINE LaneMask enter_some(D d, const Packet& packet, const Affine3& to_part, bool moved, const Box3& box, double part_size,
                               std::size_t first, LocalRays& out) {
  const hn::Rebind<float, D> narrow;
  const auto set = [&](double x) HWY_ATTR { return hn::Set(d, x); };
  const auto store = [&](V x, Lanes<double>& to) HWY_ATTR { hn::Store(x, d, to + first); };
  const auto store_float = [&](V x, Lanes<float>& to) HWY_ATTR { hn::Store(hn::DemoteTo(narrow, x), narrow, to + first); };
  const auto dot = [&](const V a[3], const V b[3]) HWY_ATTR { return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2]))); };
  V o[3], v[3];
  for (int c = 0; c < 3; ++c) {
    o[c] = hn::Load(d, packet.o[c] + first);
    v[c] = hn::Load(d, packet.d[c] + first);
  }
  if (moved) {
    const auto& m = to_part.linear;
    V p[3], w[3];
    for (int c = 0; c < 3; ++c) {
      p[c] = hn::MulAdd(set(m[0][c]), o[0], hn::MulAdd(set(m[1][c]), o[1], hn::MulAdd(set(m[2][c]), o[2], set(to_part.translation[c]))));
      w[c] = hn::MulAdd(set(m[0][c]), v[0], hn::MulAdd(set(m[1][c]), v[1], hn::Mul(set(m[2][c]), v[2])));
    }
    for (int c = 0; c < 3; ++c) {
      o[c] = p[c];
      v[c] = w[c];
    }
  }

  V enter = hn::Load(d, packet.tmin + first), leave = hn::Load(d, packet.limit + first);
  for (int c = 0; c < 3; ++c) {
    // A tiny speed in place of none keeps every quotient a number.
    const V speed = hn::IfThenElse(hn::Eq(v[c], hn::Zero(d)), set(1e-300), v[c]);
    const V a = hn::Div(hn::Sub(set(box.lo[c]), o[c]), speed), b = hn::Div(hn::Sub(set(box.hi[c]), o[c]), speed);
    enter = hn::Max(enter, hn::Min(a, b));
    leave = hn::Min(leave, hn::Max(a, b));
  }
  const auto inside = hn::Le(enter, leave);
  if (hn::AllFalse(d, inside)) return 0;

  const V dd = dot(v, v), length = hn::Sqrt(dd), inverse = hn::Div(set(1), length);
  V unit[3], n1[3], n2[3];
  for (int c = 0; c < 3; ++c) {
    o[c] = hn::MulAdd(enter, v[c], o[c]);
    unit[c] = hn::Mul(v[c], inverse);
  }
  // As `any_perpendicular`.
  const V side = hn::CopySign(set(1), unit[2]), a = hn::Neg(hn::Div(set(1), hn::Add(side, unit[2])));
  n1[0] = hn::MulAdd(hn::Mul(side, unit[0]), hn::Mul(unit[0], a), set(1));
  n1[1] = hn::Mul(hn::Mul(side, unit[0]), hn::Mul(unit[1], a));
  n1[2] = hn::Neg(hn::Mul(side, unit[0]));
  for (int c = 0; c < 3; ++c) {
    const int e = (c + 1) % 3, f = (c + 2) % 3;
    n2[c] = hn::MulSub(unit[e], n1[f], hn::Mul(unit[f], n1[e]));
  }
  const V d1 = dot(n1, o), d2 = dot(n2, o);

  const V slack = set(kStartSlack * part_size);
  for (int c = 0; c < 3; ++c) {
    store(o[c], out.o[c]);
    store(v[c], out.d[c]);
    store(n1[c], out.planes.n1[c]);
    store(n2[c], out.planes.n2[c]);
    store_float(n1[c], out.float_planes.n1[c]);
    store_float(n2[c], out.float_planes.n2[c]);
    store_float(hn::NegMulAdd(slack, unit[c], o[c]), out.fo[c]);
    store_float(unit[c], out.fd[c]);
  }
  store(d1, out.planes.d1);
  store(d2, out.planes.d2);
  store_float(d1, out.float_planes.d1);
  store_float(d2, out.float_planes.d2);
  store(hn::Mul(inverse, inverse), out.inverse_dd);
  store(hn::Add(set(part_size), hn::Add(hn::Abs(d1), hn::Abs(d2))), out.scale);
  store(enter, out.shift);
  store(length, out.length);
  // Rounded up.
  store_float(hn::Mul(hn::MulAdd(hn::Sub(leave, enter), length, hn::Add(slack, slack)), set(1 + 3e-7)), out.far);

  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, inside, bits);
  return static_cast<LaneMask>(bits[0]) << first;
}

LaneMask enter_part(const Packet& packet, LaneMask wanted, const Affine3& to_part, const Box3& box, double part_size, LocalRays& out) {
  const hn::CappedTag<double, 8> d;
  const bool moved = !to_part.is_identity();
  LaneMask inside = 0;
  for (std::size_t first = 0; first < kWidth; first += hn::Lanes(d)) {
    const LaneMask these = ((LaneMask{1} << hn::Lanes(d)) - 1) << first;
    if (wanted & these) inside |= enter_some(d, packet, to_part, moved, box, part_size, first, out) & these;
  }
  out.slack = kStartSlack * part_size;
  return inside & wanted;
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace iso {

HWY_EXPORT(enter_part);
LaneMask enter_part(const Packet& packet, LaneMask wanted, const Affine3& to_part, const Box3& box, double part_size, LocalRays& local) {
  return HWY_DYNAMIC_DISPATCH(enter_part)(packet, wanted, to_part, box, part_size, local);
}

LocalRay LocalRays::ray(int lane) const {
  LocalRay r;
  for (int c = 0; c < 3; ++c) {
    r.o[c] = o[c][lane];
    r.d[c] = d[c][lane];
    r.n1[c] = planes.n1[c][lane];
    r.n2[c] = planes.n2[c][lane];
  }
  r.d1 = planes.d1[lane];
  r.d2 = planes.d2[lane];
  r.inverse_dd = inverse_dd[lane];
  r.scale = scale[lane];
  return r;
}

}  // namespace iso
#endif
