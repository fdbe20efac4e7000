// Text files that are one stream of numbers, wherever their lines break: the patch files of P. Salvi's collections.
#pragma once

#include <string>
#include <string_view>

#include "patches/base/vec.h"
#include "patches/io/text_input.h"

namespace iso {

// Every complaint is an `Error` with the line. `where` ("side 2 of 5: ") goes before it.
class WordStream {
 public:
  WordStream(const std::string& path, std::string_view text) : path_(path), lines_(text, LineEnd::always_ends) {}

  long integer(long least, long most, const std::string& where, const std::string& expected) {
    const std::string_view word = next(where, expected);
    const auto value = parse_integer(word);
    if (!value || *value < least || *value > most) fail_here(where + "found " + quoted(word) + ", expected " + expected);
    return *value;
  }
  double number(const std::string& where, const std::string& expected) {
    const std::string_view word = next(where, expected);
    return number_in(path_, line_.number, word, expected + (where.empty() ? "" : " (" + where.substr(0, where.size() - 2) + ")"));
  }
  Vec3 point(const std::string& where) {
    Vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = number(where, "a coordinate");
    return p;
  }

  bool at_end() {
    while (word_ == line_.words.size()) {
      word_ = 0;
      if (!lines_.next(line_)) {
        line_.number = lines_.number();
        return true;
      }
    }
    return false;
  }
  int line() const { return line_.number; }  // of the word handed out last
  // How many words are left; none after it.
  int rest() {
    int words = 0;
    for (; !at_end(); ++word_) ++words;
    return words;
  }

  [[noreturn]] void fail_here(const std::string& message) const { fail(path_, std::max(line_.number, 1), message); }

 private:
  std::string_view next(const std::string& where, const std::string& expected) {
    if (at_end()) fail_here(where + "found the end of the file, expected " + expected);
    return line_.words[word_++];
  }

  const std::string& path_;
  TextLines lines_;
  TextLine line_;
  std::size_t word_ = 0;
};

}  // namespace iso
