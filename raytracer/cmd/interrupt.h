// Ctrl-C asks for a clean end; a second one ends at once.
#pragma once

#include <atomic>

namespace iso {

// While it lives, the first SIGINT or SIGTERM sets the flag instead of ending the program.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  const std::atomic<bool>& flag() const;
};

}  // namespace iso
