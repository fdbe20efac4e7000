// Plain text files of words and numbers, read with their line numbers: common ground of the readers of .bpt, OBJ, and of meshes in text.
//
// The readers throw an `Error` from the depth of their parsing and turn it into a `Result` at their one entrance; it never
// leaves the file it was thrown in.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "patches/base/result.h"

namespace iso {

// Coordinates and parameters beyond this are taken for damage: their squares still fit a double with room, but no model is that large.
inline constexpr double kLargestNumber = 1e15;

// The whole file as it is.
inline Result<std::string> read_text(const std::string& path) {
  const auto failure = [&] { return read_write_error(path, std::string("cannot be read: ") + std::strerror(errno)); };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return failure();
  std::string text;
  std::array<char, 65536> block;
  while (const std::size_t n = std::fread(block.data(), 1, block.size(), file.get())) text.append(block.data(), n);
  if (std::ferror(file.get())) return failure();
  return text;
}

// A word of the file for a message: short, and printable whatever the file holds.
inline std::string quoted(std::string_view word) {
  constexpr std::size_t kShown = 32;
  std::string shown = "\"";
  for (const char c : word.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (word.size() > kShown ? "...\"" : "\"");
}

inline std::optional<double> parse_number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if (status == std::errc::result_out_of_range) return word.find("e-") != word.npos || word.find("E-") != word.npos ? 0.0 : HUGE_VAL;
  if (status != std::errc()) return std::nullopt;
  return value;
}
inline std::optional<long> parse_integer(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  long value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// One statement: its words and the line it starts on (from 1).
struct TextLine {
  int number = 0;
  std::vector<std::string_view> words;
};

enum class LineEnd { backslash_joins, always_ends };  // what a backslash at the end of a line does

// Hands out the lines of a text that hold something: comments (from a '#' that starts a word) and empty lines are passed over.
class TextLines {
 public:
  // `lines_before`: of the file, that are not in `text`.
  explicit TextLines(std::string_view text, LineEnd end = LineEnd::backslash_joins, int lines_before = 0)
      : rest_(text), line_end_(end), number_(lines_before) {}

  // False at the end of the text.
  bool next(TextLine& line) {
    line.words.clear();
    bool joined = false;
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      std::string_view physical = rest_.substr(0, end);
      rest_ = end == rest_.npos ? std::string_view{} : rest_.substr(end + 1);
      ++number_;
      if (!joined) line.number = number_;
      joined = split(physical, line_end_, line.words);
      if (!joined && !line.words.empty()) return true;
    }
    return !line.words.empty();
  }

  // The number of the line handed out last, or of the last line of the text.
  int number() const { return std::max(number_, 1); }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  // Appends the words of a physical line; true if the line goes on.
  static bool split(std::string_view physical, LineEnd line_end, std::vector<std::string_view>& words) {
    const auto past = [&](std::size_t at, bool space) {
      while (at < physical.size() && is_space(physical[at]) == space) ++at;
      return at;
    };
    for (std::size_t begin = past(0, true); begin < physical.size() && physical[begin] != '#';) {
      const std::size_t end = past(begin, false), next = past(end, true);
      std::string_view word = physical.substr(begin, end - begin);
      const bool goes_on = line_end == LineEnd::backslash_joins && word.back() == '\\' && next == physical.size();
      if (goes_on) word.remove_suffix(1);
      if (!word.empty()) words.push_back(word);
      if (goes_on) return true;
      begin = next;
    }
    return false;
  }

  std::string_view rest_;
  LineEnd line_end_;
  int number_;
};

// Throws the error of a place in the file.
[[noreturn]] inline void fail(const std::string& path, int line, const std::string& message) {
  throw bad_input(path, std::to_string(line), message);
}

// A finite number of sensible size, or an error that says what was expected.
inline double number_in(const std::string& path, int line, std::string_view word, const std::string& expected) {
  const auto value = parse_number(word);
  if (!value) fail(path, line, "found " + quoted(word) + ", expected " + expected);
  if (!std::isfinite(*value) || std::abs(*value) > kLargestNumber)
    fail(path, line, "found " + quoted(word) + ", expected " + expected + ", finite and at most 1e15 in size");
  return *value;
}

// "wing" of "models/wing.obj".
inline std::string stem_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string name = slash == path.npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.find_last_of('.');
  return dot == name.npos || dot == 0 ? name : name.substr(0, dot);
}

}  // namespace iso
