// The meetings of a line with rational Bezier patches, in double: the patches are halved, every part whose box the line passes is kept
// down to small boxes, Newton on S(s, t) = o + r d runs from the middle of each; the least r of all roots is the first. A part where Newton
// leaves the part is halved on, until its box is at rounding level: what is left then is told as a doubtful root. Nothing is left out
// because something nearer is known.
#pragma once

#include "reference/brute_rays.h"

namespace iso::reference {

struct FirstRoot {
  double t = kInf;
  bool doubtful = false;  // ended in boxes: the line touches the patch, or nearly
  double cosine = 0;      // between line and normal; 0 where the patch has no normal

  explicit operator bool() const { return t < kInf; }
};

// A root of one of the patches; a doubtful one is a box: its middle, and where the line enters it.
struct LineRoot {
  std::size_t patch = 0;
  Vec2 st{0.0};
  double t = kInf;
  double cosine = 0;
  bool doubtful = false;
};

// A part of a patch: the sub-patch, and its box of the patch's unit square.
struct PatchPart {
  BezierPatch net;
  Vec2 lo{0.0}, hi{1.0};
};

struct NewtonRoot {
  Vec2 st;
  double t;
  double cosine;
};

// Newton for a root of the whole patch from the middle of a part. Nothing if it leaves the part by more than a share, or does not settle.
inline bool newton_from(const BezierPatch& patch, const PatchPart& part, const Vec3& o, const Vec3& d, double start, double size,
                        NewtonRoot& root) {
  constexpr double kLeash = 1;         // widths of the part beyond it
  constexpr double kSettled = 1e-14;   // steps, in sizes
  constexpr double kOnBorder = 1e-11;  // widths of the patch beyond it that rounding may ask for
  const Vec2 width = part.hi - part.lo;
  Vec2 st = 0.5 * (part.lo + part.hi);
  double t = start;
  for (int step = 0; step < 30; ++step) {
    const HomogeneousJet j = homogeneous_jet(patch, st);
    const Vec3 S = project(j.H), Ss = (Vec3(j.Hs) - j.Hs.w * S) / j.H.w, St = (Vec3(j.Ht) - j.Ht.w * S) / j.H.w;
    // Cramer's rule for ds Ss + dt St - dr d = o + t d - S.
    const Vec3 cross = glm::cross(Ss, St), rest = o + t * d - S;
    const double det = glm::dot(cross, d);
    if (det == 0) return false;
    const Vec2 delta{glm::dot(glm::cross(rest, St), d) / det, glm::dot(glm::cross(Ss, rest), d) / det};
    const double dr = -glm::dot(cross, rest) / det;
    st += delta;
    t += dr;
    for (int c = 0; c < 2; ++c)
      if (!(st[c] >= part.lo[c] - kLeash * width[c] && st[c] <= part.hi[c] + kLeash * width[c])) return false;
    const double moved = std::abs(delta.x) * glm::length(Ss) + std::abs(delta.y) * glm::length(St) + std::abs(dr);
    if (moved > kSettled * size) continue;
    for (int c = 0; c < 2; ++c)
      if (st[c] < -kOnBorder || st[c] > 1 + kOnBorder) return false;
    root = {st, t, glm::dot(cross, d) / glm::length(cross)};
    return true;
  }
  return false;
}

class RootFinder {
 public:
  explicit RootFinder(std::vector<BezierPatch> patches) : patches_(std::move(patches)) {
    Box3 all;
    for (const BezierPatch& p : patches_) {
      boxes_.push_back(hull_box(p));
      all.include(boxes_.back());
    }
    size_ = all.diagonal();
  }

  // d is a unit vector; only t >= 0 counts.
  FirstRoot first(const Vec3& o, const Vec3& d) const {
    FirstRoot best;
    each(o, d, [&](const LineRoot& root) {
      if (root.t < best.t) best = {root.t, root.doubtful, root.cosine};
    });
    return best;
  }

  // Hands over every root, some several times. The box of a doubtful one may begin before t = 0.
  template <class Found>
  void each(const Vec3& o, const Vec3& d, const Found& found) const {
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      double lo, hi;
      if (line_in_box(boxes_[i].inflated(kRounding * size_), o, d, lo, hi)) search(i, o, d, found);
    }
  }
  double size() const { return size_; }

 private:
  static constexpr double kFirstTry = 1e-2;   // boxes of this share of the size are tried by Newton
  static constexpr double kSmallest = 1e-11;  // and of this are not halved
  static constexpr double kRounding = 1e-15;

  template <class Found>
  void search(std::size_t index, const Vec3& o, const Vec3& d, const Found& found) const {
    const BezierPatch& patch = patches_[index];
    std::vector<PatchPart> stack;
    stack.push_back({patch, {}, Vec2(1.0)});
    while (!stack.empty()) {
      const PatchPart part = std::move(stack.back());
      stack.pop_back();
      const Box3 box = hull_box(part.net);
      double lo, hi;
      if (!line_in_box(box.inflated(kRounding * size_), o, d, lo, hi) || hi < 0) continue;
      if (box.diagonal() <= kSmallest * size_) {
        found(LineRoot{index, 0.5 * (part.lo + part.hi), lo, 0, true});
        continue;
      }
      if (box.diagonal() <= kFirstTry * size_) {
        NewtonRoot root;
        if (newton_from(patch, part, o, d, 0.5 * (lo + hi), size_, root)) {
          if (root.t >= 0) found(LineRoot{index, root.st, root.t, root.cosine, false});
          // Is it the part's own, and its only one? Else the part is halved on.
          if (holds(part, root.st) && single_root(part.net, d)) continue;
        }
      }
      halve(part, stack);
    }
  }

  static bool holds(const PatchPart& part, const Vec2& st) {
    constexpr double kBorder = 1e-9;  // widths: for roots on the border between two parts
    const Vec2 more = kBorder * (part.hi - part.lo);
    return Box2{part.lo - more, part.hi + more}.contains(st);
  }

  // Each difference of the net along s makes with each along t a normal that is clearly on one side of d: then the part, seen along d, is
  // one-to-one, since the mean tangents between any two points are sums of these differences. (In rational parts they are so nearly, the
  // better the smaller the part; those that need the whole margin are small.)
  static bool single_root(const BezierPatch& net, const Vec3& d) {
    constexpr double kClear = 1e-4;
    std::vector<Vec3> along_s, along_t;
    for (int i = 0; i <= net.pu; ++i)
      for (int j = 0; j <= net.pv; ++j) {
        if (i > 0) along_s.push_back(project(net.at(i, j)) - project(net.at(i - 1, j)));
        if (j > 0) along_t.push_back(project(net.at(i, j)) - project(net.at(i, j - 1)));
      }
    double lo = kInf, hi = -kInf;
    for (const Vec3& a : along_s)
      for (const Vec3& b : along_t) {
        const double c = glm::dot(glm::cross(a, b), d) / (glm::length(a) * glm::length(b));
        if (!(std::abs(c) > kClear)) return false;
        lo = std::min(lo, c);
        hi = std::max(hi, c);
      }
    return lo > 0 || hi < 0;
  }

  static void halve(const PatchPart& part, std::vector<PatchPart>& stack) {
    double along_s = 0, along_t = 0;
    const BezierPatch& net = part.net;
    for (int a = 0; a <= net.pu; ++a)
      for (int b = 0; b <= net.pv; ++b) {
        if (a > 0) along_s = std::max(along_s, net.pu * glm::length(project(net.at(a, b)) - project(net.at(a - 1, b))));
        if (b > 0) along_t = std::max(along_t, net.pv * glm::length(project(net.at(a, b)) - project(net.at(a, b - 1))));
      }
    const int c = along_s >= along_t ? 0 : 1;
    PatchPart low{{}, part.lo, part.hi}, high{{}, part.lo, part.hi};
    low.hi[c] = high.lo[c] = 0.5 * (part.lo[c] + part.hi[c]);
    split_in_half(net, c, low.net, high.net);
    stack.push_back(std::move(high));
    stack.push_back(std::move(low));
  }

  std::vector<BezierPatch> patches_;
  std::vector<Box3> boxes_;
  double size_ = 0;
};

}  // namespace iso::reference
