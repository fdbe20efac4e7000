// Four doubles at once, as two pairs: sums over homogeneous points in inner loops, which compilers do not make vectors of by themselves.
// Every lane is rounded like a double of its own.
#pragma once

#include <cstring>

#include "patches/base/vec.h"

namespace iso {

struct Four {
  using Pair = double __attribute__((vector_size(16)));
  Pair lo, hi;

  Four() = default;  // as of a double: without a value, or Four{}, zero
  Four(Pair l, Pair h) : lo(l), hi(h) {}
  explicit Four(const Vec4& v) {
    std::memcpy(&lo, &v.x, sizeof lo);
    std::memcpy(&hi, &v.z, sizeof hi);
  }
  explicit operator Vec4() const { return {lo[0], lo[1], hi[0], hi[1]}; }
  void store(Vec4& v) const {
    std::memcpy(&v.x, &lo, sizeof lo);
    std::memcpy(&v.z, &hi, sizeof hi);
  }
  Four& operator+=(const Four& b) {
    lo += b.lo;
    hi += b.hi;
    return *this;
  }
};
inline Four operator+(const Four& a, const Four& b) { return {a.lo + b.lo, a.hi + b.hi}; }
inline Four operator-(const Four& a, const Four& b) { return {a.lo - b.lo, a.hi - b.hi}; }
inline Four operator*(double f, const Four& a) { return {f * a.lo, f * a.hi}; }

}  // namespace iso
