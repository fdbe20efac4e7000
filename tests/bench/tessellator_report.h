// The comparison of tessellators as tables for readers, with what must hold, and as JSON for programs.
#pragma once

#include "tests/bench/report.h"
#include "tests/bench/tessellators.h"

namespace iso::bench {

// Something that must hold: in how many cases it does, and where it does not.
struct Must {
  std::string about;
  int held = 0, cases = 0;
  std::vector<std::string> not_held;  // "terrain.brep 0.0001: 1.07"
};
std::vector<Must> musts_of(const TessellatorResults& results);

std::string tessellator_table(const TessellatorResults& results, const TessellatorOptions& options, const Origin& origin);
nlohmann::ordered_json tessellator_json(const TessellatorResults& results, const TessellatorOptions& options, const Origin& origin);

}  // namespace iso::bench
