// Numbers as colours, and back by the eye: a range of values and the colour of each.
#pragma once

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

// The smallest of 1, 2, 5 times a power of ten that is not below x; x is positive and finite.
double round_up(double x);

}  // namespace iso
