// Feeds the triangulation with operations read from bytes: triangulation_fuzz FILE... runs files; triangulation_fuzz FIRST LAST runs the
// generator's strings of these seeds. What fails is written to triangulation-SEED, ready for tests/corpus/triangulation.
// With clang: -fsanitize=fuzzer -DISOPHOTE_LIBFUZZER makes it a libFuzzer target.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>

#include "tests/support/triangulation_operations.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  iso::test::OperationCounts counts;
  const std::string wrong = iso::test::run_triangulation_operations({data, size}, counts);
  if (wrong.empty()) return 0;
  std::cerr << wrong << '\n';
  std::abort();
}

#ifndef ISOPHOTE_LIBFUZZER
namespace {

bool run(const std::string& name, const std::vector<std::uint8_t>& bytes, iso::test::OperationCounts& counts) {
  const std::string wrong = iso::test::run_triangulation_operations(bytes, counts);
  if (static int told = 0; !wrong.empty() && ++told <= 20) std::cerr << name << ": " << wrong << '\n';
  return wrong.empty();
}

int run_seeds(std::uint64_t first, std::uint64_t last) {
  iso::test::OperationCounts counts;
  int failed = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const auto bytes = iso::test::random_triangulation_operations(seed);
    const std::string name = "triangulation-" + std::to_string(seed);
    if (run(name, bytes, counts)) continue;
    ++failed;
    std::ofstream(name, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  std::cout << last - first + 1 << " strings: " << counts.inserted << " points, " << counts.constrained << " constraints, "
            << counts.refused << " refused; " << failed << " failed\n";
  return failed > 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::isdigit(static_cast<unsigned char>(*argv[1])))
    return run_seeds(std::strtoull(argv[1], nullptr, 10), std::strtoull(argv[2], nullptr, 10));
  iso::test::OperationCounts counts;
  int failed = 0;
  for (int i = 1; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    failed += !run(argv[i], bytes, counts);
  }
  return failed > 0;
}
#endif
