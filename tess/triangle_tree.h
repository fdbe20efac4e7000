// Finds the triangle nearest to a point among millions: a tree of boxes over their middles, halved along the widest axis, without pointers.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "patches/triangle_mesh.h"
#include "tess/triangle_distance.h"

namespace iso {

class TriangleTree {
 public:
  struct Nearest {
    std::uint32_t triangle = kNone;
    Vec3 weights{0.0};  // barycentric
    Point3 point{0.0};
    double distance = kInf;
  };
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Both arrays must stay where they are; indices must be valid, coordinates finite. Built with all threads.
  TriangleTree(std::span<const Point3> points, std::span<const PointTriangle> triangles);

  // The nearest point of all triangles; of equally near ones that of the smallest index. A `hint` (a triangle that is near) makes it
  // faster. Without triangles: none, at an infinite distance.
  Nearest nearest(const Point3& p, std::uint32_t hint = kNone) const {
    return nearest_where(p, hint, [](std::uint32_t) { return true; });
  }

  // The same among those triangles that `admits`; the hint must be one of them.
  template <class F>
  Nearest nearest_where(const Point3& p, std::uint32_t hint, F admits) const;

  // The nearest point of one triangle.
  Nearest on(std::uint32_t triangle, const Point3& p) const;

  // Calls f(triangle) for all whose box has a point in common with `query`, in an order that depends on the triangles only.
  template <class F>
  void for_each_touching(const Box3& query, F f) const;

 private:
  static constexpr std::size_t kLeaf = 4;  // triangles, at most
  static constexpr int kDeepest = 40;

  // Of node i of level L (the root is level 0): the triangles [i n / 2^L, (i + 1) n / 2^L) of order_; its halves are 2 i and 2 i + 1 below.
  std::size_t begin_of(int level, std::size_t i) const { return (i * order_.size()) >> level; }
  const Box3& box(int level, std::size_t i) const { return boxes_[(std::size_t{1} << level) - 1 + i]; }
  Box3 box_of(std::uint32_t triangle) const;
  void build(int level, std::size_t i, std::span<const Point3> middles);

  static double squared_distance(const Box3& box, const Point3& p) {
    const Vec3 d = glm::max(glm::max(box.lo - p, p - box.hi), Vec3(0.0));
    return glm::dot(d, d);
  }

  std::span<const Point3> points_;
  std::span<const PointTriangle> triangles_;
  int levels_ = 0;  // of the leaves
  std::vector<std::uint32_t> order_;
  std::vector<Box3> boxes_;
};

template <class F>
TriangleTree::Nearest TriangleTree::nearest_where(const Point3& p, std::uint32_t hint, F admits) const {
  Nearest best;
  if (order_.empty()) return best;
  if (hint != kNone) best = on(hint, p);
  struct Waiting {
    double squared;
    int level;
    std::size_t i;
  };
  Waiting stack[kDeepest];
  int waiting = 0;
  stack[waiting++] = {squared_distance(box(0, 0), p), 0, 0};
  while (waiting > 0) {
    const Waiting node = stack[--waiting];
    if (node.squared > best.distance * best.distance) continue;
    if (node.level == levels_) {
      for (std::size_t k = begin_of(levels_, node.i); k < begin_of(levels_, node.i + 1); ++k) {
        if (!admits(order_[k])) continue;
        const Nearest other = on(order_[k], p);
        if (other.distance < best.distance || (other.distance == best.distance && other.triangle < best.triangle)) best = other;
      }
      continue;
    }
    // The nearer half is looked at first.
    Waiting halves[2];
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t i = 2 * node.i + k;
      halves[k] = {squared_distance(box(node.level + 1, i), p), node.level + 1, i};
    }
    if (halves[0].squared < halves[1].squared) std::swap(halves[0], halves[1]);
    stack[waiting++] = halves[0];
    stack[waiting++] = halves[1];
  }
  return best;
}

template <class F>
void TriangleTree::for_each_touching(const Box3& query, F f) const {
  const auto touch = [&](const Box3& b) {
    for (int k = 0; k < 3; ++k)
      if (query.hi[k] < b.lo[k] || b.hi[k] < query.lo[k]) return false;
    return true;
  };
  if (order_.empty()) return;
  std::pair<int, std::size_t> stack[kDeepest];
  int waiting = 0;
  stack[waiting++] = {0, 0};
  while (waiting > 0) {
    const auto [level, i] = stack[--waiting];
    if (!touch(box(level, i))) continue;
    if (level == levels_) {
      for (std::size_t k = begin_of(level, i); k < begin_of(level, i + 1); ++k)
        if (touch(box_of(order_[k]))) f(order_[k]);
      continue;
    }
    stack[waiting++] = {level + 1, 2 * i + 1};
    stack[waiting++] = {level + 1, 2 * i};
  }
}

}  // namespace iso
