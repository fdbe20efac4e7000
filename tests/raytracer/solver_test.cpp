// The certified solver against brute subdivision: on random patches, on patches with collapsed sides and folds, on grazing rays.
#include "raytracer/leaf.h"
#include "reference/brute_rays.h"
#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240617;

struct Totals {
  std::uint64_t rays = 0, hits = 0, stretches = 0, empty = 0;
  SolverStats stats;
};

std::string in_file_format(const NurbsSurface& s) {
  std::string text = fmt::format("bpt {} {}:", s.degree_u, s.degree_v);
  for (const Vec4& h : s.poles) text += fmt::format(" ({:.17g} {:.17g} {:.17g} {:.17g})", h.x, h.y, h.z, h.w);
  return text;
}

// Every hit lies in a stretch where the patch is; every stretch holds a hit, but for those that all but touch (`empty`).
void compare(const NurbsSurface& s, const std::vector<Ray>& rays, double smallest_share, Tally& hits_tally, Tally& stretch_tally,
             Totals& totals, bool may_be_empty) {
  const Tracer tracer(one_face(s, natural_domain(s)));
  const BezierPatch patch = bezier_pieces(s, natural_domain(s)).front().patch;
  const double size = hull_box(patch).diagonal(), smallest = smallest_share * size;
  std::vector<Hit> hits;
  std::vector<std::size_t> offsets;
  tracer.all(rays, hits, offsets, totals.stats);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto where = reference::stretches(patch, rays[i].o, rays[i].d, smallest);
    const std::span<const Hit> mine(hits.data() + offsets[i], offsets[i + 1] - offsets[i]);
    ++totals.rays;
    totals.hits += mine.size();
    totals.stretches += where.size();
    const auto say = [&](double t) {
      return fmt::format("t {:.17g}, {} hits, {} stretches, o {:.17g} {:.17g} {:.17g} d {:.17g} {:.17g} {:.17g}, {}", t, mine.size(),
                         where.size(), rays[i].o.x, rays[i].o.y, rays[i].o.z, rays[i].d.x, rays[i].d.y, rays[i].d.z, in_file_format(s));
    };
    // At a small angle the last boxes reach far along the line on both sides of a meeting, with gaps between them.
    const auto belongs = [&](const Hit& hit, const reference::Stretch& w) {
      const double cosine = std::abs(glm::dot(tracer.surface_point(hit).n, rays[i].d)),
                   reach = smallest * (1 + 20 / std::max(cosine, 1e-5));
      return hit.t >= w.lo - reach && hit.t <= w.hi + reach;
    };
    for (const Hit& hit : mine) {
      bool held = false;
      for (const auto& w : where) held = held || belongs(hit, w);
      hits_tally.check(held, [&] { return "a hit where the patch is not: " + say(hit.t); });
    }
    for (const auto& w : where) {
      bool found = false;
      for (const Hit& hit : mine) found = found || belongs(hit, w);
      // Does the line but pass the patch by less than the last boxes? Boxes ten thousand times smaller tell.
      if (!found && !may_be_empty) {
        found = true;
        for (const auto& finer : reference::stretches(patch, rays[i].o, rays[i].d, 1e-4 * smallest))
          if (finer.hi >= w.lo && finer.lo <= w.hi) found = false;
      }
      totals.empty += !found;
      stretch_tally.check(found || may_be_empty, [&] { return "no hit where the patch is: " + say(w.lo); });
    }
  }
}

void finish(const char* name, Tally& hits, Tally& stretches, const Totals& t, double most_empty) {
  hits.finish(t.hits);
  stretches.finish(t.stretches);
  EXPECT_LE(static_cast<double>(t.empty), most_empty * static_cast<double>(t.stretches)) << name;
  EXPECT_EQ(t.stats.fallback_out_of_budget, 0u);
  fmt::print(
      "[ measured ] {}: {} rays, {} hits, {} stretches of which {} without a hit, {} solves, {} fallbacks with {} cells, {} touching\n",
      name, t.rays, t.hits, t.stretches, t.empty, t.stats.solves, t.stats.fallbacks, t.stats.fallback_cells, t.stats.tangent);
}

NurbsSurface random_patch(Random& random, int least_degree, int most_degree, double jitter) {
  const int pu = whole(random, least_degree, most_degree), pv = whole(random, least_degree, most_degree);
  NurbsSurface s = random_nurbs(random, Knots::bezier, Knots::bezier, pu, pv, whole(random, 0, 1) == 1);
  for (int i = 0; i < s.count_u; ++i)
    for (int j = 0; j < s.count_v; ++j) {
      Vec4& h = s.poles[static_cast<std::size_t>(i * s.count_v + j)];
      h = homogeneous(Vec3(i, j, 0) * (4.0 / most_degree) + random_vector<Vec3>(random, jitter), h.w);
    }
  return s;
}

std::vector<Ray> rays_through(Random& random, const NurbsSurface& s, int count) {
  Box3 box;
  for (const Vec4& h : s.poles) box.include(project(h));
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Ray ray = random_ray(random, box.middle(), 0.4 * box.diagonal());
    if (i % 2) ray.o = point(s, point_in(random, natural_domain(s))) - 2.0 * box.diagonal() * ray.d;  // one that surely meets it
    rays.push_back(ray);
  }
  return rays;
}

void random_patches(std::uint64_t seed, int patches) {
  Random random(seed);
  Tally hits("hits", seed), stretches("stretches", seed);
  Totals totals;
  for (int i = 0; i < patches; ++i) {
    const NurbsSurface s = random_patch(random, 1, whole(random, 1, 8), between(random, 0.1, 3));
    compare(s, rays_through(random, s, 20), 1e-8, hits, stretches, totals, false);
  }
  EXPECT_GE(totals.hits, static_cast<std::uint64_t>(10 * patches));
  finish("random patches", hits, stretches, totals, 0);
}

void degenerate_patches(std::uint64_t seed, int patches) {
  Random random(seed);
  Tally hits("hits", seed), stretches("stretches", seed);
  Totals totals;
  for (int i = 0; i < patches; ++i) {
    NurbsSurface s = random_patch(random, 2, 5, 0.5);
    const auto at = [&](int u, int v) -> Vec4& { return s.poles[static_cast<std::size_t>(u * s.count_v + v)]; };
    switch (i % 4) {
      case 0:  // one side is a point
        for (int v = 0; v < s.count_v; ++v) at(0, v) = homogeneous(project(at(0, 0)), at(0, v).w);
        break;
      case 1:  // two opposite sides are points
        for (int v = 0; v < s.count_v; ++v) {
          at(0, v) = homogeneous(project(at(0, 0)), at(0, v).w);
          at(s.count_u - 1, v) = homogeneous(project(at(s.count_u - 1, 0)), at(s.count_u - 1, v).w);
        }
        break;
      case 2:  // folded over on itself: the last row lies on the first
        for (int v = 0; v < s.count_v; ++v) at(s.count_u - 1, v) = homogeneous(project(at(0, v)), at(s.count_u - 1, v).w);
        break;
      default:  // two neighbouring sides run in one direction: a corner without a tangent plane
        if (s.count_u > 1 && s.count_v > 1) at(0, 1) = homogeneous(0.5 * (project(at(0, 0)) + project(at(1, 0))), at(0, 1).w);
    }
    compare(s, rays_through(random, s, 20), 1e-7, hits, stretches, totals, false);
  }
  EXPECT_GE(totals.hits, static_cast<std::uint64_t>(10 * patches));
  finish("degenerate patches", hits, stretches, totals, 0);
}

// Rays in tangent planes, moved off by 1e-2 .. 1e-9 of the size: two near roots, or none. Those nearer than the boxes of the reference may
// be told apart by the solver alone.
void grazing_rays(std::uint64_t seed, int patches) {
  Random random(seed);
  Tally hits("hits", seed), stretches("stretches", seed);
  Totals near, clear;
  for (int i = 0; i < patches; ++i) {
    const NurbsSurface s = random_patch(random, 1, whole(random, 2, 5), 0.4);
    Box3 box;
    for (const Vec4& h : s.poles) box.include(project(h));
    for (const bool close : {false, true}) {
      std::vector<Ray> rays;
      for (int k = 0; k < 10; ++k) {
        const UV uv = point_in(random, natural_domain(s));
        const Jet2 j = jet2(s, uv);
        const double angle = between(random, 0, kTwoPi);
        const Vec3 d = glm::normalize(std::cos(angle) * j.Su + std::sin(angle) * j.Sv), n = glm::normalize(glm::cross(j.Su, j.Sv));
        const double off = box.diagonal() * std::pow(10.0, close ? between(random, -9, -6) : between(random, -5, -2)) * (k % 2 ? 1 : -1);
        rays.push_back({j.S + off * n - 2.0 * box.diagonal() * d, d});
      }
      compare(s, rays, close ? 1e-5 : 1e-6, hits, stretches, close ? near : clear, close);
    }
  }
  EXPECT_GE(clear.hits, static_cast<std::uint64_t>(5 * patches));
  EXPECT_LE(clear.empty, 0u);
  Totals both = clear;
  both.rays += near.rays;
  both.hits += near.hits;
  both.stretches += near.stretches;
  both.empty += near.empty;
  both.stats += near.stats;
  finish("grazing rays", hits, stretches, both, 0.5);
}

// What the last resort works on comes from the powers: the nets of the surface again, to rounding.
TEST(Solver, NetsFromPowersAreTheSurfacesNets) {
  Random random(kSeed + 9);
  Tally nets("nets", kSeed + 9);
  std::uint64_t count = 0;
  for (const SurfaceCase& c : random_surfaces(random)) {
    const TraceScene scene = one_face(c.surface, c.uv);
    const Part& part = *scene.placed[0].part;  // about an origin of its own
    const PartGeometry geometry = make_geometry(part);
    if (geometry.patches.empty()) continue;  // met in closed form
    const auto pieces = bezier_pieces(part.faces[0].surface, part.faces[0].domain);
    ASSERT_EQ(pieces.size(), geometry.patches.size());
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      BezierPatch net;
      bernstein_form(geometry, geometry.patches[p], net);
      ASSERT_EQ(net.net.size(), pieces[p].patch.net.size());
      double largest = 0, apart = 0;
      for (std::size_t i = 0; i < net.net.size(); ++i) {
        largest = std::max(largest, glm::length(pieces[p].patch.net[i]));
        apart = std::max(apart, glm::length(net.net[i] - pieces[p].patch.net[i]));
      }
      ++count;
      const double roundings = static_cast<double>(net.net.size());  // one a power; they add up to far less
      nets.check(apart <= roundings * kEps * largest,
                 [&] { return fmt::format("{}: {} units of rounding apart", c.name, apart / (kEps * largest)); });
    }
  }
  nets.finish(count);
  EXPECT_GE(count, 100u);
}

TEST(Solver, RandomPatchesAgainstBruteSubdivision) { random_patches(kSeed, 100); }
TEST(Solver, CollapsedSidesAndFoldsAgainstBruteSubdivision) { degenerate_patches(kSeed + 1, 60); }
TEST(Solver, GrazingRaysAgainstBruteSubdivision) { grazing_rays(kSeed + 2, 40); }
TEST(SolverSlow, RandomPatchesAgainstBruteSubdivision) { random_patches(kSeed + 3, 400); }
TEST(SolverSlow, CollapsedSidesAndFoldsAgainstBruteSubdivision) { degenerate_patches(kSeed + 4, 320); }
TEST(SolverSlow, GrazingRaysAgainstBruteSubdivision) { grazing_rays(kSeed + 5, 300); }

// S = (u + v, eps v, (u - v)^2 / 2): tangents all but parallel. A ray along y meets it where u - v = +-sqrt(2 z).
TEST(Solver, NearlyParallelTangentsLoseNoRoot) {
  for (const double eps : {1e-4, 1e-5, 1e-6, 1e-7}) {
    NurbsSurface s;
    s.degree_u = s.degree_v = 2;
    s.count_u = s.count_v = 3;
    s.knots_u = s.knots_v = {0, 0, 0, 1, 1, 1};
    const double one[] = {0, 0.5, 1}, square[] = {0, 0, 1};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        s.poles.emplace_back(one[i] + one[j], eps * one[j], 0.5 * square[i] - one[i] * one[j] + 0.5 * square[j], 1.0);
    const Tracer tracer(one_face(s, natural_domain(s)));
    std::vector<Ray> rays;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 40; ++j) rays.push_back({{0.8 + 0.4 * (i + 0.37) / 40, -1, 0.001 + 0.03 * (j + 0.59) / 40}, {0, 1, 0}});
    std::vector<Hit> hits;
    std::vector<std::size_t> offsets;
    SolverStats stats;
    tracer.all(rays, hits, offsets, stats);
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) pairs += offsets[i + 1] - offsets[i] == 2 ? 1 : 0;
    EXPECT_EQ(pairs, rays.size()) << eps;
  }
}

}  // namespace
}  // namespace iso::test
