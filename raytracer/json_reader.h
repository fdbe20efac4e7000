// JSON with manners: every complaint names the file, the path inside it, what was found and what was expected. A reader inside
// raytracer/, not an interface for others: it throws SceneError, which read_scene turns into a Result.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "patches/base/result.h"
#include "patches/base/vec.h"

namespace iso {

struct SceneError {
  Error error;
};

// The text as JSON; syntax errors give line and column, repeated keys are refused.
nlohmann::json parse_json(const std::string& text, const std::string& file);

// A value together with its place.
class Node {
 public:
  Node(const nlohmann::json& value, std::string file, std::string path = {})
      : value_(&value), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void expected(const std::string& what) const;  // "found ..., expected ..."

  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  bool is_number() const { return value_->is_number(); }

  // Insists on an object with no other keys than these.
  void check_keys(const std::vector<const char*>& known) const;
  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  Node operator[](const char* key) const;  // the key must be there
  std::vector<Node> items(const char* what) const;

  double number() const;  // finite
  double positive() const;
  long long whole(long long lo, long long hi) const;
  std::string text() const;
  bool boolean() const;
  Vec3 vector() const;     // three finite numbers
  Vec3 direction() const;  // not zero; scaled to unit length
  Colour colour() const;   // three non-negative numbers (linear) or "#rrggbb" (sRGB)

  // The index of a word in a list of words.
  std::size_t word(std::initializer_list<const char*> words) const;
  template <std::size_t N>
  std::size_t word(const std::array<const char*, N>& words) const {
    return word_of({words.begin(), words.end()});
  }

 private:
  std::size_t word_of(const std::vector<const char*>& words) const;
  const nlohmann::json* value_;
  std::string file_, path_;
};

// The word among `known` that `word` may have been meant to be, if one is near.
std::optional<std::string> did_you_mean(std::string_view word, const std::vector<const char*>& known);

// "#rrggbb" to linear Rec. 709; nothing if it is not of that form.
std::optional<Colour> colour_from_hex(std::string_view text);

}  // namespace iso
