#include "raytracer/analytic_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raytracer/analytic_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, by its rules.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace iso::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V set(double x) { return hn::Set(D(), x); }
HWY_INLINE V dot(const V3& a, const V3& b) { return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z))); }
HWY_INLINE V dot(const Vec3& a, const V3& b) { return hn::MulAdd(set(a.x), b.x, hn::MulAdd(set(a.y), b.y, hn::Mul(set(a.z), b.z))); }
HWY_INLINE V3 along(const V3& o, V t, const V3& d) { return {hn::MulAdd(t, d.x, o.x), hn::MulAdd(t, d.y, o.y), hn::MulAdd(t, d.z, o.z)}; }
HWY_INLINE V length_of(V x, V y) { return hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y))); }
HWY_INLINE V product(V a, V b) { return hn::Mul(a, b); }

// The angle of (x, y) in [0, 2 pi); of (0, 0) it is 0.
HWY_INLINE V angle_of(V y, V x) {
  const V ax = hn::Abs(x), ay = hn::Abs(y), most = hn::Max(ax, ay);
  const V ratio = hn::IfThenElseZero(hn::Gt(most, set(0)), hn::Div(hn::Min(ax, ay), most));
  V a = hn::CallAtan(D(), ratio);
  a = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(set(0.5 * kPi), a), a);
  a = hn::IfThenElse(hn::Lt(x, set(0)), hn::Sub(set(kPi), a), a);
  return hn::IfThenElse(hn::Lt(y, set(0)), hn::Sub(set(kTwoPi), a), a);
}

// Rays in the coordinates of the face's frame, and the roots as they come.
struct Rays {
  V3 o, d;
  V inverse_dd, scale;
};
struct Roots {
  V t[2];
  V3 p[2];  // in the frame
  M found[2], tangent;
};

HWY_INLINE M none() { return hn::Lt(set(1), set(0)); }

// a t^2 + 2 b t + c = 0 where the caller chose the origin so that |b| is small. `doubtful`: how large b^2 - a c may be by rounding alone.
HWY_INLINE void quadratic(V a, V b, V c, V doubtful, Roots& roots) {
  const V discriminant = hn::NegMulAdd(a, c, product(b, b));
  roots.tangent = hn::Le(hn::Abs(discriminant), doubtful);
  const M two = hn::Gt(discriminant, doubtful);
  const V q = hn::Neg(hn::Add(b, hn::CopySign(hn::Sqrt(hn::Max(discriminant, set(0))), b)));
  const V s = hn::Div(q, a), r = hn::Div(c, q);
  roots.t[0] = hn::IfThenElse(roots.tangent, hn::Neg(hn::Div(b, a)), hn::Min(s, r));
  roots.t[1] = hn::Max(s, r);
  roots.found[0] = hn::Or(two, roots.tangent);
  roots.found[1] = two;
}

HWY_INLINE void meet_plane(const Rays& r, Roots& roots) {
  roots.t[0] = hn::Neg(hn::Div(r.o.z, r.d.z));
  roots.p[0] = along(r.o, roots.t[0], r.d);
  roots.found[0] = hn::Ne(r.d.z, set(0));
  roots.found[1] = roots.tangent = none();
}

HWY_INLINE void meet_cylinder(const Rays& r, double radius, Roots& roots) {
  const V a = hn::MulAdd(r.d.x, r.d.x, product(r.d.y, r.d.y));
  const V nearest = hn::Neg(hn::Div(hn::MulAdd(r.o.x, r.d.x, product(r.o.y, r.d.y)), a));
  const V3 q = along(r.o, nearest, r.d);
  // Distance to the axis as a cross product: no digits lost to a far origin.
  const V distance = hn::Div(hn::MulSub(r.o.x, r.d.y, product(r.o.y, r.d.x)), hn::Sqrt(a)), R = set(radius);
  const V doubtful = product(product(set(8 * kEps * radius), a), hn::Add(R, r.scale));
  quadratic(a, set(0), product(hn::Sub(distance, R), hn::Add(distance, R)), doubtful, roots);
  for (int i = 0; i < 2; ++i) {
    const V x = hn::MulAdd(roots.t[i], r.d.x, q.x), y = hn::MulAdd(roots.t[i], r.d.y, q.y), off = length_of(x, y);
    const V slope = hn::MulAdd(x, r.d.x, product(y, r.d.y));
    const V step = hn::Div(product(product(set(0.5), hn::Sub(off, R)), hn::Add(off, R)), slope);
    roots.t[i] = hn::IfThenElse(hn::Or(roots.tangent, hn::Eq(slope, set(0))), roots.t[i], hn::Sub(roots.t[i], step));
    roots.p[i] = along(q, roots.t[i], r.d);
    roots.t[i] = hn::Add(nearest, roots.t[i]);
  }
  const M turns = hn::Gt(product(a, r.inverse_dd), set(1e-30));  // else the ray runs along the axis
  roots.found[0] = hn::And(roots.found[0], turns);
  roots.found[1] = hn::And(roots.found[1], turns);
}

HWY_INLINE void meet_sphere(const Rays& r, double radius, Roots& roots) {
  const V a = dot(r.d, r.d), nearest = hn::Neg(hn::Div(dot(r.o, r.d), a));
  const V3 cross{hn::MulSub(r.o.y, r.d.z, product(r.o.z, r.d.y)), hn::MulSub(r.o.z, r.d.x, product(r.o.x, r.d.z)),
                 hn::MulSub(r.o.x, r.d.y, product(r.o.y, r.d.x))};
  const V distance = hn::Sqrt(hn::Div(dot(cross, cross), a)), R = set(radius);
  const V3 q = along(r.o, nearest, r.d);
  const V doubtful = product(product(set(8 * kEps * radius), a), hn::Add(R, r.scale));
  quadratic(a, set(0), product(hn::Sub(distance, R), hn::Add(distance, R)), doubtful, roots);
  for (int i = 0; i < 2; ++i) {
    const V3 p = along(q, roots.t[i], r.d);
    const V off = hn::Sqrt(dot(p, p)), slope = dot(p, r.d);
    const V step = hn::Div(product(product(set(0.5), hn::Sub(off, R)), hn::Add(off, R)), slope);
    roots.t[i] = hn::IfThenElse(hn::Or(roots.tangent, hn::Eq(slope, set(0))), roots.t[i], hn::Sub(roots.t[i], step));
    roots.p[i] = along(q, roots.t[i], r.d);
    roots.t[i] = hn::Add(nearest, roots.t[i]);
  }
}

// From the apex: x^2 + y^2 = k^2 z^2. Both nappes are met.
HWY_INLINE void meet_cone(const Rays& from, double k, double apex, Roots& roots) {
  Rays r = from;
  r.o.z = hn::Sub(r.o.z, set(apex));
  const V kk = set(k * k), nearest = hn::Neg(product(dot(r.o, r.d), r.inverse_dd));  // to the apex
  const V3 q = along(r.o, nearest, r.d);
  const auto form = [&](const V3& x, const V3& y)
                        HWY_ATTR { return hn::NegMulAdd(product(kk, x.z), y.z, hn::MulAdd(x.x, y.x, product(x.y, y.y))); };
  const V steep = hn::Div(set(1 + k * k), r.inverse_dd), size = hn::MulAdd(product(kk, q.z), q.z, dot(q, q));
  V a = form(r.d, r.d);
  const V b = form(q, r.d), c = form(q, q);
  const M linear = hn::Lt(hn::Abs(a), product(set(4 * kEps), steep));  // along a ruling's direction: one root
  a = hn::IfThenElse(linear, set(1), a);
  const V doubtful = product(product(set(8 * kEps), steep), hn::MulAdd(product(set(kEps), r.scale), r.scale, size));
  quadratic(a, b, c, doubtful, roots);
  roots.t[0] = hn::IfThenElse(linear, hn::Div(product(set(-0.5), c), b), roots.t[0]);
  roots.found[0] = hn::Or(hn::And(linear, hn::Ne(b, set(0))), hn::AndNot(linear, roots.found[0]));
  roots.found[1] = hn::AndNot(linear, roots.found[1]);
  roots.tangent = hn::AndNot(linear, roots.tangent);
  for (int i = 0; i < 2; ++i) {
    V3 p = along(q, roots.t[i], r.d);
    const V slope = form(p, r.d), radius = length_of(p.x, p.y), wanted = hn::Abs(product(set(k), p.z));
    const V step = hn::Div(product(product(set(0.5), hn::Sub(radius, wanted)), hn::Add(radius, wanted)), slope);
    const V most = hn::MulAdd(set(1e-3), hn::Abs(roots.t[i]), product(product(set(1e-6), r.scale), hn::Sqrt(r.inverse_dd)));
    const M good = hn::AndNot(roots.tangent, hn::Lt(hn::Abs(step), most));
    roots.t[i] = hn::IfThenElse(good, hn::Sub(roots.t[i], step), roots.t[i]);
    roots.p[i] = along(q, roots.t[i], r.d);
    roots.t[i] = hn::Add(nearest, roots.t[i]);
  }
}

HWY_INLINE void parameters(const AnalyticFace& face, const V3& p, V& u, V& v) {
  switch (face.kind) {
    case AnalyticKind::plane:
      u = p.x;
      v = p.y;
      return;
    case AnalyticKind::cylinder:
      u = angle_of(p.y, p.x);
      v = p.z;
      return;
    case AnalyticKind::sphere: {
      u = angle_of(p.y, p.x);
      const V latitude = angle_of(p.z, length_of(p.x, p.y));
      v = hn::IfThenElse(hn::Gt(latitude, set(kPi)), hn::Sub(latitude, set(kTwoPi)), latitude);
      return;
    }
    case AnalyticKind::cone: {
      // v tells the nappes apart, as the surface's own formula does (radius r + v sin a < 0).
      const M mirrored = hn::Lt(product(set(face.k), p.z), set(0));
      u = angle_of(hn::IfThenElse(mirrored, hn::Neg(p.y), p.y), hn::IfThenElse(mirrored, hn::Neg(p.x), p.x));
      v = hn::Div(hn::Add(p.z, set(face.apex)), set(face.cosine));
      return;
    }
  }
}

HWY_INLINE LaneMask bits_of(M mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(D(), mask, bits);
  return bits[0] & ((1u << hn::Lanes(D())) - 1);
}

HWY_INLINE void meet_some(const AnalyticFace& face, const Packet& packet, LaneMask lanes, std::size_t first, AnalyticRoots& out) {
  const LocalRays& local = packet.local;
  const auto load = [&](const Lanes<double>& x) HWY_ATTR { return hn::Load(D(), x + first); };
  const V3 o{load(local.o[0]), load(local.o[1]), load(local.o[2])}, d{load(local.d[0]), load(local.d[1]), load(local.d[2])};
  const Frame& f = face.frame;
  const V3 from{hn::Sub(o.x, set(f.O.x)), hn::Sub(o.y, set(f.O.y)), hn::Sub(o.z, set(f.O.z))};
  const Rays r{
      {dot(f.X, from), dot(f.Y, from), dot(f.Z, from)}, {dot(f.X, d), dot(f.Y, d), dot(f.Z, d)}, load(local.inverse_dd), load(local.scale)};
  Roots roots;
  roots.found[0] = roots.found[1] = roots.tangent = none();
  switch (face.kind) {
    case AnalyticKind::plane:
      meet_plane(r, roots);
      break;
    case AnalyticKind::cylinder:
      meet_cylinder(r, face.radius, roots);
      break;
    case AnalyticKind::sphere:
      meet_sphere(r, face.radius, roots);
      break;
    case AnalyticKind::cone:
      meet_cone(r, face.k, face.apex, roots);
      break;
  }
  const V shift = load(local.shift), near = hn::Sub(load(packet.tmin), shift), far = hn::Sub(load(packet.limit), shift);
  LaneMask found[2];
  const int most = face.kind == AnalyticKind::plane ? 1 : 2;
  for (int i = 0; i < most; ++i) {
    const V t = roots.t[i];
    const V3 p = along(o, t, d);
    const auto within = [&](V x, double lo, double hi) HWY_ATTR { return hn::And(hn::Ge(x, set(lo)), hn::Le(x, set(hi))); };
    const M in_box = hn::And(within(p.x, face.box.lo.x, face.box.hi.x),
                             hn::And(within(p.y, face.box.lo.y, face.box.hi.y), within(p.z, face.box.lo.z, face.box.hi.z)));
    const M in_time = hn::And(hn::Ge(t, near), hn::Le(t, far));
    found[i] = bits_of(hn::And(roots.found[i], hn::And(in_box, in_time))) & (lanes >> first);
    if (!found[i]) continue;
    out.found[i] |= found[i] << first;
    V u = set(0), v = u;
    parameters(face, roots.p[i], u, v);
    hn::Store(t, D(), out.t[i] + first);
    hn::Store(u, D(), out.u[i] + first);
    hn::Store(v, D(), out.v[i] + first);
  }
  if (found[0]) out.tangent |= (bits_of(roots.tangent) & found[0]) << first;
}

void roots_of_face(const AnalyticFace& face, const Packet& packet, LaneMask lanes, AnalyticRoots& roots) {
  const std::size_t step = hn::Lanes(D());
  for (std::size_t first = 0; first < kWidth; first += step)
    if (lanes >> first & ((1u << step) - 1)) meet_some(face, packet, lanes, first, roots);
}

}  // namespace iso::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace iso {

HWY_EXPORT(roots_of_face);
void roots_of_packet(const AnalyticFace& face, const Packet& packet, LaneMask lanes, AnalyticRoots& roots) {
  HWY_DYNAMIC_DISPATCH(roots_of_face)(face, packet, lanes, roots);
}

}  // namespace iso
#endif
