#include "tess/edge_net.h"

#include "patches/curve/curve.h"

namespace iso {

namespace {

// A segment is not split below this share of its edge.
constexpr double kLeastShare = 1e-7;

// Nearer than this share of the domain's width to a crease is on it.
constexpr double kOnCrease = 1e-9;

// Nearer to each other than this share of the tolerance are samples that are one point.
constexpr double kOnePoint = 1e-6;

// Pieces into which a segment is cut to bound its distance from the curve.
constexpr int kPieces = 4;

// Errors of more than this many times what is allowed say too little of how many segments are needed.
constexpr double kTrustedRatio = 1e4;

// Segments of equal length are kept if the least error among them is at least this share of the largest.
constexpr double kEven = 0.5;

// How far a point of a curve is from a chord, in all and along the surface that the curve lies on.
struct Offset {
  double all = 0, along_surface = 0;
};
Offset offset_from_segment(const FaceShape::Placed& p, const Point3& a, const Point3& b) {
  const Vec3 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  const double s = length2 > 0 ? std::clamp(glm::dot(p.S - a, ab) / length2, 0.0, 1.0) : 0.0;
  const Vec3 r = p.S - a - s * ab;
  return {glm::length(r), glm::length(r - glm::dot(r, p.normal) * p.normal)};
}

// The largest share that the inner control points of a span have in a point of the curve: 1 - 2^(1 - degree) where all weights are one.
double inner_share(const std::vector<Vec3>& points) {
  double inner = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) inner = std::max(inner, weight(points[i]));
  const double ends = std::min(weight(points.front()), weight(points.back()));
  const double of_ends = std::exp2(2.0 - static_cast<double>(points.size())), of_inner = 1 - of_ends;
  return inner * of_inner / (inner * of_inner + ends * of_ends);
}

// How far, at most, the curve strays from the line between its ends, as a displacement (|du|, |dv|) measured by `speed`: the control points
// of its Bezier spans bound it.
double sliver_of(const Curve2& curve, double t0, double t1, const UV& a, const UV& b, const Vec2& speed) {
  if (std::holds_alternative<Line<Vec2>>(curve) || t0 == t1) return 0;
  const Vec2 line = (b - a) * speed;
  const double length2 = glm::dot(line, line);
  const auto off_line = [&](const Vec3& h) {
    const Vec2 p = (project(h) - a) * speed;
    const double s = length2 > 0 ? std::clamp(glm::dot(p, line) / length2, 0.0, 1.0) : 0.0;
    const Vec2 off = p - s * line;
    return std::abs(off.x) + std::abs(off.y);
  };
  double worst = 0;
  for (const auto& span : bezier_spans(curve, std::min(t0, t1), std::max(t0, t1))) {
    const auto& h = span.points;
    const double ends = std::max(off_line(h.front()), off_line(h.back()));
    double inner = 0;
    for (std::size_t i = 1; i + 1 < h.size(); ++i) inner = std::max(inner, off_line(h[i]));
    worst = std::max(worst, ends + inner_share(h) * std::max(0.0, inner - ends));
  }
  return worst;
}

// How far the curve of a use strays from its chord over a short piece: in (u, v) from the straight line, and over that line by the second
// derivatives and the jumps of the first.
double stray_of(const FaceShape& shape, const Curve2& curve, double t0, double t1, const UV& from, const UV& to) {
  Box2 box;
  box.include(from);
  box.include(to);
  const BoxBend bend = shape.bend().over(box);
  const Vec2 d = glm::abs(to - from);
  const auto times = [](double m, double by) { return by == 0 ? 0.0 : m * by; };
  return sliver_of(curve, t0, t1, from, to, shape.speed(box)) +
         (times(bend.Muu, d.x * d.x) + times(2 * bend.Muv, d.x * d.y) + times(bend.Mvv, d.y * d.y)) / 8 +
         (times(bend.kink_u, d.x) + times(bend.kink_v, d.y)) / 4;
}

// Parameters inside (lo, hi) at which a NURBS has a knot of full multiplicity.
void add_kinks(const NurbsCurve<Vec2>& curve, std::vector<double>& at) {
  const auto& k = curve.knots;
  for (std::size_t i = 0; i + static_cast<std::size_t>(curve.degree) <= k.size();) {
    std::size_t j = i;
    while (j < k.size() && k[j] == k[i]) ++j;
    if (j - i >= static_cast<std::size_t>(curve.degree)) at.push_back(k[i]);
    i = j;
  }
}

}  // namespace

EdgeNet::EdgeNet(const Part& part, const Boundary& boundary, const std::vector<FaceShape>& shapes, const EdgePolicy& policy)
    : part_(&part), boundary_(&boundary), shapes_(&shapes), policy_(policy) {
  place_.resize(boundary.uses.size());
  anchors_.resize(boundary.uses.size());
  for (const BoundaryEdge& edge : boundary.edges)
    for (std::size_t i = 0; i < edge.uses.size(); ++i) place_[static_cast<std::size_t>(edge.uses[i])] = static_cast<int>(i);

  // Vertices come first: the middle of all ends that meet there.
  points_.assign(static_cast<std::size_t>(boundary.vertex_count), Point3(0.0));
  std::vector<int> ends(points_.size(), 0);
  for (std::size_t u = 0; u < boundary.uses.size(); ++u) {
    const EdgeUse& use = boundary.uses[u];
    for (int k = 0; k < 2; ++k) {
      const auto v = static_cast<std::size_t>(boundary.edges[static_cast<std::size_t>(use.edge)].vertex[static_cast<std::size_t>(k)]);
      points_[v] += place(static_cast<int>(u), uv_at(use, k));
      ++ends[v];
    }
  }
  for (std::size_t v = 0; v < points_.size(); ++v) points_[v] /= std::max(1, ends[v]);

  edges_.resize(boundary.edges.size());
  for (std::size_t e = 0; e < boundary.edges.size(); ++e) preferred_.push_back(preferred_splits(static_cast<int>(e)));
  for (std::size_t e = 0; e < boundary.edges.size(); ++e) sample(static_cast<int>(e));
}

Point3 EdgeNet::place(int use, const UV& uv) const {
  return point(part_->faces[static_cast<std::size_t>(boundary_->uses[static_cast<std::size_t>(use)].face)].surface, uv);
}

UV EdgeNet::uv_on(int use, double share) const {
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  UV uv = uv_at(u, share_on(use, share));
  // What is meant to be on a crease is on it.
  const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
  for (int axis = 0; axis < 2; ++axis)
    for (const double crease : axis == 0 ? shape.bend().creases_u() : shape.bend().creases_v())
      if (std::abs(uv[axis] - crease) <= kOnCrease * shape.face().domain.size()[axis]) uv[axis] = crease;
  return uv;
}

// The use's own share at a share of the edge.
double EdgeNet::share_on(int use, double share) const {
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  if (u.shares_parameter || share == 0 || share == 1) return share;
  for (const auto& [of_edge, own] : anchors_[static_cast<std::size_t>(use)])
    if (share == of_edge) return own;
  // Matched to the edge's first use by distance.
  const int first = boundary_->edges[static_cast<std::size_t>(u.edge)].uses[0];
  const Point3 p = place(first, uv_at(boundary_->uses[static_cast<std::size_t>(first)], share));
  return own_share(part_->faces[static_cast<std::size_t>(u.face)], u, p, share);
}

std::vector<double> EdgeNet::preferred_splits(int e) {
  std::vector<double> shares;
  for (int use : boundary_->edges[static_cast<std::size_t>(e)].uses) {
    const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
    const double a = parameter_at(u, 0), b = parameter_at(u, 1);
    if (a == b) continue;
    // Shares of this use as shares of the edge; the way back is remembered, for it would not lead to the same place.
    const auto shared = [&](double s) {
      if (u.shares_parameter) return s;
      const EdgeUse& first = boundary_->uses[static_cast<std::size_t>(boundary_->edges[static_cast<std::size_t>(e)].uses[0])];
      const double of_edge = first_share(part_->faces[static_cast<std::size_t>(first.face)], first, u, place(use, uv_at(u, s)), s);
      anchors_[static_cast<std::size_t>(use)].push_back({of_edge, s});
      return of_edge;
    };
    if (const auto* nurbs = std::get_if<NurbsCurve<Vec2>>(&u.curve.curve)) {
      std::vector<double> kinks;
      add_kinks(*nurbs, kinks);
      for (double t : kinks)
        if (const double s = (t - a) / (b - a); s > kLeastShare && s < 1 - kLeastShare) shares.push_back(shared(s));
    }
    // Crossings of the surface's creases.
    const BendTree& bend = (*shapes_)[static_cast<std::size_t>(u.face)].bend();
    constexpr int kScan = 64;
    for (int axis = 0; axis < 2; ++axis)
      for (double crease : axis == 0 ? bend.creases_u() : bend.creases_v())
        for (int i = 0; i < kScan; ++i) {
          double lo = static_cast<double>(i) / kScan, hi = static_cast<double>(i + 1) / kScan;
          const double at_lo = uv_at(u, lo)[axis] - crease, at_hi = uv_at(u, hi)[axis] - crease;
          if (!(at_lo * at_hi < 0)) continue;
          for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (lo + hi);
            (((uv_at(u, middle)[axis] - crease) * at_lo > 0) ? lo : hi) = middle;
          }
          shares.push_back(shared(0.5 * (lo + hi)));
        }
  }
  std::sort(shares.begin(), shares.end());
  std::vector<double> kept;
  for (double s : shares)
    if (kept.empty() || s - kept.back() > kLeastShare) kept.push_back(s);
  return kept;
}

SegmentError EdgeNet::error_of(int use, double a, double b) const {
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
  const UV uva = uv_on(use, a), uvb = uv_on(use, b);
  const FaceShape::Placed A = shape.place(uva), B = shape.place(uvb);
  SegmentError error;
  error.surface = shape.segment_bound({uva, A.S}, {uvb, B.S});
  // The curve is compared with the chord at some places; between them it strays from its own short chords by little.
  UV from_uv = uva;
  Offset from;
  for (int i = 1; i <= kPieces; ++i) {
    const double s0 = a + (b - a) * (i - 1) / kPieces, s1 = i == kPieces ? b : a + (b - a) * i / kPieces;
    const UV to_uv = i == kPieces ? uvb : uv_on(use, s1);
    const Offset to = i == kPieces ? Offset{} : offset_from_segment(shape.place(to_uv), A.S, B.S);
    const double between =
        stray_of(shape, u.curve.curve, parameter_at(u, share_on(use, s0)), parameter_at(u, share_on(use, s1)), from_uv, to_uv);
    error.chord = std::max(error.chord, std::max(from.all, to.all) + between);
    error.sliver = std::max(error.sliver, std::max(from.along_surface, to.along_surface) + between);
    from_uv = to_uv;
    from = to;
  }
  return error;
}

bool EdgeNet::turns_too_far(int use, double a, double b) const {
  if (!(policy_.turn < kPi)) return false;
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
  const auto tangent = [&](double s) {
    const auto c = jet(u.curve.curve, parameter_at(u, s));
    const Jet2 at = jet2(shape.face().surface, c.C);
    return at.Su * c.Ct.x + at.Sv * c.Ct.y;
  };
  const auto angle = [](const Vec3& x, const Vec3& y) { return std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)); };
  if (angle(shape.place(uv_on(use, a)).normal, shape.place(uv_on(use, b)).normal) > policy_.turn) return true;
  return u.shares_parameter && angle(tangent(a), tangent(b)) > policy_.turn;
}

// The largest error of a segment as a multiple of what is allowed.
double EdgeNet::excess(int e, double a, double b) const {
  double worst = 0;
  for (int use : boundary_->edges[static_cast<std::size_t>(e)].uses) {
    const SegmentError error = error_of(use, a, b);
    worst = std::max({worst, error.chord / policy_.chord, (error.sliver + error.surface) / policy_.surface});
    if (worst <= 1 && turns_too_far(use, a, b)) worst = 2;
  }
  return worst;
}

double EdgeNet::split_at(int e, double a, double b) const {
  const double middle = 0.5 * (a + b);
  double best = middle, least = kInf;
  for (double s : preferred_[static_cast<std::size_t>(e)])
    if (s > a + kLeastShare && s < b - kLeastShare && std::abs(s - middle) < least) least = std::abs(s - middle), best = s;
  return best;
}

// Into how many equal parts a segment is cut: the fewest that are short enough where the edge bends evenly, so that a circle takes no
// power of two; else 2.
int EdgeNet::even_parts(int e, double a, double b, double over) const {
  if (!(over < kTrustedRatio)) return 2;
  constexpr int kTries = 4;
  int parts = static_cast<int>(std::ceil(std::sqrt(over)));
  for (int i = 0; i < kTries && parts > 2; ++i) {
    Range errors;
    const auto see = [&](int k) { errors.include(excess(e, a + (b - a) * k / parts, k + 1 == parts ? b : a + (b - a) * (k + 1) / parts)); };
    for (const int k : {0, parts / 2, parts - 1}) see(k);  // these often tell
    for (int k = 1; k + 1 < parts && errors.lo >= kEven * errors.hi; ++k) see(k);
    if (errors.lo < kEven * errors.hi) return 2;
    if (errors.hi <= 1) return parts;
    parts = std::max(parts + 1, static_cast<int>(std::ceil(parts * std::sqrt(errors.hi))));
  }
  return parts;
}

void EdgeNet::sample(int e) {
  const BoundaryEdge& edge = boundary_->edges[static_cast<std::size_t>(e)];
  std::vector<double> shares{0.0};
  std::vector<double> stack{1.0};  // ends of segments still to do, the nearest on top
  // A closed edge must not collapse to a point or to a segment run through twice.
  if (!edge.degenerate && edge.vertex[0] == edge.vertex[1]) stack = {1.0, 2.0 / 3, 1.0 / 3};
  while (!stack.empty()) {
    const double a = shares.back(), b = stack.back();
    const double over = edge.degenerate ? 0.0 : excess(e, a, b);
    if (over <= 1 || b - a < kLeastShare) {
      unresolved_ += over > 1;
      shares.push_back(b);
      stack.pop_back();
      continue;
    }
    const double at = split_at(e, a, b);
    const int parts = at == 0.5 * (a + b) ? even_parts(e, a, b, over) : 2;
    if (parts == 2) {
      stack.push_back(at);
    } else {
      for (int k = parts - 1; k >= 1; --k) stack.push_back(a + (b - a) * k / parts);
    }
  }
  put_samples(e, std::move(shares));
}

void EdgeNet::put_samples(int e, std::vector<double> shares) {
  const BoundaryEdge& edge = boundary_->edges[static_cast<std::size_t>(e)];
  SampledEdge& sampled = edges_[static_cast<std::size_t>(e)];
  sampled.share = std::move(shares);
  sampled.uv.assign(edge.uses.size(), {});
  sampled.sliver.assign(edge.uses.size(), {});
  for (std::size_t k = 0; k < edge.uses.size(); ++k) {
    for (double s : sampled.share) sampled.uv[k].push_back(uv_on(edge.uses[k], s));
    for (std::size_t i = 0; i + 1 < sampled.share.size(); ++i)
      sampled.sliver[k].push_back(
          static_cast<float>(edge.degenerate ? 0 : error_of(edge.uses[k], sampled.share[i], sampled.share[i + 1]).sliver));
  }
  sampled.point.assign(sampled.share.size(), 0);
  sampled.point.front() = static_cast<std::uint32_t>(edge.vertex[0]);
  sampled.point.back() = static_cast<std::uint32_t>(edge.vertex[1]);
  for (std::size_t i = 1; i + 1 < sampled.share.size(); ++i) {
    if (edge.degenerate) {
      sampled.point[i] = sampled.point.front();
      continue;
    }
    Point3 middle(0.0);
    for (std::size_t k = 0; k < edge.uses.size(); ++k) middle += place(edge.uses[k], sampled.uv[k][i]);
    sampled.point[i] = point_at(middle / static_cast<double>(edge.uses.size()), sampled.point[i - 1], sampled.point.back());
  }
}

// A new point, unless one of its neighbours is there already: an edge may be a point in space along a part of its length.
std::uint32_t EdgeNet::point_at(const Point3& p, std::uint32_t before, std::uint32_t after) {
  for (const std::uint32_t old : {before, after})
    if (glm::length(points_[old] - p) <= kOnePoint * policy_.chord) return old;
  points_.push_back(p);
  return static_cast<std::uint32_t>(points_.size() - 1);
}

bool EdgeNet::split(int e, std::size_t segment) {
  const BoundaryEdge& edge = boundary_->edges[static_cast<std::size_t>(e)];
  SampledEdge& sampled = edges_[static_cast<std::size_t>(e)];
  const double a = sampled.share[segment], b = sampled.share[segment + 1];
  if (b - a < kLeastShare) return false;
  const double at = split_at(e, a, b);
  Point3 middle(0.0);
  const auto where = static_cast<std::ptrdiff_t>(segment) + 1;
  sampled.share.insert(sampled.share.begin() + where, at);
  for (std::size_t k = 0; k < edge.uses.size(); ++k) {
    const UV uv = uv_on(edge.uses[k], at);
    middle += place(edge.uses[k], uv);
    sampled.uv[k].insert(sampled.uv[k].begin() + where, uv);
    const auto sliver = [&](double from, double to) {
      return static_cast<float>(edge.degenerate ? 0 : error_of(edge.uses[k], from, to).sliver);
    };
    sampled.sliver[k][segment] = sliver(a, at);
    sampled.sliver[k].insert(sampled.sliver[k].begin() + where, sliver(at, b));
  }
  std::uint32_t point = sampled.point[segment];
  if (!edge.degenerate)
    point = point_at(middle / static_cast<double>(edge.uses.size()), sampled.point[segment], sampled.point[segment + 1]);
  sampled.point.insert(sampled.point.begin() + where, point);
  return true;
}

}  // namespace iso
