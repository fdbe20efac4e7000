// Damaged files: every one is read to a sound model, the same each time, or refused with one clear message; no crash, no hang, no face lost
// without a word. Each file is read in a child process, so that one that breaks its reader is told like any other failure.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <random>

#include "patches/io/read_model.h"
#include "tests/support/child.h"
#include "tests/support/model_soundness.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

constexpr double kSeconds = 20;     // for one file of a few ten kilobytes; reading takes milliseconds
constexpr long kMemory = 4l << 30;  // bytes of address space
constexpr std::uint64_t kSeed = 20240521;

using Random = std::mt19937_64;

std::string text_of(const std::string& path) { return detail::content_of(path); }

std::size_t below(std::size_t n, Random& random) { return n == 0 ? 0 : random() % n; }

// A digit somewhere, or npos: damage to numbers reaches deeper than damage to keywords.
std::size_t some_digit(const std::string& text, Random& random) { return text.find_first_of("0123456789", below(text.size(), random)); }

// Replaces the number that begins at or after a random place by something a reader may not expect.
void replace_number(std::string& text, Random& random) {
  static const char* const kStrange[] = {"NaN", "1e300", "-1", "0", "99999999", "-0.", "1E-320", "inf", "", "2147483648", "1.5", "x"};
  const std::size_t begin = some_digit(text, random);
  if (begin == text.npos) return;
  const std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE", begin), text.size());
  text.replace(begin, end - begin, kStrange[below(std::size(kStrange), random)]);
}

// One to three small wounds; the tail stays, because every reader looks there for the end of the file first.
std::string damaged(const std::string& text, Random& random) {
  constexpr std::size_t kTail = 160;
  std::string body = text.substr(0, text.size() - std::min(text.size() / 8, kTail));
  const std::string tail = text.substr(body.size());
  for (std::size_t wounds = 1 + below(3, random); wounds > 0; --wounds) {
    const std::size_t at = below(body.size(), random);
    switch (below(6, random)) {
      case 0:
        if (!body.empty()) body[at] = static_cast<char>(random());
        break;
      case 1:
        if (const std::size_t digit = some_digit(body, random); digit != body.npos)
          body[digit] = static_cast<char>('0' + below(10, random));
        break;
      case 2:
        body.erase(at, 1 + below(40, random));
        break;
      case 3:
        body.insert(at, body.substr(below(body.size(), random), 1 + below(40, random)));
        break;
      case 4:
        if (!body.empty()) body[at] = "(),;.-+ #'$*\n"[below(13, random)];
        break;
      default:
        replace_number(body, random);
    }
  }
  return body + tail;
}

long faces_of(const Model& model) {
  long faces = 0;
  for (const Instance& instance : model.instances)
    faces += static_cast<long>(model.parts[static_cast<std::size_t>(instance.part)].faces.size());
  return faces;
}

std::string signature_of(const Model& model) {
  const Box3 box = box_of(model);
  return fmt::format("{} faces in {} {} {} to {} {} {}", faces_of(model), box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z);
}

// What is wrong with a model from a damaged file whose whole one has so many faces.
std::string objection(const Model& model, const std::string& path, long faces_when_whole) {
  if (const std::string broken = unsound(model); !broken.empty()) return broken;
  if (faces_of(model) < faces_when_whole && model.problems.empty()) return "faces are missing, and nothing says so";
  const auto again = read_model(path);  // what damage leaves unset comes from memory, which differs by now
  if (!again) return "read once, but refused when read again: " + again.error().text();
  if (signature_of(*again) != signature_of(model)) return signature_of(model) + ", but read again: " + signature_of(*again);
  return {};
}

// What came of a file: the exit codes are those of the program, 1 stands for a model that is not as it should be.
ChildResult read_in_child(const std::string& path, long faces_when_whole) {
  return run_in_child(
      [&] {
        const auto model = read_model(path);
        const std::string said = model ? objection(*model, path, faces_when_whole) : model.error().text();
        std::fputs(said.c_str(), stderr);
        std::fflush(stderr);
        if (!model) return static_cast<int>(model.error().kind);
        return said.empty() ? 0 : 1;
      },
      {}, {.seconds = kSeconds, .file_bytes = -1, .memory_bytes = kMemory, .standard_output = {}});
}

// Nothing if the result is clean, else what is wrong with it.
std::string objection(const ChildResult& result, const std::string& path) {
  if (result.code == 0) return {};
  if (result.code != static_cast<int>(Exit::bad_input)) return result.summary();
  if (result.err.find(path) == result.err.npos) return "the message does not name the file: " + result.err;
  if (result.err.size() < path.size() + 10) return "the message gives no reason: " + result.err;
  return {};
}

// Where a failure leaves its file, ready for tests/corpus.
void keep(const std::string& name, const std::string& text) {
  const char* folder = std::getenv("ISOPHOTE_KEEP_DAMAGED");
  if (folder) std::ofstream(std::filesystem::path(folder) / name, std::ios::binary) << text;
}

void survive_damage(const std::vector<std::string>& names, int rounds_each) {
  if (const char* more = std::getenv("ISOPHOTE_DAMAGE_ROUNDS")) rounds_each = std::atoi(more);
  const TemporaryDir dir;
  int tried = 0, read = 0, refused = 0, failed = 0;
  double longest = 0;
  for (const std::string& name : names) {
    const std::string whole = text_of(data(name));
    ASSERT_GT(whole.size(), 100u) << name;
    const auto model = read_model(data(name));
    ASSERT_TRUE(model) << model.error().text();
    const long faces = faces_of(*model);
    for (int round = 0; round < rounds_each; ++round, ++tried) {
      Random random(kSeed + static_cast<std::uint64_t>(round));
      const std::string text = damaged(whole, random);
      const std::string file = std::to_string(round) + "-" + std::filesystem::path(name).filename().string();
      const std::string path = dir.path() / file;
      std::ofstream(path, std::ios::binary) << text;
      const auto begin = std::chrono::steady_clock::now();
      const ChildResult result = read_in_child(path, faces);
      longest = std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      std::filesystem::remove(path);
      const std::string wrong = objection(result, path);
      (result.code == 0 ? read : refused) += wrong.empty();
      if (wrong.empty()) continue;
      keep(file, text);
      if (++failed <= 5) ADD_FAILURE() << name << ", round " << round << " (seed " << kSeed << "): " << wrong;
    }
  }
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(tried, static_cast<int>(names.size()) * rounds_each);
  EXPECT_GT(refused, 0);
  EXPECT_GT(read, 0);
  std::cout << tried << " damaged files: " << read << " read, " << refused << " refused, " << failed << " failed; longest " << longest
            << " s\n";
}

TEST(Damaged, TruncatedFilesAreRefusedWhereverTheyAreCut) {
  const std::string names[] = {"cad/occtjs-cube-mm.step",
                               "cad/edge-cases/vertex-loop-spline-pole.stp",
                               "cad/occt-wing.brep",
                               "cad/far-screw-placed.brep",
                               "cad/dealii-wigley-hull.iges",
                               "cad/pygem-pipe-hollow.iges",
                               "patches/wave-trimmed-hole.obj",
                               "patches/teaspoon.bpt"};
  const TemporaryDir dir;
  int refused = 0;
  for (const std::string& name : names) {
    const std::string whole = text_of(data(name));
    ASSERT_GT(whole.size(), 1000u);
    for (const std::size_t percent : {0, 1, 3, 12, 25, 37, 50, 63, 75, 88, 95, 99}) {
      const std::string path = dir.path() / fmt::format("{}-{}", percent, std::filesystem::path(name).filename().string());
      std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() * percent / 100);
      const ChildResult result = read_in_child(path, 0);
      EXPECT_EQ(result.code, static_cast<int>(Exit::bad_input)) << path << ": " << result.summary();
      EXPECT_EQ(objection(result, path), "");
      refused += result.code == static_cast<int>(Exit::bad_input);
    }
  }
  EXPECT_EQ(refused, static_cast<int>(std::size(names)) * 12);
}

TEST(Damaged, BptFilesAreReadOrRefused) { survive_damage({"patches/teaspoon.bpt", "patches/teapot.bpt"}, 100); }

TEST(Damaged, ObjFilesAreReadOrRefused) {
  survive_damage({"patches/wave-trimmed-hole.obj", "patches/sphere-rational-bspline.obj", "patches/teaspoon-bezier.obj"}, 70);
}

TEST(Damaged, BrepFilesAreReadOrRefused) { survive_damage({"cad/occt-wing.brep", "cad/far-screw-placed.brep"}, 60); }

TEST(Damaged, IgesFilesAreReadOrRefused) { survive_damage({"cad/dealii-wigley-hull.iges", "cad/pygem-pipe-hollow.iges"}, 80); }

TEST(Damaged, StepFilesAreReadOrRefused) {
  survive_damage({"cad/occtjs-cube-mm.step", "cad/mayo-issue-332.stp", "cad/edge-cases/four-face-keyhole.stp",
                  "cad/edge-cases/vertex-loop-spline-pole.stp", "cad/edge-cases/mapped-items.stp"},
                 60);
}

}  // namespace
}  // namespace iso::test
