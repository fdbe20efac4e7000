// glTF 2.0: the meshes of the nodes of the default scene, where they stand, turned from y up to z up.
#include <fmt/format.h>
#include <glm/matrix.hpp>

#include <map>
#include <optional>

#include "patches/base/affine.h"
#include "patches/io/gltf_data.h"
#include "patches/io/mesh_input.h"

namespace iso {
namespace {

// (x, y, z) of glTF becomes (x, -z, y).
const Affine3 kToZUp{Mat3(Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0)), Vec3(0)};

// What a mesh has about its own origin; nodes share it.
struct Geometry {
  std::vector<Point3> points;
  std::vector<PointTriangle> triangles;
  double half_step = 0;  // how far the format may have moved a coordinate
};

class GltfReader {
 public:
  GltfReader(const std::string& path, std::string_view content) : data_(path, content), root_(data_.root()) {}

  ForeignMesh read() {
    check_extensions();
    mesh_.unit = "m";
    const std::size_t nodes = root_.has("nodes") ? root_.at("nodes").size() : 0;
    geometries_.resize(root_.has("meshes") ? root_.at("meshes").size() : 0);
    visited_.assign(nodes, false);
    if (root_.has("scenes"))
      visit_scene();
    else
      visit_roots(nodes);
    note(other_primitives_, "primitives of points or lines, left out");
    note(skinned_, "nodes whose skin is not applied");
    note(morphed_, "primitives whose morph targets are not applied");
    return std::move(mesh_);
  }

 private:
  // Extensions of looks change no triangle; any other one that is required may.
  void check_extensions() const {
    if (!root_.has("extensionsRequired")) return;
    static constexpr std::string_view kHarmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                     "KHR_lights_",    "KHR_xmp",      "KHR_mesh_quantization"};
    const JsonValue list = root_.at("extensionsRequired");
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string name = list.at(i).text();
      const auto is_start = [&](std::string_view start) { return name.starts_with(start); };
      if (std::none_of(std::begin(kHarmless), std::end(kHarmless), is_start))
        list.at(i).fail(iso::quoted(name), "no extension that meshes cannot be read without");
    }
  }

  void visit_scene() {
    const JsonValue scenes = root_.at("scenes");
    const JsonValue scene = root_.has("scene") ? data_.refer(root_.at("scene"), "scenes") : scenes.at(std::size_t{0});
    if (!scene.has("nodes")) return;
    for_each_node(scene.at("nodes"), [&](const JsonValue& entry, std::uint64_t i) { visit(entry, i); });
  }

  // All nodes that are no one's children.
  void visit_roots(std::size_t nodes) {
    std::vector<bool> is_child(nodes, false);
    for (std::size_t i = 0; i < nodes; ++i)
      for_each_child(root_.at("nodes").at(i), [&](const JsonValue&, std::uint64_t child) { is_child[child] = true; });
    for (std::size_t i = 0; i < nodes; ++i)
      if (!is_child[i]) visit(root_.at("nodes").at(i), i);
  }

  template <class F>
  void for_each_child(const JsonValue& node, F f) const {
    if (node.has("children")) for_each_node(node.at("children"), f);
  }
  // Calls f(entry, index) for a list of indices of nodes.
  template <class F>
  void for_each_node(const JsonValue& list, F f) const {
    for (std::size_t i = 0; i < list.size(); ++i) {
      data_.refer(list.at(i), "nodes");
      f(list.at(i), list.at(i).whole());
    }
  }

  // A node and all below it, without recursion: hierarchies may be as deep as the file is long. `place`: what errors name.
  void visit(const JsonValue& place, std::uint64_t index) {
    struct Waiting {
      JsonValue place;
      std::uint64_t index;
      Affine3 to_parent;
    };
    std::vector<Waiting> waiting{{place, index, kToZUp}};
    while (!waiting.empty()) {
      const Waiting now = std::move(waiting.back());
      waiting.pop_back();
      if (visited_[now.index]) now.place.fail(fmt::format("the node {} again", now.index), "each node once");
      visited_[now.index] = true;
      const JsonValue node = root_.at("nodes").at(now.index);
      const Affine3 to_model = now.to_parent * placement(node);
      if (node.has("mesh")) place_mesh(node, to_model);
      const std::size_t first = waiting.size();
      for_each_child(node, [&](const JsonValue& child, std::uint64_t i) { waiting.push_back({child, i, to_model}); });
      std::reverse(waiting.begin() + static_cast<long>(first), waiting.end());
    }
  }

  static Affine3 placement(const JsonValue& node) {
    if (node.has("matrix")) {
      const std::vector<double> m = node.at("matrix").numbers(16);
      if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        node.at("matrix").fail(fmt::format("a last row {} {} {} {}", m[3], m[7], m[11], m[15]), "0 0 0 1");
      return {Mat3(Vec3(m[0], m[1], m[2]), Vec3(m[4], m[5], m[6]), Vec3(m[8], m[9], m[10])), Vec3(m[12], m[13], m[14])};
    }
    Affine3 a;
    if (node.has("rotation")) a.linear = rotation(node.at("rotation"));
    if (node.has("scale")) {
      const std::vector<double> s = node.at("scale").numbers(3);
      for (int c = 0; c < 3; ++c) a.linear[c] *= s[static_cast<std::size_t>(c)];
    }
    if (node.has("translation")) {
      const std::vector<double> t = node.at("translation").numbers(3);
      a.translation = Vec3(t[0], t[1], t[2]);
    }
    return a;
  }

  // Of a quaternion x y z w, which need be unit only as far as its digits go.
  static Mat3 rotation(const JsonValue& value) {
    const std::vector<double> q = value.numbers(4);
    const double x = q[0], y = q[1], z = q[2], w = q[3], norm = x * x + y * y + z * z + w * w, s = 2 / norm;
    if (!(norm > 0) || !finite(norm) || !finite(s)) value.fail(fmt::format("a quaternion of length {}", std::sqrt(norm)), "length 1");
    return {Vec3(1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
            Vec3(s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)),
            Vec3(s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y))};
  }

  void place_mesh(const JsonValue& node, const Affine3& to_model) {
    skinned_ += node.has("skin");
    const JsonValue mesh = data_.refer(node.at("mesh"), "meshes");
    std::optional<Geometry>& stored = geometries_[node.at("mesh").whole()];
    if (!stored) stored = geometry(mesh);
    const Geometry& g = *stored;
    if (mesh_.points.size() + g.points.size() > kMostIndices || mesh_.triangles.size() + g.triangles.size() > kMostIndices)
      node.fail("more points or triangles", fmt::format("at most {} of each", kMostIndices));

    const auto first = static_cast<std::uint32_t>(mesh_.points.size());
    for (const Point3& p : g.points) {
      const Point3 placed = to_model.point(p);
      if (!is_sensible(placed)) node.fail(fmt::format("a point at {} {} {}", placed.x, placed.y, placed.z), kSensible);
      mesh_.points.push_back(placed);
    }
    const bool mirrored = glm::determinant(to_model.linear) < 0;  // turns triangles around [glTF 2.0, 3.7.4]
    for (PointTriangle t : g.triangles) {
      if (mirrored) std::swap(t[1], t[2]);
      for (std::uint32_t& i : t) i += first;
      mesh_.triangles.push_back(t);
    }
    Vec3 reach(0.0);
    for (int c = 0; c < 3; ++c) reach += glm::abs(to_model.linear[c]) * g.half_step;
    mesh_.rounding = std::max(mesh_.rounding, glm::length(reach));
  }

  Geometry geometry(const JsonValue& mesh) {
    Geometry g;
    std::map<std::uint64_t, std::pair<std::uint32_t, std::uint32_t>> read;  // first point and count, by accessor: primitives share them
    const JsonValue primitives = mesh.at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const JsonValue p = primitives.at(i);
      const std::uint64_t mode = p.whole_or("mode", 4);
      if (mode < 4) ++other_primitives_;
      if (mode > 6) p.at("mode").fail(fmt::format("{}", mode), "0 to 6");
      if (mode < 4 || !p.at("attributes").has("POSITION")) continue;
      morphed_ += p.has("targets");
      const JsonValue position = p.at("attributes").at("POSITION");
      const auto [at, is_new] = read.try_emplace(position.whole());
      if (is_new) at->second = add_points(g, position);
      add_triangles(g, p, mode, at->second.first, at->second.second);
    }
    return g;
  }

  std::pair<std::uint32_t, std::uint32_t> add_points(Geometry& g, const JsonValue& position) const {
    const GltfNumbers numbers = data_.numbers(position, "VEC3");
    const std::size_t first = g.points.size(), count = numbers.values.size() / 3;
    if (first + count > kMostIndices) position.fail("more points", fmt::format("at most {}", kMostIndices));
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Point3 p(numbers.values[3 * i], numbers.values[3 * i + 1], numbers.values[3 * i + 2]);
      if (!is_sensible(p)) position.fail(fmt::format("the point {} {} {} at {}", p.x, p.y, p.z, i), kSensible);
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      g.points.push_back(p);
    }
    g.half_step = std::max(g.half_step, numbers.is_float ? float_rounding(largest) / std::sqrt(3.0) : numbers.step / 2);
    return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
  }

  // Of a primitive over the points [first, first + count).
  void add_triangles(Geometry& g, const JsonValue& primitive, std::uint64_t mode, std::uint32_t first, std::uint32_t count) const {
    std::vector<std::uint32_t> corners;
    if (primitive.has("indices")) {
      const JsonValue indices = primitive.at("indices");
      for (const double i : data_.numbers(indices, "SCALAR").values) {
        if (!(i >= 0 && i < count && i == std::floor(i)))
          indices.fail(fmt::format("the index {}", i), fmt::format("one of {} points", count));
        corners.push_back(first + static_cast<std::uint32_t>(i));
      }
    } else {
      for (std::uint32_t i = 0; i < count; ++i) corners.push_back(first + i);
    }
    if (mode == 4 && corners.size() % 3 != 0) primitive.fail(fmt::format("{} corners", corners.size()), "three for each triangle");
    if (g.triangles.size() + corners.size() > kMostIndices) primitive.fail("more triangles", fmt::format("at most {}", kMostIndices));

    // [glTF 2.0, 3.7.2.1] In strips and fans, a corner twice makes no triangle.
    for (std::size_t i = 0; i + 2 < corners.size(); i += mode == 4 ? 3 : 1) {
      const std::size_t odd = mode == 5 ? i % 2 : 0;
      PointTriangle t{corners[i], corners[i + 1 + odd], corners[i + 2 - odd]};
      if (mode == 6) t = {corners[i + 1], corners[i + 2], corners[0]};
      if (mode == 4 || (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])) g.triangles.push_back(t);
    }
  }

  void note(std::uint64_t count, const char* what) {
    if (count > 0) mesh_.notes.push_back(fmt::format("{}: {}", what, count));
  }

  const GltfData data_;
  const JsonValue root_;
  ForeignMesh mesh_;
  std::vector<bool> visited_;                        // nodes
  std::vector<std::optional<Geometry>> geometries_;  // of meshes
  std::uint64_t other_primitives_ = 0, skinned_ = 0, morphed_ = 0;
};

}  // namespace

ForeignMesh gltf_mesh(const std::string& path, std::string_view content) { return GltfReader(path, content).read(); }

}  // namespace iso
