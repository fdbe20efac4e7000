#include "tests/support/mesh_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>

namespace iso::test {
namespace {

template <class T>
void put(std::string& bytes, T value, bool big = false) {
  char b[sizeof(T)];
  std::memcpy(b, &value, sizeof(T));
  if (big) std::reverse(b, b + sizeof(T));
  bytes.append(b, sizeof(T));
}

void put_as(const std::string& type, std::string& bytes, double value, PlyBytes order) {
  const bool big = order == PlyBytes::big;
  if (order == PlyBytes::text)
    bytes += fmt::format("{} ", value);
  else if (type == "char" || type == "int8" || type == "uchar" || type == "uint8")
    put(bytes, static_cast<std::int8_t>(value));
  else if (type == "short" || type == "int16" || type == "ushort" || type == "uint16")
    put(bytes, static_cast<std::int16_t>(value), big);
  else if (type == "float" || type == "float32")
    put(bytes, static_cast<float>(value), big);
  else if (type == "double" || type == "float64")
    put(bytes, value, big);
  else
    put(bytes, static_cast<std::int32_t>(value), big);
}

constexpr int kTetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string base64(const std::string& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= bytes.size() - i ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

double volume_of(const ForeignMesh& mesh) {
  double sum = 0;
  for (const PointTriangle& t : mesh.triangles) sum += glm::dot(mesh.points[t[0]], glm::cross(mesh.points[t[1]], mesh.points[t[2]]));
  return sum / 6;
}

int unpaired_edges(const ForeignMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const PointTriangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++count[{t[k], t[(k + 1) % 3]}];
  int unpaired = 0;
  for (const auto& [edge, n] : count) {
    const auto opposite = count.find({edge.second, edge.first});
    unpaired += n != 1 || opposite == count.end() || opposite->second != 1;
  }
  return unpaired;
}

std::string binary_stl(const std::vector<Point3>& points, const std::vector<PointTriangle>& triangles, const std::string& header) {
  std::string bytes = header;
  bytes.resize(80);
  put(bytes, static_cast<std::uint32_t>(triangles.size()));
  for (const PointTriangle& t : triangles) {
    for (int c = 0; c < 3; ++c) put(bytes, 0.0f);
    for (const std::uint32_t i : t)
      for (int c = 0; c < 3; ++c) put(bytes, static_cast<float>(points[i][c]));
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string text_stl(const std::vector<Point3>& points, const std::vector<PointTriangle>& triangles) {
  std::string text = "solid C:\\by hand\\\n";
  for (const PointTriangle& t : triangles) {
    text += "  facet normal nan nan nan\n    outer loop\n";
    for (const std::uint32_t i : t) text += fmt::format("      vertex {} {} {}\n", points[i].x, points[i].y, points[i].z);
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid C:\\by hand\\\n";
}

std::string tetrahedron_ply(PlyBytes order, const std::string& coordinate, const std::string& length, const std::string& index,
                            const std::string& list) {
  const char* const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string bytes = fmt::format("ply\nformat {} 1.0\nelement vertex 4\n", names[static_cast<int>(order)]);
  for (const char axis : {'x', 'y', 'z'}) bytes += fmt::format("property {} {}\n", coordinate, axis);
  bytes += fmt::format("property list uchar short extra\nelement face 4\nproperty list {} {} {}\nend_header\n", length, index, list);
  const auto end_row = [&] {
    if (order == PlyBytes::text) bytes += '\n';
  };
  for (int i = 0; i < 4; ++i) {
    for (int c = 0; c < 3; ++c) put_as(coordinate, bytes, i == c + 1, order);
    put_as("uchar", bytes, i, order);
    for (int k = 0; k < i; ++k) put_as("short", bytes, k, order);
    end_row();
  }
  for (const auto& side : kTetrahedron) {
    put_as(length, bytes, 3, order);
    for (const int i : side) put_as(index, bytes, i, order);
    end_row();
  }
  return bytes;
}

std::string gltf_numbers() {
  std::string bytes;
  for (const auto& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0, 1, 0)})
    for (int c = 0; c < 3; ++c) put(bytes, static_cast<float>(p[c]));
  for (const auto& side : kTetrahedron)
    for (const int i : side) put(bytes, static_cast<std::uint8_t>(i));
  return bytes;
}

std::string tetrahedron_gltf(const std::string& node, const std::string& more, GltfScene scene, const std::string& uri) {
  const std::string numbers = gltf_numbers();
  const std::string source = uri == "data" ? "data:application/octet-stream;base64," + base64(numbers) : uri;
  return fmt::format(R"({{"asset":{{"version":"2.0"}},{}"nodes":[{{{}{}{}}}],)"
                     R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
                     R"("accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},)"
                     R"({{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}}],)"
                     R"("bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],)"
                     R"("buffers":[{{{}"byteLength":{}}}]}})",
                     scene == GltfScene::first ? R"("scenes":[{"nodes":[0]}],)" : "", node, node.empty() || more.empty() ? "" : ",", more,
                     source.empty() ? "" : "\"uri\":\"" + source + "\",", numbers.size());
}

std::string glb_of(const std::string& json, const std::string& numbers) {
  std::string text = json, data = numbers, bytes = "glTF";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4);
  const auto word = [&](std::size_t n) { put(bytes, static_cast<std::uint32_t>(n)); };
  word(2);
  word(12 + 8 + text.size() + 8 + data.size());
  word(text.size());
  bytes += "JSON" + text;
  word(data.size());
  return bytes + std::string("BIN\0", 4) + data;
}

std::string square_gltf(const std::string& primitive) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {1, 0, -1}};
  std::string bytes, views, accessors;
  const auto view = [&](const std::string& members, const std::string& accessor, const std::string& added) {
    views += fmt::format("{}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{}}}", views.empty() ? "" : ",", bytes.size(), added.size(),
                         members);
    if (!accessor.empty()) accessors += (accessors.empty() ? "" : ",") + accessor;
    bytes += added;
    bytes.resize((bytes.size() + 3) / 4 * 4);
  };
  const auto points = [&](auto zero, std::size_t padding) {
    std::string added;
    for (const Vec3& p : corners) {
      for (int c = 0; c < 3; ++c) put(added, static_cast<decltype(zero)>(p[c]));
      added.append(padding, 'x');
    }
    return added;
  };
  const auto indices = [&](auto zero) {
    std::string added;
    for (const int i : {0, 1, 2, 2, 1, 3}) put(added, static_cast<decltype(zero)>(i));
    return added;
  };
  std::string place, value;
  put(place, std::uint16_t{3});
  for (const float x : {9.0f, 8.0f, 7.0f}) put(value, x);
  view("", R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})", points(0.0f, 0));
  view("", R"({"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"})", indices(std::uint8_t{}));
  view("", R"({"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"})", indices(std::uint16_t{}));
  view("", R"({"bufferView":3,"componentType":5125,"count":6,"type":"SCALAR"})", indices(std::uint32_t{}));
  view(R"(,"byteStride":16)", R"({"bufferView":4,"componentType":5126,"count":4,"type":"VEC3"})", points(0.0f, 4));
  view("", "", place);
  view("",
       R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,)"
       R"("indices":{"bufferView":5,"componentType":5123},"values":{"bufferView":6}}})",
       value);
  view(R"(,"byteStride":8)", R"({"bufferView":7,"componentType":5122,"count":4,"type":"VEC3"})", points(std::int16_t{}, 2));
  return fmt::format(R"({{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_mesh_quantization"],"scene":0,"scenes":[{{"nodes":[0]}}],)"
                     R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{{}}}]}}],"accessors":[{}],"bufferViews":[{}],)"
                     R"("buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}]}})",
                     primitive, accessors, views, bytes.size(), base64(bytes));
}

}  // namespace iso::test
