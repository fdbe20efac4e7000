#include "tess/face_shape.h"

#include "patches/base/bspline_basis.h"
#include "patches/surface/bezier_patch.h"
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

FaceShape::FaceShape(const Face& face, double tolerance)
    : face_(&face), eval_(face.surface), bend_(face.surface, face.domain, tolerance), creases_{bend_.creases_u(), bend_.creases_v()} {
  if (const auto* s = std::get_if<NurbsSurface>(&face.surface)) add_ends_of_area(*s);
}

// The knots beside spans without area, all along them.
void FaceShape::add_ends_of_area(const NurbsSurface& s) {
  const std::array<std::vector<double>, 2> breaks{breakpoints(s.knots_u, s.degree_u), breakpoints(s.knots_v, s.degree_v)};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::vector<double>&along = breaks[axis], &across = breaks[1 - axis];
    const auto has_area = [&](std::size_t i) {
      for (std::size_t j = 0; j + 1 < across.size(); ++j) {
        const double at = 0.5 * (along[i] + along[i + 1]), other = 0.5 * (across[j] + across[j + 1]);
        if (is_regular(eval_.at(axis == 0 ? UV(at, other) : UV(other, at)))) return true;
      }
      return false;
    };
    bool before = has_area(0);
    is_line_somewhere_ |= !before;
    for (std::size_t i = 1; i + 1 < along.size(); ++i) {
      const bool here = has_area(i);
      is_line_somewhere_ |= !here;
      if (here != before && along[i] > face_->domain.lo[static_cast<int>(axis)] && along[i] < face_->domain.hi[static_cast<int>(axis)])
        creases_[axis].push_back(along[i]);
      before = here;
    }
    std::sort(creases_[axis].begin(), creases_[axis].end());
    creases_[axis].erase(std::unique(creases_[axis].begin(), creases_[axis].end()), creases_[axis].end());
  }
}

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

double FaceShape::box_bound(const std::array<SurfaceCorner, 3>& corners, double most) const {
  Box3 box;
  Box2 uv;
  for (const SurfaceCorner& c : corners) {
    box.include(c.S);
    uv.include(c.uv);
  }
  if (box.diagonal() > most) return kInf;
  uv = {glm::max(uv.lo, face_->domain.lo), glm::min(uv.hi, face_->domain.hi)};
  for (int k = 0; k < 2; ++k)
    if (!(uv.hi[k] > uv.lo[k])) return kInf;
  box.include(bounds(face_->surface, uv));
  return box.diagonal();
}

// Where derivatives say nothing (spans of next to no width, poles) a small triangle may still lie in one small box with its piece of the
// surface: then the box is the bound.
FaceShape::Verdict FaceShape::within_box(const std::array<SurfaceCorner, 3>& corners, double most, const Verdict& otherwise) const {
  const double bound = box_bound(corners, most);
  return bound <= most ? Verdict{true, bound} : otherwise;
}

namespace {

// Triangles are divided this often, until what their boxes reach beyond the ends of the line is less than the tolerance.
constexpr int kMostDivisions = 10;

// What the making of control points may round, as a share of their size.
constexpr double kPieceRounding = 1e-14;

double distance_to_segment(const Point3& p, const Point3& a, const Point3& b) {
  const Vec3 ab = b - a, ap = p - a;
  const double length2 = glm::dot(ab, ab);
  return glm::length(ap - (length2 > 0 ? std::clamp(glm::dot(ap, ab) / length2, 0.0, 1.0) : 0.0) * ab);
}

// Of the surface over a box from a segment, at most: that of its control points, for no point of their hull is farther from a convex set.
double distance_over(const AnySurface& surface, const Box2& uv, const Point3& a, const Point3& b) {
  double most = 0, size = 0;
  for (const BezierPiece& piece : bezier_pieces(surface, uv))
    for (const Vec4& h : piece.patch.net) {
      const Point3 p = project(h);
      most = std::max(most, distance_to_segment(p, a, b));
      size = std::max(size, glm::length(p));
    }
  return most + distance_of_pieces(surface) + kPieceRounding * size;
}

FaceShape::Verdict near_segment(const Face& face, const Point3& a, const Point3& b, const std::array<UV, 3>& uv, double most,
                                int divisions) {
  const Box2 box{glm::max(glm::min(glm::min(uv[0], uv[1]), uv[2]), face.domain.lo),
                 glm::min(glm::max(glm::max(uv[0], uv[1]), uv[2]), face.domain.hi)};
  const double distance = distance_over(face.surface, box, a, b);
  if (distance <= most || divisions == 0) return {distance <= most, distance};
  const std::array<UV, 3> middle{0.5 * (uv[1] + uv[2]), 0.5 * (uv[2] + uv[0]), 0.5 * (uv[0] + uv[1])};
  FaceShape::Verdict all{true, 0};
  for (const std::array<UV, 3>& part : {std::array{uv[0], middle[2], middle[1]}, std::array{middle[2], uv[1], middle[0]},
                                        std::array{middle[1], middle[0], uv[2]}, middle}) {
    const FaceShape::Verdict verdict = near_segment(face, a, b, part, most, divisions - 1);
    all = {verdict.within, std::max(all.bound, verdict.bound)};
    if (!all.within) break;
  }
  return all;
}

}  // namespace

FaceShape::Verdict FaceShape::stays_near(const Point3& a, const Point3& b, const std::array<UV, 3>& uv, double most) const {
  return near_segment(*face_, a, b, uv, most, kMostDivisions);
}

UV FaceShape::place_between(const SurfaceCorner& a, const SurfaceCorner& b, const Point3& p) const {
  constexpr int kHalvings = 52;
  double lo = 0, hi = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (lo + hi);
    (glm::dot(eval_.point(a.uv + middle * (b.uv - a.uv)) - p, b.S - a.S) < 0 ? lo : hi) = middle;
  }
  return a.uv + lo * (b.uv - a.uv);
}

std::optional<Point3> FaceShape::fold_within(const std::array<UV, 3>& uv) const {
  constexpr int kSteps = 8;
  const UV ab = uv[1] - uv[0], ac = uv[2] - uv[0];
  std::vector<Vec3> normals;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j) {
      const Placed at = place(uv[0] + ab * (double(i) / kSteps) + ac * (double(j) / kSteps));
      for (const Vec3& n : normals)
        if (glm::dot(n, at.normal) < 0) return at.S;
      normals.push_back(at.normal);
    }
  return {};
}

double FaceShape::segment_bound(const SurfaceCorner& a, const SurfaceCorner& b) const {
  if (std::holds_alternative<Sphere>(face_->surface)) {
    // A straight line in (u, v) is no great arc: the general bound.
    return general_bound(bend_, a, b, b);
  }
  return triangle_bound(a, b, b);
}

namespace {

// The box of the domain whose polynomial gives the derivatives at uv: at a knot they are those of the span that follows it.
Box2 span_around(const Face& face, const UV& uv) {
  Box2 span = face.domain;
  const auto narrow = [&](int axis, const std::vector<double>& knots, int degree) {
    const auto i = static_cast<std::size_t>(knot_span(knots, degree, uv[axis]));
    const double lo = std::max(span.lo[axis], knots[i]), hi = std::min(span.hi[axis], knots[i + 1]);
    if (lo < hi) span.lo[axis] = lo, span.hi[axis] = hi;
  };
  const auto narrow_by_profile = [&](int axis, const Curve3& profile) {
    if (const auto* c = std::get_if<NurbsCurve<Vec3>>(&profile)) narrow(axis, c->knots, c->degree);
  };
  if (const auto* s = std::get_if<NurbsSurface>(&face.surface)) {
    narrow(0, s->knots_u, s->degree_u);
    narrow(1, s->knots_v, s->degree_v);
  }
  if (const auto* s = std::get_if<Extrusion>(&face.surface)) narrow_by_profile(0, s->profile);
  if (const auto* s = std::get_if<Revolution>(&face.surface)) narrow_by_profile(1, s->profile);
  return span;
}

}  // namespace

bool FaceShape::is_regular(const TangentJet& at) const {
  constexpr double kLeastSine = 1e-6, kLeastExtent = 1e-9;
  const double su = glm::length(at.Su), sv = glm::length(at.Sv), area = glm::length(glm::cross(at.Su, at.Sv));
  const Vec2 extent = Vec2(su, sv) * face_->domain.size();
  return area > kLeastSine * su * sv && std::min(extent.x, extent.y) > kLeastExtent * std::max(extent.x, extent.y);
}

// Where a span starts with poles that repeat, derivatives say where it goes, and not where the span before came from: at an end of a span
// the limit is looked for inside it. A span without any area has no limit, and takes the normal of the nearest place that has one.
Vec3 FaceShape::limit_normal(const UV& uv) const {
  constexpr double kFirstStep = 1e-6, kLastStep = 0.5;  // of the domain
  constexpr double kAtEnd = 1e-9;                       // of the span
  const Box2 span = span_around(*face_, uv), &domain = face_->domain;
  if (is_regular(eval_.at(span.middle()))) {
    Box2 inside = domain;  // as wide as the domain, and on the side of uv where the span is
    for (int axis = 0; axis < 2; ++axis) {
      const double near = kAtEnd * span.size()[axis], width = domain.size()[axis];
      if (span.lo[axis] > domain.lo[axis] && uv[axis] - span.lo[axis] <= near)
        inside.lo[axis] = uv[axis], inside.hi[axis] = uv[axis] + width;
      else if (span.hi[axis] < domain.hi[axis] && span.hi[axis] - uv[axis] <= near)
        inside.lo[axis] = uv[axis] - width, inside.hi[axis] = uv[axis];
    }
    return unit_normal(face_->surface, uv, inside);
  }
  for (double step = kFirstStep; step <= kLastStep; step *= 2)
    for (const Vec2& way : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)})
      if (const TangentJet at = eval_.at(glm::clamp(uv + step * way * domain.size(), domain.lo, domain.hi)); is_regular(at))
        return glm::normalize(glm::cross(at.Su, at.Sv));
  return unit_normal(face_->surface, uv, domain);
}

FaceShape::Placed FaceShape::place(UV uv, const TangentJet& at) const {
  // At a pole the limit from inside decides: there one derivative is nothing but rounding, of any sign.
  const Vec3 cross = glm::cross(at.Su, at.Sv), n = is_regular(at) ? cross / glm::length(cross) : limit_normal(uv);
  return {at.S, face_->reversed ? -n : n};
}

}  // namespace iso
