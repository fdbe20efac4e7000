// What Open CASCADE does to a process while it reads, and undoing it: chatter on the console, signal handlers, floating-point traps.
#pragma once

#include <memory>

namespace iso::occt {

// For its lifetime nothing that the library says reaches stdout or stderr, and hardware signals inside it become exceptions
// (OCC_CATCH_SIGNALS). Afterwards streams, signal handlers and floating-point state are as before. One at a time in a process.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace iso::occt
