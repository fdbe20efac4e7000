// Signs of determinants against integers of 128 bits and against CGAL's exact sums.
#include "tess/predicates.h"

#include "tests/support/cgal_oracle.h"
#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240915;
__extension__ using Wide = __int128;

int sign(Wide x) { return (x > 0) - (x < 0); }

Vec2 whole_point(Random& random, std::int64_t size) {
  std::uniform_int_distribution<std::int64_t> at(-size, size);
  return {double(at(random)), double(at(random))};
}

int integer_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  return sign((Wide(a.x) - Wide(c.x)) * (Wide(b.y) - Wide(c.y)) - (Wide(a.y) - Wide(c.y)) * (Wide(b.x) - Wide(c.x)));
}

int integer_circle_side(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  Wide x[3], y[3], lift[3];
  const Vec2* corners[3] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {
    x[i] = Wide(corners[i]->x) - Wide(d.x);
    y[i] = Wide(corners[i]->y) - Wide(d.y);
    lift[i] = x[i] * x[i] + y[i] * y[i];
  }
  Wide sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += lift[i] * (x[j] * y[k] - x[k] * y[j]);
  }
  return sign(sum);
}

std::string told(std::initializer_list<Vec2> points) {
  std::string text;
  for (const Vec2& p : points) text += fmt::format("({:a}, {:a}) ", p.x, p.y);
  return text;
}

// Three points almost on a line: the third is on the rounded line through the others, a few last places off; or, where all coordinates
// are short, exactly on it.
std::array<Vec2, 3> almost_collinear(Random& random, bool exactly) {
  if (exactly) {
    // Not rounded to float: at -O3 GCC 12 drops the way there and back of a vector of two.
    const auto shortened = [&] { return Vec2(whole(random, -1000000, 1000000), whole(random, -1000000, 1000000)) / 1048576.0; };
    const Vec2 a = shortened(), b = shortened();
    return {a, b, a + double(whole(random, -3, 4)) * (b - a)};
  }
  const double size = std::pow(10.0, between(random, -30, 30));
  const Vec2 a = random_vector<Vec2>(random, size), b = random_vector<Vec2>(random, size);
  Vec2 c = a + between(random, -2, 3) * (b - a);
  for (int i = whole(random, 0, 2); i > 0; --i) c.x = std::nextafter(c.x, whole(random, 0, 1) ? kInf : -kInf);
  return {a, b, c};
}

// Four points almost on a circle, far from the origin or near it, the triangle counter-clockwise.
std::array<Vec2, 4> almost_cocircular(Random& random) {
  const double radius = std::pow(10.0, between(random, -12, 6));
  const Vec2 centre = random_vector<Vec2>(random, std::pow(10.0, between(random, -6, 6)));
  std::array<Vec2, 4> p;
  for (Vec2& q : p) {
    const double angle = between(random, 0, kTwoPi);
    q = centre + radius * Vec2(std::cos(angle), std::sin(angle));
  }
  if (orientation(p[0], p[1], p[2]) < 0) std::swap(p[0], p[1]);
  return p;
}

TEST(Predicates, OrientationOfIntegersIsThatOfTheIntegers) {
  Random random(kSeed);
  Tally tally("orientation of integers", kSeed);
  for (int i = 0; i < 200000; ++i) {
    const std::int64_t size = std::int64_t(1) << whole(random, 1, 52);
    const Vec2 a = whole_point(random, size), b = whole_point(random, size), c = i % 2 ? whole_point(random, size) : a + (b - a) / 2.0;
    const Vec2 whole_c{std::floor(c.x), std::floor(c.y)};
    tally.check(orientation(a, b, whole_c) == integer_orientation(a, b, whole_c), [&] { return told({a, b, whole_c}); });
  }
  tally.finish(200000);
}

TEST(Predicates, OrientationNearLinesIsExactAndAntisymmetric) {
  Random random(kSeed);
  Tally tally("orientation near lines", kSeed);
  int zero = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto [a, b, c] = almost_collinear(random, i % 4 == 0);
    const int o = orientation(a, b, c);
    zero += o == 0;
    tally.check(o == cgal_orientation(a, b, c), [&, &a = a, &b = b, &c = c] { return told({a, b, c}); });
    tally.check(o == orientation(b, c, a) && o == orientation(c, a, b) && o == -orientation(b, a, c) && o == -orientation(a, c, b),
                [&, &a = a, &b = b, &c = c] {
                  return "not antisymmetric: " + told({a, b, c});
                });
  }
  tally.finish(200000);
  EXPECT_GT(zero, 20000);
  EXPECT_EQ(orientation({0.1, 0.1}, {0.1, 0.1}, {7, 3}), 0);
  EXPECT_EQ(orientation({-1, -1}, {1, 1}, {1e-140, 1e-140}), 0);
  EXPECT_EQ(orientation({-1, -1}, {1, 1}, {0, 1e-140}), 1);
}

TEST(Predicates, CirclesOfIntegersAreThoseOfTheIntegers) {
  Random random(kSeed);
  Tally tally("circles of integers", kSeed);
  int on = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::int64_t size = std::int64_t(1) << whole(random, 1, 28);
    Vec2 a = whole_point(random, size), b = whole_point(random, size), c = whole_point(random, size), d = whole_point(random, size);
    if (i % 3 == 0) b = {-a.y, a.x}, c = -a, d = {whole(random, 0, 1) ? a.y : a.y + 1, -a.x};
    if (orientation(a, b, c) < 0) std::swap(a, b);
    const int truth = integer_circle_side(a, b, c, d), quick = circle_side_or_doubt(a, b, c, d);
    on += truth == 0;
    tally.check(in_circle(a, b, c, d) == (truth > 0) && (quick == 0 || quick == truth), [&] { return told({a, b, c, d}); });
  }
  tally.finish(200000);
  EXPECT_GT(on, 10000);
}

TEST(Predicates, CirclesNearFourPointsAreExactAndSymmetric) {
  Random random(kSeed);
  Tally tally("circles near four points", kSeed);
  int doubtful = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto [a, b, c, d] = almost_cocircular(random);
    if (orientation(a, b, c) == 0) continue;
    const int truth = cgal_circle_side(a, b, c, d), quick = circle_side_or_doubt(a, b, c, d);
    doubtful += quick == 0;
    const auto say = [&, &a = a, &b = b, &c = c, &d = d] { return told({a, b, c, d}); };
    tally.check(in_circle(a, b, c, d) == (truth > 0), say);
    tally.check(in_circle(b, c, a, d) == (truth > 0) && in_circle(c, a, b, d) == (truth > 0), say);
    tally.check(quick == 0 || quick == truth, say);
    tally.check(certainly_in_circle(a, b, c, d) == (quick > 0), say);
  }
  tally.finish_at_least(70000);
  EXPECT_GT(doubtful, 1000);
}

}  // namespace
}  // namespace iso::test
