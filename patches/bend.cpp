#include "patches/bend.h"

#include <array>
#include <bit>

#include "patches/base/bernstein.h"
#include "patches/bend_cell.h"

namespace iso {

namespace {

// A cell is done when the spread of an entry is this share of its largest magnitude (0.3, with half of kFlat, makes 1.5 to 2.3 times the
// cells and no fewer triangles: dividing a triangle is cheaper than dividing a cell), ...
constexpr double kSpread = 0.5;
// ... or when it moves a point by less than this share of what the largest entry does over the cell; ...
constexpr double kNegligible = 0.1;
// ... or when all that the cell bends is this share of the tolerance: triangles are larger.
constexpr double kFlat = 0.5;
// Tangents turn by no more than an angle of this tangent about their middle: bounds of curvatures would be loose.
constexpr double kMostTurn = 0.3;
// The tolerance if none is given, as a share of the surface's size.
constexpr double kUsualTolerance = 1e-4;
// Divisions below a span; fewer where there are many spans, so that the tree stays below 2^kMostCells cells.
constexpr int kMostLevels = 12, kFewestLevels = 4, kMostCells = 18;
// On the way to a singular point, where the normal stays without bound.
constexpr int kSingularLevels = 8;
// Whether the bounds over a cell of this width are as tight as wanted.
bool settled(const Bend& b, const Vec2& width, double flat, double turn = 0) {
  const std::array<const Range*, 3> ranges{&b.uu, &b.uv, &b.vv};
  const std::array<double, 3> weight{width.x * width.x, 2 * width.x * width.y, width.y * width.y};
  std::array<double, 3> most{};
  double largest = 0, sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    most[k] = weight[k] * std::max(std::abs(ranges[k]->lo), std::abs(ranges[k]->hi));
    largest = std::max(largest, most[k]);
    sum += most[k];
  }
  if (!finite(largest)) sum = b.Muu * weight[0] + b.Muv * weight[1] + b.Mvv * weight[2];
  if (sum <= 8 * flat || !finite(largest)) return sum <= 8 * flat;
  if (turn > kMostTurn) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (weight[k] * ranges[k]->width() > std::max(kSpread * most[k], kNegligible * largest)) return false;
  return true;
}

Bend scaled(Bend b, const Vec2& width) {
  const double uu = 1 / (width.x * width.x), uv = 1 / (width.x * width.y), vv = 1 / (width.y * width.y);
  b.uu = {b.uu.lo * uu, b.uu.hi * uu};
  b.uv = {b.uv.lo * uv, b.uv.hi * uv};
  b.vv = {b.vv.lo * vv, b.vv.hi * vv};
  b.Muu *= uu;
  b.Muv *= uv;
  b.Mvv *= vv;
  return b;
}

double length_of_coordinates(const Box3& box) { return glm::length(glm::max(glm::abs(box.lo), glm::abs(box.hi))); }

}  // namespace

class BendTreeBuilder {
 public:
  BendTreeBuilder(BendTree& tree, double tolerance) : tree_(tree), tolerance_(tolerance) {}

  void build(const NurbsSurface& surface, const Box2& domain);
  void build(const Revolution& surface, const Box2& domain);
  double build(const PatchChart& chart, const Box2& domain);

 private:
  struct Spans {
    int u0, u1, v0, v1;
  };

  std::int32_t add(const Bend& bend) {
    tree_.nodes_.push_back({});
    tree_.nodes_.back().bend = bend;
    return static_cast<std::int32_t>(tree_.nodes_.size()) - 1;
  }
  // Turns `node` into an inner one whose low child is the next node to be made.
  void cut(std::int32_t node, int direction, double at, BendTree::Cut kind) {
    tree_.nodes_[node].at = at;
    tree_.nodes_[node].cut = kind;
    tree_.nodes_[node].direction = static_cast<std::uint8_t>(direction);
  }
  void join(std::int32_t node, std::int32_t high) {
    BendTree::Node& n = tree_.nodes_[node];
    n.high = high;
    n.bend = tree_.nodes_[node + 1].bend;
    n.bend.include(tree_.nodes_[high].bend);
    if (n.cut == BendTree::Cut::crease) n.bend = unbounded_bend();
  }

  void set_jumps(int direction, std::vector<KnotJump> jumps) {
    for (const KnotJump& j : jumps)
      if (j.crease) (direction == 0 ? tree_.creases_u_ : tree_.creases_v_).push_back(j.at);
    tree_.jumps_[direction] = std::move(jumps);
  }
  BendTree::Cut kind_of_knot(int direction, double at) const {
    const std::vector<double>& creases = direction == 0 ? tree_.creases_u_ : tree_.creases_v_;
    return std::binary_search(creases.begin(), creases.end(), at) ? BendTree::Cut::crease : BendTree::Cut::knot;
  }
  std::int32_t over_spans(const Spans& spans);
  std::int32_t over_patch(const BezierPatch& patch, const Box2& box, int levels);
  const BezierPiece& piece(int u, int v) const { return pieces_[static_cast<std::size_t>(u) * count_v_ + v]; }

  std::int32_t over_profiles(std::size_t begin, std::size_t end);
  std::int32_t over_profile(const std::vector<Vec4>& points, const Range& v, int levels);

  BendTree& tree_;
  double tolerance_ = 0;
  PatchBend cell_;
  std::vector<BezierPiece> pieces_;
  int count_u_ = 0, count_v_ = 0;
  int most_levels_ = kMostLevels;
  bool rational_ = false;
  double size_ = 0, rounding_ = 0, flat_ = 0;
  const Revolution* turned_ = nullptr;
  std::vector<BezierSpan<Vec3>> profile_;
};

// ---- NURBS -------------------------------------------------------------------------------------------------------------

std::int32_t BendTreeBuilder::over_patch(const BezierPatch& patch, const Box2& box, int levels) {
  const PatchBend::Result r = cell_.bound(patch, rational_, rounding_);
  const std::int32_t node = add(scaled(r.bend, box.size()));
  if (levels >= (r.bounded ? most_levels_ : std::min(most_levels_, kSingularLevels)) || settled(r.bend, Vec2(1.0), flat_, r.turn))
    return node;
  const int direction = r.along_s >= r.along_t ? 0 : 1;
  const double at = box.middle()[direction];
  if (!(box.lo[direction] < at && at < box.hi[direction])) return node;
  BezierPatch low, high;
  split_in_half(patch, direction, low, high);
  cut(node, direction, at, BendTree::Cut::smooth);
  Box2 low_box = box, high_box = box;
  low_box.hi[direction] = high_box.lo[direction] = at;
  over_patch(low, low_box, levels + 1);
  join(node, over_patch(high, high_box, levels + 1));
  return node;
}

std::int32_t BendTreeBuilder::over_spans(const Spans& s) {
  const int nu = s.u1 - s.u0, nv = s.v1 - s.v0;
  if (nu == 1 && nv == 1) return over_patch(piece(s.u0, s.v0).patch, piece(s.u0, s.v0).native_box(), 0);
  const std::int32_t node = add({});
  Spans low = s, high = s;
  if (nu >= nv) {
    low.u1 = high.u0 = s.u0 + nu / 2;
    const double at = piece(high.u0, 0).u.a;
    cut(node, 0, at, kind_of_knot(0, at));
  } else {
    low.v1 = high.v0 = s.v0 + nv / 2;
    const double at = piece(0, high.v0).v.a;
    cut(node, 1, at, kind_of_knot(1, at));
  }
  over_spans(low);
  join(node, over_spans(high));
  return node;
}

void BendTreeBuilder::build(const NurbsSurface& surface, const Box2& domain) {
  pieces_ = bezier_pieces(surface, domain);
  rational_ = surface.rational();
  if (pieces_.empty()) return;
  while (count_v_ < static_cast<int>(pieces_.size()) && pieces_[count_v_].u.a == pieces_.front().u.a) ++count_v_;
  count_u_ = static_cast<int>(pieces_.size()) / count_v_;
  Box3 box;
  for (const BezierPiece& p : pieces_) box.include(hull_box(p.patch));
  const double coordinates = length_of_coordinates(box);
  // About the middle of all: what is left of the coordinates is no larger than the surface.
  for (BezierPiece& p : pieces_)
    for (Vec4& h : p.patch.net) {
      h -= Vec4(h.w * box.middle(), 0.0);
      if (!rational_) h /= h.w;
    }
  size_ = box.diagonal();
  flat_ = kFlat * (tolerance_ > 0 ? tolerance_ : kUsualTolerance * size_);
  rounding_ = kEps * coordinates + 16 * kEps * size_;
  most_levels_ = std::clamp(kMostCells - static_cast<int>(std::bit_width(pieces_.size())), kFewestLevels, kMostLevels);
  for (const int direction : {0, 1}) set_jumps(direction, knot_jumps(pieces_, count_u_, count_v_, direction, size_));
  over_spans({0, count_u_, 0, count_v_});
}

// Of a spline beside the chart that leaves most of the tolerance. Returns what the two are apart, twice.
double BendTreeBuilder::build(const PatchChart& chart, const Box2& domain) {
  constexpr double kShareOfTolerance = 0.05;
  const ChartSpline spline = spline_beside(chart, tolerance_ > 0 ? kShareOfTolerance * tolerance_ : chart.error);
  build(*spline.near, domain);
  return 2 * spline.error;
}

// ---- revolutions -------------------------------------------------------------------------------------------------------

// Triangles are about as wide as they are high: that is the width in u to weigh the entries by.
std::int32_t BendTreeBuilder::over_profile(const std::vector<Vec4>& points, const Range& v, int levels) {
  CurveBalls balls = points.empty() ? curve_balls(turned_->profile, v) : curve_balls(points, v.width());
  balls.C -= turned_->O;
  balls.stray += rounding_;
  const Bend bend = turned_bend(balls, turned_->Z);
  const std::int32_t node = add(bend);
  const double around = (glm::length(balls.Ct) + balls.stray_t) * v.width() / bend.Muu;
  const bool bounded = finite(bend.uu.lo);
  if (levels >= (bounded ? most_levels_ : std::min(most_levels_, kSingularLevels)) || !(bend.Muu > 0) ||
      settled(bend, {std::min(around, 1.0), v.width()}, flat_))
    return node;
  const double at = v.middle();
  if (!(v.lo < at && at < v.hi)) return node;
  cut(node, 1, at, BendTree::Cut::smooth);
  std::vector<Vec4> low, high;
  if (!points.empty()) bernstein_split(points, 0.5, low, high);
  over_profile(low, {v.lo, at}, levels + 1);
  join(node, over_profile(high, {at, v.hi}, levels + 1));
  return node;
}

std::int32_t BendTreeBuilder::over_profiles(std::size_t begin, std::size_t end) {
  if (end - begin == 1) return over_profile(profile_[begin].points, {profile_[begin].map.a, profile_[begin].map.b}, 0);
  const std::int32_t node = add({});
  const std::size_t middle = begin + (end - begin) / 2;
  const double at = profile_[middle].map.a;
  cut(node, 1, at, kind_of_knot(1, at));
  over_profiles(begin, middle);
  join(node, over_profiles(middle, end));
  return node;
}

void BendTreeBuilder::build(const Revolution& surface, const Box2& domain) {
  turned_ = &surface;
  const Box3 box = bounds(surface, domain);
  size_ = box.diagonal();
  flat_ = kFlat * (tolerance_ > 0 ? tolerance_ : kUsualTolerance * size_);
  rounding_ = 16 * kEps * (length_of_coordinates(box) + glm::length(surface.O));
  if (const auto* n = std::get_if<NurbsCurve<Vec3>>(&surface.profile)) {
    profile_ = bezier_spans(surface.profile, domain.lo.y, domain.hi.y);
    set_jumps(1, knot_jumps(profile_, size_));
    most_levels_ = std::clamp(kMostCells - static_cast<int>(std::bit_width(n->poles.size())), kFewestLevels, kMostLevels);
  } else {
    profile_.push_back({{}, {ParamMap::Kind::affine, domain.lo.y, domain.hi.y}});
  }
  if (!profile_.empty()) over_profiles(0, profile_.size());
}

// ---- the tree ----------------------------------------------------------------------------------------------------------

namespace {

// The same surface, point by point.
NurbsSurface as_nurbs(const Extrusion& s, const Range& v) {
  const auto& c = std::get<NurbsCurve<Vec3>>(s.profile);
  NurbsSurface out;
  out.degree_u = c.degree;
  out.degree_v = 1;
  out.count_u = static_cast<int>(c.poles.size());
  out.count_v = 2;
  out.knots_u = c.knots;
  out.knots_v = {v.lo, v.lo, v.hi, v.hi};
  for (const Vec4& h : c.poles)
    for (const double at : {v.lo, v.hi}) out.poles.push_back(h + Vec4(h.w * at * s.direction, 0.0));
  return out;
}

}  // namespace

namespace {

// A domain that reaches beyond a knot by rounding only ends at that knot: pieces of next to no width have no derivatives to speak of.
Box2 ending_at_knots(const AnySurface& surface, Box2 domain) {
  constexpr double kRounding = 1e-7;
  const auto* nurbs = std::get_if<NurbsSurface>(&surface);
  if (!nurbs) return domain;
  for (int k = 0; k < 2; ++k) {
    const double slack = kRounding * domain.size()[k];
    for (const double knot : k == 0 ? breakpoints(nurbs->knots_u, nurbs->degree_u) : breakpoints(nurbs->knots_v, nurbs->degree_v)) {
      if (std::abs(knot - domain.lo[k]) < slack) domain.lo[k] = knot;
      if (std::abs(knot - domain.hi[k]) < slack) domain.hi[k] = knot;
    }
  }
  return domain;
}

}  // namespace

BendTree::BendTree(const AnySurface& surface, const Box2& whole, double tolerance) : domain_(ending_at_knots(surface, whole)) {
  const Box2& domain = domain_;
  touch_ = 16 * kEps * glm::max(glm::abs(domain.lo), glm::abs(domain.hi));
  BendTreeBuilder builder(*this, tolerance);
  if (has_closed_form_bend(surface))
    closed_form_ = surface;
  else if (const auto* extrusion = std::get_if<Extrusion>(&surface))
    builder.build(as_nurbs(*extrusion, {domain.lo.y, domain.hi.y}), domain);
  else if (const auto* revolution = std::get_if<Revolution>(&surface))
    builder.build(*revolution, domain);
  else if (const auto* chart = std::get_if<PatchChart>(&surface))
    apart_ = builder.build(*chart, domain);
  else
    builder.build(std::get<NurbsSurface>(surface), domain);
  if (!has_closed_form_bend(surface) && nodes_.empty()) nodes_.emplace_back().bend = unbounded_bend();  // a domain without width
}

void BendTree::gather(std::int32_t index, Box2 cell, const Box2& uv, Bend& sum) const {
  for (;;) {
    const Node& node = nodes_[index];
    const bool inside = uv.lo.x <= cell.lo.x && uv.lo.y <= cell.lo.y && uv.hi.x >= cell.hi.x && uv.hi.y >= cell.hi.y;
    if (inside || node.cut == Cut::none) return sum.include(node.bend);
    const int d = node.direction;
    const double slack = node.cut == Cut::smooth ? 0.0 : touch_[d];
    bool low = uv.lo[d]<node.at - slack, high = uv.hi[d]> node.at + slack;
    if (low && high && node.cut == Cut::crease) return sum.include(unbounded_bend());
    if (!low && !high) low = high = true;  // all of it on the cut
    if (low && high) {
      Box2 part = cell;
      part.hi[d] = node.at;
      gather(index + 1, part, uv, sum);
    }
    if (high) {
      cell.lo[d] = node.at;
      index = node.high;
    } else {
      cell.hi[d] = node.at;
      ++index;
    }
  }
}

// The jumps inside a box.
double BendTree::kinks(int direction, const Box2& uv) const {
  const std::vector<KnotJump>& jumps = jumps_[direction];
  const double lo = uv.lo[direction] + touch_[direction], hi = uv.hi[direction] - touch_[direction];
  double sum = 0;
  auto at = std::upper_bound(jumps.begin(), jumps.end(), lo, [](double x, const KnotJump& j) { return x < j.at; });
  for (; at != jumps.end() && at->at < hi; ++at) sum += at->crease ? kInf : at->size;
  return sum;
}

BendTree::Place BendTree::place_of(const Box2& uv) const {
  Place place{0, domain_};
  if (nodes_.empty()) return place;
  for (;;) {
    const Node& node = nodes_[place.node];
    if (node.cut == Cut::none) return place;
    const int d = node.direction;
    const double slack = node.cut == Cut::smooth ? 0.0 : touch_[d];
    const bool low = uv.lo[d]<node.at - slack, high = uv.hi[d]> node.at + slack;
    if (low == high) return place;
    (high ? place.cell.lo : place.cell.hi)[d] = node.at;
    place.node = high ? node.high : place.node + 1;
  }
}

BoxBend BendTree::over(const Box2& uv) const { return over(uv, {0, domain_}); }

BoxBend BendTree::over(const Box2& uv, const Place& place) const {
  const Box2 part{glm::clamp(uv.lo, domain_.lo, domain_.hi), glm::clamp(uv.hi, domain_.lo, domain_.hi)};
  if (nodes_.empty()) return {closed_form_bend(closed_form_, part).value_or(unbounded_bend())};
  const Box2& cell = place.cell;
  const bool inside = part.lo.x >= cell.lo.x && part.lo.y >= cell.lo.y && part.hi.x <= cell.hi.x && part.hi.y <= cell.hi.y;
  BoxBend sum;
  gather(inside ? place.node : 0, inside ? cell : domain_, part, sum);
  sum.kink_u = kinks(0, part);
  sum.kink_v = kinks(1, part);
  sum.apart = apart_;
  return sum;
}

}  // namespace iso
