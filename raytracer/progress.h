// How far the work is, on stderr: a bar on a terminal, a few plain lines elsewhere, or one JSON object a line.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace iso {

enum class ProgressStyle { bar, lines, json, none };

class Progress {
 public:
  // `wanted`: "auto" (bar or lines, whichever stderr is), "json" or "none".
  // `counts`: what JSON calls the things that are counted.
  explicit Progress(const std::string& wanted, const char* counts = "tiles");
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  ProgressStyle style() const { return style_; }

  // From any thread; prints now and then.
  void update(int done, int all);

  // Ends a bar's line, so that other messages can follow.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  void print_bar(int done, int all);

  ProgressStyle style_;
  const char* counts_;
  std::mutex mutex_;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
  int last_percent_ = -1;
  bool bar_open_ = false;
};

}  // namespace iso
