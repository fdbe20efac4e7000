#include "tests/support/mesh_files.h"

#include <cstring>
#include <fstream>
#include <glm/mat4x4.hpp>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace iso::test {
namespace {

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot open " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Numbers one after the other out of a string.
class Reader {
 public:
  explicit Reader(const std::string& bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}
  template <class T>
  T get() {
    if (at_ + sizeof(T) > bytes_.size()) throw std::runtime_error("the file is cut off");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  template <class T>
  Vec3 get3() {
    const T x = get<T>(), y = get<T>(), z = get<T>();
    return {x, y, z};
  }
  std::size_t at() const { return at_; }

 private:
  const std::string& bytes_;
  std::size_t at_;
};

// "12//34" as two numbers from 0.
std::pair<std::uint32_t, std::uint32_t> corner_of(const std::string& word) {
  const std::size_t slashes = word.find("//");
  if (slashes == std::string::npos) throw std::runtime_error("expected a//n, found " + word);
  return {static_cast<std::uint32_t>(std::stoul(word)) - 1, static_cast<std::uint32_t>(std::stoul(word.substr(slashes + 2))) - 1};
}

void read_obj_line(const std::string& line, ObjFile& obj) {
  std::istringstream words(line);
  std::string key, name;
  words >> key;
  const auto vector = [&] {
    std::string x, y, z;
    words >> x >> y >> z;
    return Vec3(std::stod(x), std::stod(y), std::stod(z));
  };
  if (key == "v") obj.points.push_back(vector());
  if (key == "vn") obj.normals.push_back(vector());
  if (key == "o" && words >> name) obj.objects.push_back(name);
  if (key == "g" && words >> name) obj.groups.push_back(name);
  if (key == "usemtl" && words >> name) obj.materials.push_back(name);
  if (key == "mtllib") words >> obj.library;
  if (key != "f") return;
  Corners points{}, normals{};
  for (std::size_t k = 0; k < 3 && words >> name; ++k) std::tie(points[k], normals[k]) = corner_of(name);
  obj.triangles.push_back(points);
  obj.triangle_normals.push_back(normals);
  obj.object_of.push_back(static_cast<int>(obj.objects.size()) - 1);
  obj.group_of.push_back(static_cast<int>(obj.groups.size()) - 1);
}

std::size_t components(const std::string& type) { return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 0; }

// What the specification demands of an accessor, its view and its numbers.
void check_accessor(GlbFile& file, std::size_t index) {
  const auto& accessor = file.json["accessors"][index];
  const auto& view = file.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::size_t offset = view.value("byteOffset", std::size_t{0}), length = view["byteLength"];
  const std::size_t needed = accessor["count"].get<std::size_t>() * components(accessor["type"]) * 4;
  const auto complain = [&](const std::string& what) { file.complaints.push_back("accessor " + std::to_string(index) + ": " + what); };
  if (offset % 4 != 0) complain("not aligned");
  if (needed == 0) complain("holds nothing");
  if (needed > length || offset + length > file.binary.size()) return complain("out of bounds");
  if (!accessor.contains("min")) return;
  const std::vector<double> numbers = numbers_of(file, index);
  for (std::size_t k = 0; k < 3; ++k) {
    Range range;
    for (std::size_t i = k; i < numbers.size(); i += 3) range.include(numbers[i]);
    if (range.lo != accessor["min"][k] || range.hi != accessor["max"][k]) complain("min or max is wrong");
  }
}

void check_primitive(GlbFile& file, const nlohmann::json& primitive) {
  const auto& attributes = primitive["attributes"];
  const auto& accessors = file.json["accessors"];
  const std::size_t count = accessors[attributes["POSITION"].get<std::size_t>()]["count"];
  for (const auto& [name, accessor] : attributes.items())
    if (accessors[accessor.get<std::size_t>()]["count"] != count) file.complaints.push_back(name + " has another count");
  if (!accessors[attributes["POSITION"].get<std::size_t>()].contains("min")) file.complaints.push_back("POSITION has no min");
  const std::vector<double> normals = numbers_of(file, attributes["NORMAL"]);
  for (std::size_t i = 0; i < normals.size(); i += 3)
    if (std::abs(glm::length(Vec3(normals[i], normals[i + 1], normals[i + 2])) - 1) > 1e-6)
      file.complaints.push_back("a normal is not unit");
  const std::vector<double> indices = numbers_of(file, primitive["indices"]);
  if (indices.size() % 3 != 0) file.complaints.push_back("indices are not triples");
  for (const double i : indices)
    if (i >= static_cast<double>(count)) file.complaints.push_back("an index is out of range");
  if (primitive["material"] >= file.json["materials"].size()) file.complaints.push_back("no such material");
}

void add_node(const GlbFile& file, std::size_t index, glm::dmat4 to_root, std::vector<std::array<Vec3, 3>>& out) {
  const auto& node = file.json["nodes"][index];
  if (node.contains("matrix")) {
    glm::dmat4 m;
    for (int k = 0; k < 16; ++k) m[k / 4][k % 4] = node["matrix"][static_cast<std::size_t>(k)];
    to_root = to_root * m;
  }
  if (node.contains("mesh"))
    for (const auto& primitive : file.json["meshes"][node["mesh"].get<std::size_t>()]["primitives"]) {
      const std::vector<double> p = numbers_of(file, primitive["attributes"]["POSITION"]), i = numbers_of(file, primitive["indices"]);
      const auto corner = [&](std::size_t k) {
        const std::size_t v = 3 * static_cast<std::size_t>(i[k]);
        return Vec3(to_root * glm::dvec4(p[v], p[v + 1], p[v + 2], 1));
      };
      // [glTF 2.0, 3.7.4: a negative determinant turns the winding around]
      const bool mirrored = glm::determinant(glm::dmat3(to_root)) < 0;
      for (std::size_t t = 0; t < i.size(); t += 3)
        out.push_back({corner(t), corner(t + (mirrored ? 2 : 1)), corner(t + (mirrored ? 1 : 2))});
    }
  for (const auto& child : node.value("children", nlohmann::json::array())) add_node(file, child, to_root, out);
}

}  // namespace

StlFile read_stl_file(const std::string& path) {
  const std::string bytes = bytes_of(path);
  StlFile stl;
  stl.header = bytes.substr(0, 80);
  Reader in(bytes, 80);
  const auto count = in.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    stl.normals.push_back(in.get3<float>());
    std::array<Vec3, 3> corners;
    for (Vec3& c : corners) c = in.get3<float>();
    stl.triangles.push_back(corners);
    in.get<std::uint16_t>();
  }
  if (in.at() != bytes.size()) throw std::runtime_error("bytes after the last triangle");
  return stl;
}

ObjFile read_obj_file(const std::string& path) {
  ObjFile obj;
  std::istringstream text(bytes_of(path));
  for (std::string line; std::getline(text, line);) read_obj_line(line, obj);
  return obj;
}

PlyFile read_ply_file(const std::string& path) {
  const std::string bytes = bytes_of(path);
  PlyFile ply;
  std::istringstream text(bytes);
  std::size_t vertices = 0, triangles = 0;
  for (std::string line; std::getline(text, line) && line != "end_header";) {
    ply.header.push_back(line);
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) triangles = std::stoul(line.substr(13));
  }
  const bool coloured = !ply.header.empty() && ply.header.back() == "property uchar blue";
  Reader in(bytes, static_cast<std::size_t>(text.tellg()));
  for (std::size_t i = 0; i < vertices; ++i) {
    ply.points.push_back(in.get3<double>());
    ply.normals.push_back(in.get3<float>());
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    if (in.get<std::uint8_t>() != 3) throw std::runtime_error("not a triangle");
    ply.triangles.push_back(in.get<Corners>());
    ply.face_ids.push_back(in.get<std::int32_t>());
    if (coloured) ply.colours.push_back(in.get<std::array<std::uint8_t, 3>>());
  }
  if (in.at() != bytes.size()) throw std::runtime_error("bytes after the last triangle");
  return ply;
}

std::vector<double> numbers_of(const GlbFile& file, std::size_t index) {
  const auto& accessor = file.json["accessors"][index];
  const auto& view = file.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  Reader in(file.binary, view["byteOffset"].get<std::size_t>() + accessor.value("byteOffset", std::size_t{0}));
  std::vector<double> numbers(accessor["count"].get<std::size_t>() * components(accessor["type"]));
  for (double& x : numbers) x = accessor["componentType"] == 5126 ? static_cast<double>(in.get<float>()) : in.get<std::uint32_t>();
  return numbers;
}

GlbFile read_glb_file(const std::string& path) {
  const std::string bytes = bytes_of(path);
  GlbFile file;
  Reader in(bytes);
  if (in.get<std::array<char, 4>>() != std::array{'g', 'l', 'T', 'F'} || in.get<std::uint32_t>() != 2)
    throw std::runtime_error("not glTF 2");
  if (in.get<std::uint32_t>() != bytes.size()) file.complaints.push_back("the length is wrong");

  // Chunks: one of JSON, then one of numbers if there are any, each in multiples of four bytes.
  for (std::size_t at = 12, number = 0; at < bytes.size(); ++number) {
    Reader head(bytes, at);
    const auto length = head.get<std::uint32_t>(), type = head.get<std::uint32_t>();
    if (length % 4 != 0 || head.at() + length > bytes.size()) file.complaints.push_back("a chunk has a wrong length");
    const std::string content = bytes.substr(head.at(), length);
    if (type != (number == 0 ? 0x4E4F534Au : 0x004E4942u)) file.complaints.push_back("a chunk has a wrong type");
    if (number == 0) file.json = nlohmann::json::parse(content);
    if (number == 1) file.binary = content;
    at = head.at() + length;
  }
  if (file.json["asset"]["version"] != "2.0") file.complaints.push_back("the version is wrong");
  const std::size_t size = file.json.contains("buffers") ? file.json["buffers"][0]["byteLength"].get<std::size_t>() : 0;
  if (size != file.binary.size()) file.complaints.push_back("the buffer has another size than its chunk");
  for (std::size_t i = 0; i < file.json.value("accessors", nlohmann::json::array()).size(); ++i) check_accessor(file, i);
  for (const auto& mesh : file.json.value("meshes", nlohmann::json::array()))
    for (const auto& primitive : mesh["primitives"]) check_primitive(file, primitive);
  return file;
}

std::vector<std::array<Vec3, 3>> placed_triangles(const GlbFile& file) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const auto& node : file.json["scenes"][file.json["scene"].get<std::size_t>()]["nodes"])
    add_node(file, node, glm::dmat4(1.0), triangles);
  return triangles;
}

}  // namespace iso::test
