// Rays aimed at where leaves meet: at points whose s or t in their Bezier piece is k / 2^m (leaves are dyadic parts of pieces, to whatever
// depth), at the seams and at the poles, from both sides. None may slip through: there is a hit at the target. $ISOPHOTE_RAYS sets the
// number of rays per surface of the slow suite.
#include "tests/support/closed_surfaces.h"
#include "tests/support/residuals.h"
#include "tests/support/told.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240702;
constexpr std::uint64_t kChunk = 8192;
constexpr int kDeepest = 8;
// How far from the target the hit may lie, in sizes: rounding moves the ray by some 1e-15, at the smallest angle 1e-12.
constexpr double kNear = 1e-11;

struct Target {
  Vec3 p{0.0}, n{0.0};
};

double dyadic(Random& random) {
  const int m = whole(random, 0, kDeepest);
  return static_cast<double>(whole(random, 0, 1 << m)) / static_cast<double>(1 << m);
}

class Aim {
 public:
  explicit Aim(const ClosedSurface& s) : s_(s), pieces_(bezier_pieces(s.surface, s.domain)) {}

  // Of eight targets one is a corner of leaves, one lies on a seam or is a pole, the others on a line of s or t.
  Target next(Random& random) const {
    const int kind = whole(random, 0, 7);
    if (kind == 0) {
      // An end of the domain in u or v: a seam, or a pole of the sphere.
      UV uv = point_in(random, s_.domain);
      const int c = whole(random, 0, 1);
      uv[c] = whole(random, 0, 1) ? s_.domain.lo[c] : s_.domain.hi[c];
      return {s_.at(uv), unit_normal(s_.surface, uv, s_.domain)};
    }
    const BezierPiece& piece = pieces_[random() % pieces_.size()];
    Vec2 st = point_in(random, {{0, 0}, {1, 1}});
    if (kind == 1 || kind % 2 == 0) st.x = dyadic(random);
    if (kind == 1 || kind % 2 == 1) st.y = dyadic(random);
    const UV uv = piece.to_native(st);
    const Vec4 h = homogeneous_jet(piece.patch, st).H;
    return {project(h), unit_normal(s_.surface, uv, s_.domain)};
  }

 private:
  const ClosedSurface& s_;
  std::vector<BezierPiece> pieces_;
};

struct Found {
  std::uint64_t rays = 0, without_normal = 0, missed = 0, missed_window = 0, blocked_differs = 0;
  Residuals residuals;
  SolverStats stats;
  Told told;

  void add(const Found& o) {
    rays += o.rays;
    without_normal += o.without_normal;
    missed += o.missed;
    missed_window += o.missed_window;
    blocked_differs += o.blocked_differs;
    residuals.add(o.residuals);
    stats += o.stats;
    told.add(o.told);
  }
};

// Each ray is traced with an open end, and as a window about the target, where only the hit at the target counts.
Found chunk(const ClosedSurface& s, const Tracer& tracer, const Aim& aim, std::uint64_t number) {
  Random random(kSeed + number);
  Found f;
  std::vector<Ray> open, window;
  std::vector<double> targets;
  while (open.size() < kChunk) {
    const Target target = aim.next(random);
    const Vec3 d = random_direction(random);
    if (target.n == Vec3(0.0)) {
      ++f.without_normal;
      continue;
    }
    if (std::abs(glm::dot(d, target.n)) < kGrazingCosine) continue;
    // From far outside, or from as near as 1e-5 of the size before it, on either side.
    const double distance = s.size * (whole(random, 0, 1) ? 2 : std::pow(10.0, between(random, -5, -1)));
    const Ray ray{target.p - distance * d, d};
    open.push_back(ray);
    window.push_back({ray.o, ray.d, distance - kNear * s.size, distance + kNear * s.size});
    targets.push_back(distance);
  }
  const auto order = number % 2 ? Tracer::Order::coherent : Tracer::Order::scattered;
  std::vector<Hit> first(open.size()), at(open.size());
  std::vector<std::uint8_t> blocked(open.size());
  tracer.nearest(open, first, order, f.stats);
  tracer.nearest(window, at, order, f.stats);
  tracer.occluded(window, blocked, order, f.stats);
  for (std::size_t i = 0; i < open.size(); ++i) {
    ++f.rays;
    const auto tell = [&](const char* what, const Hit& hit) {
      f.told.add([&] { return fmt::format("{}: target t {:.17g}, hit t {:.17g}, {}", what, targets[i], hit.t, text_of(open[i])); });
    };
    if (!first[i] || first[i].t > targets[i] + kNear * s.size) {
      ++f.missed;
      tell("no hit at or before the target", first[i]);
    }
    if (!at[i]) {
      ++f.missed_window;
      tell("no hit at the target", at[i]);
    } else {
      f.residuals.add(tracer, window[i], at[i], cosine_at(tracer, at[i], window[i]), s.size);
    }
    f.blocked_differs += (blocked[i] != 0) != static_cast<bool>(at[i]);
  }
  return f;
}

void examine(const ClosedSurface& s, std::uint64_t rays) {
  const Tracer tracer(one_face(s.surface, s.domain));
  const Aim aim(s);
  const std::uint64_t chunks = (rays + kChunk - 1) / kChunk;
  Found sums[2];
  in_chunks(chunks, [&](std::uint64_t c, std::uint64_t thread) { sums[thread].add(chunk(s, tracer, aim, c)); });
  Found f = sums[0];
  f.add(sums[1]);
  fmt::print(
      "[ measured ] {}: {} rays at leaf borders, seams and poles; missed {}, in a window {}; {} fallbacks, {} touching, {} out of budget\n",
      s.name, f.rays, f.missed, f.missed_window, f.stats.fallbacks, f.stats.tangent, f.stats.fallback_out_of_budget);
  f.residuals.finish(s.name);
  EXPECT_EQ(f.rays, chunks * kChunk);
  EXPECT_EQ(f.without_normal, 0u) << s.name;
  EXPECT_EQ(f.missed, 0u) << s.name;
  EXPECT_EQ(f.missed_window, 0u) << s.name;
  EXPECT_EQ(f.blocked_differs, 0u) << s.name;
  f.told.fail(s.name);
}

class LeafBorders : public testing::TestWithParam<int> {};
class LeafBordersSlow : public testing::TestWithParam<int> {};
TEST_P(LeafBorders, NoRaySlipsThrough) { examine(closed_surface(GetParam()), 30000); }
TEST_P(LeafBordersSlow, NoneOfAMillionRaysSlipsThrough) { examine(closed_surface(GetParam()), wanted("ISOPHOTE_RAYS", 1000000)); }
const auto kNames = [](const testing::TestParamInfo<int>& info) { return std::string(kClosedNames[info.param]); };
INSTANTIATE_TEST_SUITE_P(All, LeafBorders, testing::Range(0, kClosedSurfaces), kNames);
INSTANTIATE_TEST_SUITE_P(All, LeafBordersSlow, testing::Range(0, kClosedSurfaces), kNames);

}  // namespace
}  // namespace iso::test
