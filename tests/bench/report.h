// The measurements as a table for readers and as JSON for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/bench/direct_versus_triangles.h"

namespace iso::bench {

// Where and of what the figures are, and the scenes whose files are absent.
struct Origin {
  std::string machine, commit;
  std::vector<std::string> left_out;
};
Origin origin_of_run();

// Columns as wide as their widest cell; the first `left` ones aligned to the left.
std::string aligned(const std::vector<std::vector<std::string>>& lines, std::size_t left);

std::string as_table(const std::vector<SceneResult>& results, const MeasureOptions& options, const Origin& origin);
nlohmann::ordered_json as_json(const std::vector<SceneResult>& results, const MeasureOptions& options, const Origin& origin);

}  // namespace iso::bench
