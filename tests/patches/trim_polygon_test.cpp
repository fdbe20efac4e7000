// Trim regions of polygons against a slow winding test, and what files do to loops: gaps, spikes, seams, shifted windows.
#include "patches/trim.h"
#include "reference/winding.h"
#include "tests/support/random_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

using reference::Polygon;
constexpr std::uint64_t kSeed = 20240612;

TrimLoop loop_of(const Polygon& polygon) {
  TrimLoop loop;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    if (a != b) loop.curves.push_back({Line<Vec2>{a, b - a}, 0, 1, -1});
  }
  return loop;
}

Face face_of(const std::vector<Polygon>& polygons, AnySurface surface = Plane{}) {
  Face face;
  face.surface = std::move(surface);
  for (const Polygon& p : polygons) face.loops.push_back(loop_of(p));
  return face;
}

Polygon star(Random& random, int corners, double lo, double hi) {
  Polygon p;
  for (int i = 0; i < corners; ++i) {
    const double angle = kTwoPi * (i + between(random, 0, 0.9)) / corners, r = between(random, lo, hi);
    p.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return p;
}

// Points anywhere, level with vertices, on vertical lines through vertices, and close to edges.
Vec2 query(Random& random, int i, const std::vector<Polygon>& polygons, double reach) {
  const Polygon& polygon = polygons[static_cast<std::size_t>(whole(random, 0, static_cast<int>(polygons.size()) - 1))];
  const std::size_t k = static_cast<std::size_t>(whole(random, 0, static_cast<int>(polygon.size()) - 1));
  const Vec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
  Vec2 p = random_vector<Vec2>(random, reach);
  switch (i % 4) {
    case 1:
      p.y = a.y;
      break;
    case 2:
      p.x = a.x;
      break;
    case 3: {
      const Vec2 along = b - a, across{-along.y, along.x};
      const double off = std::pow(10.0, between(random, -11, -2)) * (whole(random, 0, 1) ? 1 : -1);
      p = a + between(random, 0, 1) * along + off / std::max(1e-9, glm::length(along)) * across;
      break;
    }
    default:
      break;
  }
  return p;
}

// Compares with the reference wherever the point is farther than 1e-12 from every edge; returns how many were.
std::uint64_t compare(Tally& tally, Random& random, const std::vector<Polygon>& truth, const Face& face, int points, double reach,
                      double clear = 1e-12) {
  const TrimRegion trim(face, {}, 0);
  std::uint64_t decided = 0;
  for (int i = 0; i < points; ++i) {
    const Vec2 p = query(random, i, truth, reach);
    if (reference::distance(truth, p) <= clear) continue;
    ++decided;
    const bool expected = reference::inside_even_odd(truth, p);
    tally.check(trim.contains(p, face.surface).inside == expected, [&] {
      return fmt::format("({:.17g}, {:.17g}) should be {}, {:.3g} from the loop", p.x, p.y, expected ? "inside" : "outside",
                         double(reference::distance(truth, p)));
    });
  }
  return decided;
}

TEST(TrimPolygon, StarsOfAThousandSegments) {
  Random random(kSeed);
  Tally tally("stars", kSeed);
  std::uint64_t decided = 0;
  for (int round = 0; round < 5; ++round) {
    const std::vector<Polygon> truth{star(random, 1000, 0.8, 1.2)};
    decided += compare(tally, random, truth, face_of(truth), 4000, 1.3);
  }
  EXPECT_GE(decided, 19500u);
  tally.finish(decided);
}

TEST(TrimPolygon, NestedStars) {
  Random random(kSeed + 1);
  Tally tally("nested stars", kSeed + 1);
  std::uint64_t decided = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<Polygon> truth;
    for (int k = 1; k <= 5; ++k) truth.push_back(star(random, whole(random, 3, 40), 0.3 * k, 0.3 * k + 0.1));
    std::shuffle(truth.begin(), truth.end(), random);
    decided += compare(tally, random, truth, face_of(truth), 1000, 1.8);
  }
  EXPECT_GE(decided, 39000u);
  tally.finish(decided);
}

// The grid depends on the outline and the number of pieces only: a first region tells where its lines are, then inner vertices are put on
// them.
TEST(TrimPolygon, VerticesOnGridLines) {
  Random random(kSeed + 2);
  Tally tally("vertices on grid lines", kSeed + 2);
  std::uint64_t decided = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<Polygon> truth{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, star(random, whole(random, 3, 30), 0.2, 0.9)};
    const auto cells = TrimRegion(face_of(truth), {}, 0).cover();
    std::vector<double> us, vs;
    for (const Box2& c : cells) {
      us.push_back(c.lo.x);
      vs.push_back(c.lo.y);
    }
    const auto nearest = [](const std::vector<double>& lines, double x) {
      return *std::min_element(lines.begin(), lines.end(), [x](double a, double b) { return std::abs(a - x) < std::abs(b - x); });
    };
    for (Vec2& p : truth[1]) {
      const int which = whole(random, 0, 3);
      if (which != 1) p.x = nearest(us, p.x);
      if (which != 2) p.y = nearest(vs, p.y);
    }
    decided += compare(tally, random, truth, face_of(truth), 400, 1.1);
  }
  EXPECT_GE(decided, 60000u);
  tally.finish(decided);
}

// Axis-parallel steps, the commonest loops of all: edges along grid lines and level with each other.
TEST(TrimPolygon, AxisParallelStaircases) {
  Random random(kSeed + 3);
  Tally tally("staircases", kSeed + 3);
  std::uint64_t decided = 0;
  for (int round = 0; round < 100; ++round) {
    Polygon p;
    const int steps = whole(random, 2, 12);
    for (int k = 0; k < steps; ++k) {
      p.push_back({0.1 * k, 0.1 * k});
      p.push_back({0.1 * (k + 1), 0.1 * k});
    }
    p.push_back({0.1 * steps, 0.1 * steps + 0.2});
    p.push_back({0, 0.1 * steps + 0.2});
    const std::vector<Polygon> truth{p};
    decided += compare(tally, random, truth, face_of(truth), 1000, 1.5);
  }
  EXPECT_GE(decided, 60000u);
  tally.finish(decided);
}

TEST(TrimPolygon, OrientationAndOrderDoNotMatter) {
  Random random(kSeed + 4);
  Tally tally("orientation", kSeed + 4);
  std::uint64_t decided = 0;
  for (int round = 0; round < 60; ++round) {
    const std::vector<Polygon> truth{star(random, 20, 0.7, 1.0), star(random, 9, 0.2, 0.5)};
    std::vector<Polygon> turned = truth;
    for (Polygon& p : turned) {
      if (whole(random, 0, 1)) std::reverse(p.begin(), p.end());
      std::rotate(p.begin(), p.begin() + whole(random, 0, 8), p.end());
    }
    Face face = face_of(turned);
    if (round % 2) {
      // The same lines, run through against their parameter.
      for (TrimLoop& loop : face.loops)
        for (TrimCurve& c : loop.curves) {
          auto& line = std::get<Line<Vec2>>(c.curve);
          line = {line.origin + line.direction, -line.direction};
          std::swap(c.t0, c.t1);
        }
    }
    decided += compare(tally, random, truth, face, 500, 1.1);
  }
  EXPECT_GE(decided, 28000u);
  tally.finish(decided);
}

TEST(TrimPolygon, SmallGapsAreClosed) {
  Random random(kSeed + 5);
  Tally tally("gaps", kSeed + 5);
  std::uint64_t decided = 0;
  for (int round = 0; round < 100; ++round) {
    const std::vector<Polygon> truth{star(random, whole(random, 3, 60), 0.6, 1.0)};
    Face face = face_of(truth);
    const double gap = std::pow(10.0, between(random, -15, -6));
    for (TrimCurve& c : face.loops[0].curves) {
      auto& line = std::get<Line<Vec2>>(c.curve);
      line.origin += random_vector<Vec2>(random, gap);
      line.direction += random_vector<Vec2>(random, gap);
    }
    decided += compare(tally, random, truth, face, 500, 1.1, 1e-12 + 4 * gap);
  }
  EXPECT_GE(decided, 40000u);
  tally.finish(decided);
}

// Out and back along the same line: no area, no effect.
TEST(TrimPolygon, SpikesHaveNoEffect) {
  Random random(kSeed + 6);
  Tally tally("spikes", kSeed + 6);
  std::uint64_t decided = 0;
  for (int round = 0; round < 100; ++round) {
    const std::vector<Polygon> truth{star(random, whole(random, 3, 20), 0.5, 0.8)};
    Polygon spiked = truth[0];
    for (int k = 0; k < 4; ++k) {
      const auto at = static_cast<std::ptrdiff_t>(whole(random, 0, static_cast<int>(spiked.size()) - 1));
      const Vec2 base = spiked[static_cast<std::size_t>(at)], tip = random_vector<Vec2>(random, 1);
      spiked.insert(spiked.begin() + at, {base, tip});
    }
    Face face = face_of(truth);
    face.loops = {loop_of(spiked)};
    const TrimRegion trim(face, {}, 0);
    for (int i = 0; i < 500; ++i) {
      const Vec2 p = query(random, i, truth, 1.1);
      if (reference::distance(truth, p) <= 1e-12 || reference::distance({spiked}, p) <= 1e-12) continue;
      ++decided;
      tally.check(trim.contains(p, face.surface).inside == reference::inside_even_odd(truth, p),
                  [&] { return fmt::format("({:.17g}, {:.17g})", p.x, p.y); });
    }
  }
  EXPECT_GE(decided, 45000u);
  tally.finish(decided);
}

// ---- periodic surfaces -------------------------------------------------------------------------------------------------

TEST(TrimPolygon, WindowsMayLieAnyNumberOfPeriodsOff) {
  Random random(kSeed + 7);
  Tally tally("shifted windows", kSeed + 7);
  std::uint64_t decided = 0;
  for (int round = 0; round < 60; ++round) {
    const AnySurface surface = round % 2 ? AnySurface(Torus{}) : AnySurface(Cylinder{});
    const Vec2 period = periods(surface);
    // A star narrower than a period, and the same one shifted by whole periods (the truth is taken of the unshifted one).
    const std::vector<Polygon> truth{star(random, 12, 1.5, 3.0)};
    std::vector<Polygon> shifted = truth;
    const Vec2 by{period.x * whole(random, -3, 3), period.y * whole(random, -3, 3)};
    for (Vec2& p : shifted[0]) p += by;
    const Face face = face_of(shifted, surface);
    const TrimRegion trim(face, {}, 0);
    for (int i = 0; i < 500; ++i) {
      const Vec2 p = query(random, i, truth, 3.1);
      if (reference::distance(truth, p) <= 1e-11) continue;
      const bool expected = reference::inside_even_odd(truth, p);
      if (!expected && (std::abs(p.x) > 3.0 || std::abs(p.y) > 3.0)) continue;  // might be inside of a neighbouring copy
      ++decided;
      const Vec2 asked{p.x + period.x * whole(random, -3, 3), p.y + period.y * whole(random, -3, 3)};
      tally.check(trim.contains(asked, surface).inside == expected,
                  [&] { return fmt::format("({:.17g}, {:.17g}) asked at ({:.17g}, {:.17g})", p.x, p.y, asked.x, asked.y); });
    }
  }
  EXPECT_GE(decided, 25000u);
  tally.finish(decided);
}

// A full band whose loop runs along the seam on both sides: every angle is inside, the seam itself included.
TEST(TrimPolygon, SeamsAreNotCracks) {
  Random random(kSeed + 8);
  Tally tally("seam", kSeed + 8);
  for (int round = 0; round < 50; ++round) {
    const double u0 = round == 0 ? 0.0 : between(random, -9, 9), u1 = round == 0 ? kTwoPi : u0 + kTwoPi;
    const Cylinder surface;
    const Face face = face_of({{{u0, -1}, {u1, -1}, {u1, 1}, {u0, 1}}}, surface);
    const TrimRegion trim(face, {}, 1e-12);
    for (int i = 0; i < 400; ++i) {
      const double off = i % 4 == 0 ? 0.0 : std::pow(10.0, between(random, -17, 0)) * (i % 2 ? 1 : -1);
      const UV p{(whole(random, 0, 1) ? u0 : u1) + off + kTwoPi * whole(random, -2, 2), between(random, -0.999, 0.999)};
      tally.check(trim.contains(p, surface).inside, [&] { return fmt::format("({:.17g}, {:.17g}) on a band from {:.17g}", p.x, p.y, u0); });
      tally.check(!trim.contains({p.x, p.y > 0 ? p.y + 1.01 : p.y - 1.01}, surface).inside,
                  [&] { return fmt::format("u = {:.17g} beyond the band", p.x); });
    }
  }
  tally.finish(50 * 400 * 2);
}

// Within the tolerance of an edge, in world units, a point counts; the answer says so. The metric is the surface's.
TEST(TrimPolygon, ToleranceIsMeasuredInTheWorld) {
  Random random(kSeed + 9);
  Tally tally("tolerance", kSeed + 9);
  for (int round = 0; round < 100; ++round) {
    const double r = std::pow(10.0, between(random, -2, 3)), tolerance = r * std::pow(10.0, between(random, -9, -3));
    const Cylinder surface{{}, r};
    Face face = face_of({{{0.5, -r}, {2.5, -r}, {2.5, r}, {0.5, r}}}, surface);
    for (TrimCurve& c : face.loops[0].curves) c.edge = 0;
    const TrimRegion trim(face, {{2, false, tolerance, tolerance, tolerance}}, 0);
    for (int i = 0; i < 100; ++i) {
      const double share = between(random, 0, 2), off = share * tolerance;
      if (std::abs(share - 1) < 0.01) {
        tally.check(true, [] { return std::string(); });
        continue;
      }
      const double along = between(random, 0.01, 0.99);
      const UV p = i % 2 ? UV{2.5 + off / r, r * (2 * along - 1)} : UV{0.5 + 2 * along, -r - off};
      const auto answer = trim.contains(p, surface);
      tally.check(answer.inside == (share < 1) && answer.by_tolerance == (share < 1),
                  [&] { return fmt::format("{} tolerances off on a cylinder of radius {}: inside = {}", share, r, answer.inside); });
    }
  }
  tally.finish(100 * 100);
}

}  // namespace
}  // namespace iso::test
