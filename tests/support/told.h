// What a test has to tell of its failures: the first few in full. Parts that threads gathered are put together.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace iso::test {

class Told {
 public:
  // `say` makes the text; it is called for the first few only.
  template <class Say>
  void add(const Say& say) {
    if (texts_.size() < kMost) texts_.push_back(say());
  }
  void add(const Told& other) {
    for (const std::string& text : other.texts_) add([&] { return text; });
  }
  void fail(const std::string& about) const {
    for (const std::string& text : texts_) ADD_FAILURE() << about << ": " << text;
  }

 private:
  static constexpr std::size_t kMost = 5;
  std::vector<std::string> texts_;
};

}  // namespace iso::test
