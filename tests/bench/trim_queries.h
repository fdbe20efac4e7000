// The cost of a trim query: a face in the plane whose one loop is a blob of lines, circular arcs (rational quadratics) and cubic B-splines
// in turn. Each measurement also asks the slow winding test about a sample of its queries and ends the program if one answer differs.
#pragma once

namespace iso::bench {

// Nanoseconds of one query: median over the rounds, with the median absolute deviation.
struct TrimTimes {
  int segments = 0;
  double uniform = 0, uniform_deviation = 0;  // queries anywhere in the box of the loop
  double near = 0, near_deviation = 0;        // queries at most a hundredth of that box's width away from the loop, on both sides
  int checked = 0;                            // answers compared with the winding test
};

// `segments` >= 6: curves of the loop.
TrimTimes measure_trim_queries(int segments);

}  // namespace iso::bench
