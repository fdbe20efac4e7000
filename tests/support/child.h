// Runs a program, or a piece of work, as a child process: its exit code or the signal that ended it, and what it said. No shell in between.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/paths.h"

namespace iso::test {

struct ChildLimits {
  double seconds = 20;          // it is killed after that
  long file_bytes = -1;         // largest file it may write, if not negative; its two streams count as well
  long memory_bytes = -1;       // of address space, if not negative; not under the address sanitizer, which reserves terabytes
  std::string standard_output;  // a file to use as standard output in place of one that is read back
};

struct ChildResult {
  int code = -1;      // exit code; -1 if it did not end by itself
  int signal = 0;     // that ended it
  bool hung = false;  // was killed for its time
  std::string out, err;

  // Ended by itself, and not with one of the codes shells and sanitizers use for a crash.
  bool ended() const { return code >= 0 && code <= 4; }
  long error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
  std::string summary() const {
    if (hung) return "killed after its time";
    return (signal ? "signal " + std::to_string(signal) : "exit code " + std::to_string(code)) + ", says: " + err.substr(0, 600);
  }
};

namespace detail {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kMemoryMayBeLimited = false;
#else
inline constexpr bool kMemoryMayBeLimited = true;
#endif

// Between fork and exec: only calls that are safe there.
inline void take_place(const ChildLimits& limits, const char* in, const char* out, const char* err) {
  const int i = ::open(in, O_RDONLY), o = ::open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600),
            e = ::open(err, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (i < 0 || o < 0 || e < 0 || ::dup2(i, 0) < 0 || ::dup2(o, 1) < 0 || ::dup2(e, 2) < 0) ::_exit(126);
  const auto limit = [](__rlimit_resource what, long value) {
    const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
    if (value >= 0) ::setrlimit(what, &both);
  };
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, limits.file_bytes);
  if (kMemoryMayBeLimited) limit(RLIMIT_AS, limits.memory_bytes);
}

inline std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace detail

// A forked process that does `work`, which gives its exit code; its streams go to files and come back.
template <class Work>
ChildResult run_in_child(Work work, const std::string& input = {}, const ChildLimits& limits = {}) {
  const TemporaryDir dir;
  const std::string in = dir.path() / "in", err = dir.path() / "err";
  const std::string out = limits.standard_output.empty() ? (dir.path() / "out").string() : limits.standard_output;
  std::ofstream(in, std::ios::binary) << input;
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) std::abort();
  if (child == 0) {
    detail::take_place(limits, in.c_str(), out.c_str(), err.c_str());
    ::_exit(work());
  }

  // Asks now and then whether it has ended.
  ChildResult result;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limits.seconds);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end && !result.hung) {
      result.hung = true;
      ::kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (limits.standard_output.empty()) result.out = detail::content_of(out);
  result.err = detail::content_of(err);
  return result;
}

// `command[0]` is the path of the program.
inline ChildResult run_child(const std::vector<std::string>& command, const std::string& input = {}, const ChildLimits& limits = {}) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  return run_in_child([&] { return ::execv(arguments[0], arguments.data()), 127; }, input, limits);
}

// The program `isophote` with these arguments.
inline ChildResult run_isophote(std::vector<std::string> arguments, const std::string& input = {}, const ChildLimits& limits = {}) {
  arguments.insert(arguments.begin(), ISOPHOTE_PROGRAM);
  return run_child(arguments, input, limits);
}

}  // namespace iso::test
