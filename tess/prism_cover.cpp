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

class Cover {
 public:
  Cover(const TriangleTree& tree, std::span<const Point3> points, std::span<const PointTriangle> triangles, double enough)
      : tree_(tree), points_(points), triangles_(triangles), enough_(enough) {}

  double bound(const std::array<Point3, 3>& t, const std::array<double, 3>& near, int depth);
  int pieces() const { return pieces_; }

 private:
  static constexpr int kMostDepth = 4;              // of quartering
  static constexpr std::size_t kMostNearby = 1024;  // triangles before one; with more it is quartered
  static constexpr double kThin = 1e-12;            // of the triangle's size: thinner pieces are rounding

  double along(const Point3& a, const Point3& b, int depth);
  double quartered(const std::array<Point3, 3>& t, const std::array<double, 3>& near, int depth);
  bool thin(const Polygon& q) const;
  bool project(std::uint32_t triangle, Vec2 (&f)[3]) const;
  void cover_with(const Vec2 (&f)[3], std::uint32_t triangle);
  double farthest(const Polygon& q, std::uint32_t triangle) const;
  double left_over();

  const TriangleTree& tree_;
  std::span<const Point3> points_;
  std::span<const PointTriangle> triangles_;
  double enough_;
  int pieces_ = 0;

  // Of the triangle at hand.
  Point3 O_{0.0};
  Vec3 X_{0.0}, Y_{0.0};
  double size_ = 0, limit_ = 0, most_ = 0;
  Polygon whole_;
  std::vector<Polygon> open_, next_;
  std::vector<std::uint32_t> nearby_;
};

bool Cover::thin(const Polygon& q) const {
  if (q.count < 3) return true;
  double area = 0, longest = 0;
  for (int i = 1; i + 1 < q.count; ++i) area += cross(q.at[i] - q.at[0], q.at[i + 1] - q.at[0]);
  for (int i = 0; i < q.count; ++i) longest = std::max(longest, glm::length(q.at[(i + 1) % q.count] - q.at[i]));
  return !(std::abs(area) > kThin * size_ * longest);
}

double Cover::farthest(const Polygon& q, std::uint32_t triangle) const {
  double most = 0;
  for (int i = 0; i < q.count; ++i) most = std::max(most, tree_.on(triangle, O_ + q.at[i].x * X_ + q.at[i].y * Y_).distance);
  return most;
}

// The corners of a triangle of the tree in the plane, counter-clockwise; whether it lies before the triangle at hand at all.
bool Cover::project(std::uint32_t triangle, Vec2 (&f)[3]) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 d = points_[triangles_[triangle][k]] - O_;
    f[k] = {glm::dot(d, X_), glm::dot(d, Y_)};
  }
  const double area = cross(f[1] - f[0], f[2] - f[0]);
  if (!(std::abs(area) > kThin * size_ * size_)) return false;  // seen from its edge
  if (area < 0) std::swap(f[1], f[2]);
  for (int k = 0; k < 3; ++k) {
    const Vec2 a = whole_.at[k], d = whole_.at[(k + 1) % 3] - a;
    if (cross(d, f[0] - a) <= 0 && cross(d, f[1] - a) <= 0 && cross(d, f[2] - a) <= 0) return false;
  }
  return true;
}

// Takes from the open polygons what lies before a triangle, unless that is farther than the limit.
void Cover::cover_with(const Vec2 (&f)[3], std::uint32_t triangle) {
  const Vec2 lo = glm::min(glm::min(f[0], f[1]), f[2]), hi = glm::max(glm::max(f[0], f[1]), f[2]);
  next_.clear();
  for (const Polygon& q : open_) {
    Vec2 qlo(kInf), qhi(-kInf);
    for (int i = 0; i < q.count; ++i) qlo = glm::min(qlo, q.at[i]), qhi = glm::max(qhi, q.at[i]);
    const bool apart = qhi.x < lo.x || hi.x < qlo.x || qhi.y < lo.y || hi.y < qlo.y;
    if (apart || q.count + 3 >= Polygon::kMost) {
      next_.push_back(q);
      continue;
    }
    Polygon inside = q, left, outside[3];
    int parts = 0;
    for (int k = 0; k < 3 && !thin(inside); ++k) {
      cut(inside, f[k], f[(k + 1) % 3] - f[k], left, outside[parts]);
      inside = left;
      if (!thin(outside[parts])) ++parts;
    }
    const double most = thin(inside) ? kInf : farthest(inside, triangle);
    if (most > limit_) {
      next_.push_back(q);
      continue;
    }
    most_ = std::max(most_, most);
    ++pieces_;
    for (int k = 0; k < parts; ++k) next_.push_back(outside[k]);
  }
  open_.swap(next_);
}

// What no triangle lies before, or only far ones: before the nearest one, halved where that is too loose.
double Cover::left_over() {
  constexpr int kMostHalvings = 4096;
  double most = 0;
  for (int i = 0; !open_.empty() && i < kMostHalvings; ++i) {
    const Polygon q = open_.back();
    open_.pop_back();
    Vec2 middle(0.0);
    for (int k = 0; k < q.count; ++k) middle += q.at[k] / double(q.count);
    const TriangleTree::Nearest near = tree_.nearest(O_ + middle.x * X_ + middle.y * Y_);
    double around = 0;
    for (int k = 0; k < q.count; ++k) around = std::max(around, glm::length(q.at[k] - middle));
    const double bound = std::min(farthest(q, near.triangle), near.distance + around);
    ++pieces_;
    if (bound <= limit_ || i + 1 + static_cast<int>(open_.size()) >= kMostHalvings || q.count + 1 >= Polygon::kMost) {
      most = std::max(most, bound);
      continue;
    }
    // Across the longest way from the middle.
    Vec2 along(0.0);
    for (int k = 0; k < q.count; ++k)
      if (glm::length(q.at[k] - middle) >= glm::length(along)) along = q.at[k] - middle;
    Polygon left, right;
    cut(q, middle, Vec2(-along.y, along.x), left, right);
    if (!thin(left)) open_.push_back(left);
    if (!thin(right)) open_.push_back(right);
  }
  return most;
}

double Cover::quartered(const std::array<Point3, 3>& t, const std::array<double, 3>& near, int depth) {
  std::array<Point3, 3> m;
  std::array<double, 3> d;
  for (std::size_t k = 0; k < 3; ++k) {
    m[k] = 0.5 * (t[(k + 1) % 3] + t[(k + 2) % 3]);
    d[k] = tree_.nearest(m[k]).distance;
  }
  double most = bound(m, d, depth + 1);
  for (std::size_t k = 0; k < 3; ++k)
    most = std::max(most, bound({t[k], m[(k + 2) % 3], m[(k + 1) % 3]}, {near[k], d[(k + 2) % 3], d[(k + 1) % 3]}, depth + 1));
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

double Cover::bound(const std::array<Point3, 3>& t, const std::array<double, 3>& near, int depth) {
  const Vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  double longest = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (const double side = glm::length(t[(k + 1) % 3] - t[k]); side > longest) longest = side, at = k;
  const double farthest_corner = std::max({near[0], near[1], near[2]});
  if (!(glm::length(n) > kThin * longest * longest)) return along(t[at], t[(at + 1) % 3], 0);
  // What is farther than this is no help: the bound would not be tight.
  const double middle = tree_.nearest((t[0] + t[1] + t[2]) / 3.0).distance;
  const double rounding = 16 * kEps * (longest + std::max({std::abs(t[0].x), std::abs(t[0].y), std::abs(t[0].z)}));
  const double reach = std::max(enough_, 2 * std::max(farthest_corner, middle) + kThin * longest + rounding);
  Box3 box;
  for (const Point3& p : t) box.include(p);
  nearby_.clear();
  tree_.for_each_touching(box.inflated(reach), [&](std::uint32_t i) { nearby_.push_back(i); });
  O_ = t[0];
  X_ = (t[(at + 1) % 3] - t[at]) / longest;
  Y_ = glm::normalize(glm::cross(n, X_));
  size_ = longest;
  most_ = 0;
  whole_.count = 0;
  for (const Point3& p : t) whole_.add({glm::dot(p - O_, X_), glm::dot(p - O_, Y_)});
  Vec2 f[3];
  std::erase_if(nearby_, [&](std::uint32_t i) { return !project(i, f); });
  if (nearby_.size() > kMostNearby && depth < kMostDepth) return quartered(t, near, depth);
  open_.assign(1, whole_);
  limit_ = reach;
  for (std::uint32_t i : nearby_) {
    if (open_.empty()) break;
    project(i, f);
    cover_with(f, i);
  }
  const double covered = most_;
  return open_.empty() ? covered : std::max(covered, left_over());
}

}  // namespace

CoverBound cover_bound(const TriangleTree& tree, std::span<const Point3> points, std::span<const PointTriangle> triangles,
                       const std::array<Point3, 3>& corners, const std::array<double, 3>& near, double enough) {
  Cover cover(tree, points, triangles, enough);
  CoverBound result;
  result.bound = cover.bound(corners, near, 0);
  result.pieces = cover.pieces();
  return result;
}

}  // namespace iso
