#include "tests/bench/trim_queries.h"

#include <random>

#include "patches/trim.h"
#include "reference/winding.h"
#include "tests/bench/timing.h"

namespace iso::bench {

namespace {

constexpr std::uint64_t kSeed = 20240613;
constexpr int kQueries = 20000, kRounds = 15;
constexpr std::size_t kPolygonPerStep = 200;  // the more corners the polygon has, the fewer queries are compared with it
constexpr int kChords = 64;                   // per curve, in the polygon of the winding test
constexpr double kFlattening = 1e-3;          // of the longest curve: the polygon is nearer to the loop (measured: 2e-4)
constexpr double kNear = 0.01;                // of the box's width
constexpr double kTrimClosing = 1e-9;         // of the box's width; what rounding leaves between faces

double between(std::mt19937_64& random, double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }

UV blob(double angle) {
  const double r = 1 + 0.2 * std::sin(5 * angle) + 0.07 * std::cos(11 * angle + 1);
  return {r * std::cos(angle), r * std::sin(angle)};
}

UV across(const Vec2& v) { return {-v.y, v.x}; }

// From a to b: a line, an arc that rises a fifth of the chord to one side, or a cubic of two spans that sways to both.
Curve2 curve_between(int kind, UV a, UV b) {
  const Vec2 chord = b - a;
  NurbsCurve<Vec2> curve;
  switch (kind) {
    case 0:
      return Line<Vec2>{a, chord};
    case 1: {
      // The tangents at the ends meet at twice the rise's height for a flat arc; the weight is the cosine of half the arc's angle.
      const double slope = 0.4, w = 1 / std::sqrt(1 + slope * slope);
      curve.degree = 2;
      curve.knots = {0, 0, 0, 1, 1, 1};
      curve.poles = {homogeneous(a, 1.0), homogeneous(a + 0.5 * chord + 0.5 * slope * across(chord), w), homogeneous(b, 1.0)};
      return curve;
    }
    default:
      curve.degree = 3;
      curve.knots = {0, 0, 0, 0, 0.5, 1, 1, 1, 1};
      for (const Vec2& pole : {Vec2(0, 0), Vec2(0.2, 0.25), Vec2(0.5, -0.05), Vec2(0.8, -0.2), Vec2(1, 0)})
        curve.poles.push_back(homogeneous(a + pole.x * chord + pole.y * across(chord), 1.0));
      return curve;
  }
}

struct Blob {
  Face face;
  reference::Polygon polygon;
  double longest = 0;  // distance of two joints
  Box2 box;
};

Blob make_blob(int segments) {
  Blob out;
  out.face.surface = Plane{};
  TrimLoop loop;
  for (int i = 0; i < segments; ++i) {
    const UV a = blob(kTwoPi * i / segments), b = blob(kTwoPi * ((i + 1) % segments) / segments);
    loop.curves.push_back({curve_between(i % 3, a, b), 0, 1, -1});
    out.longest = std::max(out.longest, glm::length(b - a));
    for (int k = 0; k < kChords; ++k) out.polygon.push_back(jet(loop.curves.back().curve, static_cast<double>(k) / kChords).C);
  }
  for (const Vec2& p : out.polygon) out.box.include(p);
  out.face.loops.push_back(std::move(loop));
  return out;
}

std::vector<UV> anywhere(const Blob& blob, std::mt19937_64& random) {
  std::vector<UV> out;
  for (int i = 0; i < kQueries; ++i)
    out.push_back({between(random, blob.box.lo.x, blob.box.hi.x), between(random, blob.box.lo.y, blob.box.hi.y)});
  return out;
}

std::vector<UV> near_the_loop(const Blob& blob, std::mt19937_64& random) {
  std::vector<UV> out;
  const double most = kNear * blob.box.size().x;
  while (static_cast<int>(out.size()) < kQueries) {
    const std::size_t k = random() % blob.polygon.size();
    const Vec2 a = blob.polygon[k], chord = blob.polygon[(k + 1) % blob.polygon.size()] - a;
    const double along = between(random, 0, 1), off = between(random, -most, most);
    out.push_back(a + along * chord + off / glm::length(chord) * across(chord));
  }
  return out;
}

Timing nanoseconds(const TrimRegion& trim, const AnySurface& surface, const std::vector<UV>& queries) {
  std::vector<double> rounds;
  std::size_t inside = 0, first = 0;
  for (int round = -1; round < kRounds; ++round) {  // the first one warms up
    inside = 0;
    const double seconds = seconds_of([&] {
      for (const UV& uv : queries) inside += trim.contains(uv, surface).inside;
    });
    if (round < 0)
      first = inside;
    else
      rounds.push_back(1e9 * seconds / static_cast<double>(queries.size()));
    ISO_CHECK(inside == first);
  }
  return timing_of(rounds);
}

// Number of answers that could be compared; all of them agree.
int check(const TrimRegion& trim, const Blob& blob, const std::vector<UV>& queries) {
  const std::vector<reference::Polygon> truth{blob.polygon};
  const std::size_t step = std::clamp<std::size_t>(blob.polygon.size() / kPolygonPerStep, 1, kQueries / 100);
  int checked = 0;
  for (std::size_t i = 0; i < queries.size(); i += step) {
    if (reference::distance(truth, queries[i]) <= kFlattening * blob.longest) continue;
    ISO_CHECK(trim.contains(queries[i], blob.face.surface).inside == reference::inside_even_odd(truth, queries[i]));
    ++checked;
  }
  return checked;
}

}  // namespace

TrimTimes measure_trim_queries(int segments) {
  ISO_CHECK(segments >= 6);
  std::mt19937_64 random(kSeed);
  const Blob blob = make_blob(segments);
  const TrimRegion trim(blob.face, {}, kTrimClosing * blob.box.size().x);
  const std::vector<UV> all = anywhere(blob, random), close = near_the_loop(blob, random);
  TrimTimes out;
  out.segments = segments;
  out.checked = check(trim, blob, all) + check(trim, blob, close);
  ISO_CHECK(out.checked >= 100);
  const Timing uniform = nanoseconds(trim, blob.face.surface, all), near = nanoseconds(trim, blob.face.surface, close);
  out.uniform = uniform.median;
  out.uniform_deviation = uniform.deviation;
  out.near = near.median;
  out.near_deviation = near.deviation;
  return out;
}

}  // namespace iso::bench
