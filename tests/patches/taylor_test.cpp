// Truncated power series: models contain what they stand for, their width shrinks with the right order, derivatives are those of the closed
// form. At corners, where powers of the distance cancel, models contain quotients up to the corner.
#include "patches/base/taylor.h"

#include <gtest/gtest.h>

#include "patches/base/corner_series.h"
#include "patches/surface/patch_basis-inl.h"
#include "tests/support/n_sided.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

// Of the coefficients, which models do not count.
constexpr double kRounding = 1e-13;

double value(const Taylor& p, double a, double b) {
  double sum = 0;
  for (int n = 0; n <= Taylor::kOrder; ++n)
    for (int j = 0; j <= n; ++j) sum += p.c[Taylor::index(n - j, j)] * std::pow(a, n - j) * std::pow(b, j);
  return sum;
}

// Formulas for any number type; x is near `at`, and so is y. Those of corners are in (s, t) >= 0.
struct Formula {
  const char* name;
  Taylor (*model)(const Taylor&, const Taylor&);
  Series (*series)(const Series&, const Series&);
  double (*number)(const double&, const double&);
};
template <class T>
T polynomial(const T& x, const T& y) {
  return (x * y - 0.25 * x) * (x + y + 1.5) * (1.0 - y * y);
}
template <class T>
T quotient(const T& x, const T& y) {
  return (x * x - y) / (x + y * y + 1.0);
}
template <class T>
T root(const T& x, const T& y) {
  using std::sqrt;
  return sqrt(x * x + y + 0.5) * x;
}
template <class T>
T nested(const T& x, const T& y) {
  using std::sqrt;
  return sqrt((x + 1.0) / (y + 2.0) + x * y) / (x * x + 1.0);
}
template <class T>
T blended(const T& x, const T& y) {
  return blend(x, y, x * x * (y + 1.0), x * y);
}
template <class T>
T shared(const T& x, const T& y) {
  return share(x, y) * x * y + share(y, x + y);
}
constexpr Formula kFormulas[] = {
    {"polynomial", polynomial<Taylor>, polynomial<Series>, polynomial<double>},
    {"quotient", quotient<Taylor>, quotient<Series>, quotient<double>},
    {"root", root<Taylor>, root<Series>, root<double>},
    {"nested", nested<Taylor>, nested<Series>, nested<double>},
    {"blend", blended<Taylor>, blended<Series>, blended<double>},
    {"share", shared<Taylor>, shared<Series>, shared<double>},
};

TEST(Taylor, ModelsContainWhatTheyStandFor) {
  Numbers random(1);
  Tally tally("Taylor models");
  int bounded = 0;
  for (const Formula& f : kFormulas)
    for (int repeat = 0; repeat < 400; ++repeat) {
      // Boxes of every size in the positive quadrant, some of them at its corner or its borders.
      const Vec2 half = std::pow(10.0, random(-5, 0)) * Vec2(random(0.1, 0.5), random(0.1, 0.5));
      Vec2 middle = half + Vec2(random(0, 1), random(0, 1));
      for (int c = 0; c < 2; ++c)
        if (repeat >> c & 1) middle[c] = half[c];
      const Taylor model = f.model(Taylor(middle.x, half.x, 0), Taylor(middle.y, 0, half.y));
      bounded += finite(model.magnitude());
      for (int k = 0; k < 40; ++k) {
        const double a = k < 4 ? (k & 1 ? 1 : -1) : random(-1, 1), b = k < 4 ? (k & 2 ? 1 : -1) : random(-1, 1);
        const double truth = f.number(middle.x + a * half.x, middle.y + b * half.y);
        const auto text = [&] { return fmt::format("{} about {} {} +- {} {} at {} {}", f.name, middle.x, middle.y, half.x, half.y, a, b); };
        tally.check(!(std::abs(truth - value(model, a, b)) > model.radius + kRounding), text);
        tally.check(!(std::abs(truth) > model.magnitude() + kRounding), text);
      }
    }
  EXPECT_GE(bounded, 6 * 380);
  tally.finish(6 * 400 * 40 * 2);
}

// The radius is what is cut off: the next order.
TEST(Taylor, RadiusConvergesWithTheOrder) {
  int checked = 0;
  for (const Formula& f : kFormulas) {
    double before = 0;
    for (const double half : {0.2, 0.1, 0.05}) {
      const double radius = f.model(Taylor(0.7, half, 0), Taylor(0.4, 0, half)).radius;
      if (before > 0) {
        EXPECT_GE(std::log2(before / radius), Taylor::kOrder + 0.5) << f.name << ", " << half;
        ++checked;
      }
      before = radius;
    }
  }
  EXPECT_EQ(checked, 10);  // of the polynomial, of degree 5, nothing is cut off
  EXPECT_EQ(polynomial<Taylor>(Taylor(0.7, 0.1, 0), Taylor(0.4, 0, 0.1)).radius, 0.0);
}

// Of a box that holds the corner: the blend's width shrinks like the square of the box, as X - Y does.
TEST(Taylor, BlendAtTheCornerShrinksWithTheSquareOfTheBox) {
  for (const double half : {1e-1, 1e-2, 1e-3, 1e-6}) {
    const Taylor x(half, half, 0), y(half, 0, half);
    const Taylor model = blend(x, y, x * x, x * y);
    EXPECT_GT(model.radius, 0.0);
    EXPECT_LE(model.radius, 8 * half * half);
    const Taylor any = share(x, y);
    EXPECT_EQ(any.c[0], 0.5);
    EXPECT_EQ(any.radius, 0.5);
  }
}

// Nothing is known where a divisor may vanish, and that is said.
TEST(Taylor, DivisorsThatMayVanishAreUnbounded) {
  for (const double middle : {0.0, 0.5, 0.999, -0.3}) {
    const Taylor model = Taylor(1.0) / Taylor(middle, 1, 0);
    EXPECT_FALSE(model.magnitude() < kInf) << middle;
  }
  EXPECT_LT((Taylor(1.0) / Taylor(1.5, 1, 0)).magnitude(), kInf);
}

TEST(Taylor, SquareRootAcrossZeroIsARange) {
  const Taylor model = sqrt(Taylor(0.5, 0.5, 0));
  for (int k = 0; k <= 100; ++k) EXPECT_LE(std::abs(std::sqrt(0.01 * k) - value(model, 0.02 * k - 1, 0)), model.radius);
}

// Over a quarter the polynomial is the same, about another middle.
TEST(Taylor, QuartersAreTheSamePolynomial) {
  Numbers random(4);
  Tally tally("quarters");
  for (const Formula& f : kFormulas) {
    const Taylor model = f.model(Taylor(0.7, 0.2, 0), Taylor(0.6, 0, 0.1));
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) {
        const Taylor part = model.quarter(x, y);
        EXPECT_EQ(part.radius, model.radius);
        for (int k = 0; k < 20; ++k) {
          const double a = random(-1, 1), b = random(-1, 1);
          tally.within(std::abs(value(part, a, b) - value(model, x + 0.5 * a, y + 0.5 * b)), kRounding, [&] { return f.name; });
        }
      }
  }
  tally.finish(6 * 4 * 20);
}

// ---- CornerSeries --------------------------------------------------------------------------------------------------------

using Corner = CornerSeries<Taylor>;

// In (r, w): (s, t) = (r, r w), or the other way round.
struct CornerBox {
  Vec2 middle, half;
  bool swapped;

  std::pair<Corner, Corner> st() const {
    const Corner far(1.0, 1, middle.x, half.x), near(Taylor(middle.y, 0, half.y), 1, middle.x, half.x);
    return swapped ? std::pair{near, far} : std::pair{far, near};
  }
  Vec2 at(double a, double b) const {
    const double r = middle.x + a * half.x, w = middle.y + b * half.y;
    return swapped ? Vec2(r * w, r) : Vec2(r, r * w);
  }
};

// Some reach to the corner, at which nothing but the limit along a line is left: they are looked at beside it.
CornerBox random_corner_box(Numbers& random, int repeat, double largest) {
  CornerBox box{.middle = {}, .half = {largest * std::pow(10.0, random(-5, 0)), 0.5 * random(0.05, 0.3)}, .swapped = repeat % 2 == 1};
  box.middle.x = box.half.x * (repeat % 4 < 2 ? 1 : random(1, 3));
  box.middle.y = random(box.half.y, 1 - box.half.y);
  return box;
}

struct CornerFormula {
  const char* name;
  Corner (*model)(const Corner&, const Corner&);
  double (*number)(const double&, const double&);
};
template <class T>
T harmonic(const T& s, const T& t) {
  return s * t / (s + t) + 0.5 * s;
}
template <class T>
T length_of(const T& s, const T& t) {
  using std::sqrt;
  return sqrt(s * s + t * t) * (1.0 - s) + t;
}
template <class T>
T direction(const T& s, const T& t) {
  return share(s * (1.0 + t), t) * (s + 2.0);
}
template <class T>
T of_second_order(const T& s, const T& t) {
  return blend(s, t, s * s * (t + 1.0), s * t) - T(0.0) * s;
}
constexpr CornerFormula kCornerFormulas[] = {
    {"harmonic", harmonic<Corner>, harmonic<double>},
    {"length", length_of<Corner>, length_of<double>},
    {"direction", direction<Corner>, direction<double>},
    {"second order", of_second_order<Corner>, of_second_order<double>},
};

TEST(CornerSeries, ModelsContainQuotientsUpToTheCorner) {
  Numbers random(5);
  Tally tally("models at corners");
  double widest = 0;
  for (const CornerFormula& f : kCornerFormulas)
    for (int repeat = 0; repeat < 400; ++repeat) {
      const CornerBox box = random_corner_box(random, repeat, 0.1);
      const auto [s, t] = box.st();
      const Taylor model = f.model(s, t).value();
      ASSERT_TRUE(finite(model.radius));
      widest = std::max(widest, model.radius);
      for (int k = 0; k < 40; ++k) {
        const double a = k < 20 ? random(-1, 1) : -1 + std::pow(10.0, random(-12, 0)), b = random(-1, 1);
        const Vec2 st = box.at(a, b);
        tally.check(std::abs(f.number(st.x, st.y) - value(model, a, b)) <= model.radius + kRounding,
                    [&] { return fmt::format("{} at {} {}", f.name, st.x, st.y); });
      }
    }
  EXPECT_LT(widest, 1e-3);
  tally.finish(4 * 400 * 40);
}

// What cancels leaves no width, and powers below zero have no limit.
TEST(CornerSeries, PowersCancel) {
  for (const bool swapped : {false, true}) {
    const CornerBox box{.middle = {0.01, 0.6}, .half = {0.01, 0.1}, .swapped = swapped};
    const auto [s, t] = box.st();
    const Taylor one = ((s * s + s * t) / (s + t) / s).value();
    EXPECT_NEAR(one.c[0], 1, 1e-15);
    EXPECT_LT(one.spread(), 1e-6);  // of 1 + w and its inverse
    EXPECT_EQ((s / s).power, 0);
    EXPECT_EQ(sqrt(s * s + t * t).power, 1);
    EXPECT_EQ((Corner(0.0) + s).power, 1);
    EXPECT_EQ((1.0 + s).power, 0);
    EXPECT_FALSE((1.0 / s).value().radius < kInf);
    EXPECT_FALSE(sqrt(s).f.radius < kInf);
  }
}

// All weights on mean value parameters.
TEST(CornerSeries, ModelsContainWeightsUpToTheCorner) {
  Numbers random(6);
  Tally tally("weights at corners");
  int bases = 0;
  for (const PatchBasis& basis : every_basis()) {
    if (basis.parameters != SideParameters::mean_value || basis.degree > 4) continue;
    ++bases;
    for (int repeat = 0; repeat < 6; ++repeat) {
      const CornerBox box = random_corner_box(random, repeat, 1e-3);
      const auto [s, t] = box.st();
      std::vector<Corner> W(point_count(basis));
      patch_weights(basis, s, t, W.data());
      for (int k = 0; k < 10; ++k) {
        const double a = k < 5 ? random(-1, 1) : -1 + std::pow(10.0, random(-9, 0)), b = random(-1, 1);
        const std::vector<double> truth = weights(basis, box.at(a, b));
        for (std::size_t m = 0; m < W.size(); ++m) {
          const Taylor model = W[m].value();
          tally.check(std::abs(truth[m] - value(model, a, b)) <= model.radius + kRounding,
                      [&] { return fmt::format("{}, weight {} at r {} w {}", told(basis), m, a, b); });
          tally.check(model.radius < 0.01, [&] { return fmt::format("{}, weight {}: radius {}", told(basis), m, model.radius); });
        }
      }
    }
  }
  EXPECT_EQ(bases, 8 * 4);
  tally.finish_at_least(32u * 6 * 10 * 15);
}

// ---- Series ------------------------------------------------------------------------------------------------------------------

// 1 / (1 + x + 2 y): c(i, j) = (-1)^(i+j) (i + j choose j) 2^j. sqrt(1 + x): 1, 1/2, -1/8, 1/16, -5/128.
TEST(Series, CoefficientsOfClosedForms) {
  const Series x(0, 1, 0), y(0, 0, 1);
  const Series fraction = inverse(1.0 + x + 2.0 * y), radical = sqrt(1.0 + x);
  int checked = 0;
  for (int n = 0; n <= Series::kOrder; ++n) {
    double choose = 1;
    for (int j = 0; j <= n; ++j, ++checked) {
      EXPECT_NEAR(fraction.c[Series::index(n - j, j)], (n % 2 ? -1 : 1) * choose * std::pow(2, j), 1e-13) << n << " " << j;
      choose = choose * (n - j) / (j + 1);
      if (j > 0) {
        EXPECT_EQ(radical.c[Series::index(n - j, j)], 0.0);
      }
    }
  }
  const double roots[] = {1, 0.5, -0.125, 0.0625, -5.0 / 128};
  for (int n = 0; n <= 4; ++n) EXPECT_NEAR(radical.c[Series::index(n, 0)], roots[n], 1e-15);
  EXPECT_EQ(checked, Series::kCount);
}

// Against differences of the numbers: the remainder after order four falls with the fifth power.
TEST(Series, DerivativesOfFormulasLeaveAFifthOrderRemainder) {
  Numbers random(2);
  int checked = 0;
  for (const Formula& f : kFormulas)
    for (int repeat = 0; repeat < 50; ++repeat) {
      const Vec2 at(random(0.3, 1), random(0.3, 1)), by = 0.5 * glm::normalize(Vec2(random(-1, 1), random(-1, 1)));
      const Series series = f.series(Series(at.x, 1, 0), Series(at.y, 0, 1));
      const auto remainder = [&](double h) {
        double sum = 0;
        for (int n = 0; n <= Series::kOrder; ++n)
          for (int j = 0; j <= n; ++j) sum += series.c[Series::index(n - j, j)] * std::pow(h * by.x, n - j) * std::pow(h * by.y, j);
        return std::abs(f.number(at.x + h * by.x, at.y + h * by.y) - sum);
      };
      const double coarse = remainder(0.08), fine = remainder(0.04);
      EXPECT_LE(fine, coarse / 16 + 1e-9) << f.name;
      EXPECT_LE(fine, 1e-5) << f.name;
      ++checked;
    }
  EXPECT_EQ(checked, 300);
}

// All weights of all kinds: first and second derivatives as the second-order numbers have them.
TEST(Series, DerivativesOfWeightsAreThoseOfDuals) {
  Numbers random(3);
  Tally tally("weights by series");
  for (const PatchBasis& basis : every_basis()) {
    std::vector<Series> W(point_count(basis));
    const Vec2 st(random(0.1, 1), random(0.1, 1));
    patch_weights(basis, Series(st.x, 1, 0), Series(st.y, 0, 1), W.data());
    const std::vector<Dual2> D = dual_weights(basis, st);
    double worst = 0;
    for (std::size_t m = 0; m < W.size(); ++m) {
      const auto& c = W[m].c;
      const double has[] = {c[0], c[1], c[2], 2 * c[Series::index(2, 0)], c[Series::index(1, 1)], 2 * c[Series::index(0, 2)]};
      const double wants[] = {D[m].f, D[m].u, D[m].v, D[m].uu, D[m].uv, D[m].vv};
      for (int k = 0; k < 6; ++k) worst = std::max(worst, std::abs(has[k] - wants[k]) / std::max(1.0, std::abs(wants[k])));
    }
    tally.within(worst, 1e-9, [&] { return told(basis); });
  }
  tally.finish_at_least(60);
}

}  // namespace
}  // namespace iso::test
