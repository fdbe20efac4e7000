// Prepared trim curves against jet, and their bounds against samples.
#include "tess/trim_eval.h"

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace iso::test {
namespace {

// See surface_eval_test.cpp.
constexpr double kRounding = 1e-13;

TEST(TrimEval, HasThePointsOfJet) {
  Random random(22);
  int checked = 0;
  for (int round = 0; round < 100; ++round)
    for (const auto& shape : random_curves<Vec2>(random)) {
      const TrimEval eval(shape.curve);
      for (int i = 0; i < 20; ++i) {
        const double t = between(random, shape.t.lo, shape.t.hi);
        const Vec2 truth = jet(shape.curve, t).C;
        EXPECT_LE(glm::length(eval.at(t) - truth), kRounding * (10 + glm::length(truth))) << shape.name << " at " << t;
        ++checked;
      }
    }
  EXPECT_EQ(checked, static_cast<int>(100 * kCurveCases * 20));
}

// Both ways along the curve, over spans and parts of spans, with ends that were moved.
TEST(TrimEval, NoPointIsFartherFromTheChordThanTheSliver) {
  Random random(23);
  int checked = 0;
  for (int round = 0; round < 100; ++round)
    for (const auto& shape : random_curves<Vec2>(random)) {
      const TrimEval eval(shape.curve);
      double t0 = between(random, shape.t.lo, shape.t.hi), t1 = t0 + between(random, 0, 1) * (shape.t.hi - t0);
      if (round % 2) std::swap(t0, t1);
      const Vec2 speed(between(random, 0.1, 3), between(random, 0.1, 3)), moved = glm::abs(random_vector<Vec2>(random, 1e-3));
      const Vec2 a = eval.at(t0) + moved, b = eval.at(t1) - moved;
      const double bound = eval.sliver(t0, t1, a, b, moved, speed);
      for (int i = 0; i <= 50; ++i) {
        const Vec2 p = (eval.at(t0 + (t1 - t0) * i / 50) - a) * speed, line = (b - a) * speed;
        const double s = std::clamp(glm::dot(p, line) / glm::dot(line, line), 0.0, 1.0);
        EXPECT_LE(glm::length(p - s * line), bound * (1 + 1e-9) + 1e-12) << shape.name << " from " << t0 << " to " << t1;
        ++checked;
      }
    }
  EXPECT_EQ(checked, static_cast<int>(100 * kCurveCases * 51));
}

}  // namespace
}  // namespace iso::test
