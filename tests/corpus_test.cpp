// Each file of tests/corpus is read and traced without a crash and gives what its .expect says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/load.h"
#include "tests/support/solids.h"

namespace iso::test {
namespace {

struct Expected {
  std::string why, refused;
  std::vector<Ray> rays;
  std::vector<std::size_t> hits;
};

Expected read_expected(const std::filesystem::path& path) {
  Expected e;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "#") {
      std::getline(words, e.why);
    } else if (word == "refused") {
      words >> e.refused;
    } else if (word == "ray") {
      Ray r;
      std::string colon;
      std::size_t hits = 0;
      EXPECT_TRUE(words >> r.o.x >> r.o.y >> r.o.z >> r.d.x >> r.d.y >> r.d.z >> colon >> hits && colon == ":") << path << ": " << line;
      e.rays.push_back(r);
      e.hits.push_back(hits);
    } else {
      ADD_FAILURE() << path << ": unknown line: " << line;
    }
  }
  EXPECT_FALSE(e.why.empty()) << path << " does not say why";
  return e;
}

// Random rays for crashes, hangs and contradictions; the given ones for the answer.
void trace(const std::filesystem::path& path, const Tracer& tracer, const Expected& expected) {
  std::mt19937_64 random(20240618);
  std::vector<Ray> rays = expected.rays;
  const Box3 box = tracer.scene().box();
  for (int i = 0; i < 1000; ++i) rays.push_back(random_ray(random, box.middle(), 0.5 * box.diagonal()));
  std::vector<Hit> all, nearest(rays.size());
  std::vector<std::size_t> offsets;
  std::vector<std::uint8_t> blocked(rays.size());
  SolverStats stats;
  tracer.all(rays, all, offsets, stats);
  tracer.nearest(rays, nearest, Tracer::Order::scattered, stats);
  tracer.occluded(rays, blocked, Tracer::Order::scattered, stats);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t count = offsets[i + 1] - offsets[i];
    if (i < expected.hits.size()) {
      EXPECT_EQ(count, expected.hits[i]) << path << ", ray " << i << ": " << expected.why;
    }
    EXPECT_EQ(count > 0, bool(nearest[i])) << path << ", ray " << i;
    EXPECT_EQ(count > 0, blocked[i] != 0) << path << ", ray " << i;
    if (count > 0 && nearest[i]) {
      EXPECT_EQ(all[offsets[i]].t, nearest[i].t) << path << ", ray " << i << ": " << expected.why;
    }
  }
}

TEST(Corpus, EveryFileGivesWhatIsExpected) {
  int read = 0, refused = 0, rays = 0;
  const std::filesystem::path folder = std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "tests" / "corpus";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::filesystem::path path = entry.path(), beside = path;
    if (entry.is_directory() || path.extension() == ".expect" || path.extension() == ".md") continue;
    SCOPED_TRACE(path.string());
    beside.replace_extension(".expect");
    ASSERT_TRUE(std::filesystem::exists(beside)) << beside << " is missing";
    const Expected expected = read_expected(beside);
    auto model = read_model(path.string());
    if (!model) {
      ++refused;
      EXPECT_FALSE(expected.refused.empty()) << model.error().text();
      EXPECT_NE(model.error().text().find(expected.refused), std::string::npos) << model.error().text();
      continue;
    }
    ++read;
    rays += static_cast<int>(expected.rays.size());
    EXPECT_TRUE(expected.refused.empty()) << "read, but should be refused for its " << expected.refused;
    EXPECT_FALSE(expected.rays.empty()) << "nothing is expected of it";
    trace(path, tracer_of(std::make_shared<const Model>(std::move(*model))), expected);
  }
  fmt::print("[ counted  ] corpus: {} files traced with {} rays of their own, {} refused\n", read, rays, refused);
  EXPECT_GE(read, 3) << "an empty corpus proves nothing";
  EXPECT_GE(refused, 1);
}

}  // namespace
}  // namespace iso::test
