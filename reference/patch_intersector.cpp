#include "reference/patch_intersector.h"

#include <algorithm>

#include "patches/base/corner_series.h"
#include "patches/surface/patch_basis-inl.h"
#include "reference/patch_enclosure.h"

namespace iso::reference {

namespace {

static_assert(Model::kCount == 10);
constexpr double kRounding = 1e-14;    // sizes: what bounds and points may be rounded by
constexpr double kSmallest = 0x1p-27;  // of a chart: a line that touches is not told from one that does not within its square
constexpr double kKept = 0x1p-7;       // of a chart: smaller boxes are quartered anew each time,
constexpr double kAsked = 0x1p-12;     // but for those where the formulas are asked
constexpr double kSharp = 1.0 / 8;     // of what polynomials vary by: with a larger radius the formulas are asked again
constexpr double kOneToOne = 0.9;      // how much of a tangent may vary, below 1
constexpr double kBeyond = 1e-10;      // half widths: roots on a border are found from both sides of it
constexpr int kWedges = 8;             // of half a box at a corner
const Vec2 kCorners[4] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};  // of a box, whose quarters they name
constexpr double kTwice = 1e-10;                            // sizes: meetings nearer than that are one

struct Place {
  Vec3 S{0.0}, Ss{0.0}, St{0.0};
};

// The formulas in doubles.
Place place_at(const NSidedPatch& patch, const Vec2& st) {
  thread_local std::vector<Dual1<double>> W;
  W.resize(patch.points.size());
  patch_weights<Dual1<double>>(patch.basis, {st.x, 1.0, 0.0}, {st.y, 0.0, 1.0}, W.data());
  Place sum;
  double w = 0, ws = 0, wt = 0;
  for (std::size_t m = 0; m < W.size(); ++m) {
    const double weight = patch.weights.empty() ? 1.0 : patch.weights[m];
    sum.S += weight * W[m].f * patch.points[m];
    sum.Ss += weight * W[m].u * patch.points[m];
    sum.St += weight * W[m].v * patch.points[m];
    w += weight * W[m].f;
    ws += weight * W[m].u;
    wt += weight * W[m].v;
  }
  if (patch.weights.empty()) return sum;
  const Vec3 S = sum.S / w;
  return {S, (sum.Ss - ws * S) / w, (sum.St - wt * S) / w};
}

NSidedPatch turned(const NSidedPatch& patch) {
  NSidedPatch next = patch;
  const std::vector<int> from = points_from_next_corner(patch.basis);
  for (std::size_t m = 0; m < from.size(); ++m) {
    next.points[m] = patch.points[static_cast<std::size_t>(from[m])];
    if (!patch.weights.empty()) next.weights[m] = patch.weights[static_cast<std::size_t>(from[m])];
  }
  return next;
}

// A model's polynomial.
double value(const double c[Model::kCount], const Vec2& at) {
  double sum = 0, by_a = 1;
  for (int i = 0; i <= Model::kOrder; ++i, by_a *= at.x) {
    double in_b = 0;
    for (int j = Model::kOrder - i; j >= 0; --j) in_b = in_b * at.y + c[Model::index(i, j)];
    sum += by_a * in_b;
  }
  return sum;
}

Vec3 absolute(const Vec3& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

PatchMeeting meeting_at(int chart, const Vec2& st, const Place& at, const Vec3& o, const Vec3& d, bool doubtful) {
  PatchMeeting m{
      .t = glm::dot(at.S - o, d), .chart = chart, .st = st, .p = at.S, .n = glm::cross(at.Ss, at.St), .cosine = 0, .doubtful = doubtful};
  const double length = glm::length(m.n);
  m.n = length > 0 ? m.n / length : Vec3(0.0);
  m.cosine = glm::dot(m.n, d);
  return m;
}

}  // namespace

struct PatchIntersector::Found {
  int chart;
  std::vector<PatchMeeting>& meetings;
};

PatchIntersector::PatchIntersector(const NSidedPatch& patch) {
  Box3 box;
  for (const Vec3& p : patch.points) box.include(p);
  about_ = box.middle();
  size_ = box.diagonal();
  NSidedPatch centred = patch;
  for (Vec3& p : centred.points) p -= about_;
  for (int k = 0; k < patch.basis.sides; ++k) {
    charts_.push_back({centred, {bound(centred, Vec2(0.0), 1)}});
    centred = turned(centred);
  }
}

std::size_t PatchIntersector::boxes() const {
  std::size_t sum = 0;
  for (const Chart& chart : charts_) sum += chart.tree.size();
  return sum;
}

Vec3 PatchIntersector::Models::varies() const {
  Vec3 sum{0.0};
  for (std::size_t k = 1; k < kTerms; ++k) sum += absolute(c[k]);
  return sum;
}

PatchIntersector::Models PatchIntersector::Models::quarter(const Vec2& corner) const {
  Models q = *this;
  Model::to_quarter(q.c, corner - 0.5);
  return q;
}

// S and its tangents by the formulas, with bounds for numbers.
PatchIntersector::Bounds PatchIntersector::bound(const NSidedPatch& patch, const Vec2& lo, double width) const {
  if (lo == Vec2(0.0) && patch.basis.parameters == SideParameters::mean_value) return bound_at_corner(patch, width);
  const double half = 0.5 * width;
  const Vec2 middle = lo + half;
  thread_local std::vector<Enclosure> W;
  W.resize(patch.points.size());
  patch_weights<Enclosure>(patch.basis, {Model(middle.x, half, 0), 1.0, 0.0}, {Model(middle.y, 0, half), 0.0, 1.0}, W.data());
  Enclosure S[3], weight;
  for (std::size_t m = 0; m < W.size(); ++m) {
    const Enclosure w = patch.weights.empty() ? W[m] : W[m] * patch.weights[m];
    if (!patch.weights.empty()) weight = weight + w;
    for (int c = 0; c < 3; ++c) S[c] = S[c] + w * patch.points[m][c];
  }
  Bounds box{.lo = lo, .width = width, .S = {}, .Ss = {}, .St = {}};
  for (int c = 0; c < 3; ++c) {
    if (!patch.weights.empty()) S[c] = S[c] / weight;
    for (const auto& [to, from] : {std::pair{&box.S, &S[c].f}, std::pair{&box.Ss, &S[c].s}, std::pair{&box.St, &S[c].t}}) {
      for (std::size_t k = 0; k < kTerms; ++k) to->c[k][c] = from->c[k];
      to->radius[c] = from->radius + kRounding * size_;
    }
  }
  box.rs = box.Ss.varies() + box.Ss.radius;
  box.rt = box.St.varies() + box.St.radius;
  return box;
}

// By mean value coordinates the formulas divide by what vanishes at the corner: a box of all points, from wedges on either side of the
// diagonal. Tangents have no limits.
PatchIntersector::Bounds PatchIntersector::bound_at_corner(const NSidedPatch& patch, double width) const {
  using Corner = CornerSeries<Model>;
  const double half = 0.5 * width;
  const Corner far(1.0, 1, half, half);
  std::vector<Corner> W(patch.points.size());
  Bounds box{.lo = Vec2(0.0), .width = width, .S = {}, .Ss = {}, .St = {}};
  box.S.radius = box.Ss.radius = box.St.radius = box.rs = box.rt = Vec3(kInf);
  Box3 all;
  for (int part = 0; part < 2 * kWedges; ++part) {
    const bool swapped = part % 2 == 1;
    const Corner near(Model((part / 2 + 0.5) / kWedges, 0, 0.5 / kWedges), 1, half, half);
    patch_weights(patch.basis, swapped ? near : far, swapped ? far : near, W.data());
    Model S[3];
    for (std::size_t m = 0; m < W.size(); ++m)
      for (int c = 0; c < 3; ++c) S[c] = S[c] + W[m].value() * patch.points[m][c];
    for (const Model& coordinate : S)
      if (!finite(coordinate.magnitude())) return box;
    for (const double side : {-1.0, 1.0})
      all.include(Vec3(S[0].c[0], S[1].c[0], S[2].c[0]) + side * Vec3(S[0].spread(), S[1].spread(), S[2].spread()));
  }
  box.S.c[0] = all.middle();
  box.S.radius = 0.5 * all.size() + kRounding * size_;
  return box;
}

// Whether the radius is little beside what the polynomials vary by, or nothing but rounding.
bool PatchIntersector::sharp(const Bounds& box) const {
  const auto largest = [](const Vec3& v) { return std::max({v.x, v.y, v.z}); };
  for (const Models* m : {&box.S, &box.Ss, &box.St})
    if (!(largest(m->radius) <= std::max(kSharp * largest(m->varies()), 2 * kRounding * size_))) return false;
  return true;
}

PatchIntersector::Bounds PatchIntersector::quarter(const NSidedPatch& patch, const Bounds& box, const Vec2& corner) const {
  const double half = 0.5 * box.width;
  Bounds part{.lo = box.lo + half * corner, .width = half, .S = box.S.quarter(corner), .Ss = {}, .St = {}};
  part.Ss = box.Ss.quarter(corner);
  part.St = box.St.quarter(corner);
  if (!sharp(part)) return bound(patch, part.lo, half);
  part.rs = part.Ss.varies() + part.Ss.radius;
  part.rt = part.St.varies() + part.St.radius;
  part.asked = false;
  return part;
}

// Whether both planes of the line pass what is bounded. Bounds that are not numbers bound nothing.
bool PatchIntersector::may_meet(const Models& S, const Line& line) const {
  for (const Vec3& n : line.n) {
    double reach = glm::dot(absolute(n), S.radius);
    for (std::size_t k = 1; k < kTerms; ++k) reach += std::abs(glm::dot(n, S.c[k]));
    if (std::abs(glm::dot(n, S.c[0] - line.o)) > reach) return false;
  }
  return true;
}

// True if the chart over the box is one-to-one as seen along the line: then its root, if it has one, is found. In (a, b) of the box, with
// Y the inverse of the middle of the derivatives: all roots in X lie in x - Y F(x) + (1 - Y F'(X)) (X - x), for any x in X. First F is the
// box's polynomial with its radius, as long as that tells more; most boxes are settled by that. Then F is the formula.
bool PatchIntersector::settle(const Chart& chart, const Bounds& box, const Line& line, Found& found) const {
  const double half = 0.5 * box.width;
  double A[2][2], R[2][2], Y[2][2], vary[2][2], fuzzy[2];
  for (int i = 0; i < 2; ++i) {
    A[i][0] = half * glm::dot(line.n[i], box.Ss.c[0]);
    A[i][1] = half * glm::dot(line.n[i], box.St.c[0]);
    R[i][0] = half * glm::dot(absolute(line.n[i]), box.rs);
    R[i][1] = half * glm::dot(absolute(line.n[i]), box.rt);
  }
  const double det = A[0][0] * A[1][1] - A[0][1] * A[1][0];
  Y[0][0] = A[1][1] / det;
  Y[1][1] = A[0][0] / det;
  Y[0][1] = -A[0][1] / det;
  Y[1][0] = -A[1][0] / det;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) vary[i][j] = std::abs(Y[i][0]) * R[0][j] + std::abs(Y[i][1]) * R[1][j];
    fuzzy[i] = (std::abs(Y[i][0]) + std::abs(Y[i][1])) * kRounding * size_;
    if (!(vary[i][0] + vary[i][1] < kOneToOne)) return false;
  }

  Box2 X{Vec2(-1 - kBeyond), Vec2(1 + kBeyond)};
  const auto narrow = [&](const Vec2& x, const Vec2& newton, const Vec2& unsure) {
    const Vec2 far = glm::max(X.hi - x, x - X.lo);
    for (int i = 0; i < 2; ++i) {
      const double wide = vary[i][0] * far.x + vary[i][1] * far.y + unsure[i] + fuzzy[i];
      X.lo[i] = std::max(X.lo[i], x[i] - newton[i] - wide);
      X.hi[i] = std::min(X.hi[i], x[i] - newton[i] + wide);
    }
  };
  const auto times_Y = [&](const double F[2]) { return Vec2{Y[0][0] * F[0] + Y[0][1] * F[1], Y[1][0] * F[0] + Y[1][1] * F[1]}; };

  double c[2][kTerms], radius[2];
  for (int i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < kTerms; ++k) c[i][k] = glm::dot(line.n[i], box.S.c[k]);
    c[i][0] -= glm::dot(line.n[i], line.o);
    radius[i] = glm::dot(absolute(line.n[i]), box.S.radius);
  }
  const Vec2 unsure{std::abs(Y[0][0]) * radius[0] + std::abs(Y[0][1]) * radius[1],
                    std::abs(Y[1][0]) * radius[0] + std::abs(Y[1][1]) * radius[1]};
  for (double before = kInf, now = glm::length(X.size()); now < 0.5 * before; before = now, now = glm::length(X.size())) {
    const Vec2 x = X.middle();
    double F[2];
    for (int i = 0; i < 2; ++i) F[i] = value(c[i], x);
    narrow(x, times_Y(F), unsure);
    if (X.empty()) return true;
  }

  Vec2 x = X.middle();
  for (int step = 0; step < 200; ++step) {
    const Vec2 st = box.lo + half * (x + 1.0);
    const Place at = place_at(chart.patch, st);
    const double F[2] = {glm::dot(line.n[0], at.S - line.o), glm::dot(line.n[1], at.S - line.o)};
    const Vec2 newton = times_Y(F);
    if ((std::abs(newton.x) <= fuzzy[0] && std::abs(newton.y) <= fuzzy[1]) || glm::length(X.size()) < 1e-12) {
      found.meetings.push_back(meeting_at(found.chart, st, at, line.o, line.d, false));
      return true;
    }
    narrow(x, newton, Vec2(0.0));
    if (X.empty()) return true;
    // From Newton's next point, which need not be in X.
    const double a = half * glm::dot(line.n[0], at.Ss), b = half * glm::dot(line.n[0], at.St), e = half * glm::dot(line.n[1], at.Ss),
                 g = half * glm::dot(line.n[1], at.St), D = a * g - b * e;
    const Vec2 next = D != 0 ? x - Vec2(g * F[0] - b * F[1], a * F[1] - e * F[0]) / D : X.middle();
    x = finite(next) ? glm::clamp(next, X.lo, X.hi) : X.middle();
  }
  return false;
}

void PatchIntersector::leave_doubtful(const Chart& chart, const Bounds& box, const Line& line, Found& found) const {
  const Vec2 middle = box.lo + 0.5 * box.width;
  found.meetings.push_back(meeting_at(found.chart, middle, place_at(chart.patch, middle), line.o, line.d, true));
}

void PatchIntersector::search_deep(const Chart& chart, const Bounds& box, const Line& line, Found& found) const {
  if (!may_meet(box.S, line) || settle(chart, box, line, found)) return;
  if (box.width <= kSmallest) return leave_doubtful(chart, box, line, found);
  for (const Vec2& corner : kCorners) search_deep(chart, quarter(chart.patch, box, corner), line, found);
}

void PatchIntersector::search(Chart& chart, int index, const Line& line, Found& found) const {
  const auto at = static_cast<std::size_t>(index);
  if (!may_meet(chart.tree[at].S, line) || settle(chart, chart.tree[at], line, found)) return;
  if (chart.tree[at].children < 0) {
    std::array<Bounds, 4> parts;
    for (std::size_t k = 0; k < 4; ++k) parts[k] = quarter(chart.patch, chart.tree[at], kCorners[k]);
    const bool asked = std::any_of(parts.begin(), parts.end(), [](const Bounds& part) { return part.asked; });
    if (parts[0].width < (asked ? kAsked : kKept)) {
      for (const Bounds& part : parts) search_deep(chart, part, line, found);
      return;
    }
    chart.tree[at].children = static_cast<int>(chart.tree.size());
    chart.tree.insert(chart.tree.end(), parts.begin(), parts.end());
  }
  const int first = chart.tree[at].children;
  for (int k = 0; k < 4; ++k) search(chart, first + k, line, found);
}

std::vector<PatchMeeting> PatchIntersector::all(const Vec3& o, const Vec3& d) {
  // From the place nearest to the patch, since lengths are rounded.
  const double ahead = glm::dot(about_ - o, d);
  Line line{.o = o + ahead * d - about_, .d = d, .n = {}};
  line.n[0] = any_perpendicular(d);
  line.n[1] = glm::cross(d, line.n[0]);
  std::vector<PatchMeeting> meetings;
  for (std::size_t k = 0; k < charts_.size(); ++k) {
    Found found{static_cast<int>(k), meetings};
    search(charts_[k], 0, line, found);
  }
  for (PatchMeeting& m : meetings) {
    m.p += about_;
    m.t += ahead;
  }
  std::sort(meetings.begin(), meetings.end(), [](const PatchMeeting& a, const PatchMeeting& b) { return a.t < b.t; });
  // The same point in the same sense from two boxes; squares that touch the line lie side by side.
  std::vector<PatchMeeting> once;
  for (const PatchMeeting& m : meetings) {
    const bool again = std::any_of(once.begin(), once.end(), [&](const PatchMeeting& k) {
      if (k.doubtful || m.doubtful) return glm::length(k.p - m.p) <= 64 * kSmallest * size_;
      return glm::length(k.p - m.p) <= kTwice * size_ && k.cosine * m.cosine > 0;
    });
    if (!again) once.push_back(m);
  }
  return once;
}

}  // namespace iso::reference
