// The program around a function that bytes drive: NAME FILE... runs files; NAME FIRST LAST runs the generator's strings of these seeds.
// What fails is written to NAME-SEED, ready for tests/corpus/NAME. With clang, -fsanitize=fuzzer and -DISOPHOTE_LIBFUZZER make the programs
// of this folder libFuzzer targets; without that they take a file, as AFL gives it.
#pragma once

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

namespace iso::test {

struct FuzzTarget {
  std::string name;
  std::function<std::string(std::span<const std::uint8_t>)> run;           // what went wrong, or an empty text
  std::function<std::vector<std::uint8_t>(std::uint64_t seed)> generator;  // strings worth trying
  std::function<std::string()> counted;                                    // what was done, for people
};

inline bool holds(const FuzzTarget& target, const std::string& of, const std::vector<std::uint8_t>& bytes) {
  const std::string wrong = target.run(bytes);
  if (static int told = 0; !wrong.empty() && ++told <= 20) std::cerr << of << ": " << wrong << '\n';
  return wrong.empty();
}

inline int run_seeds(const FuzzTarget& target, std::uint64_t first, std::uint64_t last) {
  int failed = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const auto bytes = target.generator(seed);
    const std::string file = target.name + "-" + std::to_string(seed);
    if (holds(target, file, bytes)) continue;
    ++failed;
    std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  std::cout << last - first + 1 << " strings: " << target.counted() << "; " << failed << " failed\n";
  return failed > 0;
}

inline int fuzz_main(const FuzzTarget& target, std::span<char*> arguments) {
  if (arguments.size() == 3 && std::isdigit(static_cast<unsigned char>(*arguments[1])))
    return run_seeds(target, std::strtoull(arguments[1], nullptr, 10), std::strtoull(arguments[2], nullptr, 10));
  int failed = 0;
  for (const char* name : arguments.subspan(1)) {
    std::ifstream file(name, std::ios::binary);
    failed += !holds(target, name, {std::istreambuf_iterator<char>(file), {}});
  }
  return failed > 0;
}

// For libFuzzer: stops the program at what is wrong.
inline int run_or_abort(const FuzzTarget& target, const std::uint8_t* data, std::size_t size) {
  const std::string wrong = target.run({data, size});
  if (wrong.empty()) return 0;
  std::cerr << wrong << '\n';
  std::abort();
}

}  // namespace iso::test
