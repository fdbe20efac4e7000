// Nothing gets through a closed mesh of n-sided patches. Lines enter as often as they leave, in turn where the mesh is a ball; rays aimed
// at where charts, patches and the cells of their splines meet find what they are aimed at; rays that leave the surface neither meet it
// again where they start nor get out of it. $ISOPHOTE_RAYS sets the number of rays per mesh of the slow suite.
#include "raytracer/tracer.h"
#include "tests/support/patch_meshes.h"
#include "tests/support/paths.h"
#include "tests/support/random_shapes.h"
#include "tests/support/residuals.h"
#include "tests/support/solids.h"
#include "tests/support/told.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr std::uint64_t kChunk = 4096;
// Sizes: how far from its target a hit may lie, over the cosine: rounding of rays that start two sizes away.
constexpr double kNear = 1e-14;
// Sizes: two hits so near, in the same sense, are one that charts have in common.
constexpr double kTwice = 1e-9;
// Below this cosine a target is not aimed at, and a hit says nothing about sides.
constexpr double kGrazing = kGrazingCosine;
// Of a chart. Where the polygons about a vertex do not lie side by side in its tangent plane, patches fold there: sides are not told.
constexpr double kAtCorner = 1e-3;

struct Found {
  std::uint64_t lines = 0, met = 0, hits = 0, doubles = 0, odd = 0, touching = 0, folded = 0, unbalanced = 0, not_in_turn = 0;
  std::uint64_t aimed = 0, missed = 0, missed_window = 0, without_normal = 0;
  std::uint64_t leaving = 0, inward = 0, flat = 0, leaked = 0, at_start = 0;
  Residuals residuals;
  SolverStats stats;
  Told told;

  void add(const Found& o) {
    for (std::uint64_t Found::*m :
         {&Found::lines, &Found::met, &Found::hits, &Found::doubles, &Found::odd, &Found::touching, &Found::unbalanced, &Found::not_in_turn,
          &Found::aimed, &Found::missed, &Found::missed_window, &Found::without_normal, &Found::leaving, &Found::inward, &Found::flat,
          &Found::leaked, &Found::at_start})
      this->*m += o.*m;
    residuals.add(o.residuals);
    stats += o.stats;
    told.add(o.told);
  }
};

class Subject {
 public:
  Subject(std::string name, const PolygonMesh& mesh, MeshKind kind, bool ball, Edges edges = Edges::none)
      : name_(std::move(name)), tracer_(scene_of(patches_over(mesh, kind), edges)), ball_(ball) {
    const Box3 box = tracer_.scene().box();
    size_ = box.diagonal();
    middle_ = box.middle();
    for (const Face& face : faces()) error_ = std::max(error_, std::get<PatchChart>(face.surface).error);
    flat_ = 4 * std::sqrt(error_ / size_);
  }

  void examine(std::uint64_t rays) const {
    const std::uint64_t chunks = (rays + 3 * kChunk - 1) / (3 * kChunk);
    Found sums[2];
    in_chunks(chunks, [&](std::uint64_t c, std::uint64_t thread) {
      Random random(kSeed + c);
      through(random, sums[thread]);
      aimed(random, sums[thread]);
      leaving(random, sums[thread]);
    });
    Found f = sums[0];
    f.add(sums[1]);
    tell(f, chunks);
  }

 private:
  const Placed& placed() const { return tracer_.scene().placed.front(); }
  const std::vector<Face>& faces() const { return placed().part->faces; }

  // Lines through a random place in the box.
  void through(Random& random, Found& f) const {
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < kChunk; ++i) {
      const Vec3 d = random_direction(random), at = middle_ + 0.35 * size_ * std::cbrt(between(random, 0, 1)) * random_direction(random);
      rays.push_back({at - 2 * size_ * d, d});
    }
    follow(rays, f);
  }

  // The hits that charts have in common counted once. +1 where the line enters, -1 where it leaves.
  struct Senses {
    int sum = 0;
    std::uint64_t doubles = 0;
    bool touching = false, in_turn = true;
  };
  Senses senses_of(const Ray& ray, std::span<const Hit> hits, Found& f) const {
    Senses s;
    std::vector<std::pair<double, int>> kept;
    for (const Hit& hit : hits) {
      const double cosine = glm::dot(tracer_.surface_point(hit).n, ray.d);
      f.residuals.add(tracer_, ray, hit, cosine, size_);
      s.touching = s.touching || hit.status == HitStatus::tangent || std::abs(cosine) < std::max(flat_, kGrazing);
      const int sense = cosine < 0 ? 1 : -1;
      const double near = kTwice * size_ / std::max(std::abs(cosine), kGrazing);
      if (std::any_of(kept.begin(), kept.end(), [&](const auto& k) { return k.second == sense && hit.t - k.first < near; })) {
        ++s.doubles;
        continue;
      }
      s.in_turn = s.in_turn && sense == (kept.empty() ? 1 : -kept.back().second);
      s.sum += sense;
      kept.push_back({hit.t, sense});
    }
    return s;
  }

  // All hits of lines: as many in as out.
  void follow(const std::vector<Ray>& rays, Found& f) const {
    std::vector<Hit> hits;
    std::vector<std::size_t> offsets;
    tracer_.all(rays, hits, offsets, f.stats);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::span<const Hit> mine(hits.data() + offsets[i], offsets[i + 1] - offsets[i]);
      const Senses senses = senses_of(rays[i], mine, f);
      ++f.lines;
      f.met += !mine.empty();
      f.hits += mine.size();
      f.doubles += senses.doubles;
      f.odd += mine.size() % 2;
      const bool balanced = senses.sum == 0 && (senses.in_turn || !ball_);
      f.not_in_turn += !senses.in_turn;
      if (balanced) continue;
      if (senses.touching)
        ++f.touching;
      else if (!ball_ && std::any_of(mine.begin(), mine.end(), at_corner))
        ++f.folded;
      else {
        ++f.unbalanced;
        f.told.add([&] { return text_of_line(rays[i], mine); });
      }
    }
  }

  static bool at_corner(const Hit& hit) { return glm::length(hit.uv) < kAtCorner; }

  std::string text_of_line(const Ray& ray, std::span<const Hit> hits) const {
    std::string text = text_of(ray);
    for (const Hit& hit : hits)
      text += fmt::format(" [face {} t {:.17g} st {:.17g} {:.17g} n.d {:.3g} status {}]", hit.face, hit.t, hit.uv.x, hit.uv.y,
                          glm::dot(tracer_.surface_point(hit).n, ray.d), int(hit.status));
    return text;
  }

  // A place of a chart: its corner, the patch's centre, a border of the patch or between charts, a line of the spline's cells.
  static Vec2 special_place(Random& random) {
    static constexpr double kLines[] = {0, 1, 1.0 / 24, 1.0 / 12, 1.0 / 6, 1.0 / 3, 0.5, 0.75};
    Vec2 st = point_in(random, {Vec2(0.0), Vec2(1.0)});
    const int c = whole(random, 0, 1);
    switch (whole(random, 0, 7)) {
      case 0:
        return {0, 0};
      case 1:
        return {1, 1};
      case 2:
      case 3:
        st[c] = 0;
        return st;
      case 4:
        st[c] = 1;
        return st;
      case 5:
        // Beside the corner, as near as rounding.
        return std::pow(10.0, between(random, -16, -2)) * st;
      default:
        st[c] = kLines[whole(random, 0, 7)];
        if (whole(random, 0, 1)) st[1 - c] = kLines[whole(random, 0, 7)];
        return st;
    }
  }

  // Rays at such places, with an open end and as a window about the target; every other one as a whole line.
  void aimed(Random& random, Found& f) const {
    std::vector<Ray> open, window, lines;
    std::vector<double> targets, reach;
    while (open.size() < kChunk) {
      const Face& face = faces()[random() % faces().size()];
      const Vec2 st = special_place(random);
      const Vec3 n = unit_normal(face.surface, st, face.domain), p = placed().to_world.point(point(face.surface, st));
      if (!finite(n) || n == Vec3(0.0)) {
        ++f.without_normal;
        continue;
      }
      const Vec3 d = random_direction(random);
      const double cosine = std::abs(glm::dot(d, n));
      if (cosine < kGrazing) continue;
      const double distance = size_ * (whole(random, 0, 1) ? 2 : std::pow(10.0, between(random, -5, -1)));
      const double near = 8 * kNear * size_ / cosine;
      open.push_back({p - distance * d, d});
      window.push_back({p - distance * d, d, distance - near, distance + near});
      if (distance > size_) lines.push_back(open.back());
      targets.push_back(distance);
      reach.push_back(near);
    }
    std::vector<Hit> first(open.size()), at(open.size());
    tracer_.nearest(open, first, Tracer::Order::scattered, f.stats);
    tracer_.nearest(window, at, Tracer::Order::coherent, f.stats);
    for (std::size_t i = 0; i < open.size(); ++i) {
      ++f.aimed;
      if (!first[i] || first[i].t > targets[i] + reach[i]) {
        ++f.missed;
        f.told.add([&] { return fmt::format("missed: target t {:.17g}, hit t {:.17g}, {}", targets[i], first[i].t, text_of(open[i])); });
      }
      if (!at[i]) {
        ++f.missed_window;
        f.told.add([&] { return fmt::format("nothing at the target, t {:.17g} +- {:.2g}, {}", targets[i], reach[i], text_of(open[i])); });
      } else {
        f.residuals.add(tracer_, window[i], at[i], cosine_at(tracer_, at[i], window[i]), size_);
      }
    }
    follow(lines, f);
  }

  // Rays that leave the surface at a hit.
  void leaving(Random& random, Found& f) const {
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < kChunk; ++i) {
      const Face& face = faces()[random() % faces().size()];
      const Vec2 st = whole(random, 0, 1) ? special_place(random) : point_in(random, {Vec2(0.0), Vec2(1.0)});
      const Vec3 p = placed().to_world.point(point(face.surface, st)), d = random_direction(random);
      rays.push_back({p - 2 * size_ * d, d});
    }
    std::vector<Hit> hits(rays.size());
    tracer_.nearest(rays, hits, Tracer::Order::scattered, f.stats);
    std::vector<Ray> away, lines;
    std::vector<double> steep;
    for (const Hit& hit : hits) {
      if (!hit || (!ball_ && at_corner(hit))) continue;
      const SurfacePoint at = tracer_.surface_point(hit);
      if (!finite(at.n) || at.n == Vec3(0.0)) {
        ++f.without_normal;
        continue;
      }
      const Vec3 d = random_direction(random);
      away.push_back(secondary_ray(hit, at, d));
      lines.push_back({at.p - 3 * size_ * d, d, 3 * size_ - kTwice * size_ * 1e-3});
      steep.push_back(glm::dot(d, at.n));
    }
    compare_with_lines(away, lines, steep, f);
  }

  // A ray that leaves the surface meets what the line through its start meets beyond it, and nothing else.
  void compare_with_lines(const std::vector<Ray>& away, const std::vector<Ray>& lines, const std::vector<double>& steep, Found& f) const {
    std::vector<Hit> next(away.size()), all;
    std::vector<std::size_t> offsets;
    tracer_.nearest(away, next, Tracer::Order::scattered, f.stats);
    tracer_.all(lines, all, offsets, f.stats);
    for (std::size_t i = 0; i < away.size(); ++i) {
      ++f.leaving;
      f.inward += steep[i] < 0;
      // A ray that dips below the surface by less than the charts' splines stray may miss them.
      if (std::abs(steep[i]) < flat_) {
        ++f.flat;
        continue;
      }
      const double start = 3 * size_, near = kTwice * size_ / std::abs(steep[i]);
      double beyond = kInf;
      for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k)
        if (all[k].t > start + near) beyond = std::min(beyond, all[k].t - start);
      const double met = next[i] ? next[i].t : kInf;
      const bool lost = met > beyond + near, again = met < beyond - near, out = ball_ && steep[i] < 0 && !next[i];
      f.leaked += lost || out;
      f.at_start += again;
      if (lost || again || out)
        f.told.add([&] {
          return fmt::format("leaves at n.d {:.3g}, meets {:.17g}, expected {:.17g}: {}", steep[i], met, beyond, text_of(away[i]));
        });
    }
  }

  void tell(const Found& f, std::uint64_t chunks) const {
    fmt::print(
        "[ measured ] {}: {} charts; {} lines, {} meet it, {} hits; {} doubles, {} odd; {} touch, {} at folded corners; unbalanced {}, not "
        "in turn {}; {} aimed, "
        "missed {}, in a window {}; {} leave, {} inward, {} flatter than {:.2g}: got out {}, met their start {}; {} fallbacks, {} "
        "touching, {} out of budget\n",
        name_, faces().size(), f.lines, f.met, f.hits, f.doubles, f.odd, f.touching, f.folded, f.unbalanced, f.not_in_turn, f.aimed,
        f.missed, f.missed_window, f.leaving, f.inward, f.flat, flat_, f.leaked, f.at_start, f.stats.fallbacks, f.stats.tangent,
        f.stats.fallback_out_of_budget);
    f.residuals.finish(name_);
    EXPECT_GE(f.lines, chunks * kChunk) << name_;
    EXPECT_GE(f.met, f.lines / 10) << name_;
    EXPECT_EQ(f.aimed, chunks * kChunk) << name_;
    EXPECT_GE(f.inward, chunks * kChunk / 4) << name_;
    EXPECT_LE(f.flat, f.leaving / 30) << name_;
    EXPECT_EQ(f.without_normal, 0u) << name_;
    EXPECT_EQ(f.unbalanced, 0u) << name_;
    if (ball_) {
      EXPECT_LE(f.not_in_turn, f.touching) << name_;
    }
    EXPECT_LE(f.touching, f.lines / 500) << name_;
    EXPECT_EQ(f.missed, 0u) << name_;
    EXPECT_EQ(f.missed_window, 0u) << name_;
    EXPECT_EQ(f.leaked, 0u) << name_;
    EXPECT_EQ(f.at_start, 0u) << name_;
    f.told.fail(name_);
  }

  std::string name_;
  Tracer tracer_;
  bool ball_;  // where it is not, patches may fold over at a vertex
  double size_ = 0, error_ = 0, flat_ = 0;
  Vec3 middle_{0.0};
};

struct MeshFile {
  const char *name, *file;
  bool ball;  // round enough for every line to enter and leave in turn
};
constexpr MeshFile kMeshes[] = {{"TruncatedCuboctahedron", "truncated-cuboctahedron.obj", true},
                                {"SpotControlMesh", "spot-control-mesh.obj", false},
                                {"Goldberg", "goldberg-642.obj", true}};

void examine_file(const MeshFile& mesh, MeshKind kind, std::uint64_t rays) {
  Subject(std::string(mesh.name) + (kind == MeshKind::gregory ? "" : ", Charrot-Gregory"),
          read_polygons(data(std::string("meshes/") + mesh.file)), kind, mesh.ball)
      .examine(rays);
}

TEST(ClosedPatches, NothingGetsThroughSquaresAndHexagons) {
  for (const MeshKind kind : {MeshKind::gregory, MeshKind::charrot_gregory})
    for (const Edges edges : {Edges::none, Edges::shared})
      Subject("truncated octahedron", truncated_octahedron(), kind, true, edges).examine(25000);
}
TEST(ClosedPatches, NothingGetsThroughSquaresHexagonsAndOctagons) {
  for (const MeshKind kind : {MeshKind::gregory, MeshKind::charrot_gregory}) examine_file(kMeshes[0], kind, 50000);
}
TEST(ClosedPatches, NothingGetsThroughTheControlMeshOfACow) { examine_file(kMeshes[1], MeshKind::gregory, 50000); }

class ClosedPatchesSlow : public testing::TestWithParam<int> {};
TEST_P(ClosedPatchesSlow, NoneOfManyRaysGetsThrough) {
  examine_file(kMeshes[GetParam()], MeshKind::gregory, wanted("ISOPHOTE_RAYS", 200000));
}
const auto kNames = [](const testing::TestParamInfo<int>& info) { return std::string(kMeshes[info.param].name); };
// Without the cow: its patches fold at some corners, where about 3 of 100 000 lines are counted once too few or too often.
INSTANTIATE_TEST_SUITE_P(All, ClosedPatchesSlow, testing::Values(0, 2), kNames);

}  // namespace
}  // namespace iso::test
