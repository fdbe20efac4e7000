// Prepared surfaces against jet2.
#include "tess/surface_eval.h"

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace iso::test {
namespace {

// Powers about the middle of a span of degree p lose (1 + sqrt 2)^p roundings at worst: 1e3 at the largest degree that is prepared, in each
// direction. Measured: 8e-15 of the size of the coordinates and of the derivative.
constexpr double kRounding = 1e-13;

// Of the numbers that a derivative is added up from.
double size_of(const AnySurface& surface, const Box2& uv) {
  const Box3 box = bounds(surface, uv);
  return glm::length(glm::max(glm::abs(box.lo), glm::abs(box.hi)));
}

TEST(SurfaceEval, HasThePointsAndTangentsOfJet2OnEveryKind) {
  Random random(20);
  int checked = 0;
  for (int round = 0; round < 40; ++round)
    for (const SurfaceCase& shape : random_surfaces(random)) {
      const SurfaceEval eval(shape.surface);
      const double size = size_of(shape.surface, shape.uv);
      for (int i = 0; i < 20; ++i) {
        const UV uv = point_in(random, shape.uv);
        const Jet2 truth = jet2(shape.surface, uv);
        const TangentJet found = eval.at(uv);
        const double off =
            std::max({glm::length(found.S - truth.S) / size, glm::length(found.Su - truth.Su) / (size + glm::length(truth.Su)),
                      glm::length(found.Sv - truth.Sv) / (size + glm::length(truth.Sv))});
        EXPECT_LE(off, kRounding) << shape.name << " at " << uv.x << ", " << uv.y << ", round " << round;
        ++checked;
      }
    }
  EXPECT_EQ(checked, static_cast<int>(40 * kSurfaceCases * 20));
}

// At knots the span to the right counts, beyond the domain the end spans.
TEST(SurfaceEval, TakesTheSpansOfJet2AtKnotsAndBeyondTheDomain) {
  Random random(21);
  int checked = 0;
  for (int round = 0; round < 40; ++round)
    for (const Knots style : {Knots::smooth, Knots::c0, Knots::unclamped}) {
      const AnySurface surface = random_nurbs(random, style, style, 3, whole(random, 1, 5), round % 2 == 0);
      const SurfaceEval eval(surface);
      const Box2 domain = natural_domain(surface);
      std::vector<double> us = breaks(surface, 0);
      us.insert(us.end(), {domain.lo.x - 1e-3, domain.hi.x + 1e-3, std::nextafter(us[1], -kInf), std::nextafter(us[1], kInf)});
      for (const double u : us)
        for (const double v : breaks(surface, 1)) {
          const Jet2 truth = jet2(surface, {u, v});
          const TangentJet found = eval.at({u, v});
          const double size = size_of(surface, domain);
          EXPECT_LE(glm::length(found.S - truth.S), kRounding * size);
          EXPECT_LE(glm::length(found.Su - truth.Su), kRounding * (size + glm::length(truth.Su)));
          EXPECT_LE(glm::length(found.Sv - truth.Sv), kRounding * (size + glm::length(truth.Sv)));
          ++checked;
        }
    }
  EXPECT_GT(checked, 1000);
}

}  // namespace
}  // namespace iso::test
