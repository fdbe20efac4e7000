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

double edge_tolerance(const TrimCurve& curve, const std::vector<Edge>& edges, double least) {
  return curve.edge < 0 ? least : std::max(least, edges[static_cast<std::size_t>(curve.edge)].closing);
}

}  // namespace

TrimRegion::TrimRegion(const Face& face, const std::vector<Edge>& edges, double least_tolerance) {
  period_ = periods(face.surface);
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
  if (points.size() > 2)
    for (const int c : {0, 1})
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
    points_.insert(points_.end(), left.begin(), left.end());
    pieces_.push_back(piece);
    rest = right;
  }
}

Vec2 TrimRegion::point_at(const TrimPiece& piece, double t) const {
  const Vec3* c = &points_[piece.first];
  if (t == 0) return project(c[0]);
  if (t == 1) return project(c[piece.degree]);
  if (piece.degree == 1) return project((1 - t) * c[0] + t * c[1]);
  std::array<Vec3, kMaxDegree + 1> work;
  std::copy(c, c + piece.degree + 1, work.begin());
  for (int n = piece.degree; n > 0; --n)
    for (int i = 0; i < n; ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
  return project(work[0]);
}

// ---- building the grid -------------------------------------------------------------------------------------------------

namespace {

// Largest step in (u, v) that stays within `tolerance` of the world near a piece; a vanishing derivative is held at a share of the other
// samples'.
Vec2 reach_in_parameters(const AnySurface& surface, const Box2& box, double tolerance) {
  Vec2 least{kInf}, most{0.0};
  for (int i = 0; i <= 2; ++i) {
    const Jet2 j = jet2(surface, box.lo + 0.5 * i * box.size());
    const Vec2 speed{glm::length(j.Su), glm::length(j.Sv)};
    least = glm::min(least, speed);
    most = glm::max(most, speed);
  }
  const Vec2 speed = glm::max(least, glm::max(1e-2 * most, Vec2(1e-300)));
  return 2.0 * tolerance / speed;
}

// How much more than its tolerance an edge lets in for a ray that grazes the surface.
constexpr double kMostStretch = 8;

}  // namespace

void TrimRegion::make_grid(const AnySurface& surface) {
  for (TrimPiece& piece : pieces_) {
    const Vec2 reach = kMostStretch * reach_in_parameters(surface, piece.box, piece.tolerance);
    piece.near_box = {piece.box.lo - reach, piece.box.hi + reach};
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
}

// Exactly the cell with line(i) <= x < line(i + 1), by the same expressions that make the grid lines: the quotient alone may round across
// one.
int TrimRegion::column(double u) const {
  int i = std::clamp(static_cast<int>(std::floor((u - box_.lo.x) / step_.x)), 0, columns_ - 1);
  if (i + 1 < columns_ && u >= box_.lo.x + (i + 1) * step_.x) ++i;
  if (i > 0 && u < box_.lo.x + i * step_.x) --i;
  return i;
}
int TrimRegion::row(double v) const {
  int i = std::clamp(static_cast<int>(std::floor((v - box_.lo.y) / step_.y)), 0, rows_ - 1);
  if (i + 1 < rows_ && v >= box_.lo.y + (i + 1) * step_.y) ++i;
  if (i > 0 && v < box_.lo.y + i * step_.y) --i;
  return i;
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

void TrimRegion::fill_cells() {
  const std::size_t count = static_cast<std::size_t>(columns_) * rows_;
  std::vector<std::vector<Clip>> clips(count);
  std::vector<std::vector<std::uint32_t>> near(count);
  const auto line_u = [&](int i) { return box_.lo.x + i * step_.x; };
  const auto line_v = [&](int j) { return box_.lo.y + j * step_.y; };
  std::vector<Cut> cuts;
  for (std::uint32_t k = 0; k < pieces_.size(); ++k) {
    TrimPiece& piece = pieces_[k];
    const UV start = point_at(piece, 0), end = point_at(piece, 1);
    cuts.assign({{0.0, start, {true, true}}, {1.0, end, {true, true}}});
    // Where the piece crosses the grid lines strictly inside its box.
    for (const int c : {0, 1}) {
      const double lo = piece.box.lo[c], hi = piece.box.hi[c];
      const int first = c == 0 ? column(lo) : row(lo), last = c == 0 ? column(hi) : row(hi);
      for (int i = first; i <= last + 1; ++i) {
        const double line = c == 0 ? line_u(i) : line_v(i);
        if (!(lo < line && line < hi)) continue;
        double a = 0, b = 1;
        const bool rising = end[c] > start[c];
        for (int step = 0; step < 56; ++step) {
          const double m = 0.5 * (a + b);
          ((point_at(piece, m)[c] < line) == rising ? a : b) = m;
        }
        UV p = point_at(piece, 0.5 * (a + b));
        p[c] = line;
        p = glm::clamp(p, piece.box.lo, piece.box.hi);
        p[c] = line;
        cuts.push_back({0.5 * (a + b), p, {c == 0, c == 1}});
      }
    }
    // In order along the piece; its ends stay first and last whatever the others' rounded t, and equal t go by the coordinates.
    std::swap(cuts[1], cuts.back());
    const Vec2 forward{end.x >= start.x ? 1 : -1, end.y >= start.y ? 1 : -1};
    std::sort(cuts.begin() + 1, cuts.end() - 1,
              [&](const Cut& x, const Cut& y) { return x.t != y.t ? x.t < y.t : glm::dot(forward, x.p) < glm::dot(forward, y.p); });
    make_monotone(cuts, end - start);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (cuts[i].p == cuts[i + 1].p) continue;
      const UV middle = 0.5 * (cuts[i].p + cuts[i + 1].p);
      clips[static_cast<std::size_t>(row(middle.y)) * columns_ + column(middle.x)].push_back(
          {k, cuts[i].t, cuts[i + 1].t, cuts[i].p, cuts[i + 1].p});
    }
    // The cells that its tolerance may let points in: around each part between cuts, whose box is that of its ends.
    const Vec2 reach = piece.near_box.hi - piece.box.hi;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      const Vec2 lo = glm::min(cuts[i].p, cuts[i + 1].p) - reach, hi = glm::max(cuts[i].p, cuts[i + 1].p) + reach;
      const int c0 = column(lo.x), c1 = column(hi.x), r0 = row(lo.y), r1 = row(hi.y);
      for (int r = r0; r <= r1; ++r)
        for (int c = c0; c <= c1; ++c)
          if (auto& list = near[static_cast<std::size_t>(r) * columns_ + c]; list.empty() || list.back() != k) list.push_back(k);
    }
  }
  cells_.resize(count + 1);
  for (int r = 0; r < rows_; ++r) {
    bool inside = false;
    for (int c = 0; c < columns_; ++c) {
      const std::size_t index = static_cast<std::size_t>(r) * columns_ + c;
      Cell& cell = cells_[index];
      cell.clips_begin = static_cast<std::uint32_t>(clips_.size());
      cell.near_begin = static_cast<std::uint32_t>(near_.size());
      cell.corner_inside = inside;
      const bool plain = clips[index].empty() && near[index].empty();
      cell.kind = plain ? (inside ? Kind::inside : Kind::outside) : Kind::crossing;
      const double bottom = line_v(r);
      for (const Clip& clip : clips[index])
        if (std::min(clip.p0.y, clip.p1.y) <= bottom && std::max(clip.p0.y, clip.p1.y) > bottom) inside = !inside;
      clips_.insert(clips_.end(), clips[index].begin(), clips[index].end());
      near_.insert(near_.end(), near[index].begin(), near[index].end());
    }
  }
  cells_[count].clips_begin = static_cast<std::uint32_t>(clips_.size());
  cells_[count].near_begin = static_cast<std::uint32_t>(near_.size());
}

// ---- queries -----------------------------------------------------------------------------------------------------------

// Does the clip cross the height v left of u? Bisection on the monotone piece, ended as soon as u leaves the bracket.
bool TrimRegion::crosses_left_of(const Clip& clip, UV uv) const {
  const bool rising = clip.p1.y > clip.p0.y;
  if (uv.y < std::min(clip.p0.y, clip.p1.y) || uv.y >= std::max(clip.p0.y, clip.p1.y)) return false;
  double ulo = std::min(clip.p0.x, clip.p1.x), uhi = std::max(clip.p0.x, clip.p1.x);
  if (uv.x >= uhi) return true;
  if (uv.x < ulo) return false;
  const TrimPiece& piece = pieces_[clip.piece];
  if (piece.degree == 1) {
    const double s = (uv.y - clip.p0.y) / (clip.p1.y - clip.p0.y);
    return clip.p0.x + s * (clip.p1.x - clip.p0.x) <= uv.x;
  }
  double a = clip.t0, b = clip.t1;
  UV pa = clip.p0, pb = clip.p1;
  for (int step = 0; step < 60; ++step) {
    const double m = 0.5 * (a + b);
    const UV p = point_at(piece, m);
    if ((p.y <= uv.y) == rising) {
      a = m;
      pa = p;
    } else {
      b = m;
      pb = p;
    }
    if (uv.x >= std::max(pa.x, pb.x)) return true;
    if (uv.x < std::min(pa.x, pb.x)) return false;
  }
  return 0.5 * (pa.x + pb.x) <= uv.x;
}

double TrimRegion::distance_in_world(UV uv, const TrimPiece& piece, const Jet2& metric) const {
  const auto distance = [&](double t) {
    const UV d = point_at(piece, t) - uv;
    return glm::length(d.x * metric.Su + d.y * metric.Sv);
  };
  double best = 0, least = kInf, width = 0.125;
  for (int i = 0; i <= 8; ++i)
    if (const double at = distance(i * width); at < least) {
      least = at;
      best = i * width;
    }
  for (int step = 0; step < 40; ++step) {
    width *= 0.5;
    for (const double t : {best - width, best + width})
      if (t >= 0 && t <= 1)
        if (const double at = distance(t); at < least) {
          least = at;
          best = t;
        }
  }
  return least;
}

namespace {

// 1 / |cosine| between the ray and the normal, within [1, kMostStretch].
double stretch_for(const Jet2& metric, const Vec3& direction) {
  const Vec3 normal = glm::cross(metric.Su, metric.Sv);
  const double along = std::abs(glm::dot(normal, direction)), most = glm::length(normal) * glm::length(direction);
  return most > kMostStretch * along ? (most > 0 ? kMostStretch : 1.0) : (most > 0 ? most / along : 1.0);
}

}  // namespace

TrimRegion::Answer TrimRegion::contains_here(UV uv, const AnySurface& surface, const Vec3& direction) const {
  if (!box_.contains(uv)) return {false, false};
  const int c = column(uv.x), r = row(uv.y);
  const std::size_t index = static_cast<std::size_t>(r) * columns_ + c;
  const Cell &cell = cells_[index], &next = cells_[index + 1];
  if (cell.kind != Kind::crossing) return {cell.kind == Kind::inside, false};
  const double left = box_.lo.x + c * step_.x, bottom = box_.lo.y + r * step_.y;
  bool inside = cell.corner_inside;
  for (std::uint32_t k = cell.clips_begin; k < next.clips_begin; ++k) {
    const Clip& clip = clips_[k];
    for (const UV& end : {clip.p0, clip.p1})  // what enters through the left edge below the query
      if (end.x == left && end.y > bottom && end.y <= uv.y) inside = !inside;
    if (crosses_left_of(clip, uv)) inside = !inside;
  }
  if (inside) return {true, false};
  for (std::uint32_t k = cell.near_begin; k < next.near_begin; ++k) {
    const TrimPiece& piece = pieces_[near_[k]];
    if (!piece.near_box.contains(uv)) continue;
    const Jet2 metric = jet2(surface, uv);
    if (distance_in_world(uv, piece, metric) <= stretch_for(metric, direction) * piece.tolerance) return {true, true};
  }
  return {false, false};
}

double TrimRegion::distance_to_edge(UV uv, int edge, const AnySurface& surface) const {
  const Jet2 metric = jet2(surface, uv);
  double least = kInf;
  for (const TrimPiece& piece : pieces_)
    if (piece.edge == edge)
      for (const double du : {-period_.x, 0.0, period_.x})
        for (const double dv : {-period_.y, 0.0, period_.y})
          least = std::min(least, distance_in_world({uv.x + du, uv.y + dv}, piece, metric));
  return least;
}

TrimRegion::Answer TrimRegion::contains(UV uv, const AnySurface& surface, const Vec3& direction) const {
  if (untrimmed()) return {};
  // Bring uv into the window of the loops; where they are wider than a period, or at its very edge, the neighbouring copy counts too.
  for (const int c : {0, 1})
    if (period_[c] > 0) uv[c] -= period_[c] * std::floor((uv[c] - loops_box_.lo[c]) / period_[c]);
  Answer best = contains_here(uv, surface, direction);
  const auto try_at = [&](double du, double dv) {
    if (best.inside && !best.by_tolerance) return;
    const Answer answer = contains_here({uv.x + du, uv.y + dv}, surface, direction);
    if (answer.inside && (!best.inside || !answer.by_tolerance)) best = answer;
  };
  const auto shifts = [&](int c, double out[2]) {
    int n = 0;
    if (!(period_[c] > 0)) return n;
    const double rounding = 1e-9 * period_[c];
    if (uv[c] + period_[c] <= reach_box_.hi[c] + rounding) out[n++] = period_[c];
    if (uv[c] - period_[c] >= reach_box_.lo[c] - rounding) out[n++] = -period_[c];
    return n;
  };
  double us[2], vs[2];
  const int nu = shifts(0, us), nv = shifts(1, vs);
  for (int i = 0; i < nu; ++i) try_at(us[i], 0);
  for (int k = 0; k < nv; ++k) try_at(0, vs[k]);
  for (int i = 0; i < nu; ++i)
    for (int k = 0; k < nv; ++k) try_at(us[i], vs[k]);
  return best;
}

TrimRegion::Kind TrimRegion::classify(const Box2& uv) const {
  if (untrimmed()) return Kind::inside;
  // Near the edge of a periodic window both copies matter: leave those to the exact query.
  for (const int c : {0, 1})
    if (period_[c] > 0 && (uv.lo[c] < loops_box_.lo[c] - 1e-9 * period_[c] || uv.hi[c] > loops_box_.lo[c] + period_[c] * (1 + 1e-9) ||
                           loops_box_.size()[c] > period_[c] * (1 + 1e-9)))
      return Kind::crossing;
  if (uv.lo.x > box_.hi.x || uv.hi.x < box_.lo.x || uv.lo.y > box_.hi.y || uv.hi.y < box_.lo.y) return Kind::outside;
  // One cell more on each side against rounding of the division into cells.
  const bool sticks_out = uv.lo.x < box_.lo.x || uv.lo.y < box_.lo.y || uv.hi.x > box_.hi.x || uv.hi.y > box_.hi.y;
  const Vec2 slack = 1e-6 * step_;
  const int c0 = column(uv.lo.x - slack.x), c1 = column(uv.hi.x + slack.x), r0 = row(uv.lo.y - slack.y), r1 = row(uv.hi.y + slack.y);
  const Kind first = sticks_out ? Kind::outside : cells_[static_cast<std::size_t>(r0) * columns_ + c0].kind;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      if (cells_[static_cast<std::size_t>(r) * columns_ + c].kind != first || first == Kind::crossing) return Kind::crossing;
  return first;
}

std::vector<Box2> TrimRegion::cover() const {
  std::vector<Box2> boxes;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      if (cells_[static_cast<std::size_t>(r) * columns_ + c].kind == Kind::outside) continue;
      const Vec2 lo = box_.lo + Vec2(c, r) * step_;
      const Box2 cell{glm::max(lo, loops_box_.lo), glm::min(lo + step_, loops_box_.hi)};
      if (!cell.empty()) boxes.push_back(cell);
    }
  return boxes;
}

std::vector<UV> TrimRegion::hull() const {
  std::vector<UV> out;
  constexpr int kParts = 16;  // the hull of a curve's parts is tighter than its own, by the square
  for (const TrimPiece& piece : pieces_) {
    const std::vector<Vec3> points(points_.begin() + piece.first, points_.begin() + piece.first + piece.degree + 1);
    const int parts = piece.degree == 1 ? 1 : kParts;
    for (int i = 0; i < parts; ++i)
      for (const Vec3& h : bernstein_part(points, static_cast<double>(i) / parts, (i + 1.0) / parts)) out.push_back(project(h));
  }
  return out;
}

double TrimRegion::largest_reach() const {
  double most = 0;
  for (const TrimPiece& piece : pieces_) most = std::max(most, kMostStretch * piece.tolerance);
  return most;
}

std::size_t TrimRegion::bytes() const {
  return pieces_.size() * sizeof(TrimPiece) + points_.size() * sizeof(Vec3) + clips_.size() * sizeof(Clip) +
         near_.size() * sizeof(std::uint32_t) + cells_.size() * sizeof(Cell);
}

}  // namespace iso
