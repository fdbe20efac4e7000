// What lies in a glTF 2.0 file: its JSON, and the numbers of its accessors.  [Khronos glTF 2.0 specification]
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "patches/io/json_value.h"

namespace iso {

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

  JsonValue root() const { return {path_, json_}; }

  // The entry of a list at the root ("nodes") that `index` refers to.
  JsonValue refer(const JsonValue& index, const char* list) const;

  // Of an accessor of this type: "SCALAR" or "VEC3".
  GltfNumbers numbers(const JsonValue& accessor, const std::string& type) const;

 private:
  struct Component;
  std::string_view chunks(std::string_view content);
  void parse(std::string_view text, std::size_t bytes_before);
  void read_buffers();
  std::string_view buffer(const JsonValue& value, std::size_t i);
  Component component(const JsonValue& holder) const;
  std::vector<std::uint64_t> sparse_places(const JsonValue& sparse, std::uint64_t count) const;
  template <class Put>
  void for_each_element(const JsonValue& holder, std::uint64_t count, std::size_t bytes, Put put) const;

  const std::string& path_;
  nlohmann::json json_;
  std::string_view binary_;                // the chunk of a .glb
  std::vector<std::string> owned_;         // buffers from elsewhere
  std::vector<std::string_view> buffers_;  // each of its byteLength
  std::uint64_t bytes_ = 0;                // of all buffers
};

}  // namespace iso
