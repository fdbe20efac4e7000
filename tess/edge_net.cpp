#include "tess/edge_net.h"

#include <tbb/parallel_for.h>

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
template <class Placed>
Offset offset_from_segment(const Placed& p, const Point3& a, const Point3& b) {
  const Vec3 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  const double s = length2 > 0 ? std::clamp(glm::dot(p.S - a, ab) / length2, 0.0, 1.0) : 0.0;
  const Vec3 r = p.S - a - s * ab;
  return {glm::length(r), glm::length(r - glm::dot(r, p.normal) * p.normal)};
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
  for (const EdgeUse& use : boundary.uses) curves_.emplace_back(use.curve.curve);
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

  // Edges know nothing of each other; their points are numbered in their order.
  edges_.resize(boundary.edges.size());
  preferred_.resize(boundary.edges.size());
  std::vector<Sampling> samplings(boundary.edges.size());
  tbb::parallel_for(std::size_t{0}, edges_.size(), [&](std::size_t e) {
    preferred_[e] = preferred_splits(static_cast<int>(e));
    samplings[e] = sampled(static_cast<int>(e));
  });
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    unresolved_ += samplings[e].unresolved;
    put_samples(static_cast<int>(e), samplings[e].samples);
  }
}

Point3 EdgeNet::place(int use, const UV& uv) const {
  return (*shapes_)[static_cast<std::size_t>(boundary_->uses[static_cast<std::size_t>(use)].face)].eval().point(uv);
}

EdgeNet::OnUse EdgeNet::on_use(int use, double own) const {
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
  OnUse on;
  on.own = own;
  const UV uv = on.uv = curves_[static_cast<std::size_t>(use)].at(parameter_at(u, own));
  // What is meant to be on a crease is on it.
  for (int axis = 0; axis < 2; ++axis)
    for (const double crease : shape.creases(axis))
      if (std::abs(uv[axis] - crease) <= kOnCrease * shape.face().domain.size()[axis]) on.uv[axis] = crease;
  on.moved = glm::abs(on.uv - uv);
  const TangentJet at = shape.eval().at(on.uv);
  const FaceShape::Placed placed = shape.place(on.uv, at);
  on.S = placed.S;
  on.normal = placed.normal;
  on.speed = {glm::length(at.Su), glm::length(at.Sv)};
  return on;
}

EdgeNet::Sample EdgeNet::sample_at(int e, double share) const {
  Sample sample;
  sample.share = share;
  for (int use : boundary_->edges[static_cast<std::size_t>(e)].uses) sample.on.push_back(on_use(use, share_on(use, share)));
  return sample;
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
    const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
    constexpr int kScan = 64;
    for (int axis = 0; axis < 2; ++axis)
      for (const double crease : shape.creases(axis))
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

SegmentError EdgeNet::error_of(int use, const OnUse& a, const OnUse& b) const {
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
  SegmentError error;
  if (std::holds_alternative<Plane>(shape.face().surface) && std::holds_alternative<Line<Vec2>>(u.curve.curve)) return error;
  error.surface = shape.segment_bound({a.uv, a.S}, {b.uv, b.S});
  const BendTree::Place around = shape.bend().place_of({glm::min(a.uv, b.uv), glm::max(a.uv, b.uv)});
  // How far the curve strays from its chord over a short piece: in (u, v) from the straight line, and over that line by the second
  // derivatives and the jumps of the first.
  const auto stray = [&](const OnUse& from, const OnUse& to) {
    const BoxBend bend = shape.bend().over({glm::min(from.uv, to.uv), glm::max(from.uv, to.uv)}, around);
    const Vec2 d = glm::abs(to.uv - from.uv);
    const Vec2 speed(from.speed.x + times(bend.Muu, d.x) + times(bend.Muv, d.y) + bend.kink_u,
                     from.speed.y + times(bend.Muv, d.x) + times(bend.Mvv, d.y) + bend.kink_v);
    return curves_[static_cast<std::size_t>(use)].sliver(parameter_at(u, from.own), parameter_at(u, to.own), from.uv, to.uv,
                                                         glm::max(from.moved, to.moved), speed) +
           second_difference(bend, d) / 8 + kink_stray(bend, d);
  };
  // The curve is compared with the chord at some places; between them it strays from its own short chords by little.
  OnUse from = a;
  Offset from_chord;
  for (int i = 1; i <= kPieces; ++i) {
    const OnUse to = i == kPieces ? b : on_use(use, a.own + (b.own - a.own) * i / kPieces);
    const Offset to_chord = i == kPieces ? Offset{} : offset_from_segment(to, a.S, b.S);
    const double between = stray(from, to);
    error.chord = std::max(error.chord, std::max(from_chord.all, to_chord.all) + between);
    error.sliver = std::max(error.sliver, std::max(from_chord.along_surface, to_chord.along_surface) + between);
    from = to;
    from_chord = to_chord;
  }
  return error;
}

bool EdgeNet::turns_too_far(int use, const OnUse& a, const OnUse& b) const {
  if (!(policy_.turn < kPi)) return false;
  const EdgeUse& u = boundary_->uses[static_cast<std::size_t>(use)];
  const FaceShape& shape = (*shapes_)[static_cast<std::size_t>(u.face)];
  const auto tangent = [&](double own) {
    const auto c = jet(u.curve.curve, parameter_at(u, own));
    const TangentJet at = shape.eval().at(c.C);
    return at.Su * c.Ct.x + at.Sv * c.Ct.y;
  };
  const auto angle = [](const Vec3& x, const Vec3& y) { return std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)); };
  if (angle(a.normal, b.normal) > policy_.turn) return true;
  return u.shares_parameter && angle(tangent(a.own), tangent(b.own)) > policy_.turn;
}

// The largest error of a segment as a multiple of what is allowed; notes the slivers in its end.
double EdgeNet::excess(int e, const Sample& a, Sample& b) const {
  double worst = 0;
  const auto& uses = boundary_->edges[static_cast<std::size_t>(e)].uses;
  b.sliver.assign(uses.size(), 0.0f);
  for (std::size_t k = 0; k < uses.size(); ++k) {
    const SegmentError error = error_of(uses[k], a.on[k], b.on[k]);
    b.sliver[k] = static_cast<float>(error.sliver);
    worst = std::max({worst, error.chord / policy_.chord, (error.sliver + error.surface) / policy_.surface});
    if (worst <= 1 && turns_too_far(uses[k], a.on[k], b.on[k])) worst = 2;
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
    const auto see = [&](int k) {
      Sample end = sample_at(e, k + 1 == parts ? b : a + (b - a) * (k + 1) / parts);
      errors.include(excess(e, sample_at(e, a + (b - a) * k / parts), end));
    };
    for (const int k : {0, parts / 2, parts - 1}) see(k);  // these often tell
    for (int k = 1; k + 1 < parts && errors.lo >= kEven * errors.hi; ++k) see(k);
    if (errors.lo < kEven * errors.hi) return 2;
    if (errors.hi <= 1) return parts;
    parts = std::max(parts + 1, static_cast<int>(std::ceil(parts * std::sqrt(errors.hi))));
  }
  return parts;
}

EdgeNet::Sampling EdgeNet::sampled(int e) const {
  const BoundaryEdge& edge = boundary_->edges[static_cast<std::size_t>(e)];
  Sampling result;
  result.samples.push_back(sample_at(e, 0));
  std::vector<Sample> stack{sample_at(e, 1)};  // ends of segments still to do, the nearest on top
  // A closed edge must not collapse to a point or to a segment run through twice.
  if (!edge.degenerate && edge.vertex[0] == edge.vertex[1])
    for (const double share : {2.0 / 3, 1.0 / 3}) stack.push_back(sample_at(e, share));
  // A collapsed edge is nowhere too long, but may go around a corner of the domain.
  const std::vector<double>& preferred = preferred_[static_cast<std::size_t>(e)];
  for (auto share = preferred.rbegin(); edge.degenerate && share != preferred.rend(); ++share) stack.push_back(sample_at(e, *share));
  while (!stack.empty()) {
    const Sample& last = result.samples.back();
    const double a = last.share, b = stack.back().share;
    const double over = edge.degenerate ? 0.0 : excess(e, last, stack.back());
    if (over <= 1 || b - a < kLeastShare) {
      result.unresolved += over > 1;
      result.samples.push_back(std::move(stack.back()));
      stack.pop_back();
      continue;
    }
    const double at = split_at(e, a, b);
    const int parts = at == 0.5 * (a + b) ? even_parts(e, a, b, over) : 2;
    if (parts == 2) {
      stack.push_back(sample_at(e, at));
    } else {
      for (int k = parts - 1; k >= 1; --k) stack.push_back(sample_at(e, a + (b - a) * k / parts));
    }
  }
  return result;
}

// Where its uses place it, in the mean.
Point3 EdgeNet::middle_of(const Sample& sample) const {
  Point3 sum(0.0);
  for (const OnUse& on : sample.on) sum += on.S;
  return sum / static_cast<double>(sample.on.size());
}

void EdgeNet::put_samples(int e, const std::vector<Sample>& samples) {
  const BoundaryEdge& edge = boundary_->edges[static_cast<std::size_t>(e)];
  SampledEdge& put = edges_[static_cast<std::size_t>(e)];
  put.uv.assign(edge.uses.size(), {});
  put.sliver.assign(edge.uses.size(), {});
  for (const Sample& sample : samples) {
    put.share.push_back(sample.share);
    for (std::size_t k = 0; k < edge.uses.size(); ++k) {
      put.uv[k].push_back(sample.on[k].uv);
      if (put.share.size() > 1) put.sliver[k].push_back(edge.degenerate ? 0.0f : sample.sliver[k]);
    }
  }
  put.point.assign(samples.size(), static_cast<std::uint32_t>(edge.vertex[0]));
  put.point.back() = static_cast<std::uint32_t>(edge.vertex[1]);
  if (edge.degenerate) return;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) put.point[i] = point_at(middle_of(samples[i]), put.point[i - 1], put.point.back());
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
  SampledEdge& put = edges_[static_cast<std::size_t>(e)];
  const double a = put.share[segment], b = put.share[segment + 1];
  if (b - a < kLeastShare) return false;
  Sample middle = sample_at(e, split_at(e, a, b)), end = sample_at(e, b);
  middle.sliver.assign(edge.uses.size(), 0.0f);
  end.sliver = middle.sliver;
  if (!edge.degenerate) {
    excess(e, sample_at(e, a), middle);
    excess(e, middle, end);
  }
  const auto where = static_cast<std::ptrdiff_t>(segment) + 1;
  put.share.insert(put.share.begin() + where, middle.share);
  for (std::size_t k = 0; k < edge.uses.size(); ++k) {
    put.uv[k].insert(put.uv[k].begin() + where, middle.on[k].uv);
    put.sliver[k][segment] = middle.sliver[k];
    put.sliver[k].insert(put.sliver[k].begin() + where, end.sliver[k]);
  }
  std::uint32_t point = put.point[segment];
  if (!edge.degenerate) point = point_at(middle_of(middle), put.point[segment], put.point[segment + 1]);
  put.point.insert(put.point.begin() + where, point);
  return true;
}

}  // namespace iso
