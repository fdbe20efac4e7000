// All meetings of a line with a patch of n sides by subdivision. Slow, and obviously right: it knows the formulas of the weights and
// nothing else, no spline, nothing of the tracer.
//
// Each chart is a tree of boxes of (s, t). Over a box the formulas are evaluated with bounds (patch_enclosure.h): where the line cannot
// meet what is bounded, the box is dropped; where the tangents vary so little that the chart seen along the line is one-to-one, the box has
// one root at most, and Krawczyk's operator finds it or proves that there is none [Krawczyk 1969; Neumaier 1990, 5.1]; all others are
// divided. What is left at kSmallest touches the line, or is met in a corner, and is said to be doubtful.
//
// Bounds hold on every part of their box: a quarter takes over the polynomials about its own middle, and the formulas are asked again only
// where the radius, which stays, has become a good part of what the polynomials vary by. Bounds of boxes that are not small are kept: rays
// by the million are affordable. Not for several threads at once.
#pragma once

#include <array>
#include <vector>

#include "patches/surface/patch_chart.h"

namespace iso::reference {

struct PatchMeeting {
  double t = 0;  // in lengths of d
  int chart = 0;
  Vec2 st{0.0};
  Vec3 p{0.0}, n{0.0};    // the point, and the unit normal Ss x St; zero where there is none
  double cosine = 0;      // n . d
  bool doubtful = false;  // the line touches here or nearly, or meets the chart's corner: to some 1e-8 of the chart
};

class PatchIntersector {
 public:
  // A valid patch, of any kind. Lengths are rounded to some 1e-15 of the patch's size.
  explicit PatchIntersector(const NSidedPatch& patch);

  // All meetings on the whole line, sorted by t; one that is met at a border of charts is named once. d is a unit vector.
  std::vector<PatchMeeting> all(const Vec3& o, const Vec3& d);

  double size() const { return size_; }  // diagonal of the box of the control points
  std::size_t boxes() const;             // that are kept

 private:
  static constexpr int kTerms = 10;  // of Model

  // Three coordinates as models.
  struct Models {
    std::array<Vec3, kTerms> c{};
    Vec3 radius{0.0};

    Vec3 varies() const;  // without the radius
    Models quarter(const Vec2& corner) const;
  };
  // Bounds over a square of (s, t) with the lower corner `lo`: of S - about, and of the tangents.
  struct Bounds {
    Vec2 lo{0.0};
    double width = 1;
    Models S, Ss, St;
    Vec3 rs{0.0}, rt{0.0};  // how far tangents are from those in the middle
    int children = -1;      // the first of four
    bool asked = true;      // the formulas, not the box around
  };
  struct Chart {
    NSidedPatch patch;  // turned, about the middle of its points
    std::vector<Bounds> tree;
  };
  // n1, n2 and d at right angles; o relative to `about`.
  struct Line {
    Vec3 o, d, n[2];
  };
  struct Found;

  Bounds bound(const NSidedPatch& patch, const Vec2& lo, double width) const;
  Bounds bound_at_corner(const NSidedPatch& patch, double width) const;
  bool sharp(const Bounds& box) const;
  Bounds quarter(const NSidedPatch& patch, const Bounds& box, const Vec2& corner) const;
  bool may_meet(const Models& S, const Line& line) const;
  bool settle(const Chart& chart, const Bounds& box, const Line& line, Found& found) const;
  void search(Chart& chart, int index, const Line& line, Found& found) const;
  void search_deep(const Chart& chart, const Bounds& box, const Line& line, Found& found) const;
  void leave_doubtful(const Chart& chart, const Bounds& box, const Line& line, Found& found) const;

  Vec3 about_{0.0};
  double size_ = 0;
  std::vector<Chart> charts_;
};

}  // namespace iso::reference
