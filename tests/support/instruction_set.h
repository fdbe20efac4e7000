// The kernels' instruction set, chosen for a scope. Embree's is chosen by the device string.
#pragma once

#include <hwy/targets.h>

namespace iso::test {

// Highway's dispatch picks the best of `targets` (bits as in hwy/targets.h) as long as it lives. Not to be made while rays are traced.
class KernelsFor {
 public:
  explicit KernelsFor(std::int64_t targets) { choose(targets); }
  ~KernelsFor() { choose(0); }  // all that the processor has
  KernelsFor(const KernelsFor&) = delete;
  KernelsFor& operator=(const KernelsFor&) = delete;

 private:
  static void choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

}  // namespace iso::test
