#include "tess/topology.h"

#include <tbb/parallel_sort.h>

#include <numeric>

#include "patches/base/check.h"
#include "tess/box_tree.h"

namespace iso {
namespace {

// One triangle's use of the edge between two points; `corner` is 3 * triangle + k, where it starts.
struct EdgeUse {
  std::uint32_t lo = 0, hi = 0, corner = 0;
  auto operator<=>(const EdgeUse&) const = default;
};

std::uint32_t next_of(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

// Corners joined to fans.
class Fans {
 public:
  explicit Fans(std::size_t corners) : parent_(corners) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

class Check {
 public:
  Check(std::span<const Point3> points, std::span<const PointTriangle> triangles) : points_(points), triangles_(triangles) {
    ISO_CHECK(points.size() < 0xffffffffu && triangles.size() < 0xffffffffu / 3);
    for (const Point3& p : points) ISO_CHECK(finite(p));
    for (const PointTriangle& t : triangles)
      for (const std::uint32_t p : t) ISO_CHECK(p < points.size());
    report_.points = points.size();
    report_.triangles = triangles.size();
  }

  TopologyReport run(const TopologyOptions& options, std::vector<OpenEdge>* open_edges) {
    check_areas();
    check_edges();
    check_points();
    check_duplicates();
    check_t_junctions(options.t_junction_distance);
    if (open_edges) *open_edges = std::move(open_);
    return std::move(report_);
  }

 private:
  std::uint32_t point_of(std::uint32_t corner) const { return triangles_[corner / 3][corner % 3]; }
  const Point3& place_of(std::uint32_t corner) const { return points_[point_of(corner)]; }
  bool is_proper(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return a != b && b != c && c != a;
  }
  MeshPlace middle_of_triangle(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return {(points_[a] + points_[b] + points_[c]) / 3.0, static_cast<std::int64_t>(t), -1};
  }
  MeshPlace middle_of_edge(std::uint32_t corner) const { return {0.5 * (place_of(corner) + place_of(next_of(corner))), corner / 3, -1}; }

  void check_areas() {
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto& [a, b, c] = triangles_[t];
      if (!is_proper(t) || has_no_area(points_[a], points_[b], points_[c])) report_.zero_area.add(middle_of_triangle(t));
    }
  }

  void check_edges() {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles_.size());
    for (std::uint32_t c = 0; c < 3 * triangles_.size(); ++c) {
      if (!is_proper(c / 3)) continue;
      const auto [lo, hi] = std::minmax({point_of(c), point_of(next_of(c))});
      uses.push_back({lo, hi, c});
    }
    tbb::parallel_sort(uses.begin(), uses.end());
    fans_ = Fans(3 * triangles_.size());
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
      for (end = begin + 1; end < uses.size() && uses[end].lo == uses[begin].lo && uses[end].hi == uses[begin].hi;) ++end;
      check_edge(std::span(uses).subspan(begin, end - begin));
    }
  }

  void check_edge(std::span<const EdgeUse> uses) {
    ++report_.edges;
    const std::uint32_t first = uses[0].corner;
    if (uses.size() == 1) {
      report_.open_edges.add(middle_of_edge(first));
      open_.push_back({first / 3, static_cast<int>(first % 3)});
    }
    if (uses.size() > 2) report_.non_manifold_edges.add(middle_of_edge(first));
    if (uses.size() == 2 && point_of(first) == point_of(uses[1].corner)) report_.misoriented_edges.add(middle_of_edge(first));
    for (const EdgeUse& use : uses) {
      const bool same = point_of(use.corner) == point_of(first);
      fans_.join(first, same ? use.corner : next_of(use.corner));
      fans_.join(next_of(first), same ? next_of(use.corner) : use.corner);
    }
  }

  void check_points() {
    std::vector<std::uint32_t> fans(points_.size());
    std::vector<std::uint32_t> triangle(points_.size());
    for (std::uint32_t c = 0; c < 3 * triangles_.size(); ++c)
      if (is_proper(c / 3) && fans_.root(c) == c) {
        ++fans[point_of(c)];
        triangle[point_of(c)] = c / 3;
      }
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (fans[p] == 0) report_.isolated_points.add({points_[p], -1, -1});
      if (fans[p] > 1) report_.non_manifold_points.add({points_[p], triangle[p], -1});
    }
  }

  void check_duplicates() {
    std::vector<std::pair<PointTriangle, std::uint32_t>> sorted;
    sorted.reserve(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      PointTriangle key = triangles_[t];
      std::sort(key.begin(), key.end());
      if (is_proper(t)) sorted.emplace_back(key, t);
    }
    tbb::parallel_sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first) report_.duplicates.add(middle_of_triangle(sorted[i].second));
  }

  // Each end of an open edge against all open edges that it is not an end of.
  void check_t_junctions(double distance) {
    if (distance == 0)
      for (const Point3& p : points_)
        for (int k = 0; k < 3; ++k) distance = std::max(distance, 16 * kEps * std::abs(p[k]));
    std::vector<Box3> boxes;
    std::vector<std::uint32_t> ends;
    for (const OpenEdge& e : open_) {
      const std::uint32_t c = 3 * e.triangle + static_cast<std::uint32_t>(e.corner);
      boxes.emplace_back().include(place_of(c));
      boxes.back().include(place_of(next_of(c)));
      ends.insert(ends.end(), {point_of(c), point_of(next_of(c))});
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    const BoxTree<Vec3> tree(std::move(boxes));
    for (const std::uint32_t p : ends) {
      std::vector<std::uint32_t> inside;
      tree.for_each_touching(Box3{points_[p], points_[p]}.inflated(distance), [&](std::uint32_t i) {
        if (is_inside(p, open_[i], distance)) inside.push_back(open_[i].triangle);
      });
      if (!inside.empty()) report_.t_junctions.add({points_[p], *std::min_element(inside.begin(), inside.end()), -1});
    }
  }

  bool is_inside(std::uint32_t point, const OpenEdge& e, double distance) const {
    const std::uint32_t c = 3 * e.triangle + static_cast<std::uint32_t>(e.corner);
    if (point == point_of(c) || point == point_of(next_of(c))) return false;
    const Point3 a = place_of(c), b = place_of(next_of(c)), p = points_[point];
    if (glm::length(p - a) <= distance || glm::length(p - b) <= distance) return false;
    const double along = glm::dot(p - a, b - a) / glm::dot(b - a, b - a);
    return along > 0 && along < 1 && glm::length(p - (a + along * (b - a))) <= distance;
  }

  std::span<const Point3> points_;
  std::span<const PointTriangle> triangles_;
  Fans fans_{0};
  std::vector<OpenEdge> open_;
  TopologyReport report_;
};

}  // namespace

bool TopologyReport::sound() const {
  for (const Finding* f : {&non_manifold_edges, &misoriented_edges, &non_manifold_points, &zero_area, &duplicates, &t_junctions})
    if (f->count != 0) return false;
  return true;
}

bool has_no_area(const Point3& a, const Point3& b, const Point3& c) {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max({size, std::abs(a[k]), std::abs(b[k]), std::abs(c[k])});
  const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  return !(glm::length(glm::cross(b - a, c - a)) > kHeightRounding * size * longest);
}

TopologyReport check_topology(std::span<const Point3> points, std::span<const PointTriangle> triangles, const TopologyOptions& options,
                              std::vector<OpenEdge>* open_edges) {
  return Check(points, triangles).run(options, open_edges);
}

std::vector<std::uint32_t> joined_points(std::span<const Point3> points) {
  std::vector<std::uint32_t> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) { return std::array{points[i].x, points[i].y, points[i].z}; };
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto x = key(a), y = key(b);
    return x != y ? x < y : a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

}  // namespace iso
