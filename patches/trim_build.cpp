// The making of a trim region: monotone pieces, and the grid they are clipped to. The queries are in trim.cpp.
#include "patches/trim.h"

#include <array>

#include "patches/base/bernstein.h"
#include "patches/base/bspline_basis.h"

namespace iso {

namespace {

// Numerator of (x / w)' as a Bernstein polynomial: x' w - x w'.
std::vector<double> slope_numerator(const std::vector<Vec3>& points, int coordinate) {
  std::vector<double> x, w;
  bool rational = false;
  for (const Vec3& h : points) {
    x.push_back(h[coordinate]);
    w.push_back(h.z);
    rational = rational || h.z != points.front().z;
  }
  if (!rational) return bernstein_derivative(x);
  std::vector<double> a = bernstein_product(bernstein_derivative(x), w);
  const std::vector<double> b = bernstein_product(x, bernstein_derivative(w));
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

// Whether a coordinate of polynomial points never turns, by their differences. Nothing is known of rational ones.
bool runs_one_way(const std::vector<Vec3>& points, int coordinate) {
  bool rises = true, falls = true;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].z != points[0].z) return false;
    rises = rises && points[i][coordinate] >= points[i - 1][coordinate];
    falls = falls && points[i][coordinate] <= points[i - 1][coordinate];
  }
  return rises || falls;
}

double edge_tolerance(const TrimCurve& curve, const std::vector<Edge>& edges, double least) {
  return curve.edge < 0 ? least : std::max(least, edges[static_cast<std::size_t>(curve.edge)].closing);
}

// Whether the loops are the four sides of a domain that the surface itself ends at, in turn: then they take nothing away.
bool run_along_domain(const Face& face) {
  const Box2 whole = natural_domain(face.surface);
  if (face.loops.size() != 1 || face.loops[0].curves.size() != 4 || face.domain.lo != whole.lo || face.domain.hi != whole.hi) return false;
  const UV corners[] = {whole.lo, {whole.hi.x, whole.lo.y}, whole.hi, {whole.lo.x, whole.hi.y}};
  for (std::size_t k = 0; k < 4; ++k) {
    const TrimCurve& curve = face.loops[0].curves[k];
    if (!std::holds_alternative<Line<Vec2>>(curve.curve)) return false;
    if (jet(curve.curve, curve.t0).C != corners[k] || jet(curve.curve, curve.t1).C != corners[(k + 1) % 4]) return false;
  }
  return true;
}

// Whether an edge lets in more than rounding does.
bool any_loose(const Face& face, const std::vector<Edge>& edges, double least) {
  for (const TrimCurve& curve : face.loops[0].curves)
    if (edge_tolerance(curve, edges, least) > least) return true;
  return false;
}

}  // namespace

TrimRegion::TrimRegion(const Face& face, const std::vector<Edge>& edges, double least_tolerance) {
  period_ = periods(face.surface);
  if (run_along_domain(face) && !any_loose(face, edges, least_tolerance)) return;
  for (const TrimLoop& loop : face.loops) {
    std::vector<UV> ends;          // start and end of every curve in turn
    std::vector<TrimPiece> kinds;  // edge and tolerance of every curve
    for (const TrimCurve& curve : loop.curves) {
      TrimPiece like;
      like.edge = curve.edge;
      like.tolerance = edge_tolerance(curve, edges, least_tolerance);
      const std::size_t before = ends.size();
      add_curve(curve, like, ends);
      if (ends.size() > before) kinds.push_back(like);
    }
    // Joints that do not meet bit for bit are closed by a straight piece, so that the even-odd count is that of closed curves.
    for (std::size_t i = 0; i + 1 < ends.size(); i += 2) add_segment(ends[i + 1], ends[(i + 2) % ends.size()], kinds[i / 2]);
  }
  if (pieces_.empty()) return;
  make_grid(face.surface);
  fill_cells();
}

void TrimRegion::add_curve(const TrimCurve& curve, const TrimPiece& like, std::vector<UV>& ends) {
  const bool backward = curve.t0 > curve.t1;
  const auto spans = bezier_spans(curve.curve, std::min(curve.t0, curve.t1), std::max(curve.t0, curve.t1));
  if (spans.empty()) return;
  UV last = project(spans.front().points.front());
  for (const auto& span : spans) {
    add_segment(last, project(span.points.front()), like);
    add_monotone(span.points, like);
    last = project(span.points.back());
  }
  const UV first = project(spans.front().points.front());
  ends.push_back(backward ? last : first);
  ends.push_back(backward ? first : last);
}

void TrimRegion::add_segment(const UV& from, const UV& to, const TrimPiece& like) {
  if (from == to) return;
  TrimPiece piece = like;
  piece.first = static_cast<std::uint32_t>(points_.size());
  piece.degree = 1;
  piece.box.include(from);
  piece.box.include(to);
  points_.push_back(homogeneous(from, 1.0));
  points_.push_back(homogeneous(to, 1.0));
  pieces_.push_back(piece);
}

void TrimRegion::add_monotone(const std::vector<Vec3>& points, const TrimPiece& like) {
  std::vector<double> cuts{0.0, 1.0};
  for (const int c : {0, 1})
    if (!runs_one_way(points, c))
      for (const double root : bernstein_roots(slope_numerator(points, c))) cuts.push_back(root);
  std::sort(cuts.begin(), cuts.end());
  std::vector<Vec3> rest = points, left, right;
  double done = 0;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    if (cuts[i] - done < 1e-13 && i + 1 < cuts.size()) continue;
    if (i + 1 < cuts.size() && 1 - cuts[i] > 1e-13) {
      bernstein_split(rest, (cuts[i] - done) / (1 - done), left, right);
    } else if (i + 1 < cuts.size()) {
      continue;
    } else {
      left = rest;
    }
    done = cuts[i];
    TrimPiece piece = like;
    piece.first = static_cast<std::uint32_t>(points_.size());
    piece.degree = static_cast<std::int32_t>(left.size()) - 1;
    piece.box.include(project(left.front()));
    piece.box.include(project(left.back()));
    for (const Vec3& h : left) piece.polynomial = piece.polynomial && h.z == 1;
    points_.insert(points_.end(), left.begin(), left.end());
    pieces_.push_back(piece);
    rest = right;
  }
}

namespace {

struct Reach {
  Vec2 along;  // largest step in u alone and in v alone
  Vec2 askew;  // the same in both at once, which is more where Su and Sv are askew
};

// Steps in (u, v) that stay within `tolerance` of the world near a piece; a vanishing derivative, or a vanishing height of the
// parallelogram of both, is held at a share of the other samples' derivatives.
Reach reach_in_parameters(const AnySurface& surface, const Box2& box, double tolerance) {
  Vec2 least{kInf}, most{0.0}, height{kInf};
  for (int i = 0; i <= 2; ++i) {
    const Jet2 j = jet2(surface, box.lo + 0.5 * i * box.size());
    const Vec2 speed{glm::length(j.Su), glm::length(j.Sv)};
    const double area = glm::length(glm::cross(j.Su, j.Sv));
    least = glm::min(least, speed);
    most = glm::max(most, speed);
    height = glm::min(height, Vec2{speed.y > 0 ? area / speed.y : speed.x, speed.x > 0 ? area / speed.x : speed.y});
  }
  const Vec2 floor = glm::max(1e-2 * most, Vec2(1e-300));
  const Vec2 along = 2.0 * tolerance / glm::max(least, floor);
  return {along, glm::max(along, 2.0 * tolerance / glm::max(height, floor))};
}

}  // namespace

void TrimRegion::make_grid(const AnySurface& surface) {
  for (TrimPiece& piece : pieces_) {
    const Reach reach = reach_in_parameters(surface, piece.box, piece.tolerance);
    piece.near_box = {piece.box.lo - kMostStretch * reach.along, piece.box.hi + kMostStretch * reach.along};
    piece.reach = kMostStretch * reach.askew;
    loops_box_.include(piece.box);
    reach_box_.include(piece.near_box);
  }
  Vec2 size = loops_box_.size();
  for (int c = 0; c < 2; ++c)
    if (!(size[c] > 0)) size[c] = 1e-9 + 1e-9 * std::abs(loops_box_.lo[c]);
  // A margin that no round parameter value falls on.
  box_ = {reach_box_.lo - 0.003171 * size, reach_box_.hi + 0.004137 * size};
  const Jet2 j = jet2(surface, loops_box_.middle());
  const double lu = std::max(1e-30, glm::length(j.Su) * size.x), lv = std::max(1e-30, glm::length(j.Sv) * size.y);
  const double cells = std::clamp(12.0 * static_cast<double>(pieces_.size()), 64.0, 65536.0);
  const double aspect = std::clamp(std::sqrt(lu / lv), 0.125, 8.0);
  columns_ = std::clamp(static_cast<int>(std::sqrt(cells) * aspect), 4, 1024);
  rows_ = std::clamp(static_cast<int>(std::sqrt(cells) / aspect), 4, 1024);
  step_ = {(box_.hi.x - box_.lo.x) / columns_, (box_.hi.y - box_.lo.y) / rows_};
  per_step_ = 1.0 / step_;
}

namespace {

// A point where a piece is cut by a grid line; `fixed` coordinates lie on a line (or are an end) and are shared with a neighbour bit for
// bit.
struct Cut {
  double t;
  UV p;
  std::array<bool, 2> fixed;
};

// Rounding may swap two cuts near a grid corner by a bit: brings the chain back in order by moving only coordinates that are not fixed.
void make_monotone(std::vector<Cut>& cuts, const Vec2& direction) {
  for (int pass = 0; pass < 4; ++pass) {
    bool changed = false;
    for (std::size_t i = 1; i < cuts.size(); ++i)
      for (const int c : {0, 1}) {
        double &before = cuts[i - 1].p[c], &here = cuts[i].p[c];
        if (direction[c] >= 0 ? here >= before : here <= before) continue;
        (cuts[i].fixed[c] ? before : here) = cuts[i].fixed[c] ? here : before;
        changed = true;
      }
    if (!changed) return;
  }
}

}  // namespace

namespace {

// A clip in a cell.
struct CellEntry {
  std::uint32_t cell, clip;
};

// Entries sorted by their cells, in each in the order of their making: those of a cell are clips[begin[cell]] up to clips[begin[cell + 1]].
struct EntriesByCell {
  std::vector<std::uint32_t> begin, clips;

  EntriesByCell(const std::vector<CellEntry>& entries, std::size_t cells) : begin(cells + 2), clips(entries.size()) {
    for (const CellEntry& e : entries) ++begin[e.cell + 2];
    for (std::size_t i = 2; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (const CellEntry& e : entries) clips[begin[e.cell + 1]++] = e.clip;
    begin.pop_back();
  }
};

}  // namespace

// The clips of all pieces in the order of their making, and which of them lie in or near which cell.
struct TrimRegion::CellParts {
  std::vector<Clip> clips;
  std::vector<CellEntry> within, near;
};

// Bounds of the curve across the clip's chord: the hull of the Bezier points of this part of it, widened by what rounding may do to the
// points, to the snapped ends and to the product.
void TrimRegion::bound_clip(Clip& clip) const {
  const TrimPiece& piece = pieces_[clip.piece];
  const double du = std::abs(clip.p1.x - clip.p0.x), dv = clip.p1.y - clip.p0.y;
  Range across;
  across.include(0.0);
  Vec2 largest = glm::max(glm::abs(clip.p0), glm::abs(clip.p1));
  if (piece.degree > 1) {
    const Vec3* points = &points_[piece.first];
    std::array<Vec3, kMaxDegree + 1> part;
    std::copy(points, points + piece.degree + 1, part.begin());
    bernstein_restrict(part.data(), 1, piece.degree, std::min(clip.t0, clip.t1), std::max(clip.t0, clip.t1));
    for (int i = 0; i <= piece.degree; ++i) {
      const UV here = project(part[i]);
      across.include(clip.across(here));
      largest = glm::max(largest, glm::max(glm::abs(here), glm::abs(project(points[i]))));
    }
  }
  // De Casteljau errs by a few units in the last place of the largest coordinate per degree; the second term is the product's share.
  const double rounding = 16 * (piece.degree + 2) * kEps * (largest.x * dv + largest.y * du) + 16 * kEps * (step_.x + du) * dv;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  clip.lo = std::nextafter(static_cast<float>(across.lo - rounding), -kFar);
  clip.hi = std::nextafter(static_cast<float>(across.hi + rounding), kFar);
}

// Where the monotone piece from `start` to `end` crosses a line that lies between them in coordinate c. Regula falsi; an end that stays
// counts for half each time [Dowell & Jarratt 1971, the Illinois method], and a bracket that has not halved in four steps is bisected.
double TrimRegion::crossing(const TrimPiece& piece, int c, double line, const UV& start, const UV& end) const {
  constexpr int kMostSteps = 4 * 53;
  const double rounding = kEps * std::max(std::abs(start[c]), std::abs(end[c]));
  double a = 0, b = 1, before = start[c] - line, after = end[c] - line, width = 2;
  if (piece.degree == 1 && piece.polynomial) return before / (before - after);
  for (int step = 0; step < kMostSteps && b - a > 0.5 * kEps; ++step) {
    const bool slow = step % 4 == 0 && b - a > 0.5 * width;
    if (step % 4 == 0) width = b - a;
    double m = slow ? 0.5 * (a + b) : a + (b - a) * (before / (before - after));
    if (!(m > a && m < b)) m = 0.5 * (a + b);
    if (!(m > a && m < b)) break;
    const double here = point_at(piece, m)[c] - line;
    if (std::abs(here) <= rounding) return m;
    if ((here < 0) == (before < 0)) {
      a = m;
      before = here;
      after *= 0.5;
    } else {
      b = m;
      after = here;
      before *= 0.5;
    }
  }
  return 0.5 * (a + b);
}

void TrimRegion::cut_at_grid(std::uint32_t k, CellParts& parts) const {
  const TrimPiece& piece = pieces_[k];
  const UV start = point_at(piece, 0), end = point_at(piece, 1);
  std::vector<Cut> cuts{{0.0, start, {true, true}}, {1.0, end, {true, true}}};
  // Where the piece crosses the grid lines strictly inside its box.
  for (const int c : {0, 1}) {
    const double lo = piece.box.lo[c], hi = piece.box.hi[c];
    const int first = c == 0 ? column(lo) : row(lo), last = c == 0 ? column(hi) : row(hi);
    for (int i = first; i <= last + 1; ++i) {
      const double line = box_.lo[c] + i * step_[c];
      if (!(lo < line && line < hi)) continue;
      const double t = crossing(piece, c, line, start, end);
      UV p = point_at(piece, t);
      p[c] = line;
      p = glm::clamp(p, piece.box.lo, piece.box.hi);
      p[c] = line;
      cuts.push_back({t, p, {c == 0, c == 1}});
    }
  }
  // In order along the piece; its ends stay first and last whatever the others' rounded t, and equal t go by the coordinates.
  std::swap(cuts[1], cuts.back());
  const Vec2 forward{end.x >= start.x ? 1 : -1, end.y >= start.y ? 1 : -1};
  std::sort(cuts.begin() + 1, cuts.end() - 1,
            [&](const Cut& x, const Cut& y) { return x.t != y.t ? x.t < y.t : glm::dot(forward, x.p) < glm::dot(forward, y.p); });
  make_monotone(cuts, end - start);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Cut &from = cuts[i].p.y <= cuts[i + 1].p.y ? cuts[i] : cuts[i + 1], &to = &from == &cuts[i] ? cuts[i + 1] : cuts[i];
    const auto number = static_cast<std::uint32_t>(parts.clips.size());
    Clip& clip = parts.clips.emplace_back();
    clip.piece = k;
    clip.p0 = from.p, clip.p1 = to.p;
    clip.t0 = from.t, clip.t1 = to.t;
    bound_clip(clip);
    if (from.p != to.p) {
      const UV middle = 0.5 * (from.p + to.p);
      const int c = column(middle.x), r = row(middle.y);
      const double left = box_.lo.x + c * step_.x, bottom = box_.lo.y + r * step_.y;
      clip.enters0 = from.p.x == left && from.p.y > bottom;
      clip.enters1 = to.p.x == left && to.p.y > bottom;
      parts.within.push_back({static_cast<std::uint32_t>(r * columns_ + c), number});
    }
    // The cells that its tolerance may let points in: around the box of its ends.
    const Vec2 lo = glm::max(glm::min(from.p, to.p) - piece.reach, piece.near_box.lo);
    const Vec2 hi = glm::min(glm::max(from.p, to.p) + piece.reach, piece.near_box.hi);
    const int c0 = column(lo.x), c1 = column(hi.x), r0 = row(lo.y), r1 = row(hi.y);
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) parts.near.push_back({static_cast<std::uint32_t>(r * columns_ + c), number});
  }
}

void TrimRegion::fill_cells() {
  const std::size_t count = static_cast<std::size_t>(columns_) * rows_;
  CellParts parts;
  for (std::uint32_t k = 0; k < pieces_.size(); ++k) cut_at_grid(k, parts);
  const EntriesByCell within(parts.within, count), near(parts.near, count);
  states_.resize(count);
  lists_.resize(count + 1);
  // The clips in the order of the cells; those without length, which no cell holds, come last.
  constexpr std::uint32_t kNowhere = ~0u;
  std::vector<std::uint32_t> place(parts.clips.size(), kNowhere);
  clips_.reserve(parts.clips.size());
  const auto put = [&](std::uint32_t number) {
    place[number] = static_cast<std::uint32_t>(clips_.size());
    clips_.push_back(parts.clips[number]);
  };
  for (int r = 0; r < rows_; ++r) {
    bool inside = false;
    for (int c = 0; c < columns_; ++c) {
      const std::size_t index = static_cast<std::size_t>(r) * columns_ + c;
      const bool plain = within.begin[index] == within.begin[index + 1] && near.begin[index] == near.begin[index + 1];
      lists_[index].clips_begin = static_cast<std::uint32_t>(clips_.size());
      states_[index] = {plain ? (inside ? Kind::inside : Kind::outside) : Kind::crossing, inside};
      const double bottom = box_.lo.y + r * step_.y;
      for (std::uint32_t k = within.begin[index]; k < within.begin[index + 1]; ++k) {
        put(within.clips[k]);
        if (clips_.back().p0.y <= bottom && clips_.back().p1.y > bottom) inside = !inside;
      }
    }
  }
  lists_[count].clips_begin = static_cast<std::uint32_t>(clips_.size());
  for (std::uint32_t number = 0; number < place.size(); ++number)
    if (place[number] == kNowhere) put(number);
  for (std::size_t index = 0; index <= count; ++index) lists_[index].near_begin = near.begin[index];
  for (const std::uint32_t number : near.clips) near_.push_back(place[number]);
}

}  // namespace iso
