// Stripes as functions of directions: their windows, and that both sides of a surface are alike.
#include "raytracer/stripes.h"

#include "raytracer/filter.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20241205;

TEST(Stripes, TheWindowIsTheIntegralOfSharpStripes) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Tally tally("windows", kSeed);
  for (int i = 0; i < 300; ++i) {
    const double phase = 40 * uniform(random) - 20, width = 0.05 + 0.9 * uniform(random), reach = std::pow(10, 3 * uniform(random) - 2.5);
    constexpr int kSteps = 40000;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double x = -1 + (k + 0.5) * 2 / kSteps;
      sum += (1 - std::abs(x)) * filtered_stripe(phase + reach * x, width, 0) * 2 / kSteps;
    }
    tally.within(std::abs(filtered_stripe(phase, width, reach) - sum), 1e-3,
                 [&] { return fmt::format("phase {:.17g} width {:.17g} reach {:.17g}", phase, width, reach); });
  }
  for (const double reach : {0.99e-5, 1.01e-5, 1e-4}) {  // where the closed form takes over
    EXPECT_NEAR(filtered_stripe(0.1, 0.3, reach), 1, 1e-5);
    EXPECT_NEAR(filtered_stripe(0.2, 0.3, reach), 0, 1e-5);
    EXPECT_NEAR(filtered_stripe(7.15 + reach * 1e-3, 0.3, reach * 1.001), reach < 1e-5 ? 0 : 0.5, 1e-2);
  }
  EXPECT_EQ(filtered_stripe(0.3, 0.25, kInf), 0.25);
  EXPECT_EQ(filtered_stripe(std::nan(""), 0.25, 1), 0.25);
  tally.finish(300);
}

TEST(Stripes, ThePixelFilterHasTheDeviationThatWindowsAreMadeOf) {
  const PixelFilter filter;
  double sum = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) sum += std::pow(filter.offset({(i + 0.5) / kCount, 0.5}).x, 2);
  EXPECT_NEAR(std::sqrt(sum / kCount), PixelFilter::kDeviation, 1e-4);
}

TEST(Stripes, BothSidesOfASurfaceLookAlike) {
  std::mt19937_64 random(kSeed);
  int checked = 0;
  for (const StripeKind kind : {StripeKind::zebra, StripeKind::reflection_lines, StripeKind::isophotes})
    for (int i = 0; i < 100; ++i, ++checked) {
      const Stripes s{kind, {0, 0, 1}, {1, 0, 0}, 9, 0.3};
      const Vec3 n = random_direction(random), turn = 0.01 * any_perpendicular(n);
      const SeenNormal out{.d = random_direction(random), .n = n, .n_x = turn}, in{.d = out.d, .n = -n, .n_x = -turn};
      const StripePhase a = phase_of(s, out), b = phase_of(s, in);
      EXPECT_NEAR(a.per_pixel, b.per_pixel, 1e-9 * a.per_pixel);
      EXPECT_NEAR(filtered_stripe(a.at, 0.3, a.per_pixel), filtered_stripe(b.at, 0.3, b.per_pixel), 1e-9);
    }
  EXPECT_EQ(checked, 300);
}

}  // namespace
}  // namespace iso::test
