// The queries of a trim region. Its making is in trim_build.cpp.
#include "patches/trim.h"

#include <array>

#include "patches/base/bernstein.h"
#include "patches/base/bspline_basis.h"

namespace iso {

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
  constexpr double kMostStretch = TrimRegion::kMostStretch;
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
