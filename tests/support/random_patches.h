// Random patches of every kind that has charts: over polygons with normals, and from control points about their places.
#pragma once

#include <gtest/gtest.h>

#include "patches/surface/patch_construct.h"
#include "tests/support/random_shapes.h"

namespace iso::test {

// A polygon about the regular one, with normals about its own.
inline NSidedPatch random_patch_over(const PatchBasis& basis, Random& random) {
  std::vector<PatchCorner> corners;
  for (int k = 0; k < basis.sides; ++k)
    corners.push_back({Vec3(domain_corner(basis.sides, k), 0) + random_vector<Vec3>(random, 0.15),
                       glm::normalize(Vec3(0, 0, 1) + random_vector<Vec3>(random, 0.5))});
  auto made = patch_over(basis, corners);
  EXPECT_TRUE(made) << made.error().text();
  return made ? *made : NSidedPatch{};
}

// Each control point about the place of the domain where it weighs most.
inline NSidedPatch random_net(const PatchBasis& basis, Random& random, bool rational) {
  constexpr int kSteps = 12;
  const auto count = static_cast<std::size_t>(point_count(basis));
  const std::vector<int> turn = points_from_next_corner(basis);
  NSidedPatch patch{.basis = basis, .points = std::vector<Vec3>(count), .weights = {}};
  std::vector<double> most(count, -1), W(count);
  std::vector<std::size_t> name(count);  // of point m as seen from corner k
  for (std::size_t m = 0; m < count; ++m) name[m] = m;
  for (int k = 0; k < basis.sides; ++k) {
    const double angle = kTwoPi * k / basis.sides;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; j <= kSteps; ++j) {
        const Vec2 st = Vec2(i, j) / double(kSteps), x = domain_point(basis.sides, st);
        weights_at(basis, st, std::span<double>(W));
        for (std::size_t m = 0; m < count; ++m)
          if (W[m] > most[name[m]] + 1e-12) {
            most[name[m]] = W[m];
            patch.points[name[m]] = {std::cos(angle) * x.x - std::sin(angle) * x.y, std::sin(angle) * x.x + std::cos(angle) * x.y, 0};
          }
      }
    std::vector<std::size_t> next(count);
    for (std::size_t m = 0; m < count; ++m) next[m] = name[static_cast<std::size_t>(turn[m])];
    name = next;
  }
  for (Vec3& p : patch.points) p += random_vector<Vec3>(random, 0.1) + Vec3(0, 0, between(random, -0.3, 0.3));
  if (rational)
    for (std::size_t m = 0; m < count; ++m) patch.weights.push_back(between(random, 0.4, 2.5));
  return patch;
}

// Patches of a kind, with 3 to 8 sides where it has a choice, and all side parameters: at least eight. `few`: higher degrees, and side
// parameters by distance, for every other number of sides only. Those by mean value, which take seconds each to be proven, for the given
// numbers of sides.
inline std::vector<NSidedPatch> random_patches(PatchKind kind, Random& random, bool few, const std::vector<int>& by_mean_value = {5}) {
  constexpr std::size_t kLeast = 8;
  std::vector<NSidedPatch> patches;
  while (patches.size() < kLeast)
    for (int n = 3; n <= 8; ++n)
      for (const SideParameters parameters : {SideParameters::wachspress, SideParameters::distance, SideParameters::mean_value})
        for (const int degree : {2, 3, 4, 5}) {
          const PatchBasis basis{kind, n, degree, parameters};
          if (!problem_of(basis).empty()) continue;
          const bool triangle = kind == PatchKind::bezier_triangle;
          if (parameters == SideParameters::mean_value && std::count(by_mean_value.begin(), by_mean_value.end(), n) == 0) continue;
          if (few && !triangle && (parameters == SideParameters::wachspress ? degree > 3 && degree != 4 + n % 2 : n % 2 == 0)) continue;
          if (!triangle && degree == 3) patches.push_back(random_patch_over(basis, random));
          if (triangle || degree > 3) patches.push_back(random_net(basis, random, false));
          if (triangle) patches.push_back(random_net(basis, random, true));
        }
  return patches;
}

}  // namespace iso::test
