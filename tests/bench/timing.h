// How benchmarks measure: CPU time of the calling thread, so that other work on the machine counts as little as it can; medians, because
// what is left of it disturbs single rounds.
#pragma once

#include <time.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "patches/base/check.h"

namespace iso::bench {

inline double thread_seconds() {
  timespec now{};
  ISO_CHECK(clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) == 0);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double seconds_of(const Work& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

inline double median(std::vector<double> values) {
  ISO_CHECK(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// A median with the median absolute deviation from it.
struct Timing {
  double median = 0, deviation = 0;
};

inline Timing scaled(const Timing& timing, double by) { return {by * timing.median, by * timing.deviation}; }

inline Timing timing_of(const std::vector<double>& values) {
  const double middle = median(values);
  std::vector<double> apart;
  for (const double value : values) apart.push_back(std::abs(value - middle));
  return {middle, median(apart)};
}

}  // namespace iso::bench
