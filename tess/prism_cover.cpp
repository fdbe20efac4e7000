#include "tess/prism_cover.h"

#include <algorithm>

namespace iso {
namespace {

// A convex polygon in the plane of the triangle that is covered; clipping by a line adds one corner.
struct Polygon {
  static constexpr int kMost = 16;
  Vec2 at[kMost];
  int count = 0;

  void add(const Vec2& p) { at[count++] = p; }
};

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Cuts at the line through a along d: what is to the left, and what is to the right.
void cut(const Polygon& all, const Vec2& a, const Vec2& d, Polygon& left, Polygon& right) {
  left.count = right.count = 0;
  double side[Polygon::kMost];
  for (int i = 0; i < all.count; ++i) side[i] = cross(d, all.at[i] - a);
  for (int i = 0; i < all.count; ++i) {
    const int j = i + 1 == all.count ? 0 : i + 1;
    if (side[i] >= 0) left.add(all.at[i]);
    if (side[i] <= 0) right.add(all.at[i]);
    if ((side[i] > 0 && side[j] < 0) || (side[i] < 0 && side[j] > 0)) {
      const Vec2 p = all.at[i] + (side[i] / (side[i] - side[j])) * (all.at[j] - all.at[i]);
      left.add(p);
      right.add(p);
    }
  }
}

// A polygon with many corners as two of about half as many, so that clipping has room.
constexpr int kManyCorners = 9;
void add_divided(std::vector<Polygon>& to, const Polygon& q) {
  if (q.count <= kManyCorners) {
    to.push_back(q);
    return;
  }
  Polygon first, second;
  const int half = q.count / 2;
  for (int i = 0; i <= half; ++i) first.add(q.at[i]);
  for (int i = half; i <= q.count; ++i) second.add(q.at[i % q.count]);
  to.push_back(first);
  to.push_back(second);
}

class Cover {
 public:
  Cover(const TriangleTree& tree, std::span<const Point3> points, std::span<const PointTriangle> triangles, double enough)
      : tree_(tree), points_(points), triangles_(triangles), enough_(enough) {}

  double bound(const std::array<Point3, 3>& t, double near, int depth);
  int pieces() const { return pieces_; }

 private:
  static constexpr double kLoose = 1.5;             // times the limit: worth another way
  static constexpr double kEnough = 1 + 1e-4;       // times what is there: tight to this
  static constexpr int kMostDepth = 4;              // of quartering
  static constexpr std::size_t kMostNearby = 1024;  // triangles before one; with more it is quartered
  static constexpr double kNarrow = 1e-9;           // of the triangle's size: a bound may grow by this rather than follow a piece as narrow
  static constexpr double kThin = 1e-12;            // of the triangle's size: thinner pieces are not cut any further

  double along(const Point3& a, const Point3& b, int depth);
  double quartered(const std::array<Point3, 3>& t, double near, int depth);
  bool thin(const Polygon& q) const;
  bool left_out(const Polygon& q, const Vec2& from, const Vec2& along);
  struct Region {  // of the plane: to the left of some lines
    Vec2 from[3], along[3];
    int lines = 0;
    Box2 box;
  };
  void project(std::uint32_t triangle, Vec2 (&f)[3]) const;
  bool prism(std::uint32_t triangle, Region& region) const;
  bool slab(std::uint32_t triangle, Region& region) const;
  void cover_with(const Region& region, std::uint32_t triangle);
  double farthest(const Polygon& q, std::uint32_t triangle) const;
  struct Waiting {
    double bound;
    Vec2 middle;
    Polygon q;
  };
  Waiting judged(const Polygon& q);
  void cover_all(const std::vector<std::uint32_t>& beside);
  double left_over();

  const TriangleTree& tree_;
  std::span<const Point3> points_;
  std::span<const PointTriangle> triangles_;
  double enough_;
  int pieces_ = 0;

  // Of the triangle at hand.
  Point3 O_{0.0};
  Vec3 X_{0.0}, Y_{0.0};
  double size_ = 0, limit_ = 0, most_ = 0, slack_ = 0;
  Polygon whole_;
  std::vector<Polygon> open_, next_;
  std::vector<Waiting> waiting_;
  std::vector<std::uint32_t> nearby_;
};

bool Cover::thin(const Polygon& q) const {
  if (q.count < 3) return true;
  double area = 0, longest = 0;
  for (int i = 1; i + 1 < q.count; ++i) area += cross(q.at[i] - q.at[0], q.at[i + 1] - q.at[0]);
  for (int i = 0; i < q.count; ++i) longest = std::max(longest, glm::length(q.at[(i + 1) % q.count] - q.at[i]));
  return !(std::abs(area) > kThin * size_ * longest);
}

// Whether a piece to the right of a line is left out: it lies within rounding of the line, and so of what is to the left.
bool Cover::left_out(const Polygon& q, const Vec2& from, const Vec2& along) {
  double width = 0;
  for (int i = 0; i < q.count; ++i) width = std::max(width, std::abs(cross(along, q.at[i] - from)) / glm::length(along));
  if (width > kNarrow * size_) return false;
  slack_ += width;
  return true;
}

double Cover::farthest(const Polygon& q, std::uint32_t triangle) const {
  double most = 0;
  for (int i = 0; i < q.count; ++i) most = std::max(most, tree_.on(triangle, O_ + q.at[i].x * X_ + q.at[i].y * Y_).distance);
  return most;
}

void Cover::project(std::uint32_t triangle, Vec2 (&f)[3]) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 d = points_[triangles_[triangle][k]] - O_;
    f[k] = {glm::dot(d, X_), glm::dot(d, Y_)};
  }
}

// What lies before a triangle of the tree; false if that is nothing of the triangle at hand.
bool Cover::prism(std::uint32_t triangle, Region& region) const {
  Vec2 f[3];
  project(triangle, f);
  const double area = cross(f[1] - f[0], f[2] - f[0]);
  if (!(std::abs(area) > kThin * size_ * size_)) return false;  // seen from its edge
  if (area < 0) std::swap(f[1], f[2]);
  for (int k = 0; k < 3; ++k) {
    const Vec2 a = whole_.at[k], d = whole_.at[(k + 1) % 3] - a;
    if (cross(d, f[0] - a) <= 0 && cross(d, f[1] - a) <= 0 && cross(d, f[2] - a) <= 0) return false;
  }
  region.lines = 3;
  region.box = {};
  for (int k = 0; k < 3; ++k) {
    region.from[k] = f[k];
    region.along[k] = f[(k + 1) % 3] - f[k];
    region.box.include(f[k]);
  }
  return true;
}

// What lies beside the longest side of a triangle of the tree, between its ends: for triangles seen from their edge, and for borders.
bool Cover::slab(std::uint32_t triangle, Region& region) const {
  Vec2 f[3];
  project(triangle, f);
  int at = 0;
  for (int k = 1; k < 3; ++k)
    if (glm::length(f[(k + 1) % 3] - f[k]) > glm::length(f[(at + 1) % 3] - f[at])) at = k;
  const Vec2 a = f[at], b = f[(at + 1) % 3], e = b - a;
  if (!(glm::length(e) > kThin * size_)) return false;
  region.lines = 2;
  region.from[0] = a;
  region.along[0] = {e.y, -e.x};
  region.from[1] = b;
  region.along[1] = {-e.y, e.x};
  region.box = {Vec2(-kInf), Vec2(kInf)};
  return true;
}

// Takes from the open polygons what lies in the region, unless it is farther from the triangle than the limit.
void Cover::cover_with(const Region& region, std::uint32_t triangle) {
  const Vec2 lo = region.box.lo, hi = region.box.hi;
  next_.clear();
  for (const Polygon& q : open_) {
    Vec2 qlo(kInf), qhi(-kInf);
    for (int i = 0; i < q.count; ++i) qlo = glm::min(qlo, q.at[i]), qhi = glm::max(qhi, q.at[i]);
    const bool apart = qhi.x < lo.x || hi.x < qlo.x || qhi.y < lo.y || hi.y < qlo.y;
    if (apart) {
      next_.push_back(q);
      continue;
    }
    Polygon inside = q, left, outside[3];
    int parts = 0;
    for (int k = 0; k < region.lines && !thin(inside); ++k) {
      cut(inside, region.from[k], region.along[k], left, outside[parts]);
      inside = left;
      if (!left_out(outside[parts], region.from[k], region.along[k])) ++parts;
    }
    const double most = thin(inside) ? kInf : farthest(inside, triangle);
    if (most > limit_) {
      next_.push_back(q);
      continue;
    }
    most_ = std::max(most_, most);
    ++pieces_;
    for (int k = 0; k < parts; ++k) add_divided(next_, outside[k]);
  }
  open_.swap(next_);
}

Cover::Waiting Cover::judged(const Polygon& q) {
  Vec2 middle(0.0);
  for (int k = 0; k < q.count; ++k) middle += q.at[k] / double(q.count);
  const TriangleTree::Nearest near = tree_.nearest(O_ + middle.x * X_ + middle.y * Y_);
  double around = 0;
  for (int k = 0; k < q.count; ++k) around = std::max(around, glm::length(q.at[k] - middle));
  ++pieces_;
  return {std::min(farthest(q, near.triangle), near.distance + around), middle, q};
}

// What no triangle lies before, or only far ones (most often the mesh ends in the middle of it): before the nearest one; the piece with
// the largest bound is halved until that is small enough.
double Cover::left_over() {
  constexpr int kMostHalvings = 512;
  const auto lower = [](const Waiting& a, const Waiting& b) { return a.bound < b.bound; };
  waiting_.clear();
  for (const Polygon& q : open_) waiting_.push_back(judged(q));
  std::make_heap(waiting_.begin(), waiting_.end(), lower);
  for (int i = 0; i < kMostHalvings && !waiting_.empty() && waiting_.front().bound > limit_; ++i) {
    std::pop_heap(waiting_.begin(), waiting_.end(), lower);
    const Waiting one = waiting_.back();
    waiting_.pop_back();
    // Across the longest way from the middle.
    Vec2 along(0.0);
    for (int k = 0; k < one.q.count; ++k)
      if (glm::length(one.q.at[k] - one.middle) >= glm::length(along)) along = one.q.at[k] - one.middle;
    Polygon halves[2];
    cut(one.q, one.middle, Vec2(-along.y, along.x), halves[0], halves[1]);
    for (const Polygon& half : halves) {
      if (half.count == 0) continue;
      waiting_.push_back(judged(half));
      std::push_heap(waiting_.begin(), waiting_.end(), lower);
    }
  }
  return waiting_.empty() ? 0 : waiting_.front().bound;
}

double Cover::quartered(const std::array<Point3, 3>& t, double near, int depth) {
  std::array<Point3, 3> m;
  for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (t[(k + 1) % 3] + t[(k + 2) % 3]);
  double most = bound(m, near, depth + 1);
  for (std::size_t k = 0; k < 3; ++k) most = std::max(most, bound({t[k], m[(k + 2) % 3], m[(k + 1) % 3]}, near, depth + 1));
  return most;
}

// Of a triangle without area: the line between its farthest corners.
double Cover::along(const Point3& a, const Point3& b, int depth) {
  constexpr int kMostHalvings = 8;
  const Point3 middle = 0.5 * (a + b);
  const TriangleTree::Nearest near = tree_.nearest(middle);
  const double half = 0.5 * glm::length(b - a);
  const double one = std::min(std::max(tree_.on(near.triangle, a).distance, tree_.on(near.triangle, b).distance), near.distance + half);
  ++pieces_;
  if (depth == kMostHalvings || one <= 1.5 * near.distance + kThin * half) return one;
  return std::max(along(a, middle, depth + 1), along(middle, b, depth + 1));
}

// What lies before the nearby triangles, then what lies beside the sides of all.
void Cover::cover_all(const std::vector<std::uint32_t>& beside) {
  Region region;
  for (std::uint32_t i : nearby_)
    if (!open_.empty() && prism(i, region)) cover_with(region, i);
  for (std::uint32_t i : beside)
    if (!open_.empty() && slab(i, region)) cover_with(region, i);
}

double Cover::bound(const std::array<Point3, 3>& t, double near, int depth) {
  const Vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  double longest = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (const double side = glm::length(t[(k + 1) % 3] - t[k]); side > longest) longest = side, at = k;
  if (!(glm::length(n) > kThin * longest * longest)) return along(t[at], t[(at + 1) % 3], 0);
  // What is farther than this is no help: the bound would not be tight.
  const double rounding = 16 * kEps * (longest + std::max({std::abs(t[0].x), std::abs(t[0].y), std::abs(t[0].z)}));
  const double reach = std::max(enough_, near) + kThin * longest + rounding;
  // Far away from all triangles one is the nearest for large pieces: no others need to be gathered.
  const bool is_far = reach > longest;
  Box3 box;
  for (const Point3& p : t) box.include(p);
  nearby_.clear();
  if (!is_far) tree_.for_each_touching(box.inflated(reach), [&](std::uint32_t i) { nearby_.push_back(i); });
  O_ = t[0];
  X_ = (t[(at + 1) % 3] - t[at]) / longest;
  Y_ = glm::normalize(glm::cross(n, X_));
  size_ = longest;
  most_ = slack_ = 0;
  whole_.count = 0;
  for (const Point3& p : t) whole_.add({glm::dot(p - O_, X_), glm::dot(p - O_, Y_)});
  Region region;
  std::vector<std::uint32_t> all = nearby_;
  std::erase_if(nearby_, [&](std::uint32_t i) { return !prism(i, region); });
  if (nearby_.size() > kMostNearby && depth < kMostDepth) return quartered(t, near, depth);
  open_.assign(1, whole_);
  limit_ = kEnough * std::max(enough_, rounding);
  cover_all(all);
  if (open_.empty()) return most_ + slack_;
  const std::vector<Polygon> rest = open_;
  const double tight = std::max(most_, left_over());
  if (tight <= kLoose * limit_) return tight + slack_;
  // Pieces before triangles that are somewhat farther, then.
  open_ = rest;
  for (int i = 0; i < 2 && !open_.empty(); ++i) {
    limit_ *= kLoose;
    cover_all(all);
  }
  return std::min(tight, open_.empty() ? most_ : std::max(most_, left_over())) + slack_;
}

}  // namespace

CoverBound cover_bound(const TriangleTree& tree, std::span<const Point3> points, std::span<const PointTriangle> triangles,
                       const std::array<Point3, 3>& corners, double near, double enough) {
  Cover cover(tree, points, triangles, enough);
  CoverBound result;
  result.bound = cover.bound(corners, near, 0);
  result.pieces = cover.pieces();
  return result;
}

}  // namespace iso
