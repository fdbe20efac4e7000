// Counts what a test checked. The first failures are told in full, the rest only counted; the end requires the counts.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace iso::test {

class Tally {
 public:
  explicit Tally(std::string name, std::uint64_t seed = 0) : name_(std::move(name)), seed_(seed) {}

  // `say` makes the message; it is called for the first failures only.
  template <class Say>
  bool check(bool holds, Say say) {
    ++checked_;
    if (holds) return true;
    if (++failed_ <= kTold) ADD_FAILURE() << name_ << " (seed " << seed_ << "): " << say();
    return false;
  }
  // value <= limit, and remembers the largest share of the limit that was used.
  template <class Say>
  bool within(double value, double limit, Say say) {
    if (limit > 0 && value / limit > worst_) worst_ = value / limit;
    return check(value <= limit, [&] { return fmt::format("{:.3g} is more than {:.3g}; {}", value, limit, say()); });
  }

  std::uint64_t checked() const { return checked_; }
  std::uint64_t failed() const { return failed_; }
  double worst() const { return worst_; }

  // Requires that exactly, or at least, so many were checked and none failed.
  void finish(std::uint64_t expected) {
    EXPECT_EQ(checked_, expected) << name_;
    end();
  }
  void finish_at_least(std::uint64_t least) {
    EXPECT_GE(checked_, least) << name_;
    end();
  }

 private:
  void end() {
    EXPECT_EQ(failed_, 0u) << name_ << " (seed " << seed_ << "): of " << checked_;
    fmt::print("[ counted  ] {}: {} checked, {} failed{}\n", name_, checked_, failed_,
               worst_ > 0 ? fmt::format(", worst {:.2g} of the limit", worst_) : std::string{});
  }
  static constexpr std::uint64_t kTold = 3;
  std::string name_;
  std::uint64_t seed_;
  std::uint64_t checked_ = 0, failed_ = 0;
  double worst_ = 0;
};

}  // namespace iso::test
