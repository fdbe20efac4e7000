// How many rays a test takes: its own number, or that of an environment variable for longer runs by hand.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <thread>
#include <vector>

namespace iso::test {

inline std::uint64_t wanted(const char* variable, std::uint64_t usual) {
  const char* set = std::getenv(variable);
  return set && *set ? std::strtoull(set, nullptr, 10) : usual;
}

// Runs work(chunk, thread) for `count` chunks on two threads. What a chunk does must depend on its number alone.
template <class Work>
void in_chunks(std::uint64_t count, const Work& work) {
  std::vector<std::thread> threads;
  for (std::uint64_t k = 0; k < 2; ++k)
    threads.emplace_back([&, k] {
      for (std::uint64_t c = k; c < count; c += 2) work(c, k);
    });
  for (std::thread& t : threads) t.join();
}

}  // namespace iso::test
