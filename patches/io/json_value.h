// JSON of model and mesh files: every complaint names the file, the path inside it, what was found and what was expected.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace iso {

// A value and its path ("meshes[2].primitives[0].mode"). Whatever is not as asked for throws an `Error` with that path. File name and JSON
// have to live as long as it does.
class JsonValue {
 public:
  JsonValue(const std::string& file, const nlohmann::json& json, std::string path = {})
      : file_(&file), json_(&json), path_(std::move(path)) {}

  // Of an object.
  bool has(const char* member) const;
  JsonValue at(const char* member) const;
  std::uint64_t whole_or(const char* member, std::uint64_t absent) const;
  // Of an array.
  std::size_t size() const;
  JsonValue at(std::size_t i) const;
  std::vector<double> numbers(std::size_t count) const;  // finite
  // Of a single value.
  std::uint64_t whole() const;  // 0 to 2^48
  std::string text() const;
  double number() const;  // finite, at most kLargestNumber in size
  // Insists on an object with no other members than these.
  void check_members(const std::vector<const char*>& known) const;
  bool is_true() const { return json_->is_boolean() && json_->get<bool>(); }

  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const;

 private:
  const std::string* file_;
  const nlohmann::json* json_;
  std::string path_;
};

// The text as JSON. Throws an `Error` with line and column for what is none, and for a member that one object has twice.
nlohmann::json parse_json_text(const std::string& path, std::string_view text);

// What the library says of text that is no JSON, without its numbers, on one line.
std::string told(const nlohmann::json::exception& e);

}  // namespace iso
