// Patterns over the domain of patches with any number of sides: counts, cover, symmetry, levels of sides, cuts along spokes, and tables.
#include "tess/multisided.h"

#include <gtest/gtest.h>

#include <set>

#include "tess/domain_overlap.h"
#include "tess/pattern_cuts.h"
#include "tess/predicates.h"
#include "tests/support/n_sided.h"

namespace iso::test {
namespace {

std::uint64_t squared(int m) { return static_cast<std::uint64_t>(m) * static_cast<std::uint64_t>(m); }

std::string told(Strategy strategy, int n, const PatternLevels& levels) {
  std::string text = std::string(name_of(strategy)) + ", " + std::to_string(n) + " sides, level " + std::to_string(levels.inner);
  for (const int level : levels.of_side) text += " " + std::to_string(level);
  return text;
}

double area_of(const Vec2& a, const Vec2& b, const Vec2& c) { return 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)); }
double polygon_area(int n) { return 0.5 * n * std::sin(kTwoPi / n); }

// Even levels, and some that differ from side to side.
std::vector<PatternLevels> levels_for(int n) {
  std::vector<PatternLevels> all;
  for (const int m : {1, 2, 3, 4, 5, 8}) {
    all.push_back({m, {}});
    PatternLevels uneven{m, {}}, finer{m, {}};
    for (int k = 0; k < n; ++k) uneven.of_side.push_back(1 + (5 * k + m) % 7);
    for (int k = 0; k < n; ++k) finer.of_side.push_back(m + (k == 1 ? 3 : 0));
    all.push_back(uneven);
    all.push_back(finer);
  }
  return all;
}

template <class Check>
int for_every_pattern(Check check) {
  int count = 0;
  for (const Strategy strategy : kStrategies)
    for (int n = 3; n <= kMostSides; ++n)
      for (const PatternLevels& levels : levels_for(n)) {
        SCOPED_TRACE(told(strategy, n, levels));
        check(strategy, n, levels, domain_pattern(strategy, n, levels));
        ++count;
        if (::testing::Test::HasFailure()) return count;
      }
  return count;
}

TEST(Multisided, TrianglesAndQuadsAreAsManyAsTheStrategiesSay) {
  int checked = 0;
  for (const Strategy strategy : kStrategies)
    for (int n = 3; n <= kMostSides; ++n)
      for (const int m : {1, 2, 3, 4, 7, 16}) {
        const DomainPattern p = domain_pattern(strategy, n, {m, {}});
        const bool fan = strategy == Strategy::fan_triangles || strategy == Strategy::fan_quads, even = n % 2 == 0;
        SCOPED_TRACE(told(strategy, n, {m, {}}));
        EXPECT_EQ(p.triangles.size(), squared(m) * static_cast<std::uint64_t>(fan ? n - 2 : n));
        std::uint64_t quads = 0;
        if (strategy == Strategy::fan_quads) quads = static_cast<std::uint64_t>(even ? n / 2 - 1 : (n - 3) / 2) * squared(m);
        if (strategy == Strategy::symmetric_quads && even) quads = static_cast<std::uint64_t>(n / 2) * squared(m);
        EXPECT_EQ(p.quads, quads);
        // Euler: V - E + F = 1 for a disc, with 3 F = 2 E - border.
        const std::size_t border = static_cast<std::size_t>(n * m);
        EXPECT_EQ(2 * p.points.size(), p.triangles.size() + border + 2);
        ++checked;
      }
  EXPECT_EQ(checked, 4 * 14 * 6);
}

TEST(Multisided, PatternsCoverThePolygonExactlyOnce) {
  const int checked = for_every_pattern([](Strategy, int n, const PatternLevels&, const DomainPattern& p) {
    double area = 0;
    std::vector<std::array<UV, 3>> triangles;
    for (const auto& [a, b, c] : p.triangles) {
      ASSERT_GT(orientation(p.points[a], p.points[b], p.points[c]), 0);
      area += area_of(p.points[a], p.points[b], p.points[c]);
      triangles.push_back({p.points[a], p.points[b], p.points[c]});
    }
    EXPECT_NEAR(area, polygon_area(n), 1e-13);
    const DomainOverlap overlap = domain_overlap(triangles, 1);
    EXPECT_TRUE(overlap.turned.empty() && overlap.overlapping.empty());
  });
  EXPECT_EQ(checked, 4 * 14 * 18);
}

TEST(Multisided, SidesHaveTheirOwnLevelsEvenly) {
  int points = 0;
  for_every_pattern([&](Strategy, int n, const PatternLevels& levels, const DomainPattern& p) {
    ASSERT_EQ(p.of_side.size(), static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) {
      const auto& row = p.of_side[static_cast<std::size_t>(k)];
      const int level = levels.of_side.empty() ? levels.inner : levels.of_side[static_cast<std::size_t>(k)];
      ASSERT_EQ(row.size(), static_cast<std::size_t>(level) + 1);
      const Vec2 from = domain_corner(n, k - 1), to = domain_corner(n, k);
      for (int i = 0; i <= level; ++i, ++points) {
        const double x = static_cast<double>(i) / level;
        EXPECT_LT(glm::length(p.points[row[static_cast<std::size_t>(i)]] - ((1 - x) * from + x * to)), 4e-16 * 4);
        const ChartPlace& place = p.places[row[static_cast<std::size_t>(i)]];
        EXPECT_TRUE(place.st.x == 0 || place.st.y == 0) << "not exactly on the side";
      }
    }
  });
  EXPECT_GT(points, 40000);
}

TEST(Multisided, PlacesInChartsAreThoseOfThePoints) {
  int points = 0;
  double worst = 0;
  for_every_pattern([&](Strategy, int n, const PatternLevels&, const DomainPattern& p) {
    for (std::size_t i = 0; i < p.points.size(); ++i, ++points) {
      const Vec2 at = domain_point(n, p.places[i].st), by = domain_corner(n, p.places[i].corner);
      worst = std::max(worst, glm::length(Vec2(by.x * at.x - by.y * at.y, by.y * at.x + by.x * at.y) - p.points[i]));
      EXPECT_TRUE(p.places[i].st.x >= 0 && p.places[i].st.x <= 1 && p.places[i].st.y >= 0 && p.places[i].st.y <= 1);
    }
  });
  EXPECT_LT(worst, 4e-15);
  EXPECT_GT(points, 40000);
}

// A pattern's edges, in numbers of places that are the same for points within rounding.
std::set<std::array<long long, 4>> edges_of(const DomainPattern& p, int turn) {
  std::set<std::array<long long, 4>> edges;
  const Vec2 by = domain_corner(p.sides, turn);
  const auto number = [](double x) { return std::llround(x * 1e9); };
  for (const auto& t : p.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<long long, 4> ends;
      for (std::size_t e = 0; e < 2; ++e) {
        const Vec2 q = p.points[t[(k + e) % 3]];
        ends[2 * e] = number(by.x * q.x - by.y * q.y);
        ends[2 * e + 1] = number(by.y * q.x + by.x * q.y);
      }
      if (std::pair(ends[2], ends[3]) < std::pair(ends[0], ends[1])) std::swap(ends[0], ends[2]), std::swap(ends[1], ends[3]);
      edges.insert(ends);
    }
  return edges;
}

TEST(Multisided, SymmetricPatternsComeToThemselvesWhenTurned) {
  int checked = 0;
  for (int n = 3; n <= kMostSides; ++n)
    for (const int m : {1, 2, 3, 6})
      for (const Strategy strategy : {Strategy::symmetric_triangles, Strategy::symmetric_quads}) {
        SCOPED_TRACE(told(strategy, n, {m, {}}));
        const DomainPattern p = domain_pattern(strategy, n, {m, {}});
        // Sectors of quads take two sides.
        const int turn = strategy == Strategy::symmetric_quads && n % 2 == 0 ? 2 : 1;
        EXPECT_EQ(edges_of(p, 0), edges_of(p, turn));
        ++checked;
      }
  EXPECT_EQ(checked, 14 * 4 * 2);
  // A fan does not.
  EXPECT_NE(edges_of(domain_pattern(Strategy::fan_triangles, 6, {3, {}}), 0),
            edges_of(domain_pattern(Strategy::fan_triangles, 6, {3, {}}), 1));
}

TEST(Multisided, CutsCoverEachChartExactlyOnce) {
  std::size_t pieces = 0;
  for_every_pattern([&](Strategy, int n, const PatternLevels&, const DomainPattern& p) {
    const PatternCuts cuts = cut_by_charts(p);
    std::vector<std::vector<std::array<UV, 3>>> of_chart(static_cast<std::size_t>(n));
    for (const PatternCuts::Piece& piece : cuts.pieces) of_chart[static_cast<std::size_t>(piece.corner)].push_back(piece.st);
    double all = 0;
    pieces += cuts.pieces.size();
    for (const auto& chart : of_chart) {
      double area = 0;
      for (const auto& [a, b, c] : chart) area += area_of(a, b, c);
      EXPECT_NEAR(area, 1, 1e-13);
      // Straight in the polygon is not straight in the chart: they are disjoint there.
      std::vector<std::array<UV, 3>> triangles;
      for (const auto& [a, b, c] : chart) triangles.push_back({domain_point(n, a), domain_point(n, b), domain_point(n, c)});
      for (const auto& [a, b, c] : triangles) all += area_of(a, b, c);
      const DomainOverlap overlap = domain_overlap(triangles, 1);
      EXPECT_TRUE(overlap.turned.empty()) << overlap.turned.size() << " of " << chart.size();
      EXPECT_TRUE(overlap.overlapping.empty());
    }
    EXPECT_NEAR(all, polygon_area(n), 1e-13);
  });
  EXPECT_GT(pieces, 100000u);
}

TEST(Multisided, TablesAreTheWeights) {
  Numbers random(5);
  int checked = 0;
  double worst = 0;
  for (const PatchBasis& basis : every_basis())
    for (const Strategy strategy : kStrategies) {
      const DomainPattern p = domain_pattern(strategy, basis.sides, {4, {}});
      const CoordinateTable table(basis, p.places);
      const std::vector<Vec3> points = random.points(basis);
      const std::vector<Vec3> places = table.places(points);
      const std::vector<CoordinateTable::At> at = table.evaluate(points);
      std::vector<Vec3> seen = points;
      for (int corner = 0; corner < basis.sides; ++corner, seen = turned(basis, seen))
        for (std::size_t i = 0; i < p.points.size(); ++i) {
          if (p.places[i].corner != corner) continue;
          const Jet2 jet = jet_at(basis, seen, p.places[i].st);
          worst = std::max({worst, glm::length(places[i] - point_at(basis, seen, p.places[i].st)), glm::length(at[i].S - jet.S)});
          const double size = 1 + glm::length(jet.Su) + glm::length(jet.Sv);
          worst = std::max(worst, (glm::length(at[i].Ss - jet.Su) + glm::length(at[i].St - jet.Sv)) / size);
          ++checked;
        }
      // Those of one sector, but for what its ends share.
      if (strategy == Strategy::symmetric_triangles) {
        EXPECT_LE(table.rows(), 4u * 5 / 2 + 5 + 1);
      }
    }
  EXPECT_LT(worst, 1e-14);
  EXPECT_GT(checked, 30000);
}

}  // namespace
}  // namespace iso::test
