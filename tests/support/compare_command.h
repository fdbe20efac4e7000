// `isophote compare` through the program, for tests: runs in a folder of their own, and what they leave there.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "patches/base/result.h"
#include "tests/support/child.h"
#include "tests/support/paths.h"

namespace iso::test {

namespace fs = std::filesystem;
using nlohmann::json;

inline const std::string kCone = "cad/occtjs-conical-surface.step", kPipe = "cad/nist-mbe-pmi-11.stp", kScrew = "cad/occt-screw.step",
                         kCrank = "cad/occt-crank-arm.brep";
inline constexpr int kConeFaces = 5;

class CompareCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_.path() / name; }
  static ChildResult program(const std::vector<std::string>& arguments) {
    ChildLimits limits;
    limits.seconds = 120;
    return run_isophote(arguments, {}, limits);
  }
  // `arguments` follow `compare`.
  static ChildResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "compare");
    arguments.insert(arguments.end(), {"--progress", "none"});
    return program(arguments);
  }
  // Without pictures, into the folder `report`.
  ChildResult measure(const std::string& model, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {model, "-o", path("report"), "--no-pictures"});
    return run(arguments);
  }
  json report() const { return json::parse(detail::content_of(path("report/report.json"))); }
  std::string page() const { return detail::content_of(path("report/index.html")); }
  std::set<std::string> files(const std::string& folder) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.empty() ? dir_.path() : fs::path(path(folder))))
      names.insert(entry.path().filename());
    return names;
  }
  // A mesh by `tessellate`, with 1e-3 diagonals.
  std::string meshed(const std::string& model, const std::string& name) const {
    const ChildResult made = program({"tessellate", data(model), "-o", path(name), "--tolerance", "1e-3d", "-q"});
    EXPECT_EQ(made.code, 0) << made.summary();
    return path(name);
  }

 private:
  TemporaryDir dir_;
};

}  // namespace iso::test
