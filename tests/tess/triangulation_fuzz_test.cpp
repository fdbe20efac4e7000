// Operations read from bytes: the corpus, and a few hundred random strings. tests/fuzz/triangulation_fuzz.cpp runs as many as wanted.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/paths.h"
#include "tests/support/tally.h"
#include "tests/support/triangulation_operations.h"

namespace iso::test {
namespace {

TEST(TriangulationFuzz, Corpus) {
  Tally tally("corpus of triangulations");
  OperationCounts counts;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "tests/corpus/triangulation")) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    const std::string wrong = run_triangulation_operations(bytes, counts);
    tally.check(wrong.empty(), [&] { return entry.path().filename().string() + ": " + wrong; });
  }
  tally.finish_at_least(5);
  EXPECT_GT(counts.inserted, 40);
  EXPECT_GT(counts.met_again, 0);
  EXPECT_GT(counts.constrained, 10);
  EXPECT_GT(counts.refused, 0);
  EXPECT_GT(counts.marked, 3);
}

TEST(TriangulationFuzz, RandomStrings) {
  Tally tally("random strings of operations", 1);
  OperationCounts counts;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const std::string wrong = run_triangulation_operations(random_triangulation_operations(seed), counts);
    tally.check(wrong.empty(), [&] { return fmt::format("string {}: {}", seed, wrong); });
  }
  tally.finish(400);
  fmt::print("[ counted  ] {} points, {} met again, {} constraints, {} refused, {} swaps, {} times marked\n", counts.inserted,
             counts.met_again, counts.constrained, counts.refused, counts.swapped, counts.marked);
  EXPECT_GT(counts.inserted, 10000);
  EXPECT_GT(counts.met_again, 100);
  EXPECT_GT(counts.constrained, 2000);
  EXPECT_GT(counts.refused, 2000);
  EXPECT_GT(counts.swapped, 500);
  EXPECT_GT(counts.marked, 1000);
}

}  // namespace
}  // namespace iso::test
