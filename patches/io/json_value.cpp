#include "patches/io/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "patches/io/text_input.h"

namespace iso {

bool JsonValue::has(const char* member) const { return json_->is_object() && json_->contains(member); }

JsonValue JsonValue::at(const char* member) const {
  if (!json_->is_object()) fail(json_->type_name(), "an object");
  const auto found = json_->find(member);
  if (found == json_->end()) fail("no member \"" + std::string(member) + "\"", "one");
  return {*file_, *found, path_.empty() ? member : path_ + "." + member};
}

std::uint64_t JsonValue::whole_or(const char* member, std::uint64_t absent) const { return has(member) ? at(member).whole() : absent; }

std::size_t JsonValue::size() const {
  if (!json_->is_array()) fail(json_->type_name(), "an array");
  return json_->size();
}

JsonValue JsonValue::at(std::size_t i) const {
  if (i >= size()) fail(fmt::format("{} entries", size()), fmt::format("at least {}", i + 1));
  return {*file_, (*json_)[i], fmt::format("{}[{}]", path_, i)};
}

std::vector<double> JsonValue::numbers(std::size_t count) const {
  if (size() != count) fail(fmt::format("{} entries", size()), fmt::format("{} numbers", count));
  std::vector<double> values;
  for (const auto& entry : *json_) {
    if (!entry.is_number() || !std::isfinite(entry.get<double>())) fail(entry.type_name(), fmt::format("{} finite numbers", count));
    values.push_back(entry.get<double>());
  }
  return values;
}

std::uint64_t JsonValue::whole() const {
  constexpr double kMost = 0x1p48;  // sums and small multiples of such fit into 64 bits
  const double value = json_->is_number() ? json_->get<double>() : -1;
  if (!(value >= 0 && value <= kMost && value == std::floor(value)))
    fail(json_->is_number() ? fmt::format("{}", value) : json_->type_name(), "a whole number from 0 on");
  return static_cast<std::uint64_t>(value);
}

std::string JsonValue::text() const {
  if (!json_->is_string()) fail(json_->type_name(), "text");
  return json_->get<std::string>();
}

void JsonValue::fail(const std::string& found, const std::string& expected) const {
  throw bad_input(*file_, path_.empty() ? "JSON" : path_, "found " + found + ", expected " + expected);
}

double JsonValue::number() const {
  if (!json_->is_number()) fail(json_->type_name(), "a number");
  const double value = json_->get<double>();
  if (!(std::abs(value) <= kLargestNumber)) fail(fmt::format("{}", value), "a finite number of at most 1e15 in size");
  return value;
}

void JsonValue::check_members(const std::vector<const char*>& known) const {
  if (!json_->is_object()) fail(json_->type_name(), "an object");
  for (const auto& item : json_->items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    std::string list;
    for (const char* name : known) list += (list.empty() ? "" : ", ") + std::string(name);
    fail("the unknown member " + iso::quoted(item.key()), list);
  }
}

std::string told(const nlohmann::json::exception& e) {
  std::string_view what = e.what();
  if (const auto end = what.find("] "); end != what.npos) what.remove_prefix(end + 2);
  std::string text;
  for (const char c : what.substr(0, 200)) text += c >= ' ' && c <= '~' ? c : '?';
  return text;
}

nlohmann::json parse_json_text(const std::string& path, std::string_view text) {
  const auto place_of = [&](std::size_t byte) {
    const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
    const std::size_t last = before.rfind('\n');
    return fmt::format("{}:{}", std::count(before.begin(), before.end(), '\n') + 1,
                       before.size() - (last == before.npos ? 0 : last + 1) + 1);
  };
  // The library keeps the last of equal members; a file that says a thing twice is refused instead.
  std::vector<std::set<std::string>> open;
  const nlohmann::json::parser_callback_t watch = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    if (event == nlohmann::json::parse_event_t::object_start) open.emplace_back();
    if (event == nlohmann::json::parse_event_t::object_end) open.pop_back();
    if (event == nlohmann::json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      throw bad_input(path, "JSON", "found the member " + iso::quoted(value.get<std::string>()) + " twice in one object, expected it once");
    return true;
  };
  try {
    return nlohmann::json::parse(text, watch);
  } catch (const nlohmann::json::parse_error& e) {
    throw bad_input(path, place_of(e.byte), told(e) + "; expected JSON");
  } catch (const nlohmann::json::exception& e) {
    throw bad_input(path, "JSON", told(e) + "; expected JSON");
  }
}

}  // namespace iso
