// glTF 2.0, binary: a header, a chunk of JSON that says what lies where, a chunk of numbers.  [Khronos glTF 2.0 specification]
#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "patches/io/placed_mesh.h"

namespace iso {
namespace {

using Json = nlohmann::ordered_json;
using ColourKey = std::optional<std::array<float, 3>>;

ColourKey key_of(const std::optional<Colour>& c) { return c ? ColourKey({c->r, c->g, c->b}) : ColourKey(); }

// Faces of one colour of their own, or of none.
struct Group {
  ColourKey colour;
  std::vector<int> faces;
  std::uint64_t triangles = 0;
  std::size_t accessor = 0;  // of its indices
};

// What meshes share: the nodes and triangles of a part, or of one sheared instance of it, then in model coordinates.
struct Geometry {
  const PlacedMesh* placed = nullptr;
  bool baked = false;
  std::vector<Group> groups;
  std::size_t first_accessor = 0;  // positions, normals, numbers of faces

  FloatPoint position(const MeshNode& node) const {
    const Point3& p = placed->mesh->points[node.point];
    return FloatPoint(baked ? placed->point(p) : p);
  }
  Triangle turned(const Triangle& t) const { return baked ? placed->turned(t) : t; }
};

// A geometry whose colourless faces have got the colour of an instance.
struct MeshKey {
  std::size_t geometry = 0;
  ColourKey fallback;
  auto operator<=>(const MeshKey&) const = default;
};

// A node's matrix must be scales along the axes and a rotation, so its columns are at right angles. Readers compute in float, and cannot
// tell angles apart that differ by less than this.
constexpr double kRightAngle = 1e-6;
bool is_sheared(const Mat3& m) {
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = m[i], b = m[(i + 1) % 3];
    if (std::abs(glm::dot(a, b)) > kRightAngle * glm::length(a) * glm::length(b)) return true;
  }
  return false;
}

std::vector<Group> groups_of(const PlacedMesh& placed) {
  std::vector<Group> groups;
  std::map<ColourKey, std::size_t> index;
  for (int face = 0; face < placed.mesh->face_count(); ++face) {
    const std::uint32_t triangles = placed.mesh->first_triangle[face + 1] - placed.mesh->first_triangle[face];
    if (triangles == 0) continue;
    const ColourKey colour = key_of(placed.part->faces[static_cast<std::size_t>(face)].colour);
    const auto [at, is_new] = index.try_emplace(colour, groups.size());
    if (is_new) groups.push_back({colour, {}, 0, 0});
    groups[at->second].faces.push_back(face);
    groups[at->second].triangles += triangles;
  }
  return groups;
}

// Builds the JSON chunk and decides where the numbers go.
class Plan {
 public:
  Plan(const Model& model, const Placed& placed, const WriteMeshOptions& options) {
    Json nodes = Json::array({root_node(model)});
    for (const PlacedMesh& p : placed) {
      nodes[0]["children"].push_back(nodes.size());
      nodes.push_back(node_of(p));
    }
    json_["asset"] = {{"version", "2.0"}, {"generator", "isophote" + (options.version.empty() ? "" : " " + options.version)}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
    json_["nodes"] = std::move(nodes);
    for (auto* list : {&meshes_, &materials_, &accessors_, &views_}) {
      const char* name = list == &meshes_      ? "meshes"
                         : list == &materials_ ? "materials"
                         : list == &accessors_ ? "accessors"
                                               : "bufferViews";
      if (!list->empty()) json_[name] = std::move(*list);
    }
    if (bytes_ > 0) json_["buffers"] = Json::array({{{"byteLength", bytes_}}});
  }

  std::string json() const {
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return text;
  }
  std::uint64_t bytes() const { return bytes_; }
  const std::vector<Geometry>& geometries() const { return geometries_; }
  const std::optional<Vec3>& beyond() const { return beyond_; }  // a point that float cannot hold

 private:
  // z up to y up, millimetres to metres.
  static Json root_node(const Model& model) {
    const double s = model.unit == "mm" ? 0.001 : 1;
    const std::string name = std::filesystem::path(model.file).stem().string();
    return {{"name", name.empty() ? "model" : name}, {"matrix", {s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, 0, 0, 0, 1}}};
  }

  Json node_of(const PlacedMesh& p) {
    const bool baked = is_sheared(p.instance->to_model.linear);
    Json node;
    node["name"] = p.instance->name.empty() ? p.part->name : p.instance->name;
    if (node["name"] == "") node["name"] = fmt::format("instance_{}", p.number);
    if (!baked && !p.instance->to_model.is_identity()) {
      Json matrix;
      for (int c = 0; c < 4; ++c) {
        const Vec3 column = c < 3 ? p.instance->to_model.linear[c] : p.instance->to_model.translation;
        for (int r = 0; r < 3; ++r) matrix.push_back(column[r]);
        matrix.push_back(c < 3 ? 0 : 1);
      }
      node["matrix"] = std::move(matrix);
    }
    node["mesh"] = mesh_of(p, geometry_of(p, baked));
    return node;
  }

  std::size_t geometry_of(const PlacedMesh& p, bool baked) {
    const auto [at, is_new] = geometry_index_.try_emplace({p.instance->part, baked ? p.number : -1}, geometries_.size());
    if (!is_new) return at->second;
    Geometry g{&p, baked, groups_of(p), accessors_.size()};
    add_vertices(g);
    for (Group& group : g.groups) {
      group.accessor = accessors_.size();
      add_accessor(5125, "SCALAR", 3 * group.triangles, 4, 34963);  // UNSIGNED_INT, ELEMENT_ARRAY_BUFFER
    }
    geometries_.push_back(std::move(g));
    return at->second;
  }

  void add_vertices(const Geometry& g) {
    const std::vector<MeshNode>& nodes = g.placed->mesh->nodes;
    Box3 box;
    for (const MeshNode& node : nodes) {
      const FloatPoint p = g.position(node);
      if (!p.is_finite()) beyond_ = g.placed->mesh->points[node.point];
      box.include(p.exact());
    }
    for (const char* type : {"VEC3", "VEC3", "SCALAR"})  // FLOAT, ARRAY_BUFFER
      add_accessor(5126, type, nodes.size(), type[0] == 'V' ? 12 : 4, 34962);
    accessors_[g.first_accessor]["min"] = {box.lo.x, box.lo.y, box.lo.z};
    accessors_[g.first_accessor]["max"] = {box.hi.x, box.hi.y, box.hi.z};
  }

  void add_accessor(int component, const char* type, std::uint64_t count, std::uint64_t bytes_each, int target) {
    accessors_.push_back({{"bufferView", views_.size()}, {"componentType", component}, {"count", count}, {"type", type}});
    views_.push_back({{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", count * bytes_each}, {"target", target}});
    bytes_ += count * bytes_each;
  }

  std::size_t mesh_of(const PlacedMesh& p, std::size_t geometry) {
    const Geometry& g = geometries_[geometry];
    MeshKey key{geometry, {}};
    for (const Group& group : g.groups)
      if (!group.colour) key.fallback = key_of(p.instance->colour);
    const auto [at, is_new] = mesh_index_.try_emplace(key, meshes_.size());
    if (!is_new) return at->second;
    const std::size_t a = g.first_accessor;
    Json primitives;
    for (const Group& group : g.groups)
      primitives.push_back({{"attributes", {{"POSITION", a}, {"NORMAL", a + 1}, {"_FACE_ID", a + 2}}},
                            {"indices", group.accessor},
                            {"material", material_of(group.colour ? group.colour : key.fallback)},
                            {"mode", 4}});
    meshes_.push_back(
        {{"name", p.part->name.empty() ? fmt::format("part_{}", p.instance->part) : p.part->name}, {"primitives", primitives}});
    return at->second;
  }

  std::size_t material_of(const ColourKey& colour) {
    const auto [at, is_new] = material_index_.try_emplace(colour, materials_.size());
    if (!is_new) return at->second;
    Json factor;
    for (int k = 0; k < 3; ++k) factor.push_back(std::clamp(colour ? (*colour)[static_cast<std::size_t>(k)] : kUncoloured[k], 0.0f, 1.0f));
    factor.push_back(1);
    materials_.push_back({{"name", colour ? fmt::format("colour_{}", materials_.size() + 1) : "uncoloured"},
                          {"pbrMetallicRoughness", {{"baseColorFactor", factor}, {"metallicFactor", 0}, {"roughnessFactor", 0.6}}},
                          {"doubleSided", true}});
    return at->second;
  }

  Json json_, meshes_ = Json::array(), materials_ = Json::array(), accessors_ = Json::array(), views_ = Json::array();
  std::vector<Geometry> geometries_;
  std::map<std::pair<int, int>, std::size_t> geometry_index_;
  std::map<MeshKey, std::size_t> mesh_index_;
  std::map<ColourKey, std::size_t> material_index_;
  std::uint64_t bytes_ = 0;
  std::optional<Vec3> beyond_;
};

// The numbers of a geometry, in the order of its accessors.
void write_geometry(OutputFile& file, const Geometry& g, WrittenMesh& written) {
  const PartMesh& mesh = *g.placed->mesh;
  for (const MeshNode& node : mesh.nodes) put(file, g.position(node));
  for (const Vec3& n : full_normals(mesh)) {
    const FloatPoint normal(g.baked ? g.placed->normal(n) : n);
    ISO_CHECK(normal.is_finite());
    put(file, normal);
  }
  for (int face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t i = mesh.first_node[face]; i < mesh.first_node[face + 1]; ++i) put(file, static_cast<float>(face));
  for (const Group& group : g.groups)
    for (const int face : group.faces)
      for (std::uint32_t i = mesh.first_triangle[face]; i < mesh.first_triangle[face + 1]; ++i) {
        const Triangle t = g.turned(mesh.triangles[i]);
        put(file, t);
        const auto corner = [&](int k) { return g.position(mesh.nodes[t[static_cast<std::size_t>(k)]]); };
        written.collapsed += without_area(corner(0), corner(1), corner(2));
      }
  written.triangles += mesh.triangles.size();
}

}  // namespace

Result<WrittenMesh> write_glb(const std::string& path, const Model& model, const Placed& placed, const WriteMeshOptions& options) {
  const Plan plan(model, placed, options);
  if (plan.beyond()) return beyond_float(path, *plan.beyond());
  const std::string json = plan.json();
  const std::uint64_t total = 12 + 8 + json.size() + (plan.bytes() > 0 ? 8 + plan.bytes() : 0);
  if (total > std::numeric_limits<std::uint32_t>::max())
    return bad_input(path, {},
                     fmt::format("the file would take {} bytes; binary glTF ends at 4 GiB: expected a coarser mesh, or .ply", total));

  auto file = OutputFile::open(path);
  if (!file) return file.error();
  const auto word = [&](std::uint64_t value) { put(*file, static_cast<std::uint32_t>(value)); };
  file->write("glTF");
  word(2);
  word(total);
  word(json.size());
  file->write("JSON");
  file->write(json);
  WrittenMesh written;
  if (plan.bytes() > 0) {
    word(plan.bytes());
    file->write({"BIN\0", 4});
    for (const Geometry& g : plan.geometries()) write_geometry(*file, g, written);
  }
  ISO_CHECK(file->size() == total);
  if (const auto done = file->put_in_place(); !done) return done.error();
  written.bytes = total;
  written.files = {path};
  return written;
}

}  // namespace iso
