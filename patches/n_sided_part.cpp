#include "patches/n_sided_part.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "patches/base/check.h"

namespace iso {
namespace {

// ---- the sides, and which of them are one --------------------------------------------------------------------------------

// The boundary curve of a side as a rational Bezier curve.
std::vector<Vec4> side_curve(const NSidedPatch& patch, int side) {
  std::vector<Vec4> curve;
  for (const int m : points_of_side(patch.basis, side)) {
    const auto i = static_cast<std::size_t>(m);
    curve.push_back(homogeneous(patch.points[i], patch.weights.empty() ? 1.0 : patch.weights[i]));
  }
  return curve;
}

// The same curve, one degree higher [Farin 2002, 5.1].
std::vector<Vec4> elevated(const std::vector<Vec4>& curve) {
  const auto n = static_cast<double>(curve.size());
  std::vector<Vec4> raised{curve.front()};
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double share = static_cast<double>(i) / n;
    raised.push_back(share * curve[i - 1] + (1 - share) * curve[i]);
  }
  raised.push_back(curve.back());
  return raised;
}

struct Side {
  int patch, side;
  long long from = -1, to = -1;  // vertices, -1: not known
  std::vector<Vec4> curve;
  bool point = false;     // collapsed
  int group = -1;         // sides of one group are one
  bool backward = false;  // against the direction of its group

  bool by_place() const { return from < 0 && !point; }
  Point3 middle() const {
    std::vector<Vec4> work = curve;
    for (std::size_t left = work.size() - 1; left > 0; --left)
      for (std::size_t i = 0; i < left; ++i) work[i] = 0.5 * (work[i] + work[i + 1]);
    return project(work[0]);
  }
};

double size_of(const std::vector<Side>& sides) {
  Box3 box;
  for (const Side& s : sides)
    for (const Vec4& h : s.curve) box.include(project(h));
  return box.empty() ? 0.0 : box.diagonal();
}

std::vector<Side> sides_of(const std::vector<PatchEntry>& patches) {
  std::vector<Side> sides;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const PatchEntry& entry = patches[p];
    const int n = entry.patch.basis.sides;
    ISO_CHECK(entry.corners.empty() || entry.corners.size() == static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) {
      Side s{.patch = static_cast<int>(p), .side = k, .curve = side_curve(entry.patch, k)};
      if (!entry.corners.empty()) {
        s.from = entry.corners[static_cast<std::size_t>((k + n - 1) % n)];
        s.to = entry.corners[static_cast<std::size_t>(k)];
      }
      sides.push_back(std::move(s));
    }
  }
  return sides;
}

bool is_point(const Side& s, double near) {
  return std::all_of(s.curve.begin(), s.curve.end(), [&](const Vec4& h) { return glm::length(project(h) - project(s.curve[0])) <= near; });
}

// Whether two curves are one, b run through backward or not.
bool same_curve(std::vector<Vec4> a, std::vector<Vec4> b, bool backward, double near) {
  while (a.size() < b.size()) a = elevated(a);
  while (b.size() < a.size()) b = elevated(b);
  if (backward) std::reverse(b.begin(), b.end());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (glm::length(project(a[i]) - project(b[i])) > near) return false;
    if (std::abs(weight(a[i]) / weight(a[0]) - weight(b[i]) / weight(b[0])) > kSameSide) return false;
  }
  return true;
}

void group_by_vertices(std::vector<Side>& sides, int& groups) {
  std::map<std::pair<long long, long long>, int> known;
  for (Side& s : sides) {
    if (s.from < 0 || s.point || s.from == s.to) continue;
    const auto [at, is_new] = known.try_emplace(std::minmax(s.from, s.to), groups);
    groups += is_new;
    s.group = at->second;
    s.backward = s.from > s.to;
  }
}

// Sides that are one have one middle: they are looked for among those whose middles are near in x.
void group_by_place(std::vector<Side>& sides, double near, int& groups) {
  struct Middle {
    Point3 at;
    std::size_t side;
  };
  std::vector<Middle> middles;
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (sides[i].by_place()) middles.push_back({sides[i].middle(), i});
  std::sort(middles.begin(), middles.end(),
            [](const Middle& a, const Middle& b) { return std::pair(a.at.x, a.side) < std::pair(b.at.x, b.side); });
  for (std::size_t i = 0; i < middles.size(); ++i) {
    Side& first = sides[middles[i].side];
    if (first.group >= 0) continue;
    first.group = groups++;
    for (std::size_t j = i + 1; j < middles.size() && middles[j].at.x - middles[i].at.x <= 2 * near; ++j) {
      Side& other = sides[middles[j].side];
      if (other.group >= 0 || glm::length(middles[j].at - middles[i].at) > 2 * near) continue;
      const bool backward = same_curve(first.curve, other.curve, true, near);
      if (!backward && !same_curve(first.curve, other.curve, false, near)) continue;
      other.group = first.group;
      other.backward = backward;
    }
  }
}

// ---- closed solids ---------------------------------------------------------------------------------------------------------

int root_of(std::vector<int>& parent, int i) {
  while (parent[static_cast<std::size_t>(i)] != i)
    i = parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
  return i;
}

// Connected patches of which every side, points aside, is used once each way.
void find_solids(const std::vector<Side>& sides, int groups, std::size_t patches, PatchEdges& found) {
  struct Uses {
    int first = -1, forward = 0, backward = 0;
  };
  std::vector<Uses> uses(static_cast<std::size_t>(groups));
  std::vector<int> parent(patches);
  std::iota(parent.begin(), parent.end(), 0);
  for (const Side& s : sides) {
    if (s.group < 0) continue;
    Uses& u = uses[static_cast<std::size_t>(s.group)];
    (s.backward ? u.backward : u.forward)++;
    if (u.first < 0) u.first = s.patch;
    parent[static_cast<std::size_t>(root_of(parent, s.patch))] = root_of(parent, u.first);
  }
  std::vector<bool> open(patches, false);
  for (const Side& s : sides) {
    const bool closed = s.point || (s.group >= 0 && uses[static_cast<std::size_t>(s.group)].forward == 1 &&
                                    uses[static_cast<std::size_t>(s.group)].backward == 1);
    if (!closed) open[static_cast<std::size_t>(root_of(parent, s.patch))] = true;
  }
  std::vector<int> number(patches, -1);
  for (std::size_t p = 0; p < patches; ++p) {
    const auto root = static_cast<std::size_t>(root_of(parent, static_cast<int>(p)));
    if (!open[root] && number[root] < 0) number[root] = found.solids++;
    found.solid_of_patch.push_back(open[root] ? -1 : number[root]);
  }
}

// ---- edges -----------------------------------------------------------------------------------------------------------------

// The half sides of every side: [0] at the corner before it, [1] at its own.
std::vector<std::array<int, 2>> half_sides(const std::vector<Side>& sides, int groups, std::vector<Edge>& edges) {
  std::vector<int> first_of_group(static_cast<std::size_t>(groups), -1);
  std::vector<std::array<int, 2>> halves;
  for (const Side& s : sides) {
    int fresh = -1;
    int& first = s.group >= 0 ? first_of_group[static_cast<std::size_t>(s.group)] : fresh;
    if (first < 0) {
      first = static_cast<int>(edges.size());
      edges.resize(edges.size() + 2);
    }
    for (const int end : {0, 1}) edges[static_cast<std::size_t>(first + end)].degenerate = s.point;
    halves.push_back({first + (s.backward ? 1 : 0), first + (s.backward ? 0 : 1)});
  }
  return halves;
}

TrimCurve straight(const UV& origin, const UV& direction, bool backward, int edge) {
  return {Line<Vec2>{origin, direction}, backward ? 1.0 : 0.0, backward ? 0.0 : 1.0, edge};
}

// Half sides run away from the corner, spokes toward the centre (1, 1).
TrimLoop loop_of_chart(const std::array<int, 4>& edges) {
  return {{straight({0, 0}, {1, 0}, false, edges[0]), straight({1, 0}, {0, 1}, false, edges[1]), straight({0, 1}, {1, 0}, true, edges[2]),
           straight({0, 0}, {0, 1}, true, edges[3])}};
}

}  // namespace

PatchEdges edges_of_patches(const std::vector<PatchEntry>& patches) {
  std::vector<Side> sides = sides_of(patches);
  const double near = kSameSide * size_of(sides);
  for (Side& s : sides) s.point = is_point(s, near);
  int groups = 0;
  group_by_vertices(sides, groups);
  group_by_place(sides, near, groups);

  PatchEdges found;
  find_solids(sides, groups, patches.size(), found);
  const std::vector<std::array<int, 2>> halves = half_sides(sides, groups, found.edges);
  for (const PatchEntry& entry : patches) {
    // Chart k lies between side k + 1, which begins at its corner, and side k, which ends there.
    const int n = entry.patch.basis.sides, spokes = static_cast<int>(found.edges.size());
    const std::size_t first_side = found.first_chart.back();
    found.edges.resize(found.edges.size() + static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) {
      const int next = (k + 1) % n;
      const std::array<int, 4> loop{halves[first_side + static_cast<std::size_t>(next)][0], spokes + next, spokes + k,
                                    halves[first_side + static_cast<std::size_t>(k)][1]};
      for (const int edge : loop) ++found.edges[static_cast<std::size_t>(edge)].uses;
      found.of_chart.push_back(loop);
    }
    found.first_chart.push_back(first_side + static_cast<std::size_t>(n));
  }
  return found;
}

Part part_of_patches(std::string name, const std::vector<PatchEntry>& patches) {
  PatchEdges edges = edges_of_patches(patches);
  Part part;
  part.name = std::move(name);
  part.edges = std::move(edges.edges);
  part.solids = edges.solids;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const PatchEntry& entry = patches[p];
    const std::string patch_name = entry.name.empty() ? "patch " + std::to_string(p + 1) : entry.name;
    for (int k = 0; k < entry.patch.basis.sides; ++k) {
      PatchChart chart = chart_of(entry.patch, k);
      chart.patch = static_cast<int>(p);
      Face face;
      face.surface = std::move(chart);
      face.loops.push_back(loop_of_chart(edges.of_chart[edges.first_chart[p] + static_cast<std::size_t>(k)]));
      face.domain = {Vec2(0.0), Vec2(1.0)};
      face.colour = entry.colour;
      face.name = patch_name + ", corner " + std::to_string(k + 1);
      face.solid = edges.solid_of_patch[p];
      face.approximation_error = entry.approximation_error;
      part.faces.push_back(std::move(face));
    }
  }
  return part;
}

}  // namespace iso
