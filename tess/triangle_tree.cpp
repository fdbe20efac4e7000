#include "tess/triangle_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace iso {

TriangleTree::TriangleTree(std::span<const Point3> points, std::span<const PointTriangle> triangles)
    : points_(points), triangles_(triangles), order_(triangles.size()) {
  if (triangles.empty()) return;
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<Point3> middles(triangles.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t i) { middles[i] = box_of(static_cast<std::uint32_t>(i)).middle(); });
  while ((order_.size() >> levels_) > kLeaf) ++levels_;
  boxes_.resize((std::size_t{2} << levels_) - 1);
  build(0, 0, middles);
}

void TriangleTree::build(int level, std::size_t i, std::span<const Point3> middles) {
  const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  const std::size_t begin = begin_of(level, i), end = begin_of(level, i + 1);
  Box3 all;
  if (level == levels_) {
    for (std::size_t k = begin; k < end; ++k) all.include(box_of(order_[k]));
  } else {
    Box3 spread;
    for (std::size_t k = begin; k < end; ++k) spread.include(middles[order_[k]]);
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (spread.size()[k] > spread.size()[axis]) axis = k;
    std::nth_element(at(begin), at(begin_of(level + 1, 2 * i + 1)), at(end),
                     [&](std::uint32_t a, std::uint32_t b) { return std::pair(middles[a][axis], a) < std::pair(middles[b][axis], b); });
    constexpr std::size_t kWorthAThread = 4096;
    const auto half = [&](std::size_t k) { build(level + 1, 2 * i + k, middles); };
    if (end - begin > kWorthAThread) {
      tbb::parallel_invoke([&] { half(0); }, [&] { half(1); });
    } else {
      half(0);
      half(1);
    }
    all = box(level + 1, 2 * i);
    all.include(box(level + 1, 2 * i + 1));
  }
  boxes_[(std::size_t{1} << level) - 1 + i] = all;
}

Box3 TriangleTree::box_of(std::uint32_t triangle) const {
  Box3 box;
  for (std::uint32_t p : triangles_[triangle]) box.include(points_[p]);
  return box;
}

TriangleTree::Nearest TriangleTree::on(std::uint32_t triangle, const Point3& p) const {
  const PointTriangle& t = triangles_[triangle];
  const Point3 &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
  Nearest found{triangle, nearest_in_triangle(p, a, b, c), {}, 0};
  found.point = found.weights.x * a + found.weights.y * b + found.weights.z * c;
  found.distance = glm::length(found.point - p);
  return found;
}

}  // namespace iso
