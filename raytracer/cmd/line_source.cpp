#include "raytracer/cmd/line_source.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace iso {
namespace {

constexpr std::size_t kBlock = 8 << 20;     // bytes read at a time; a batch of rays fits
constexpr std::size_t kLongest = 64 << 10;  // bytes; a longer line is no ray

bool more_soon() {
  constexpr int kWait = 2;  // milliseconds
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return ::poll(&input, 1, kWait) > 0;
}

}  // namespace

Status LineSource::next(std::size_t most, std::vector<InputLine>& lines) {
  lines.clear();
  std::size_t at = begin_;
  while (lines.size() < most) {
    // A whole line, or the rest of the input.
    const std::size_t end = buffer_.find('\n', at);
    if (end == std::string::npos && !end_) {
      if (!lines.empty()) break;  // hand out what there is before the buffer moves
      if (buffer_.size() - at > kLongest)
        return bad_input("standard input", fmt::format("line {}", number_ + 1),
                         fmt::format("found more than {} characters, expected a ray", kLongest));
      if (const auto status = fill(); !status) return status.error();
      at = begin_;
      continue;
    }
    const std::size_t stop = std::min(end, buffer_.size());
    if (stop == buffer_.size() && at == stop) break;
    lines.push_back({number_++, std::string_view(buffer_).substr(at, stop - at)});
    at = std::min(stop + 1, buffer_.size());
  }
  begin_ = at;
  return Done{};
}

// Drops what has been handed out and reads on: until a block is full, the input ends, or nothing comes for a moment. A pipe gives little at
// a time, which would starve the threads; a partner who waits for an answer must still get it.
Status LineSource::fill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  std::size_t used = buffer_.size();
  const std::size_t full = used + kBlock;
  buffer_.resize(full);
  do {
    const ssize_t n = ::read(STDIN_FILENO, buffer_.data() + used, full - used);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return read_write_error("standard input", fmt::format("reading failed: {}", std::strerror(errno)));
    used += static_cast<std::size_t>(n);
    end_ = n == 0;
  } while (!end_ && used < full && more_soon());
  buffer_.resize(used);
  return Done{};
}

}  // namespace iso
