#include "tess/face_shape.h"

#include "tess/triangle_division.h"

namespace iso {

namespace {

// The largest value over barycentric coordinates of 1/2 (l0 l1 x + l1 l2 y + l2 l0 z): with squared lengths of sides this is half the
// squared radius of the smallest circle around the triangle.
double largest_of_form(double x, double y, double z) {
  const double edges = std::max({x, y, z, 0.0}) / 8;
  if (!(x > 0 && y > 0 && z > 0)) return edges;
  // Inside the triangle there is a maximum if it is "acute".
  if (x + y <= z || y + z <= x || z + x <= y) return edges;
  const double area = 2 * (x * y + y * z + z * x) - (x * x + y * y + z * z);
  return area > 0 ? std::max(edges, x * y * z / (2 * area)) : edges;
}

// d^T [uu uv; uv vv] d, from below and from above.
Range form_range(const Bend& bend, const Vec2& d) {
  const double uu = d.x * d.x, uv = 2 * d.x * d.y, vv = d.y * d.y;
  const auto term = [](const Range& r, double by) {
    if (by == 0) return Range{0, 0};
    return by > 0 ? Range{r.lo * by, r.hi * by} : Range{r.hi * by, r.lo * by};
  };
  const Range a = term(bend.uu, uu), b = term(bend.uv, uv), c = term(bend.vv, vv);
  return {a.lo + b.lo + c.lo, a.hi + b.hi + c.hi};
}

// Where the shift along the surface is more than this share of its radius of curvature, the bound does not separate it.
constexpr double kMostShift = 0.25;

// From bounds on e = S - L: its size, and its part along the normal of the surface. A point of the triangle lies over the tangent plane at
// the matching surface point, a shift of at most `size` away from it, where the surface has left that plane by half the curvature times the
// shift squared.
double with_shift(double along_normal, double size, double curvature) {
  if (!(curvature * size <= kMostShift)) return size;
  return std::min(size, along_normal + 0.5 * curvature * size * size * (1 + curvature * size));
}

double cap_of_arc(double width) { return width >= kTwoPi ? 2.0 : 1 - std::cos(0.5 * width); }

double width_of(const std::array<UV, 3>& uv) { return std::max({uv[0].x, uv[1].x, uv[2].x}) - std::min({uv[0].x, uv[1].x, uv[2].x}); }

// The sphere is farthest from a triangle over the foot of its centre, if that lies in the triangle, else over the middle of the longest
// side.
double sphere_bound(const Sphere& sphere, const std::array<Point3, 3>& S) {
  const Vec3 a = S[0] - sphere.frame.O, ab = S[1] - S[0], bc = S[2] - S[1], ca = S[0] - S[2];
  const double x = glm::dot(ab, ab), y = glm::dot(bc, bc), z = glm::dot(ca, ca), longest = std::max({x, y, z});
  const double r = sphere.r;
  if (2 * longest < x + y + z) {
    const Vec3 n = glm::cross(ab, -ca);
    return r - std::abs(glm::dot(n, a)) / glm::length(n);
  }
  return r - std::sqrt(std::max(0.0, r * r - 0.25 * longest));
}

}  // namespace

FaceShape::FaceShape(const Face& face, double tolerance) : face_(&face), eval_(face.surface), bend_(face.surface, face.domain, tolerance) {}

double bound_in(const BoxBend& bend, const std::array<UV, 3>& uv, double longest) {
  const Vec2 extent = glm::max(glm::max(uv[0], uv[1]), uv[2]) - glm::min(glm::min(uv[0], uv[1]), uv[2]);
  const std::array<Vec2, 3> d{uv[1] - uv[0], uv[2] - uv[1], uv[0] - uv[2]};
  // Where the first derivative jumps in size or direction, but not out of the tangent plane, S strays from L along the surface only.
  const double jump = kink_stray(bend, extent);
  const double size = largest_of_form(second_difference(bend, d[0]), second_difference(bend, d[1]), second_difference(bend, d[2])) + jump;
  if (!(bend.curvature * size <= kMostShift)) return size;
  // The normal is taken at another point than the second derivative: it turns by at most the angle `turn` between them.
  const double turn = std::min(1.0, bend.curvature * (longest + 2 * size));
  const auto widened = [&](const Range& h, double M) {
    const double least = h.lo > 0 ? h.lo : (h.hi < 0 ? -h.hi : 0.0);
    const double tangential = std::sqrt(std::max(0.0, M * M - least * least));
    const double by = turn * tangential + 0.5 * turn * turn * h.magnitude();
    return Range{h.lo - by, h.hi + by};
  };
  Bend wide = bend;
  wide.uu = widened(bend.uu, bend.Muu);
  wide.uv = widened(bend.uv, bend.Muv);
  wide.vv = widened(bend.vv, bend.Mvv);
  const Range x = form_range(wide, d[0]), y = form_range(wide, d[1]), z = form_range(wide, d[2]);
  const double along = std::max(largest_of_form(x.hi, y.hi, z.hi), largest_of_form(-x.lo, -y.lo, -z.lo)) + turn * jump + bend.apart;
  return with_shift(along, size, bend.curvature);
}

namespace {

double general_bound(const BendTree& tree, const SurfaceCorner& a, const SurfaceCorner& b, const SurfaceCorner& c) {
  Box2 box;
  for (const UV& p : {a.uv, b.uv, c.uv}) box.include(p);
  return bound_in(tree.over(box), {a.uv, b.uv, c.uv}, longest_side(a, b, c));
}

}  // namespace

double FaceShape::triangle_bound(const SurfaceCorner& a, const SurfaceCorner& b, const SurfaceCorner& c) const {
  const std::array<UV, 3> uv{a.uv, b.uv, c.uv};
  if (std::holds_alternative<Plane>(face_->surface)) return 0;
  if (const auto* s = std::get_if<Cylinder>(&face_->surface)) return s->r * cap_of_arc(width_of(uv));
  if (const auto* s = std::get_if<Sphere>(&face_->surface)) return sphere_bound(*s, {a.S, b.S, c.S});
  if (const auto* s = std::get_if<Cone>(&face_->surface)) {
    const auto radius = [&](const UV& p) { return s->r + p.y * std::sin(s->half_angle); };
    const double r0 = radius(a.uv), r1 = radius(b.uv), r2 = radius(c.uv);
    const double most = std::max({r0, r1, r2}), least = std::min({r0, r1, r2}), slack = 1e-9 * std::max(std::abs(most), std::abs(least));
    if (least >= -slack || most <= slack)  // all on one half of the cone
      return std::max(std::abs(most), std::abs(least)) * cap_of_arc(width_of(uv)) * std::cos(s->half_angle);
  }
  return general_bound(bend_, a, b, c);
}

namespace {

// Whether the bound of a triangle is the distance itself, so that dividing the triangle proves no more.
bool bound_is_exact(const AnySurface& surface) {
  return std::holds_alternative<Plane>(surface) || std::holds_alternative<Cylinder>(surface) || std::holds_alternative<Cone>(surface) ||
         std::holds_alternative<Sphere>(surface);
}

}  // namespace

FaceShape::Verdict FaceShape::keeps(const SurfaceCorner& a, const SurfaceCorner& b, const SurfaceCorner& c, double most) const {
  const double quick = triangle_bound(a, b, c);
  if (quick <= most) return {true, quick};
  if (bound_is_exact(face_->surface)) return {false, quick};
  const Verdict divided = TriangleDivision(*this, {a, b, c}, most).verdict(quick);
  return divided.within ? divided : within_box({a, b, c}, most, divided);
}

// Where derivatives say nothing (spans of next to no width, poles) a small triangle may still lie in one small box with its piece of the
// surface: then the box is the bound.
FaceShape::Verdict FaceShape::within_box(const std::array<SurfaceCorner, 3>& corners, double most, const Verdict& otherwise) const {
  Box3 box;
  Box2 uv;
  for (const SurfaceCorner& c : corners) {
    box.include(c.S);
    uv.include(c.uv);
  }
  if (box.diagonal() > most) return otherwise;
  uv = {glm::max(uv.lo, face_->domain.lo), glm::min(uv.hi, face_->domain.hi)};
  for (int k = 0; k < 2; ++k)
    if (!(uv.hi[k] > uv.lo[k])) return otherwise;
  box.include(bounds(face_->surface, uv));
  return box.diagonal() <= most ? Verdict{true, box.diagonal()} : otherwise;
}

double FaceShape::segment_bound(const SurfaceCorner& a, const SurfaceCorner& b) const {
  if (std::holds_alternative<Sphere>(face_->surface)) {
    // A straight line in (u, v) is no great arc: the general bound.
    return general_bound(bend_, a, b, b);
  }
  return triangle_bound(a, b, b);
}

FaceShape::Placed FaceShape::place(UV uv, const TangentJet& at) const {
  const Vec3 cross = glm::cross(at.Su, at.Sv);
  const double area = glm::length(cross);
  // At a pole the limit from inside decides: there one derivative is nothing but rounding, of any sign.
  constexpr double kLeastSine = 1e-6, kLeastExtent = 1e-9;
  const double su = glm::length(at.Su), sv = glm::length(at.Sv);
  const Vec2 extent = Vec2(su, sv) * face_->domain.size();
  const bool regular = area > kLeastSine * su * sv && std::min(extent.x, extent.y) > kLeastExtent * std::max(extent.x, extent.y);
  const Vec3 n = regular ? cross / area : unit_normal(face_->surface, uv, face_->domain);
  return {at.S, face_->reversed ? -n : n};
}

}  // namespace iso
