// The whole program on AVX2, for machines that have more: Highway's kernels here, Embree's by the device string.
#pragma once

#include <hwy/targets.h>

namespace iso::bench {

inline constexpr const char* kAvx2Device = "isa=avx2";

// Highway's dispatch takes nothing beyond AVX2 as long as it lives. Not to be made while rays are traced.
class OnlyAvx2 {
 public:
  OnlyAvx2() { choose(hwy::SupportedTargets() & ~(HWY_AVX2 - 1)); }
  ~OnlyAvx2() { choose(0); }
  OnlyAvx2(const OnlyAvx2&) = delete;
  OnlyAvx2& operator=(const OnlyAvx2&) = delete;

 private:
  // Better targets have lower bits; 0: all that the processor has.
  static void choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

}  // namespace iso::bench
