// Random numbers that depend only on (seed, pixel, sample, dimension): the same picture for any number of threads and any tiling.
// Owen-scrambled Sobol' pairs [Burley 2020], walked in Morton order over blocks of 64 x 64 pixels, so that neighbouring pixels share
// strata and the noise that is left is fine-grained [Ahmed and Wonka 2020].
#pragma once

#include <cstdint>

#include "patches/base/vec.h"

namespace iso {

inline constexpr int kMaxSamples = 1 << 16;

struct SampleId {
  std::uint32_t x = 0, y = 0, index = 0;
};

// What a pair of numbers is used for; one independent sequence each.
enum class Dimension : std::uint32_t { filter, sky, key };

std::uint64_t hash_mix(std::uint64_t value);
std::uint64_t hash_mix(std::uint64_t seed, std::uint64_t value);

class Sampler {
 public:
  // 1 <= samples <= kMaxSamples.
  Sampler(std::uint64_t seed, int samples);

  // A point of (0, 1)^2.
  Vec2 pair(const SampleId& id, Dimension dimension) const;

 private:
  std::uint64_t seed_;
  int sample_bits_ = 0;
};

// A unit vector about the unit normal n, density cos / pi.
Vec3 cosine_hemisphere(const Vec3& n, const Vec2& random);

// A unit vector within the cone about the unit vector `axis`, uniform in solid angle.
Vec3 uniform_cone(const Vec3& axis, double cos_angle, const Vec2& random);

}  // namespace iso
