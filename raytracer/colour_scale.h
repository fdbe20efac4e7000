// Numbers as colours, and back by the eye: a range of values and the colour of each.
#pragma once

#include <vector>

#include "patches/base/vec.h"

namespace iso {

// If 0 lies inside the range, colours diverge from white at 0 to blue (negative) and red (positive), at the same rate to both sides, the
// end that is farther from 0 in full colour; else they go from dark to light over the range. What is beyond an end has the end's colour;
// what is no number is yellow. Linear Rec. 709.
struct ColourScale {
  Range range{-1, 1};  // finite, lo < hi

  bool diverges() const { return range.lo < 0 && range.hi > 0; }
  Colour colour(double value) const;
};

// "Viridis" of matplotlib (public domain, CC0), every sixteenth part of it, from dark to light, display-encoded: even steps look even, also
// to the colour-blind and printed grey. The scale over a range without 0 goes along it. [van der Walt and Smith 2015]
std::vector<Colour> even_scale();

// The smallest of 1, 2, 5 times a power of ten that is not below x; x is positive and finite.
double round_up(double x);

}  // namespace iso
