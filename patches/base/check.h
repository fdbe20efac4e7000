// ISO_CHECK: a promise of our own that was broken. Prints the place and the condition and aborts; never for bad input.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace iso {

[[noreturn]] inline void check_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "isophote: internal error at %s:%d: %s does not hold; please report this\n", file, line, condition);
  std::abort();
}

}  // namespace iso

#define ISO_CHECK(condition) ((condition) ? void(0) : ::iso::check_failed(#condition, __FILE__, __LINE__))
