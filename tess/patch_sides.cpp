#include "tess/patch_sides.h"

#include <map>
#include <numeric>

namespace iso {
namespace {

// The edge of a half side: along t = 0 (the first curve of the loop) or s = 0 (the last); -1: none.
int edge_of(const Face& chart, bool along_t) {
  if (chart.loops.size() != 1 || chart.loops[0].curves.size() != 4) return -1;
  return chart.loops[0].curves[along_t ? 3 : 0].edge;
}

int root_of(std::vector<int>& parent, int i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    int& up = parent[static_cast<std::size_t>(i)];
    i = up = parent[static_cast<std::size_t>(up)];
  }
  return i;
}

class SideFinder {
 public:
  SideFinder(const Part& part, const PartPatches& patches) : part_(part), patches_(patches) {
    for (const NSidedPatch& patch : patches.patches) {
      first_corner_.push_back(static_cast<int>(parent_.size()));
      parent_.resize(parent_.size() + static_cast<std::size_t>(patch.basis.sides));
    }
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  PatchSides run() {
    for (std::size_t p = 0; p < patches_.patches.size(); ++p) {
      found_.of_patch.emplace_back();
      for (int k = 0; k < patches_.patches[p].basis.sides; ++k) found_.of_patch.back().push_back(add(p, k));
    }
    std::map<int, int> number;
    for (std::size_t p = 0; p < patches_.patches.size(); ++p) {
      found_.corner_of.emplace_back();
      for (int k = 0; k < patches_.patches[p].basis.sides; ++k)
        found_.corner_of.back().push_back(
            number.try_emplace(root_of(parent_, first_corner_[p] + k), static_cast<int>(number.size())).first->second);
    }
    found_.corners = static_cast<int>(number.size());
    return std::move(found_);
  }

 private:
  void join(int a, int b) { parent_[static_cast<std::size_t>(root_of(parent_, a))] = root_of(parent_, b); }

  PatchSides::Use add(std::size_t p, int k) {
    const int n = patches_.patches[p].basis.sides, before = (k + n - 1) % n;
    const Face& from = part_.faces[patches_.first_face[p] + static_cast<std::size_t>(before)];
    const Face& to = part_.faces[patches_.first_face[p] + static_cast<std::size_t>(k)];
    const int a = edge_of(from, false), b = edge_of(to, true);
    const int start = first_corner_[p] + before, end = first_corner_[p] + k;
    if (a < 0 || b < 0 || a == b) {
      found_.sides.push_back({1, false});
      ends_.push_back({start, end});
      return {static_cast<int>(found_.sides.size()) - 1, false};
    }
    const bool backward = a > b;
    const auto [at, is_new] = known_.try_emplace(std::minmax(a, b), static_cast<int>(found_.sides.size()));
    const auto side = static_cast<std::size_t>(at->second);
    const std::array<int, 2> ends = backward ? std::array{end, start} : std::array{start, end};
    if (is_new) {
      found_.sides.push_back({0, part_.edges[static_cast<std::size_t>(a)].degenerate});
      ends_.push_back(ends);
    }
    ++found_.sides[side].users;
    join(ends[0], ends_[side][0]);
    join(ends[1], ends_[side][1]);
    if (found_.sides[side].degenerate) join(start, end);
    return {static_cast<int>(side), backward};
  }

  const Part& part_;
  const PartPatches& patches_;
  std::vector<int> first_corner_, parent_;
  std::map<std::pair<int, int>, int> known_;
  std::vector<std::array<int, 2>> ends_;
  PatchSides found_;
};

}  // namespace

Result<PartPatches> patches_of(const Part& part) {
  PartPatches found;
  for (std::size_t f = 0; f < part.faces.size();) {
    const auto* first = std::get_if<PatchChart>(&part.faces[f].surface);
    if (!first)
      return bad_input({}, "face " + std::to_string(f),
                       std::string("is a ") + kind_name(part.faces[f].surface) + ", expected patches with any number of sides only");
    const auto n = static_cast<std::size_t>(first->basis.sides);
    for (std::size_t k = 0; k < n; ++k) {
      const auto* chart = f + k < part.faces.size() ? std::get_if<PatchChart>(&part.faces[f + k].surface) : nullptr;
      if (!chart || chart->patch != first->patch || chart->corner != static_cast<int>(k) || !(chart->basis == first->basis))
        return bad_input({}, "face " + std::to_string(f + k), "is not the next corner of the patch before it");
    }
    found.patches.push_back({first->basis, first->points, first->weights});
    found.first_face.push_back(f);
    f += n;
  }
  return found;
}

PatchSides sides_of(const Part& part, const PartPatches& patches) { return SideFinder(part, patches).run(); }

}  // namespace iso
