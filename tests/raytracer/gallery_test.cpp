// The gallery and the README are run, not only read: every scene renders, and every command of the README's sh blocks works as written.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <regex>
#include <sstream>

#include "raytracer/image_io.h"
#include "tests/support/paths.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// The exit code of bash lines run in a folder, 0 if all are done; what they print goes to a file there.
int run_in(const fs::path& folder, const std::string& lines) {
  const fs::path script = folder / "lines.sh";
  std::ofstream(script) << "set -eo pipefail\ncd '" << folder.string() << "'\n" << lines << "\n";
  const int status = std::system(("bash '" + script.string() + "' > '" + (folder / "said.txt").string() + "' 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// A folder that looks like the root of the source tree, with the built program in the launcher's place and the models of the README.
void furnish(const fs::path& folder) {
  fs::create_symlink(ISOPHOTE_PROGRAM, folder / "isophote");
  for (const char* part : {"scenes", "tests"}) fs::create_directory_symlink(fs::path(ISOPHOTE_SOURCE_DIR) / part, folder / part);
  fs::copy_file(data("cad/occt-screw.step"), folder / "part.step");
}

// The sh blocks, without the lines that are the launcher's own: `./isophote test` and `bench`.
std::vector<std::vector<std::string>> blocks_of(const std::string& markdown) {
  std::vector<std::vector<std::string>> blocks;
  std::istringstream lines(markdown);
  bool in_block = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("```", 0) == 0) {
      in_block = line == "```sh";
      if (in_block) blocks.emplace_back();
    } else if (in_block && !std::regex_search(line, std::regex("\\./isophote (test|bench)\\b"))) {
      blocks.back().push_back(line);
    }
  }
  return blocks;
}

// Small pictures: what is tested is that the command works.
std::string made_small(std::string line) {
  const std::string render = "./isophote render ";
  const auto at = line.find(render);
  if (at == std::string::npos) return line;
  line = std::regex_replace(line, std::regex(" --(size|samples) \\S+"), "");
  return line.insert(line.find(render) + render.size(), "--size 64x48 --samples 1 ");
}

double covered_share(const Image& image) {
  double sum = 0;
  for (const glm::vec4& pixel : image.rgba) sum += pixel.a;
  return sum / static_cast<double>(image.rgba.size());
}

TEST(Gallery, EverySceneRendersAndItsModelsFillAFairShareOfThePicture) {
  const TemporaryDir folder;
  furnish(folder.path());
  int scenes = 0;
  for (const fs::path& scene : files_in(fs::path(ISOPHOTE_SOURCE_DIR) / "scenes", {".json"})) {
    if (scene.filename() == "scene.schema.json") continue;
    ++scenes;
    const std::string name = scene.stem().string();
    SCOPED_TRACE(name);
    const std::string line = "./isophote render scenes/" + name + ".json -o " + name +
                             ".exr --size 64x48 --samples 1 --background transparent --aov none --quiet";
    ASSERT_EQ(run_in(folder.path(), line), 0) << text_of(folder.path() / "said.txt");
    EXPECT_EQ(text_of(folder.path() / "said.txt"), "");
    const auto image = read_image((folder.path() / (name + ".exr")).string());
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_GT(covered_share(*image), 0.12);
    EXPECT_LT(covered_share(*image), 0.95);

    // The page shows each scene, and its stored picture is small.
    EXPECT_NE(text_of(scene.parent_path() / "README.md").find("](" + name + ".json)"), std::string::npos);
    const fs::path picture = scene.parent_path() / (name + ".jpg");
    ASSERT_TRUE(fs::exists(picture));
    EXPECT_LT(fs::file_size(picture), 200'000u);
  }
  EXPECT_GE(scenes, 12);
}

TEST(Readme, EveryCommandLineWorksAsWritten) {
  const TemporaryDir folder;
  furnish(folder.path());
  int commands = 0;
  for (const std::vector<std::string>& block : blocks_of(text_of(fs::path(ISOPHOTE_SOURCE_DIR) / "README.md"))) {
    std::string script = "set -x\n";
    for (const std::string& line : block) {
      script += made_small(line) + "\n";
      commands += line.find("./isophote ") != std::string::npos;
    }
    EXPECT_EQ(run_in(folder.path(), script), 0) << text_of(folder.path() / "said.txt");
  }
  std::cout << commands << " command lines\n";
  EXPECT_GE(commands, 10);
}

TEST(Readme, EveryFileItLinksToExists) {
  int links = 0;
  for (const char* page : {"README.md", "scenes/README.md", "CONTRIBUTING.md"}) {
    const fs::path path = fs::path(ISOPHOTE_SOURCE_DIR) / page;
    const std::string text = text_of(path);
    const std::regex link("\\]\\(([^)#:]+)\\)");
    for (auto it = std::sregex_iterator(text.begin(), text.end(), link); it != std::sregex_iterator(); ++it, ++links)
      EXPECT_TRUE(fs::exists(path.parent_path() / (*it)[1].str())) << page << ": " << (*it)[1];
  }
  EXPECT_GE(links, 20);
}

}  // namespace
}  // namespace iso::test
