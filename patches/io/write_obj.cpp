// Wavefront OBJ with a material library beside it where there are colours.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>

#include "patches/io/placed_mesh.h"

namespace iso {
namespace {

namespace fs = std::filesystem;

// Lines of text on their way into a file.
class Text {
 public:
  explicit Text(OutputFile& file) : file_(&file) {}
  ~Text() { flush(); }
  Text(const Text&) = delete;
  Text& operator=(const Text&) = delete;

  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Args>(args)...);
    if (buffer_.size() > (1u << 16)) flush();
  }

 private:
  void flush() {
    file_->write({buffer_.data(), buffer_.size()});
    buffer_.clear();
  }
  OutputFile* file_;
  fmt::memory_buffer buffer_;
};

// Colours by the name of their material, numbered as they come.
class Materials {
 public:
  const std::string& name_of(const std::optional<Colour>& colour) {
    const Colour c = colour.value_or(kUncoloured);
    const std::array<float, 4> key{c.r, c.g, c.b, colour ? 1.0f : 0.0f};
    const auto [at, is_new] = names_.try_emplace(key);
    if (!is_new) return at->second;
    at->second = colour ? fmt::format("colour_{}", ++coloured_) : "uncoloured";
    lines_ += fmt::format("newmtl {}\nKd {} {} {}\n", at->second, to_srgb(c.r), to_srgb(c.g), to_srgb(c.b));
    return at->second;
  }
  std::string text(const std::string& program) const { return "# " + program + "; Kd are values for a screen (sRGB curve)\n" + lines_; }

 private:
  std::map<std::array<float, 4>, std::string> names_;
  int coloured_ = 0;
  std::string lines_;
};

// Names of instances as words, told apart by a number where they are equal.
class Names {
 public:
  std::string of(const PlacedMesh& placed) {
    std::string name = one_word(placed.instance->name.empty() ? placed.part->name : placed.instance->name);
    if (name.empty()) name = fmt::format("instance_{}", placed.number);
    std::string unique = name;
    for (int k = next_[name]; !used_.insert(unique).second; next_[name] = k) unique = fmt::format("{}_{}", name, ++k + 1);
    return unique;
  }

 private:
  std::set<std::string> used_;
  std::map<std::string, int> next_;
};

// What was written before the instance, counted: OBJ's indices start at 1 and run through the file.
struct Counts {
  std::uint64_t points = 1, normals = 1;
};

// Points, and normals in the order of the nodes; one that equals the node's before is not repeated. Gives the nodes' indices of normals.
std::vector<std::uint64_t> write_vertices(Text& text, const PlacedMesh& placed, Counts& counts) {
  for (const Point3& stored : placed.mesh->points) {
    const Point3 p = placed.point(stored);
    text.add("v {} {} {}\n", p.x, p.y, p.z);
  }
  std::vector<std::uint64_t> index;
  index.reserve(placed.mesh->nodes.size());
  std::optional<FloatPoint> last;
  for (const Vec3& stored : full_normals(*placed.mesh)) {
    const FloatPoint n(placed.normal(stored));
    ISO_CHECK(n.is_finite());
    if (!last || last->exact() != n.exact()) {
      text.add("vn {} {} {}\n", n.x, n.y, n.z);
      ++counts.normals;
      last = n;
    }
    index.push_back(counts.normals - 1);
  }
  return index;
}

void write_face_head(Text& text, const PlacedMesh& placed, int face, Materials* materials) {
  const std::string& name = placed.part->faces[static_cast<std::size_t>(face)].name;
  text.add("g face_{}{}{}\n", face, name.empty() ? "" : "_", one_word(name));
  if (materials) text.add("usemtl {}\n", materials->name_of(placed.colour(face)));
}

void write_instance(Text& text, const PlacedMesh& placed, const std::string& name, Counts& counts, Materials* materials) {
  text.add("o {}\n", name);
  const std::uint64_t first_point = counts.points;
  const std::vector<std::uint64_t> normal = write_vertices(text, placed, counts);
  counts.points += placed.mesh->points.size();
  int current = -1;
  for_each_triangle(*placed.mesh, [&](int face, const Triangle& stored) {
    if (face != current) write_face_head(text, placed, face, materials);
    current = face;
    const Triangle t = placed.turned(stored);
    const auto point = [&](int k) { return first_point + placed.mesh->nodes[t[static_cast<std::size_t>(k)]].point; };
    text.add("f {}//{} {}//{} {}//{}\n", point(0), normal[t[0]], point(1), normal[t[1]], point(2), normal[t[2]]);
  });
}

}  // namespace

Result<WrittenMesh> write_obj(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options) {
  WrittenMesh written;
  const std::string program = "isophote" + (options.version.empty() ? "" : " " + options.version);
  auto file = OutputFile::open(path);
  if (!file) return file.error();
  std::optional<Materials> materials;
  const std::string library = fs::path(path).replace_extension(".mtl");
  {
    Text text(*file);
    text.add("# {}; unit {}\n", program, model.unit.empty() ? "unknown" : model.unit);
    if (any_colour(placed)) {
      materials.emplace();
      text.add("mtllib {}\n", fs::path(library).filename().string());
    }
    Names names;
    Counts counts;
    for (const PlacedMesh& p : placed) {
      write_instance(text, p, names.of(p), counts, materials ? &*materials : nullptr);
      written.triangles += p.mesh->triangles.size();
    }
  }

  // The library is put in place only once the large file is known to be whole.
  if (const auto done = file->finish(); !done) return done.error();
  written.bytes = file->size();
  if (materials) {
    const std::string text = materials->text(program);
    if (const auto done = write_whole_file(library, text); !done) return done.error();
    written.bytes += text.size();
  }
  if (const auto done = file->put_in_place(); !done) return done.error();
  written.files = {path};
  if (materials) written.files.push_back(library);
  return written;
}

}  // namespace iso
