// Where a line may meet a rational Bezier patch: the patch is halved until the boxes of its parts are tiny, and every part whose box the
// line passes is kept. Slow and obviously right: it cannot miss a meeting, and what it names is one to within the size of the last boxes.
#pragma once

#include <algorithm>
#include <vector>

#include "patches/surface/bezier_patch.h"

namespace iso::reference {

// A stretch of the line, in t, in which last boxes lie.
struct Stretch {
  double lo, hi;
};

// The part of a line inside a box; false if there is none.
inline bool line_in_box(const Box3& box, const Vec3& o, const Vec3& d, double& lo, double& hi) {
  lo = -kInf;
  hi = kInf;
  for (int c = 0; c < 3; ++c) {
    if (d[c] == 0) {
      if (o[c] < box.lo[c] || o[c] > box.hi[c]) return false;
      continue;
    }
    const double a = (box.lo[c] - o[c]) / d[c], b = (box.hi[c] - o[c]) / d[c];
    lo = std::max(lo, std::min(a, b));
    hi = std::min(hi, std::max(a, b));
  }
  return lo <= hi;
}

// d is a unit vector. Boxes end at the diagonal `smallest`; stretches nearer together than `smallest` are one.
inline std::vector<Stretch> stretches(const BezierPatch& patch, const Vec3& o, const Vec3& d, double smallest) {
  std::vector<BezierPatch> stack{patch};
  std::vector<Stretch> found;
  while (!stack.empty()) {
    const BezierPatch part = std::move(stack.back());
    stack.pop_back();
    const Box3 box = hull_box(part);
    double lo, hi;
    if (!line_in_box(box.inflated(1e-13 * smallest + 1e-15 * glm::length(box.middle())), o, d, lo, hi)) continue;
    if (box.diagonal() <= smallest) {
      found.push_back({lo, hi});
      continue;
    }
    // Across the direction in which the net is longer.
    double along_s = 0, along_t = 0;
    for (int a = 0; a <= part.pu; ++a)
      for (int b = 0; b <= part.pv; ++b) {
        if (a > 0) along_s = std::max(along_s, part.pu * glm::length(project(part.at(a, b)) - project(part.at(a - 1, b))));
        if (b > 0) along_t = std::max(along_t, part.pv * glm::length(project(part.at(a, b)) - project(part.at(a, b - 1))));
      }
    BezierPatch low, high;
    split_in_half(part, along_s >= along_t ? 0 : 1, low, high);
    stack.push_back(std::move(high));
    stack.push_back(std::move(low));
  }
  std::sort(found.begin(), found.end(), [](const Stretch& a, const Stretch& b) { return a.lo < b.lo; });
  std::vector<Stretch> out;
  for (const Stretch& s : found) {
    if (!out.empty() && s.lo <= out.back().hi + smallest)
      out.back().hi = std::max(out.back().hi, s.hi);
    else
      out.push_back(s);
  }
  return out;
}

}  // namespace iso::reference
