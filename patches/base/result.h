// Errors that a user can meet: bad input and failed reading or writing. `Result<T>` carries either a value or one Error.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "patches/base/check.h"

namespace iso {

// The program's exit codes, one table for every subcommand (see README).
enum class Exit : int { done = 0, promise_not_kept = 1, bad_command_line = 2, bad_input = 3, read_write = 4, interrupted = 130 };

struct Error {
  Exit kind = Exit::bad_input;
  std::string file;     // the file concerned, may be empty
  std::string place;    // line, entity or JSON path inside it, may be empty
  std::string message;  // what was found and what was expected

  // "file:place: message"
  std::string text() const {
    std::string s = file;
    if (!place.empty()) s += (s.empty() ? "" : ":") + place;
    return s.empty() ? message : s + ": " + message;
  }
};

inline Error bad_input(std::string file, std::string place, std::string message) {
  return {Exit::bad_input, std::move(file), std::move(place), std::move(message)};
}
inline Error read_write_error(std::string file, std::string message) { return {Exit::read_write, std::move(file), {}, std::move(message)}; }

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  explicit operator bool() const { return std::holds_alternative<T>(state_); }
  T& operator*() {
    ISO_CHECK(*this);
    return std::get<T>(state_);
  }
  const T& operator*() const {
    ISO_CHECK(*this);
    return std::get<T>(state_);
  }
  T* operator->() { return &**this; }
  const T* operator->() const { return &**this; }
  const Error& error() const {
    ISO_CHECK(!*this);
    return std::get<Error>(state_);
  }

 private:
  std::variant<T, Error> state_;
};

// For functions that only succeed or fail.
struct Done {};
using Status = Result<Done>;

}  // namespace iso
