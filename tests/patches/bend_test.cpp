// Bounds of second derivatives: they hold for every surface, are tight, and are those known in closed form.
#include "patches/bend.h"

#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20250311;

// What the second derivatives do at a point.
struct Sample {
  std::array<double, 3> form{}, length{};
  double curvature = 0;
  bool regular = false;
};
Sample sample_at(const AnySurface& surface, const UV& uv) {
  const Jet2 j = jet2(surface, uv);
  Sample s;
  s.length = {glm::length(j.Suu), glm::length(j.Suv), glm::length(j.Svv)};
  const Vec3 cross = glm::cross(j.Su, j.Sv);
  s.regular = glm::length(cross) > 1e-6 * glm::length(j.Su) * glm::length(j.Sv) && glm::length(j.Su) > 0 && glm::length(j.Sv) > 0;
  if (!s.regular) return s;
  const Vec3 n = glm::normalize(cross);
  s.form = {glm::dot(n, j.Suu), glm::dot(n, j.Suv), glm::dot(n, j.Svv)};
  const Curvatures k = principal_curvatures(j, n);
  s.curvature = std::max(std::abs(k.k1), std::abs(k.k2));
  return s;
}

Box2 random_box(Random& random, const Box2& domain) {
  const Vec2 size = domain.size() * Vec2(std::pow(10.0, between(random, -3, 0)), std::pow(10.0, between(random, -3, 0)));
  const Vec2 lo = domain.lo + (domain.size() - size) * Vec2(between(random, 0, 1), between(random, 0, 1));
  return {lo, glm::min(lo + size, domain.hi)};
}

bool inside(const Range& r, double x, double by) { return r.lo - by <= x && x <= r.hi + by; }

// The evaluation by jets rounds in the size of the largest second derivatives, and in that of the coordinates over the spans' widths.
constexpr double kRounding = 1e-10;

TEST(Bend, HoldsEverySampleOfEverySurface) {
  Tally forms{"forms", kSeed}, lengths{"lengths", kSeed}, curvatures{"curvatures", kSeed};
  Random random(kSeed);
  for (int round = 0; round < 1; ++round)
    for (const SurfaceCase& c : random_surfaces(random)) {
      const BendTree tree(c.surface, c.uv);
      std::array<double, 3> most{};
      for (int i = 0; i < 100; ++i) {
        const Sample s = sample_at(c.surface, point_in(random, c.uv));
        for (std::size_t k = 0; k < 3; ++k) most[k] = std::max(most[k], s.length[k]);
      }
      for (int i = 0; i < 30; ++i) {
        const Box2 box = random_box(random, c.uv);
        const Bend b = tree.over(box);
        for (int k = 0; k < 30; ++k) {
          const UV uv = point_in(random, box);
          const Sample s = sample_at(c.surface, uv);
          const std::array<Range, 3> ranges{b.uu, b.uv, b.vv};
          const std::array<double, 3> M{b.Muu, b.Muv, b.Mvv};
          for (std::size_t e = 0; e < 3; ++e) {
            const double by = kRounding * (most[e] + s.length[e]);
            lengths.check(s.length[e] <= M[e] + by, [&] {
              return fmt::format("{} at ({}, {}): derivative {} is {} long, bound {}", c.name, uv.x, uv.y, e, s.length[e], M[e]);
            });
            if (s.regular)
              forms.check(inside(ranges[e], s.form[e], by), [&] {
                return fmt::format("{} at ({}, {}): form {} is {}, not in [{}, {}]", c.name, uv.x, uv.y, e, s.form[e], ranges[e].lo,
                                   ranges[e].hi);
              });
          }
          if (s.regular && finite(s.curvature))
            curvatures.check(s.curvature <= b.curvature * (1 + 1e-7) + 1e-7, [&] {
              return fmt::format("{} at ({}, {}): curvature {}, bound {}", c.name, uv.x, uv.y, s.curvature, b.curvature);
            });
        }
      }
    }
  forms.finish_at_least(150000);
  lengths.finish_at_least(150000);
  curvatures.finish_at_least(50000);
}

}  // namespace
}  // namespace iso::test
