// Our tessellator against Open CASCADE's two: the same models, tolerances and meter. Times are CPU time of one thread.
#pragma once

#include <optional>

#include "tests/bench/tessellator_runs.h"

namespace iso::bench {

enum class Rivals { measured, left_out };

struct TessellatorOptions {
  Rivals rivals = Rivals::measured;
  std::vector<std::string> models;                         // empty: all
  std::vector<double> tolerances{1e-2, 1e-3, 1e-4, 1e-5};  // shares of the diagonal
  int rounds = 5;                                          // of each mesher, in turns; one for a mesher whose first run takes long
  std::uint64_t sampled_triangles = 60'000;
};

struct ScalingRow {
  std::string model;
  int faces = 0;
  double tolerance = 0;
  ThreadTimes wall;
};

struct TessellatorResults {
  std::vector<TessellatorRow> rows;  // model by model, tolerance by tolerance, one of each mesher
  std::vector<ScalingRow> scaling;
  std::vector<std::string> left_out;
};

// The names of the models, files of the package occt-misc.
std::vector<std::string> tessellator_models();

// Tells on standard error what it does. Must run before anything uses threads. Errors: a model cannot be read.
Result<TessellatorResults> measure_tessellators(const TessellatorOptions& options);

}  // namespace iso::bench
