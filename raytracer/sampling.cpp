#include "raytracer/sampling.h"

#include <bit>

namespace iso {
namespace {

constexpr std::uint32_t kBlock = 64;  // pixels; its Morton index takes 12 of the 32 bits, leaving room for more than kMaxSamples

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

// Flips each bit depending on the bits above it: Owen's scrambling by a hash, and a shuffle that keeps aligned blocks of 2^k together.
// [Burley 2020, section 3; constants of Vegdahl]
std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  x = reverse_bits(x);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reverse_bits(x);
}

// The second dimension of Sobol's sequence; the first is the radical inverse.
std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t v = 1u << 31; index != 0; index >>= 1, v ^= v >> 1)
    if (index & 1u) result ^= v;
  return result;
}

// Bits of a six-bit number, spread to the even places.
std::uint32_t spread(std::uint32_t x) {
  x = (x | (x << 4)) & 0x0f0fu;
  x = (x | (x << 2)) & 0x3333u;
  return (x | (x << 1)) & 0x5555u;
}

double to_unit(std::uint32_t x) { return (x + 0.5) * 0x1p-32; }

}  // namespace

// [Steele et al. 2014, SplitMix64]
std::uint64_t hash_mix(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15ull;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
  return value ^ (value >> 31);
}
std::uint64_t hash_mix(std::uint64_t seed, std::uint64_t value) { return hash_mix(hash_mix(seed) ^ value); }

Sampler::Sampler(std::uint64_t seed, int samples) : seed_(seed), sample_bits_(std::bit_width(static_cast<unsigned>(samples - 1))) {}

Vec2 Sampler::pair(const SampleId& id, Dimension dimension) const {
  // One scrambling per block of pixels and dimension.
  const std::uint64_t block = (std::uint64_t{id.x / kBlock} << 32) | (id.y / kBlock);
  const std::uint64_t h = hash_mix(hash_mix(seed_, block), static_cast<std::uint64_t>(dimension));
  const std::uint64_t h2 = hash_mix(h);

  // Inside the block, pixel by pixel along the Morton curve, each pixel a run of 2^k numbers.
  const std::uint32_t morton = spread(id.x % kBlock) | (spread(id.y % kBlock) << 1);
  const std::uint32_t index = owen_scramble((morton << sample_bits_) | id.index, static_cast<std::uint32_t>(h));
  return {to_unit(owen_scramble(reverse_bits(index), static_cast<std::uint32_t>(h >> 32))),
          to_unit(owen_scramble(sobol_second(index), static_cast<std::uint32_t>(h2)))};
}

Vec3 cosine_hemisphere(const Vec3& n, const Vec2& random) {
  const double r = std::sqrt(random.x), phi = kTwoPi * random.y;
  const Vec3 a = any_perpendicular(n), b = glm::cross(n, a);
  return glm::normalize(r * std::cos(phi) * a + r * std::sin(phi) * b + std::sqrt(1 - random.x) * n);
}

Vec3 uniform_cone(const Vec3& axis, double cos_angle, const Vec2& random) {
  const double c = 1 - random.x * (1 - cos_angle), s = std::sqrt(std::max(0.0, 1 - c * c)), phi = kTwoPi * random.y;
  const Vec3 a = any_perpendicular(axis), b = glm::cross(axis, a);
  return glm::normalize(s * std::cos(phi) * a + s * std::sin(phi) * b + c * axis);
}

}  // namespace iso
