// The ratios that direct intersection must reach; above 1 it is better than the best tessellation.
#pragma once

#include <optional>
#include <string>

namespace iso::bench {

struct Goal {
  std::string about;  // what is promised, for the reader
  double must;
};

// The goal of a measurement, if it has one. `tolerance`: of the tessellation; 0 where there is none.
std::optional<Goal> goal_of(const std::string& scene, const std::string& rays, double tolerance);

}  // namespace iso::bench
