// Feeds the triangulation with operations read from bytes; see driver.h.
#include "tests/fuzz/driver.h"
#include "tests/support/triangulation_operations.h"

namespace {

const iso::test::FuzzTarget& target() {
  static iso::test::OperationCounts counts;
  static const iso::test::FuzzTarget all{"triangulation", [](auto bytes) { return iso::test::run_triangulation_operations(bytes, counts); },
                                         iso::test::random_triangulation_operations,
                                         [] {
                                           return std::to_string(counts.inserted) + " points, " + std::to_string(counts.constrained) +
                                                  " constraints, " + std::to_string(counts.refused) + " refused";
                                         }};
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { return iso::test::run_or_abort(target(), data, size); }

#ifndef ISOPHOTE_LIBFUZZER
int main(int argc, char** argv) { return iso::test::fuzz_main(target(), {argv, static_cast<std::size_t>(argc)}); }
#endif
