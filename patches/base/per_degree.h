// Tables that depend on a degree alone, made when first asked for.
#pragma once

#include <array>
#include <mutex>

#include "patches/base/bspline_basis.h"

namespace iso {

// What `make(degree)` makes, for degrees up to kMaxDegree; safe from all threads.
template <class T, T (*make)(int)>
const T& of_degree(int degree) {
  static std::array<std::once_flag, kMaxDegree + 1> flags;
  static std::array<T, kMaxDegree + 1> made;
  const auto k = static_cast<std::size_t>(degree);
  std::call_once(flags[k], [&] { made[k] = make(degree); });
  return made[k];
}

}  // namespace iso
