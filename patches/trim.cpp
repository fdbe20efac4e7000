// The queries of a trim region. Its making is in trim_build.cpp.
#include "patches/trim.h"

#include <array>
#include <optional>

#include "patches/base/bernstein.h"
#include "patches/base/bspline_basis.h"

namespace iso {

namespace {

// De Casteljau for a degree known beforehand and for any; V without the weight where all weights are one: then it would stay one.
template <class V, int kDegree>
V value_of_degree(const Vec3* c, double t) {
  std::array<V, kDegree + 1> work;
  for (int i = 0; i <= kDegree; ++i) work[i] = V(c[i]);
  for (int n = kDegree; n > 0; --n)
    for (int i = 0; i < n; ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
  return work[0];
}
template <class V>
V value(const Vec3* c, int degree, double t) {
  switch (degree) {
    case 1:
      return value_of_degree<V, 1>(c, t);
    case 2:
      return value_of_degree<V, 2>(c, t);
    case 3:
      return value_of_degree<V, 3>(c, t);
    default:
      break;
  }
  std::array<V, kMaxDegree + 1> work;
  for (int i = 0; i <= degree; ++i) work[i] = V(c[i]);
  for (int n = degree; n > 0; --n)
    for (int i = 0; i < n; ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
  return work[0];
}

// The i with lo + i step <= x < lo + (i + 1) step, within [0, count): exactly, by the same expressions that make the grid lines; the
// product alone may round across one. `per_step`: 1 / step.
int cell_of(double x, double lo, double step, double per_step, int count) {
  int i = static_cast<int>(std::min(std::max(0.0, (x - lo) * per_step), count - 1.0));
  i += i + 1 < count && x >= lo + (i + 1) * step;
  i -= i > 0 && x < lo + i * step;
  return i;
}

}  // namespace

Vec2 TrimRegion::point_at(const TrimPiece& piece, double t) const {
  const Vec3* c = &points_[piece.first];
  if (t == 0) return project(c[0]);
  if (t == 1) return project(c[piece.degree]);
  return piece.polynomial ? value<Vec2>(c, piece.degree, t) : project(value<Vec3>(c, piece.degree, t));
}

int TrimRegion::column(double u) const { return cell_of(u, box_.lo.x, step_.x, per_step_.x, columns_); }
int TrimRegion::row(double v) const { return cell_of(v, box_.lo.y, step_.y, per_step_.y, rows_); }

// Does the clip, whose heights hold v, cross the height v left of u? Regula falsi on the monotone piece, ended as soon as u leaves the
// bracket. An end that stays counts for half each time [Dowell & Jarratt 1971, the Illinois method], and a bracket that has not halved in
// four steps is bisected.
bool TrimRegion::crosses_in_band(const Clip& clip, UV uv) const {
  if (uv.x >= std::max(clip.p0.x, clip.p1.x)) return true;
  if (uv.x < std::min(clip.p0.x, clip.p1.x)) return false;
  const TrimPiece& piece = pieces_[clip.piece];
  if (piece.degree == 1) {
    const double s = (uv.y - clip.p0.y) / (clip.p1.y - clip.p0.y);
    return clip.p0.x + s * (clip.p1.x - clip.p0.x) <= uv.x;
  }
  constexpr int kMostSteps = 256;  // four for each halving of a bracket of 53 bits
  double a = clip.t0, b = clip.t1, width = 2 * std::abs(b - a);
  UV pa = clip.p0, pb = clip.p1;
  double below = uv.y - pa.y, above = pb.y - uv.y;
  for (int step = 0; step < kMostSteps; ++step) {
    double m = a + (b - a) * (below / (below + above));
    if (step % 4 == 3) {
      if (std::abs(b - a) > 0.5 * width) m = 0.5 * (a + b);
      width = std::abs(b - a);
    }
    if (m == a || m == b) m = 0.5 * (a + b);
    if (m == a || m == b) break;
    const UV p = point_at(piece, m);
    if (p.y <= uv.y) {
      a = m;
      pa = p;
      below = uv.y - p.y;
      above *= 0.5;
    } else {
      b = m;
      pb = p;
      above = p.y - uv.y;
      below *= 0.5;
    }
    if (uv.x >= std::max(pa.x, pb.x)) return true;
    if (uv.x < std::min(pa.x, pb.x)) return false;
  }
  return 0.5 * (pa.x + pb.x) <= uv.x;
}

double TrimRegion::distance_in_world(UV uv, const TrimPiece& piece, const Jet2& metric, double t0, double t1) const {
  const auto distance = [&](double t) {
    const UV d = point_at(piece, t) - uv;
    return glm::length(d.x * metric.Su + d.y * metric.Sv);
  };
  double best = t0, least = kInf, width = 0.125 * (t1 - t0);
  for (int i = 0; i <= 8; ++i)
    if (const double t = i < 8 ? t0 + i * width : t1, at = distance(t); at < least) {
      least = at;
      best = t;
    }
  for (int step = 0; step < 40; ++step) {
    width *= 0.5;
    for (const double t : {best - width, best + width})
      if (t >= t0 && t <= t1)
        if (const double at = distance(t); at < least) {
          least = at;
          best = t;
        }
  }
  return least;
}

namespace {

// A part of a monotone piece; it lies in the box of its ends.
struct Stretch {
  double a, b;
  UV pa, pb;
};

}  // namespace

// May a point of the clip be within the piece's reach of uv? First the box and the band of the whole clip, then parts of it, halved.
bool TrimRegion::comes_near(const Clip& clip, const TrimPiece& piece, UV uv) const {
  const auto beside = [&](UV a, UV b) {
    return uv.y < std::min(a.y, b.y) - piece.reach.y || uv.y > std::max(a.y, b.y) + piece.reach.y ||
           uv.x < std::min(a.x, b.x) - piece.reach.x || uv.x > std::max(a.x, b.x) + piece.reach.x;
  };
  if (beside(clip.p0, clip.p1) || !piece.near_box.contains(uv)) return false;
  const double across = clip.across(uv);
  const double slack = piece.reach.x * (clip.p1.y - clip.p0.y) + piece.reach.y * std::abs(clip.p1.x - clip.p0.x);
  if (across < clip.lo - slack || across > clip.hi + slack) return false;
  if (piece.degree == 1) return true;
  constexpr int kMostParts = 24;  // beyond it the precise test decides
  std::array<Stretch, kMostParts + 1> left;
  int count = 0;
  left[count++] = {clip.t0, clip.t1, clip.p0, clip.p1};
  for (int parts = 0; count > 0; ++parts) {
    const Stretch part = left[--count];
    if (beside(part.pa, part.pb)) continue;
    const Vec2 size = glm::abs(part.pb - part.pa);
    if (parts >= kMostParts || (size.x <= piece.reach.x && size.y <= piece.reach.y)) return true;
    const double m = 0.5 * (part.a + part.b);
    const UV p = point_at(piece, m);
    left[count++] = {part.a, m, part.pa, p};
    left[count++] = {m, part.b, p, part.pb};
  }
  return false;
}

// Is a point of the clip at most `most` away from uv in the world? Parts are halved until an end is that near, or none can be: the way from
// one end by a point of the part to the other is at most as long as both sides of their box. What stays open is searched.
bool TrimRegion::within(const Clip& clip, const TrimPiece& piece, UV uv, const Jet2& metric, double most) const {
  const auto in_world = [&](Vec2 d) { return d.x * metric.Su + d.y * metric.Sv; };
  if (piece.degree == 1) {
    const Vec3 from = in_world(clip.p0 - uv), along = in_world(clip.p1 - clip.p0);
    const double square = glm::dot(along, along), s = square > 0 ? std::clamp(-glm::dot(from, along) / square, 0.0, 1.0) : 0.0;
    return glm::length(from + s * along) <= most;
  }
  const auto distance = [&](UV p) { return glm::length(in_world(p - uv)); };
  const double speed_u = glm::length(metric.Su), speed_v = glm::length(metric.Sv);
  constexpr int kMostParts = 32;
  std::array<Stretch, kMostParts + 1> left;
  int count = 0;
  if (std::min(distance(clip.p0), distance(clip.p1)) <= most) return true;
  left[count++] = {clip.t0, clip.t1, clip.p0, clip.p1};
  for (int parts = 0; count > 0; ++parts) {
    const Stretch part = left[--count];
    const Vec2 size = glm::abs(part.pb - part.pa);
    if (0.5 * (distance(part.pa) + distance(part.pb) - size.x * speed_u - size.y * speed_v) > most) continue;
    if (parts >= kMostParts) return distance_in_world(uv, piece, metric, std::min(clip.t0, clip.t1), std::max(clip.t0, clip.t1)) <= most;
    const double m = 0.5 * (part.a + part.b);
    const UV p = point_at(piece, m);
    if (distance(p) <= most) return true;
    left[count++] = {part.a, m, part.pa, p};
    left[count++] = {m, part.b, p, part.pb};
  }
  return false;
}

namespace {

// 1 / |cosine| between the ray and the normal, within [1, kMostStretch].
double stretch_for(const Jet2& metric, const Vec3& direction) {
  constexpr double kMostStretch = TrimRegion::kMostStretch;
  const Vec3 normal = glm::cross(metric.Su, metric.Sv);
  const double along = std::abs(glm::dot(normal, direction)), most = glm::length(normal) * glm::length(direction);
  return most > kMostStretch * along ? (most > 0 ? kMostStretch : 1.0) : (most > 0 ? most / along : 1.0);
}

}  // namespace

// Does a tolerance let in a point outside? The metric is the surface's at the point, asked for only if something is near.
bool TrimRegion::let_in(const CellLists& lists, const CellLists& next, UV uv, const AnySurface& surface, const Vec3& direction) const {
  std::optional<Jet2> metric;
  double stretch = 1;
  for (std::uint32_t k = lists.near_begin; k < next.near_begin; ++k) {
    const Clip& clip = clips_[near_[k]];
    const TrimPiece& piece = pieces_[clip.piece];
    if (!comes_near(clip, piece, uv)) continue;
    if (!metric) {
      metric = jet2(surface, uv);
      stretch = stretch_for(*metric, direction);
    }
    if (within(clip, piece, uv, *metric, stretch * piece.tolerance)) return true;
  }
  return false;
}

TrimRegion::Answer TrimRegion::contains_here(UV uv, const AnySurface& surface, const Vec3& direction) const {
  if (!box_.contains(uv)) return {false, false};
  const std::size_t index = static_cast<std::size_t>(row(uv.y)) * columns_ + column(uv.x);
  const CellState state = states_[index];
  if (state.kind != Kind::crossing) return {state.kind == Kind::inside, false};
  const CellLists &lists = lists_[index], &next = lists_[index + 1];
  bool inside = state.corner_inside;
  for (std::uint32_t k = lists.clips_begin; k < next.clips_begin; ++k) {
    const Clip& clip = clips_[k];
    const bool above0 = clip.p0.y <= uv.y, above1 = clip.p1.y <= uv.y;
    inside ^= (clip.enters0 & above0) ^ (clip.enters1 & above1);  // what enters through the left edge below the query
    if (above0 == above1) continue;
    const double across = clip.across(uv);
    if (across >= clip.lo) inside ^= across > clip.hi || crosses_in_band(clip, uv);
  }
  if (inside) return {true, false};
  return lists.near_begin < next.near_begin && let_in(lists, next, uv, surface, direction) ? Answer{true, true} : Answer{false, false};
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

// The copies of uv a period off that the loops or their tolerances may hold, after `best`, the answer at uv itself.
TrimRegion::Answer TrimRegion::contains_shifted(UV uv, Answer best, const AnySurface& surface, const Vec3& direction) const {
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

TrimRegion::Answer TrimRegion::contains(UV uv, const AnySurface& surface, const Vec3& direction) const {
  if (untrimmed()) return {};
  // Bring uv into the window of the loops; where they are wider than a period, or at its very edge, the neighbouring copy counts too.
  for (const int c : {0, 1})
    if (const double off = uv[c] - loops_box_.lo[c]; period_[c] > 0 && !(off >= 0 && off < period_[c]))
      uv[c] -= period_[c] * std::floor(off / period_[c]);
  const Answer answer = contains_here(uv, surface, direction);
  if ((answer.inside && !answer.by_tolerance) || !(period_.x > 0 || period_.y > 0)) return answer;
  return contains_shifted(uv, answer, surface, direction);
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
  const Kind first = sticks_out ? Kind::outside : states_[static_cast<std::size_t>(r0) * columns_ + c0].kind;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      if (states_[static_cast<std::size_t>(r) * columns_ + c].kind != first || first == Kind::crossing) return Kind::crossing;
  return first;
}

std::vector<Box2> TrimRegion::cover() const {
  std::vector<Box2> boxes;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      if (states_[static_cast<std::size_t>(r) * columns_ + c].kind == Kind::outside) continue;
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

Box2 TrimRegion::grown(const Box2& domain) const {
  if (untrimmed()) return domain;
  constexpr double kMost = 1e-2;  // what is added continues the surface's last span, which cannot be trusted far
  const Vec2 most = kMost * domain.size();
  return {domain.lo - glm::min(loops_box_.lo - reach_box_.lo, most), domain.hi + glm::min(reach_box_.hi - loops_box_.hi, most)};
}

std::size_t TrimRegion::bytes() const {
  return pieces_.size() * sizeof(TrimPiece) + points_.size() * sizeof(Vec3) + clips_.size() * sizeof(Clip) +
         near_.size() * sizeof(std::uint32_t) + states_.size() * sizeof(CellState) + lists_.size() * sizeof(CellLists);
}

}  // namespace iso
