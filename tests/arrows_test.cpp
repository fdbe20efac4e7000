// Who may include whom (CONTRIBUTING.md, "Rooms"): reads every source file and objects to includes against the arrows.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/paths.h"

namespace iso::test {
namespace {

namespace fs = std::filesystem;

// The rooms, and the rooms each may include besides itself. "patches" is what lies directly in that folder: brep, cells, trim.
const std::map<std::string, std::set<std::string>> kMayInclude{
    {"patches/base", {}},
    {"patches/curve", {"patches/base"}},
    {"patches/surface", {"patches/base", "patches/curve"}},
    {"patches", {"patches/base", "patches/curve", "patches/surface"}},
    {"patches/mesh", {"patches/base", "patches/curve", "patches/surface", "patches"}},
    {"patches/spline", {"patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh"}},
    {"patches/colour", {"patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh"}},
    {"patches/files", {"patches/base"}},
    {"patches/io",
     {"patches/files", "patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh", "patches/spline", "patches/colour"}},
    {"tess", {"patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh", "patches/spline", "patches/colour"}},
    {"raytracer",
     {"patches/files", "patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh", "patches/spline", "patches/colour"}},
    {"raytracer/cmd",
     {"patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh", "patches/spline", "patches/colour", "patches/files",
      "patches/io", "tess", "raytracer"}},
    {"tests",
     {"patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh", "patches/spline", "patches/colour", "patches/files",
      "patches/io", "tess", "raytracer", "raytracer/cmd", "reference"}},
    {"reference", {"patches/base", "patches/curve", "patches/surface", "patches", "patches/mesh", "patches/spline", "patches/colour"}},
};

// A library whose headers only some files may include; tests and reference may include any.
struct Guarded {
  std::string name;
  std::regex header;
  std::regex allowed;  // files
};
const std::vector<Guarded>& guarded() {
  static const std::vector<Guarded> all{
      {"Embree", std::regex("embree.*"), std::regex("raytracer/embree_.*")},
      {"Open CASCADE", std::regex(".*\\.hxx"), std::regex("patches/io/occt_.*")},
      {"OpenImageIO", std::regex("OpenImageIO/.*"), std::regex("raytracer/image_io\\.cpp")},
      {"OpenColorIO", std::regex("OpenColorIO/.*"), std::regex("raytracer/display_transform\\.cpp")},
      {"OpenEXR", std::regex("(Imf|Iex|Imath|half).*"), std::regex("raytracer/exr_writer\\.cpp")},
      {"OpenGL", std::regex("(GL|EGL|GLFW|epoxy)/.*"), std::regex("tess/gpu/.*")},
      // The mathematics: values in, values out; no library but GLM, no files, threads or printing (check.h aborts with a message,
      // made_once.h keeps tables).
      {"libraries other than GLM", std::regex("(fmt|tbb|nlohmann|CLI|hwy|Eigen|boost|opencv2).*"),
       std::regex("(patches/files|patches/io|tess|raytracer)/.*")},
      {"files, threads and printing",
       std::regex(
           "fstream|iostream|ostream|istream|cstdio|stdio.h|filesystem|thread|mutex|shared_mutex|future|atomic|unistd.h|fcntl.h|sys/.*"),
       std::regex("(patches/files|patches/io|tess|raytracer)/.*|patches/base/(check|made_once)\\.h")},
  };
  return all;
}

// The room of a file or of an include: its longest folder that is a room. Empty if there is none.
std::string room_of(const std::string& path) {
  for (std::string folder = fs::path(path).parent_path(); !folder.empty(); folder = fs::path(folder).parent_path())
    if (kMayInclude.count(folder)) return folder;
  return {};
}

struct Include {
  std::string header;
  bool own = false;  // written with quotes
  int line = 0;
};
std::vector<Include> includes_in(std::istream& text) {
  static const std::regex pattern("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::vector<Include> found;
  std::string line;
  std::smatch match;
  for (int number = 1; std::getline(text, line); ++number)
    if (std::regex_match(line, match, pattern)) found.push_back({match[2], match[1] == "\"", number});
  return found;
}

// What is wrong with an include, or nothing.
std::string objection(const std::string& file, const Include& include) {
  const std::string from = room_of(file);
  if (from.empty()) return "a source file outside of all rooms";
  if (include.own) {
    const std::string to = room_of(include.header);
    if (to.empty()) return "\"" + include.header + "\" does not start with the folder of a room";
    if (to != from && !kMayInclude.at(from).count(to)) return from + " must not include " + to + " (\"" + include.header + "\")";
    return {};
  }
  if (!room_of(include.header).empty()) return "<" + include.header + "> is ours: write it with quotes";
  if (from == "tests" || from == "reference") return {};
  for (const Guarded& g : guarded())
    if (std::regex_match(include.header, g.header) && !std::regex_match(file, g.allowed))
      return g.name + " must not be included here (<" + include.header + ">)";
  return {};
}

struct Survey {
  int files = 0, includes = 0;
  std::vector<std::string> objections;
};
Survey survey(const fs::path& root) {
  Survey s;
  for (const char* top : {"patches", "tess", "raytracer", "tests", "reference"}) {
    if (!fs::is_directory(root / top)) continue;
    for (const fs::path& path : files_in(root / top, {".h", ".cpp"})) {
      const std::string file = fs::relative(path, root);
      std::ifstream text(path);
      ++s.files;
      for (const Include& include : includes_in(text)) {
        ++s.includes;
        if (const std::string o = objection(file, include); !o.empty())
          s.objections.push_back(file + ":" + std::to_string(include.line) + ": " + o);
      }
    }
  }
  return s;
}

TEST(Arrows, NoSourceFileIncludesAgainstTheArrows) {
  const Survey s = survey(ISOPHOTE_SOURCE_DIR);
  for (const std::string& o : s.objections) ADD_FAILURE() << o;
  std::cout << s.files << " files, " << s.includes << " includes checked\n";
  EXPECT_GE(s.files, 40) << "the survey has lost its way";
  EXPECT_GE(s.includes, 3 * s.files) << "the survey overlooks includes";
}

TEST(Arrows, PlantedWrongIncludesAreCaught) {
  const struct {
    const char *file, *include;
  } wrong[] = {
      {"patches/base/vec.h", "\"patches/curve/curve.h\""},
      {"patches/curve/curve.h", "\"patches/surface/surface.h\""},
      {"patches/surface/surface.cpp", "\"patches/brep.h\""},
      {"patches/surface/surface.cpp", "\"surface.h\""},
      {"patches/surface/surface.cpp", "\"../curve/curve.h\""},
      {"patches/cells.cpp", "\"patches/io/read_model.h\""},
      {"patches/cells.cpp", "\"raytracer/tracer.h\""},
      {"patches/cells.cpp", "<fmt/core.h>"},
      {"patches/cells.cpp", "<fstream>"},
      {"patches/brep.cpp", "<gp_Pnt.hxx>"},
      {"patches/brep.cpp", "<patches/base/vec.h>"},
      {"patches/cells.cpp", "\"patches/files/output_file.h\""},
      {"patches/files/output_file.cpp", "\"patches/brep.h\""},
      {"patches/io/read_model.cpp", "<TopoDS_Shape.hxx>"},
      {"patches/io/read_obj.cpp", "\"tess/mesh.h\""},
      {"tess/mesh.cpp", "\"raytracer/tracer.h\""},
      {"raytracer/film.cpp", "\"tess/mesh.h\""},
      {"raytracer/film.cpp", "\"raytracer/cmd/main.h\""},
      {"raytracer/film.cpp", "\"reference/slow.h\""},
      {"raytracer/tracer.h", "<embree3/rtcore.h>"},
      {"raytracer/film.cpp", "<OpenImageIO/imageio.h>"},
      {"raytracer/film.cpp", "<ImfOutputFile.h>"},
      {"raytracer/cmd/render.cpp", "\"reference/slow.h\""},
      {"raytracer/cmd/render.cpp", "<embree3/rtcore.h>"},
      {"reference/slow.cpp", "\"raytracer/tracer.h\""},
      {"somewhere/else.cpp", "<vector>"},
  };
  int caught = 0;
  for (const auto& w : wrong) {
    std::istringstream text("// \"x.h\"\n  #  include " + std::string(w.include) + "  // why\n");
    const auto includes = includes_in(text);
    ASSERT_EQ(includes.size(), 1u) << w.include;
    EXPECT_EQ(includes[0].line, 2);
    EXPECT_NE(objection(w.file, includes[0]), "") << w.file << " includes " << w.include;
    caught += !objection(w.file, includes[0]).empty();
  }
  EXPECT_EQ(caught, int(std::size(wrong)));
}

TEST(Arrows, AllowedIncludesPass) {
  const struct {
    const char *file, *include;
  } right[] = {
      {"patches/surface/surface.h", "\"patches/curve/curve.h\""},
      {"patches/brep.h", "\"patches/surface/surface.h\""},
      {"patches/trim.h", "\"patches/brep.h\""},
      {"patches/io/occt_reader.cpp", "<TopoDS.hxx>"},
      {"raytracer/embree_scene.cpp", "<embree3/rtcore.h>"},
      {"raytracer/exr_writer.cpp", "<ImfOutputFile.h>"},
      {"raytracer/cmd/render.cpp", "\"patches/io/read_model.h\""},
      {"raytracer/cmd/compare.cpp", "\"tess/mesh.h\""},
      {"tests/raytracer/film_test.cpp", "\"raytracer/cmd/main.h\""},
      {"tests/io/oracle.cpp", "<BRepMesh.hxx>"},
      {"patches/base/vec.h", "<glm/vec3.hpp>"},
      {"patches/base/vec.h", "<vector>"},
  };
  for (const auto& r : right) {
    std::istringstream text("#include " + std::string(r.include));
    const auto includes = includes_in(text);
    ASSERT_EQ(includes.size(), 1u) << r.include;
    EXPECT_EQ(objection(r.file, includes[0]), "") << r.file;
  }
}

TEST(Arrows, TheSurveyFindsAPlantedFileInATree) {
  const TemporaryDir tree;
  fs::create_directories(tree.path() / "patches/base");
  std::ofstream(tree.path() / "patches/base/good.h") << "#include <vector>\n";
  std::ofstream(tree.path() / "patches/base/bad.h") << "#include <vector>\n#include \"raytracer/tracer.h\"\n";
  const Survey s = survey(tree.path());
  EXPECT_EQ(s.files, 2);
  EXPECT_EQ(s.includes, 3);
  ASSERT_EQ(s.objections.size(), 1u);
  EXPECT_EQ(s.objections[0].substr(0, 21), "patches/base/bad.h:2:") << s.objections[0];
}

}  // namespace
}  // namespace iso::test
