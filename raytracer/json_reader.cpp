#include "raytracer/json_reader.h"

#include <fmt/format.h>

#include <charconv>
#include <numeric>
#include <set>

#include "raytracer/srgb.h"

namespace iso {
namespace {

using nlohmann::json;

// A value as a reader of the message would recognise it.
std::string described(const json& value) {
  switch (value.type()) {
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return fmt::format("a list of {}", value.size());
    case json::value_t::null:
      return "null";
    default:
      break;
  }
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  constexpr std::size_t kLongest = 40;
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

std::string joined(const std::vector<const char*>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : (i + 1 == words.size() ? " or " : ", "), words[i]);
  return text;
}

// [Damerau 1964]: insertions, deletions, replacements, and swaps of neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

std::string line_and_column(const std::string& text, std::size_t byte) {
  const std::size_t end = std::min(byte > 0 ? byte - 1 : 0, text.size());
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i < end; ++i)
    if (text[i] == '\n') {
      ++line;
      column = 1;
    } else {
      ++column;
    }
  return fmt::format("{}:{}", line, column);
}

// The library's message without its own prefix and position.
std::string plain_message(std::string text) {
  if (const auto at = text.find("syntax error"); at != std::string::npos) text = text.substr(at);
  return text;
}

}  // namespace

json parse_json(const std::string& text, const std::string& file) {
  // The library keeps the last of equal keys; a scene that says a thing twice is refused instead.
  std::vector<std::set<std::string>> open;
  const json::parser_callback_t watch = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      throw SceneError{bad_input(file, {}, fmt::format("the key '{}' occurs twice in one object", value.get<std::string>()))};
    return true;
  };
  try {
    return json::parse(text, watch);
  } catch (const json::parse_error& e) {
    throw SceneError{bad_input(file, line_and_column(text, e.byte), plain_message(e.what()))};
  } catch (const json::exception& e) {
    throw SceneError{bad_input(file, {}, fmt::format("not readable as JSON: {}", e.what()))};
  }
}

void Node::fail(const std::string& message) const { throw SceneError{bad_input(file_, path_, message)}; }
void Node::expected(const std::string& what) const { fail(fmt::format("found {}, expected {}", described(*value_), what)); }

void Node::check_keys(const std::vector<const char*>& known) const {
  if (!is_object()) expected(fmt::format("an object with {}", joined(known)));
  for (const auto& item : value_->items()) {
    const std::string& key = item.key();
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const auto meant = did_you_mean(key, known);
    const Node child(item.value(), file_, path_.empty() ? key : path_ + "." + key);
    child.fail(fmt::format("unknown key '{}'; {}", key, meant ? fmt::format("did you mean '{}'?", *meant) : "expected " + joined(known)));
  }
}

Node Node::operator[](const char* key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) fail(fmt::format("the key '{}' is missing", key));
  return {*found, file_, path_.empty() ? key : path_ + "." + key};
}

std::vector<Node> Node::items(const char* what) const {
  if (!is_array()) expected(what);
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < value_->size(); ++i) nodes.emplace_back((*value_)[i], file_, fmt::format("{}[{}]", path_, i));
  return nodes;
}

double Node::number() const {
  if (!value_->is_number()) expected("a number");
  const double x = value_->get<double>();
  if (!std::isfinite(x)) expected("a finite number");
  return x;
}

double Node::positive() const {
  const double x = number();
  if (!(x > 0)) expected("a number above 0");
  return x;
}

long long Node::whole(long long lo, long long hi) const {
  const std::string what = fmt::format("a whole number from {} to {}", lo, hi);
  if (!value_->is_number()) expected(what);
  const double x = value_->get<double>();
  if (!(x >= static_cast<double>(lo)) || !(x <= static_cast<double>(hi)) || x != std::floor(x)) expected(what);
  return value_->is_number_integer() ? value_->get<long long>() : static_cast<long long>(x);
}

std::string Node::text() const {
  if (!is_string()) expected("a text");
  return value_->get<std::string>();
}

bool Node::boolean() const {
  if (!value_->is_boolean()) expected("true or false");
  return value_->get<bool>();
}

Vec3 Node::vector() const {
  if (!is_array() || value_->size() != 3) expected("a list of three numbers");
  const std::vector<Node> parts = items("a list of three numbers");
  return {parts[0].number(), parts[1].number(), parts[2].number()};
}

Vec3 Node::direction() const {
  // Scaled by the largest component first: squares of tiny or huge numbers would leave the range of double.
  const Vec3 v = vector();
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) fail("found [0, 0, 0], expected a direction");
  return glm::normalize(v / largest);
}

Colour Node::colour() const {
  const char* const kWhat = "a colour: three numbers from 0 on (linear), or \"#rrggbb\" (sRGB)";
  if (is_string()) {
    const auto hex = colour_from_hex(text());
    if (!hex) expected(kWhat);
    return *hex;
  }
  if (!is_array() || value_->size() != 3) expected(kWhat);
  const Vec3 v = vector();
  if (v.x < 0 || v.y < 0 || v.z < 0 || std::max({v.x, v.y, v.z}) > 1e6) fail("colour components must lie between 0 and 1e6");
  return Colour(v);
}

std::size_t Node::word(std::initializer_list<const char*> words) const { return word_of({words}); }

std::size_t Node::word_of(const std::vector<const char*>& words) const {
  if (!is_string()) expected(joined(words));
  const std::string found = text();
  for (std::size_t i = 0; i < words.size(); ++i)
    if (found == words[i]) return i;
  const auto meant = did_you_mean(found, words);
  expected(joined(words) + (meant ? fmt::format("; did you mean '{}'?", *meant) : ""));
}

std::optional<std::string> did_you_mean(std::string_view word, const std::vector<const char*>& known) {
  constexpr std::size_t kLongest = 64;  // longer words are no slips of the pen
  if (word.size() > kLongest) return {};
  const char* best = nullptr;
  std::size_t least = std::max<std::size_t>(1, word.size() / 2);
  for (const char* candidate : known)
    if (const std::size_t d = edit_distance(word, candidate); d < least || (d == least && best == nullptr)) {
      least = d;
      best = candidate;
    }
  if (best == nullptr) return {};
  return best;
}

std::optional<Colour> colour_from_hex(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return {};
  Colour colour;
  for (int i = 0; i < 3; ++i) {
    unsigned level = 0;
    const char* first = text.data() + 1 + 2 * i;
    const auto [end, code] = std::from_chars(first, first + 2, level, 16);
    if (code != std::errc{} || end != first + 2) return {};
    const float x = static_cast<float>(level) / 255;
    colour[i] = linear_from_srgb(x);
  }
  return colour;
}

}  // namespace iso
