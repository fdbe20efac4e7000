// Loose faces read from bytes, sewn and meshed: the corpus, and some random strings. tests/fuzz/sewing_fuzz.cpp runs as many as wanted.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/paths.h"
#include "tests/support/sewing_checks.h"
#include "tests/support/sewing_model.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

TEST(SewingFuzz, Corpus) {
  Tally tally("corpus of loose faces");
  SewingCounts counts;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "tests/corpus/sewing")) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    const std::string wrong = run_sewing(bytes, counts);
    tally.check(wrong.empty(), [&] { return entry.path().filename().string() + ": " + wrong; });
  }
  tally.finish_at_least(6);
  EXPECT_GT(counts.joined, 10);
  EXPECT_GT(counts.split, 2);
}

TEST(SewingFuzz, RandomStrings) {
  Tally tally("random strings of loose faces", 1);
  SewingCounts counts;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    const std::string wrong = run_sewing(random_sewing_bytes(seed), counts);
    tally.check(wrong.empty(), [&] { return fmt::format("string {}: {}", seed, wrong); });
  }
  tally.finish(150);
  fmt::print("[ counted  ] {} free edges, {} pairs joined, {} times split, {} open, {} collapsed, {} shared, {} compared, {} triangles\n",
             counts.free_edges, counts.joined, counts.split, counts.open, counts.collapsed, counts.shared, counts.compared,
             counts.triangles);
  EXPECT_GT(counts.joined, 1500);
  EXPECT_GT(counts.split, 1000);
  EXPECT_GT(counts.open, 2000);
  EXPECT_GT(counts.collapsed, 100);
  EXPECT_GT(counts.shared, 10);
  EXPECT_GT(counts.compared, 50000);
}

}  // namespace
}  // namespace iso::test
