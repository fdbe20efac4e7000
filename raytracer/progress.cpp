#include "raytracer/progress.h"

#include <fmt/format.h>
#include <unistd.h>

namespace iso {
namespace {

constexpr double kBarEvery = 0.1, kJsonEvery = 0.2, kLineEvery = 5;  // seconds
constexpr int kLineStep = 10;                                        // percent

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

ProgressStyle style_for(const std::string& wanted) {
  if (wanted == "json") return ProgressStyle::json;
  if (wanted == "none") return ProgressStyle::none;
  return ::isatty(STDERR_FILENO) ? ProgressStyle::bar : ProgressStyle::lines;
}

}  // namespace

Progress::Progress(const std::string& wanted, const char* counts) : style_(style_for(wanted)), counts_(counts) {}
Progress::~Progress() { finish(); }

void Progress::update(int done, int all) {
  if (style_ == ProgressStyle::none) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const double since = seconds(now - last_);
  const int percent = static_cast<int>(100.0 * done / all);
  if (percent <= last_percent_) return;  // threads may arrive out of order

  // Each style has its own idea of "now and then"; the end is always told by bar and JSON.
  const bool end = done == all;
  if (style_ == ProgressStyle::bar && !end && since < kBarEvery) return;
  if (style_ == ProgressStyle::json && !end && since < kJsonEvery) return;
  if (style_ == ProgressStyle::lines && (end || since < kLineEvery || percent < last_percent_ + kLineStep)) return;
  last_ = now;
  last_percent_ = percent;
  if (style_ == ProgressStyle::bar) print_bar(done, all);
  if (style_ == ProgressStyle::lines) fmt::print(stderr, "progress {} %\n", percent);
  if (style_ == ProgressStyle::json)
    fmt::print(stderr, "{{\"event\":\"progress\",\"percent\":{},\"{}\":{},\"of\":{},\"seconds\":{:.3f}}}\n", percent, counts_, done, all,
               seconds(now - begin_));
}

void Progress::print_bar(int done, int all) {
  constexpr int kWidth = 40;
  const int filled = static_cast<int>(static_cast<long long>(kWidth) * done / all);
  const double elapsed = seconds(Clock::now() - begin_), left = elapsed * (all - done) / done;
  fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {:3d} %  {:.0f} s left \033[K", "", filled, "", kWidth - filled, 100LL * done / all, left);
  std::fflush(stderr);
  bar_open_ = true;
}

void Progress::finish() {
  if (bar_open_) fmt::print(stderr, "\r\033[K");
  bar_open_ = false;
}

}  // namespace iso
