#include "tess/domain_overlap.h"

#include "tess/box_tree.h"
#include "tess/predicates.h"

namespace iso {
namespace {

using PlaneTriangle = std::array<UV, 3>;

// Whether r is not to the left of the line from p to q. Common corners are told without arithmetic: most pairs are neighbours.
bool is_outside(const UV& p, const UV& q, const UV& r) { return r == p || r == q || orientation(p, q, r) <= 0; }

// Whether the line through some side of a has b on its outer side. Both counter-clockwise.
bool side_separates(const PlaneTriangle& a, const PlaneTriangle& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    const UV &p = a[k], &q = a[(k + 1) % 3];
    if (is_outside(p, q, b[0]) && is_outside(p, q, b[1]) && is_outside(p, q, b[2])) return true;
  }
  return false;
}

// The interiors of two convex polygons are disjoint just if the line through a side of one of them separates them.
bool interiors_meet(const PlaneTriangle& a, const PlaneTriangle& b) { return !side_separates(a, b) && !side_separates(b, a); }

bool boxes_meet(const Box2& a, const Box2& b) { return a.lo.x < b.hi.x && b.lo.x < a.hi.x && a.lo.y < b.hi.y && b.lo.y < a.hi.y; }

}  // namespace

DomainOverlap domain_overlap(std::span<const PlaneTriangle> triangles, int way) {
  // All counter-clockwise from here on, whichever way they ran.
  DomainOverlap result;
  std::vector<PlaneTriangle> turned(triangles.begin(), triangles.end());
  std::vector<bool> has_area(triangles.size(), true);
  std::vector<Box2> boxes(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const int runs = orientation(turned[i][0], turned[i][1], turned[i][2]);
    if (runs != way) result.turned.push_back(i);
    if (runs < 0) std::swap(turned[i][1], turned[i][2]);
    has_area[i] = runs != 0;
    for (const UV& uv : turned[i]) boxes[i].include(uv);
  }

  const BoxTree<Vec2> tree(std::move(boxes));
  for (std::uint32_t i = 0; i < turned.size(); ++i) {
    if (!has_area[i]) continue;
    std::vector<std::uint32_t> met;
    tree.for_each_touching(tree.box(i), [&](std::uint32_t j) {
      if (j > i && has_area[j] && met.size() < DomainOverlap::kMostPairs && boxes_meet(tree.box(i), tree.box(j)) &&
          interiors_meet(turned[i], turned[j]))
        met.push_back(j);
    });
    std::sort(met.begin(), met.end());
    for (const std::uint32_t j : met) result.overlapping.push_back({i, j});
  }
  return result;
}

}  // namespace iso
