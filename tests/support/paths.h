// Where tests find their files. A path that must exist and does not makes the test fail, not pass.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace iso::test {

// tests/data of the source tree.
inline std::filesystem::path data_dir() { return ISOPHOTE_TEST_DATA; }
inline std::string data(const std::string& name) { return (data_dir() / name).string(); }

// A larger collection with the same layout (cad/, patches/, meshes/): the folder $ISOPHOTE_DATA, else shared/data beside the
// source tree; none if neither exists.
inline std::optional<std::filesystem::path> shared_data_dir() {
  if (const char* set = std::getenv("ISOPHOTE_DATA"); set && *set) return std::filesystem::path(set);
  const auto beside = std::filesystem::path(ISOPHOTE_SOURCE_DIR).parent_path() / "shared" / "data";
  if (std::filesystem::is_directory(beside)) return beside;
  return std::nullopt;
}

// The models of the Debian package occt-misc (folders step, iges, occ).
inline std::optional<std::filesystem::path> occt_data_dir() {
  const std::filesystem::path dir = "/usr/share/opencascade/data";
  if (std::filesystem::is_directory(dir)) return dir;
  return std::nullopt;
}

// All files below `dir` whose ending is one of `endings` (".step", lower case), sorted.
inline std::vector<std::filesystem::path> files_in(const std::filesystem::path& dir, const std::vector<std::string>& endings) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(dir)) {
    std::string ending = entry.path().extension().string();
    for (char& c : ending)
      if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    for (const std::string& wanted : endings)
      if (entry.is_regular_file() && ending == wanted) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The CAD models at hand: the large collection where it exists, else the one of the source tree; and occt-misc's.
inline std::vector<std::filesystem::path> cad_models() {
  const std::vector<std::string> endings{".step", ".stp", ".iges", ".igs", ".brep", ".rle"};
  auto models = files_in(shared_data_dir().value_or(data_dir()) / "cad", endings);
  if (const auto occt = occt_data_dir())
    for (const char* folder : {"step", "iges", "occ"})
      if (std::filesystem::is_directory(*occt / folder))
        for (auto& path : files_in(*occt / folder, endings)) models.push_back(path);
  return models;
}

// A fresh folder for a test's own files, removed at the end of its life.
class TemporaryDir {
 public:
  TemporaryDir() {
    std::string name = (std::filesystem::temp_directory_path() / "isophote-test-XXXXXX").string();
    if (!mkdtemp(name.data())) std::abort();
    path_ = name;
  }
  ~TemporaryDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDir(const TemporaryDir&) = delete;
  TemporaryDir& operator=(const TemporaryDir&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace iso::test
