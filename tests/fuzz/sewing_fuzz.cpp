// Sews and meshes loose faces read from bytes; see driver.h.
#include "tests/fuzz/driver.h"
#include "tests/support/sewing_checks.h"
#include "tests/support/sewing_model.h"

namespace {

const iso::test::FuzzTarget& target() {
  static iso::test::SewingCounts counts;
  static const iso::test::FuzzTarget all{
      "sewing", [](auto bytes) { return iso::test::run_sewing(bytes, counts); }, iso::test::random_sewing_bytes,
      [] {
        return std::to_string(counts.free_edges) + " free edges, " + std::to_string(counts.joined) + " pairs joined, " +
               std::to_string(counts.split) + " times split, " + std::to_string(counts.open) + " left open";
      }};
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { return iso::test::run_or_abort(target(), data, size); }

#ifndef ISOPHOTE_LIBFUZZER
int main(int argc, char** argv) { return iso::test::fuzz_main(target(), {argv, static_cast<std::size_t>(argc)}); }
#endif
