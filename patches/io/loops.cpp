#include "patches/io/loops.h"

#include <utility>

namespace iso {
namespace {

// Ends nearer than this, in units of the face's size in (u, v), meet.
constexpr double kMeets = 1e-6;
// A continuation that needs a shift by whole periods is taken only if no other lies within this distance.
constexpr double kShiftPenalty = 1e-3;
// A piece is turned around only if that brings it nearer by this factor.
constexpr double kTurnGain = 1e-2;
// Joints that are open by more than this share of the loop's box are closed by a piece of their own.
constexpr double kJump = 1e-4;
constexpr int kSamples = 24;    // per trim curve
constexpr int kBoxSlices = 16;  // control polygons of so many slices bound a trim curve

double whole_periods(double distance, double period) { return period > 0 ? std::round(distance / period) * period : 0.0; }
Vec2 whole_periods(const Vec2& d, const Vec2& period) { return {whole_periods(d.x, period.x), whole_periods(d.y, period.y)}; }

// How badly `to` continues `from`.
struct Metric {
  Vec2 period, size;

  double plain(const UV& from, const UV& to) const { return glm::length((to - from) / size); }
  double operator()(const UV& from, const UV& to) const {
    const Vec2 turns = whole_periods(from - to, period);
    if (turns == Vec2(0.0)) return plain(from, to);
    return std::min(plain(from, to), plain(from, to + turns) + kShiftPenalty);
  }
};

void move(LoopPiece& p, const Vec2& by) {
  struct Mover {
    Vec2 d;
    void operator()(Line<Vec2>& c) const { c.origin += d; }
    void operator()(Ellipse<Vec2>& c) const { c.centre += d; }
    void operator()(Parabola<Vec2>& c) const { c.vertex += d; }
    void operator()(Hyperbola<Vec2>& c) const { c.centre += d; }
    void operator()(NurbsCurve<Vec2>& c) const {
      for (Vec3& h : c.poles) h += Vec3(h.z * d, 0);
    }
  };
  if (by == Vec2(0.0)) return;
  std::visit(Mover{by}, p.trim.curve);
  p.start += by;
  p.end += by;
}

void turn(LoopPiece& p) {
  std::swap(p.trim.t0, p.trim.t1);
  std::swap(p.start, p.end);
}

// The shift that continues `from` with `to`: none unless whole periods bring the two clearly nearer.
Vec2 continuing_shift(const UV& from, const UV& to, const Metric& metric) {
  const Vec2 turns = whole_periods(from - to, metric.period);
  return metric.plain(from, to + turns) + kShiftPenalty < metric.plain(from, to) ? turns : Vec2(0.0);
}

struct Choice {
  size_t index = 0;
  double distance = kInf;
  bool turned = false;
};

// The unused piece that starts nearest; the first one in the file's order of those that are about as near.
Choice best_start(const std::vector<LoopPiece>& pieces, const std::vector<char>& used, size_t last, const UV& end, const Metric& metric) {
  double nearest = kInf;
  for (size_t i = 0; i < pieces.size(); ++i)
    if (!used[i]) nearest = std::min(nearest, metric(end, pieces[i].start));
  for (size_t step = 1; step < pieces.size(); ++step) {
    const size_t i = (last + step) % pieces.size();
    if (used[i]) continue;
    const double d = metric(end, pieces[i].start);
    if (d <= std::max(kMeets, 2 * nearest)) return {i, d, false};
  }
  return {};
}

// The unused piece that ends nearest.
Choice best_end(const std::vector<LoopPiece>& pieces, const std::vector<char>& used, const UV& end, const Metric& metric) {
  Choice best{0, kInf, true};
  for (size_t i = 0; i < pieces.size(); ++i)
    if (!used[i] && metric(end, pieces[i].end) < best.distance) best = {i, metric(end, pieces[i].end), true};
  return best;
}

Chain next_chain(std::vector<LoopPiece>& pieces, std::vector<char>& used, size_t seed, const Metric& metric) {
  Chain chain;
  used[seed] = 1;
  chain.pieces.push_back(pieces[seed]);
  const UV start = pieces[seed].start;
  for (size_t last = seed;;) {
    const UV end = chain.pieces.back().end;
    const double closing = metric(end, start);
    Choice next = best_start(pieces, used, last, end, metric);
    // Closing wins over a continuation that is further away; the pieces left over make chains of their own.
    if (closing <= next.distance && next.distance > kMeets && closing <= kShiftPenalty + kMeets) break;
    // The direction in the file is trusted unless a piece continues far better when turned.
    if (next.distance > kMeets) {
      const Choice turned = best_end(pieces, used, end, metric);
      if (turned.distance < kTurnGain * next.distance) next = turned;
    }
    if (!(next.distance < kInf) || closing < next.distance) break;
    LoopPiece piece = pieces[next.index];
    used[next.index] = 1;
    last = next.index;
    if (next.turned) turn(piece);
    chain.turned += next.turned;
    move(piece, continuing_shift(end, piece.start, metric));
    chain.pieces.push_back(std::move(piece));
  }
  chain.winding = continuing_shift(chain.pieces.back().end, start, metric);
  return chain;
}

bool inside(const std::vector<UV>& polygon, const UV& p) {
  bool in = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const UV &a = polygon[i], &b = polygon[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) in = !in;
  }
  return in;
}

Box2 box_of(const std::vector<UV>& points) {
  Box2 box;
  for (const UV& p : points) box.include(p);
  return box;
}

// How far the chain that closes a band lies from the one that opens it, on the material's side.
double band_width(const Chain& from, const Chain& to, const Vec2& period) {
  const auto [across, sign] = material_side(from);
  double width = sign * (box_of(polygon_of(to)).middle()[across] - box_of(polygon_of(from)).middle()[across]);
  if (period[across] > 0) width -= std::floor(width / period[across]) * period[across];
  return width;
}

// The two pieces of a seam: a line, and the same line one winding before, run back.
LoopPiece seam_there(const UV& from, const UV& to, int tag) { return loop_piece({Line<Vec2>{from, to - from}, 0, 1, -1}, tag); }
LoopPiece seam_back(const UV& from, const UV& to, const Vec2& winding, int tag) {
  return loop_piece({Line<Vec2>{from - winding, to - from}, 1, 0, -1}, tag);
}

// a, across, b, back: `b` is moved so that the line across is short and does not leave the band.
Chain joined(Chain a, Chain b, double width, const Vec2& period, int tag) {
  const auto [across, sign] = material_side(a);
  Vec2 by = whole_periods(a.pieces.back().end - b.pieces.front().start, period);
  const double now = box_of(polygon_of(b)).middle()[across] - box_of(polygon_of(a)).middle()[across];
  by[across] = whole_periods(sign * width - now, period[across]);
  shift(b, by);
  const UV from = a.pieces.back().end, to = b.pieces.front().start;
  a.pieces.push_back(seam_there(from, to, tag));
  a.pieces.insert(a.pieces.end(), b.pieces.begin(), b.pieces.end());
  a.pieces.push_back(seam_back(from, to, a.winding, tag));
  a.winding = Vec2(0.0);
  a.turned += b.turned;
  return a;
}

// The shift by whole periods that brings [lo, hi] into the window; the smallest one that does.
double shift_into(double lo, double hi, double window_lo, double window_hi, double period) {
  if (!(period > 0)) return 0;
  const double slack = kMeets * period;
  if (lo >= window_lo - slack && hi <= window_hi + slack) return 0;
  return whole_periods(0.5 * (window_lo + window_hi) - 0.5 * (lo + hi), period);
}
Vec2 shift_into(const Box2& box, const Box2& window, const Vec2& period) {
  return {shift_into(box.lo.x, box.hi.x, window.lo.x, window.hi.x, period.x),
          shift_into(box.lo.y, box.hi.y, window.lo.y, window.hi.y, period.y)};
}

}  // namespace

LoopPiece loop_piece(TrimCurve trim, int tag) {
  LoopPiece p;
  p.start = jet(trim.curve, trim.t0).C;
  p.end = jet(trim.curve, trim.t1).C;
  p.trim = std::move(trim);
  p.tag = tag;
  return p;
}

std::vector<Chain> chains_of(std::vector<LoopPiece> pieces, const Vec2& period, const Vec2& size) {
  const Metric metric{period, {size.x > 0 ? size.x : 1.0, size.y > 0 ? size.y : 1.0}};
  std::vector<Chain> chains;
  std::vector<char> used(pieces.size(), 0);
  for (size_t i = 0; i < pieces.size(); ++i)
    if (!used[i]) chains.push_back(next_chain(pieces, used, i, metric));
  return chains;
}

void shift(Chain& chain, const Vec2& by) {
  for (LoopPiece& p : chain.pieces) move(p, by);
}

void turn(Chain& chain) {
  chain.pieces = std::vector<LoopPiece>(chain.pieces.rbegin(), chain.pieces.rend());
  for (LoopPiece& p : chain.pieces) turn(p);
  chain.winding = -chain.winding;
}

Gap gap_after(const Chain& chain, size_t i) {
  const bool last = i + 1 == chain.pieces.size();
  const LoopPiece& next = chain.pieces[last ? 0 : i + 1];
  return {chain.pieces[i].end, next.start + (last ? chain.winding : Vec2(0.0)), static_cast<int>(i)};
}

Side material_side(const Chain& chain) {
  // Left of +u is +v, left of +v is -u.
  if (chain.winding.x != 0) return {1, chain.winding.x > 0 ? 1.0 : -1.0};
  return {0, chain.winding.y > 0 ? -1.0 : 1.0};
}

void join_bands(std::vector<Chain>& chains, const Vec2& period, Partner allowed, int& next_seam) {
  for (size_t i = 0; i < chains.size(); ++i) {
    if (chains[i].winding == Vec2(0.0)) continue;
    size_t partner = chains.size();
    double width = kInf;
    for (size_t j = 0; j < chains.size(); ++j) {
      if (j == i || chains[j].winding != -chains[i].winding) continue;
      const double w = band_width(chains[i], chains[j], period);
      if (allowed == Partner::on_material_side && w < 0) continue;
      if (partner == chains.size() || std::abs(w) < std::abs(width)) partner = j, width = w;
    }
    if (partner == chains.size()) continue;
    chains[i] = joined(chains[i], chains[partner], width, period, next_seam--);
    chains.erase(chains.begin() + static_cast<std::ptrdiff_t>(partner));
    if (partner < i) --i;
  }
}

void close_at(Chain& chain, double value, int& next_seam) {
  const auto [across, sign] = material_side(chain);
  const UV from = chain.pieces.back().end;
  UV far = from;
  far[across] = value;
  chain.pieces.push_back(seam_there(from, far, next_seam));
  chain.pieces.push_back(loop_piece({Line<Vec2>{far, -chain.winding}, 0, 1, -1}, kClosingTag));
  chain.pieces.push_back(seam_back(from, far, chain.winding, next_seam));
  --next_seam;
  chain.winding = Vec2(0.0);
}

Chain outline_of(const Box2& box, const Vec2& period, int& next_seam) {
  const UV a = box.lo, b{box.hi.x, box.lo.y}, c = box.hi, d{box.lo.x, box.hi.y};
  const int sides = period.x > 0 ? next_seam-- : kClosingTag, ends = period.y > 0 ? next_seam-- : kClosingTag;
  Chain chain;
  chain.pieces.push_back(seam_there(a, b, ends));
  chain.pieces.push_back(seam_there(b, c, sides));
  chain.pieces.push_back(seam_back(a, b, a - d, ends));
  chain.pieces.push_back(seam_back(b, c, b - a, sides));
  return chain;
}

void close_jumps(Chain& chain) {
  Vec2 size = box_of(std::vector<Chain>{chain}).size();
  for (int c = 0; c < 2; ++c) size[c] = size[c] > 0 ? size[c] : 1;
  std::vector<LoopPiece> pieces;
  for (size_t i = 0; i < chain.pieces.size(); ++i) {
    const Gap gap = gap_after(chain, i);
    pieces.push_back(chain.pieces[i]);
    if (glm::length((gap.to - gap.from) / size) > kJump)
      pieces.push_back(loop_piece({Line<Vec2>{gap.from, gap.to - gap.from}, 0, 1, -1}, kClosingTag));
  }
  chain.pieces = std::move(pieces);
}

std::vector<UV> polygon_of(const Chain& chain) {
  std::vector<UV> points;
  for (const LoopPiece& p : chain.pieces) {
    const bool straight = std::holds_alternative<Line<Vec2>>(p.trim.curve);
    const int n = straight ? 1 : kSamples;
    for (int i = 0; i < n; ++i) points.push_back(jet(p.trim.curve, p.trim.t0 + (p.trim.t1 - p.trim.t0) * i / n).C);
    if (straight) points.push_back(p.end);
  }
  return points;
}

double signed_area(const std::vector<UV>& polygon) {
  double twice = 0;
  if (polygon.empty()) return 0;
  const UV o = polygon.front();  // near the loop, against cancellation
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const UV a = polygon[j] - o, b = polygon[i] - o;
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

void align_periods(std::vector<Chain>& chains, const Vec2& period, const Box2& natural) {
  if (period == Vec2(0.0) || chains.empty()) return;
  size_t outer = 0;
  double largest = -1;
  std::vector<Box2> boxes;
  for (const Chain& chain : chains) {
    const auto polygon = polygon_of(chain);
    boxes.push_back(box_of(polygon));
    const double area = std::abs(signed_area(polygon));
    if (area > largest) outer = boxes.size() - 1, largest = area;
  }
  const Vec2 by = shift_into(boxes[outer], natural, period);
  shift(chains[outer], by);
  const Box2 window{boxes[outer].lo + by, boxes[outer].hi + by};
  for (size_t i = 0; i < chains.size(); ++i)
    if (i != outer) shift(chains[i], shift_into(boxes[i], window, period));
}

std::vector<size_t> wrongly_directed(const std::vector<Chain>& chains) {
  std::vector<std::vector<UV>> polygons;
  std::vector<Box2> boxes;
  for (const Chain& chain : chains) {
    polygons.push_back(polygon_of(chain));
    boxes.push_back(box_of(polygons.back()));
  }
  std::vector<size_t> wrong;
  for (size_t i = 0; i < chains.size(); ++i) {
    int depth = 0;
    const UV probe = 0.5 * (polygons[i][0] + polygons[i][1 % polygons[i].size()]);
    for (size_t j = 0; j < chains.size(); ++j)
      if (j != i && boxes[j].contains(probe) && inside(polygons[j], probe)) ++depth;
    const double area = signed_area(polygons[i]);
    // The area of a loop that runs to and fro is nothing but rounding: it has no direction.
    if (std::abs(area) <= 1e-9 * boxes[i].size().x * boxes[i].size().y) continue;
    if ((area > 0) != (depth % 2 == 0)) wrong.push_back(i);
  }
  return wrong;
}

Box2 box_of(const std::vector<Chain>& chains) {
  Box2 box;
  for (const Chain& chain : chains)
    for (const LoopPiece& p : chain.pieces) {
      box.include(p.start);
      box.include(p.end);
      const double lo = std::min(p.trim.t0, p.trim.t1), hi = std::max(p.trim.t0, p.trim.t1);
      if (!(lo < hi)) continue;
      for (int i = 0; i < kBoxSlices; ++i)
        for (const auto& span : bezier_spans(p.trim.curve, lo + (hi - lo) * i / kBoxSlices, lo + (hi - lo) * (i + 1) / kBoxSlices))
          for (const Vec3& h : span.points) box.include(project(h));
    }
  return box;
}

}  // namespace iso
