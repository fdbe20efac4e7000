// Properties of every curve kind, in the plane and in space.
#include "patches/curve/curve.h"

#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240607;
constexpr int kRounds = 40;

template <class V>
V bezier_point(const std::vector<Homogeneous<V>>& points, double s) {
  std::vector<Homogeneous<V>> work = points;
  for (std::size_t n = work.size(); n > 1; --n)
    for (std::size_t i = 0; i + 1 < n; ++i) work[i] = (1 - s) * work[i] + s * work[i + 1];
  return project(work.front());
}

template <class V>
double size_of(const CurveCase<V>& c) {
  double size = 0;
  for (int i = 0; i <= 50; ++i) size = std::max(size, glm::length(jet(c.curve, c.t.lo + i / 50.0 * c.t.width()).C));
  return size;
}

template <class V>
void spans_reproduce(Tally& tally) {
  Random random(kSeed);
  for (int round = 0; round < kRounds; ++round)
    for (const CurveCase<V>& c : random_curves<V>(random)) {
      const double size = size_of(c), a = between(random, c.t.lo, c.t.hi), b = between(random, c.t.lo, c.t.hi);
      const auto spans = bezier_spans(c.curve, std::min(a, b), std::max(a, b));
      bool chained = !spans.empty() && spans.front().map.a == std::min(a, b) && spans.back().map.b == std::max(a, b);
      for (std::size_t i = 1; i < spans.size(); ++i)
        chained =
            chained && spans[i].map.a == spans[i - 1].map.b && project(spans[i].points.front()) == project(spans[i - 1].points.back());
      tally.check(chained, [&] { return c.name + ": spans do not touch end to end"; });
      for (int k = 0; k < 50 && !spans.empty(); ++k) {
        const auto& span = spans[static_cast<std::size_t>(whole(random, 0, static_cast<int>(spans.size()) - 1))];
        const double s = k == 0 ? 0 : k == 1 ? 1 : between(random, 0, 1);
        const V exact = jet(c.curve, span.map.to_native(s)).C;
        tally.within(glm::length(bezier_point<V>(span.points, s) - exact), 1e-14 * size,
                     [&] { return fmt::format("{} at s = {}", c.name, s); });
      }
    }
  tally.finish(kRounds * kCurveCases * 51);
}

TEST(Curve, BezierSpansReproduceEveryKindInThePlane) {
  Tally tally("spans in the plane", kSeed);
  spans_reproduce<Vec2>(tally);
}
TEST(Curve, BezierSpansReproduceEveryKindInSpace) {
  Tally tally("spans in space", kSeed);
  spans_reproduce<Vec3>(tally);
}

// Mean error of central differences at one step width, for the first (0) and the second derivative (1).
template <class V>
Vec2 difference_error(const CurveCase<V>& c, const std::vector<double>& at, double h) {
  Vec2 sum{0.0};
  for (const double t : at) {
    const auto j = jet(c.curve, t);
    const V low = jet(c.curve, t - h).C, high = jet(c.curve, t + h).C;
    sum.x += glm::length((high - low) / (2 * h) - j.Ct);
    sum.y += glm::length((high - 2.0 * j.C + low) / (h * h) - j.Ctt);
  }
  return sum / static_cast<double>(at.size());
}

template <class V>
void derivatives_converge(Tally& tally, int& slopes) {
  Random random(kSeed + 1);
  for (int round = 0; round < kRounds; ++round)
    for (const CurveCase<V>& c : random_curves<V>(random)) {
      const auto* nurbs = std::get_if<NurbsCurve<V>>(&c.curve);
      const std::vector<double> at_breaks = nurbs ? breakpoints(nurbs->knots, nurbs->degree) : std::vector<double>{};
      const double h = 0.004, size = size_of(c);
      std::vector<double> at;
      for (int k = 0; k < 20; ++k) at.push_back(away_from(random, at_breaks, c.t.lo, c.t.hi, 2 * h));
      const Vec2 coarse = difference_error(c, at, h), fine = difference_error(c, at, h / 2);
      for (const int order : {0, 1}) {
        const double noise = 40 * kEps * size / std::pow(h / 2, order + 1);
        if (coarse[order] > 1000 * noise) {
          ++slopes;
          const double ratio = coarse[order] / fine[order];
          tally.check(ratio > 3.3 && ratio < 4.8,
                      [&] { return fmt::format("{}: derivative {} converges with ratio {}", c.name, order + 1, ratio); });
        } else {
          tally.check(fine[order] <= 1001 * noise,
                      [&] { return fmt::format("{}: derivative {} is off by {}", c.name, order + 1, fine[order]); });
        }
      }
    }
  tally.finish(kRounds * kCurveCases * 2);
}

TEST(Curve, DerivativesConvergeWithSecondOrder) {
  Tally plane("derivatives in the plane", kSeed + 1), space("derivatives in space", kSeed + 1);
  int slopes = 0;
  derivatives_converge<Vec2>(plane, slopes);
  derivatives_converge<Vec3>(space, slopes);
  EXPECT_GE(slopes, kRounds * 2 * 15) << "too few slopes were above rounding";
}

TEST(ParamMap, RoundTripsAndRises) {
  Random random(kSeed + 2);
  Tally tally("param maps", kSeed + 2);
  for (const auto kind : {ParamMap::Kind::affine, ParamMap::Kind::arc, ParamMap::Kind::hyperbolic})
    for (int i = 0; i < 2000; ++i) {
      const double a = between(random, -7, 7), width = between(random, 1e-3, kind == ParamMap::Kind::hyperbolic ? 1.0 : kPi / 2);
      const ParamMap map{kind, a, a + width};
      tally.check(map.to_native(0) == map.a && map.to_native(1) == map.b,
                  [&] { return fmt::format("the ends of [{}, {}] are not exact", map.a, map.b); });
      double before = map.a;
      bool rises = true;
      for (int k = 1; k <= 20; ++k) {
        const double native = map.to_native(k / 20.0);
        rises = rises && native > before;
        before = native;
        tally.within(std::abs(map.to_unit(native) - k / 20.0), 16 * kEps * (1 + std::abs(a) / width),
                     [&] { return fmt::format("s = {}", k / 20.0); });
      }
      tally.check(rises, [&] { return fmt::format("not rising on [{}, {}]", map.a, map.b); });
    }
  tally.finish(3 * 2000 * 22);
}

TEST(Curve, BadNurbsDataAreNamed) {
  Random random(kSeed + 3);
  const auto good = random_nurbs_curve<Vec3>(random, Knots::smooth, 3, true);
  EXPECT_EQ(problem_of(good), "");
  const auto says = [&](auto change, const char* word) {
    auto bad = good;
    change(bad);
    EXPECT_NE(problem_of(bad).find(word), std::string::npos) << problem_of(bad) << "; expected: " << word;
  };
  says([](auto& c) { c.knots[5] = c.knots[4] - 1; }, "must not decrease");
  says([](auto& c) { c.knots[2] = std::nan(""); }, "not a finite number");
  says([](auto& c) { c.knots.pop_back(); }, "expected poles + degree + 1");
  says([](auto& c) { c.poles[1].w = 0; }, "not positive");
  says([](auto& c) { c.poles[1].w = -1; }, "not positive");
  says([](auto& c) { c.poles[2].x = kInf; }, "not finite");
  says([](auto& c) { c.degree = 0; }, "degree 0");
  says([](auto& c) { c.degree = 31; }, "degree 31");
  says([](auto& c) { std::fill(c.knots.begin(), c.knots.end(), 1.0); }, "empty domain");
}

}  // namespace
}  // namespace iso::test
