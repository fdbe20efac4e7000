// What lies in a glTF 2.0 file: values of its JSON with their paths, and the numbers of its accessors.  [Khronos glTF 2.0 specification]
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace iso {

// A value of the JSON and its path ("meshes[2].primitives[0].mode"). Whatever is not as asked for throws an `Error` with that path.
class GltfValue {
 public:
  GltfValue(const std::string& file, const nlohmann::json& json, std::string path = {})
      : file_(&file), json_(&json), path_(std::move(path)) {}

  // Of an object.
  bool has(const char* member) const;
  GltfValue at(const char* member) const;
  std::uint64_t whole_or(const char* member, std::uint64_t absent) const;
  // Of an array.
  std::size_t size() const;
  GltfValue at(std::size_t i) const;
  std::vector<double> numbers(std::size_t count) const;  // finite
  // Of a single value.
  std::uint64_t whole() const;  // 0 to 2^48
  std::string text() const;
  bool is_true() const { return json_->is_boolean() && json_->get<bool>(); }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const;

 private:
  const std::string* file_;
  const nlohmann::json* json_;
  std::string path_;
};

// The numbers of an accessor, component by component.
struct GltfNumbers {
  std::vector<double> values;
  bool is_float = false;
  double step = 1;  // between neighbouring values of integers, 1 or less if they are normalised
};

// A file with its buffers. Throws an `Error` for a container, JSON or buffer that is damaged or cannot be read.
class GltfData {
 public:
  // `content` (.glb or .gltf, told by its first bytes) and `path` must outlive it. Buffers in other files are looked for beside `path`.
  GltfData(const std::string& path, std::string_view content);

  GltfValue root() const { return {path_, json_}; }

  // The entry of a list at the root ("nodes") that `index` refers to.
  GltfValue refer(const GltfValue& index, const char* list) const;

  // Of an accessor of this type: "SCALAR" or "VEC3".
  GltfNumbers numbers(const GltfValue& accessor, const std::string& type) const;

 private:
  struct Component;
  std::string_view chunks(std::string_view content);
  void parse(std::string_view text, std::size_t bytes_before);
  void read_buffers();
  std::string_view buffer(const GltfValue& value, std::size_t i);
  Component component(const GltfValue& holder) const;
  std::vector<std::uint64_t> sparse_places(const GltfValue& sparse, std::uint64_t count) const;
  template <class Put>
  void for_each_element(const GltfValue& holder, std::uint64_t count, std::size_t bytes, Put put) const;

  const std::string& path_;
  nlohmann::json json_;
  std::string_view binary_;                // the chunk of a .glb
  std::vector<std::string> owned_;         // buffers from elsewhere
  std::vector<std::string_view> buffers_;  // each of its byteLength
  std::uint64_t bytes_ = 0;                // of all buffers
};

}  // namespace iso
