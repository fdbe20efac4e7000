// Two routes to the meetings of rays with patches of every kind: the tracer's, by splines beside the charts and Newton to the charts, and
// the reference's, by subdivision of the formulas (reference/patch_intersector.h). They agree in place, side and normal; what only one
// of them finds must be shown to touch, or to pass the patch's border, within the proven distance of chart and spline. $ISOPHOTE_RAYS sets
// the number of rays per kind of the slow suite; a million take 10 s of one core for the first three kinds, some minutes for the next two
// and, by mean value, 40 min for the last.
//
// With a million rays per kind, as measured on AVX-512: all that meet with a cosine of at least 1e-5 are met by both routes at the same
// place, to `farthest` of the size; flatter ones to 1e-14 over the cosine. What only one route meets touches, with cosines up to 3.9e-4;
// nothing passes a border. The last row is without parameters by mean value, of which 12,000 rays were asked.
//
//                         meetings    farthest    flatter    touching on one side only
//    Bezier triangle        965,478     2.9e-10         10      36
//    Gregory triangle       924,807     8.3e-10         17      52
//    Gregory quad           931,474     5.0e-10         10      26
//    generalised Bezier   1,008,096     4.8e-10          7      38
//    generalised Gregory    926,845     6.5e-10          8      22
//    Charrot-Gregory        943,528     3.7e-10         19     129
#include "patches/surface/bezier_triangle.h"
#include "raytracer/tracer.h"
#include "reference/patch_intersector.h"
#include "tests/support/patch_meshes.h"
#include "tests/support/random_patches.h"
#include "tests/support/residuals.h"
#include "tests/support/solids.h"
#include "tests/support/told.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20261123;
constexpr std::size_t kBatch = 1024;
constexpr double kSame = 1e-9;            // sizes: meetings of both routes so near are one
constexpr double kAlong = 1e-14;          // sizes: rounding, which a ray that meets a surface flatly moves along it by one over the cosine,
constexpr double kFlat = kAlong / kSame;  // below this cosine by more than kSame: it dips into the surface by next to nothing
// Radians, where the normal is well told: the tangents not along each other and the ray not along the surface.
constexpr double kSameNormal = 1e-9, kApart = 1e-2, kSteep = 1e-2;
// A meeting that one route misses: chart and spline lie `error` apart, so a dip of twice that may be missing, or be none.
constexpr double kErrors = 2, kRounding = 1e-12;  // sizes
// Of all meetings, how many may touch, or pass the border, on one side only.
constexpr double kMostTouching = 2e-3, kMostAtBorder = 1e-3;

// A meeting as either route tells it.
struct Meeting {
  double t = 0, cosine = 0;
  int chart = 0;
  Vec2 st{0.0};
  Vec3 p{0.0}, n{0.0};
  bool touching = false, matched = false;
};

struct Found {
  std::uint64_t patches = 0, rays = 0, both = 0, flat = 0, touching_both = 0, normals = 0, touching = 0, at_border = 0, only_tracer = 0,
                only_reference = 0, normals_differ = 0;
  double farthest = 0, farthest_flat = 0, steepest_touching = 0, most_turned = 0, largest_error = 0;
  Told told;

  void add(const Found& o) {
    for (std::uint64_t Found::*m :
         {&Found::patches, &Found::rays, &Found::both, &Found::flat, &Found::touching_both, &Found::normals, &Found::touching,
          &Found::at_border, &Found::only_tracer, &Found::only_reference, &Found::normals_differ})
      this->*m += o.*m;
    for (double Found::*m :
         {&Found::farthest, &Found::farthest_flat, &Found::steepest_touching, &Found::most_turned, &Found::largest_error})
      this->*m = std::max(this->*m, o.*m);
    told.add(o.told);
  }
};

class Routes {
 public:
  explicit Routes(const NSidedPatch& patch) : patch_(patch), tracer_(scene_of({patch})), cut_(patch), size_(cut_.size()) {
    for (int k = 0; k < patch.basis.sides; ++k) {
      charts_.push_back(chart_of(patch, k));
      error_ = std::max(error_, charts_.back().error);
    }
  }

  void compare(std::uint64_t rays, Random& random, Found& f) {
    ++f.patches;
    f.largest_error = std::max(f.largest_error, error_ / size_);
    for (std::uint64_t done = 0; done < rays; done += kBatch) {
      std::vector<Ray> batch;
      for (std::size_t i = 0; i < std::min<std::uint64_t>(kBatch, rays - done); ++i) batch.push_back(ray(random));
      std::vector<Hit> hits;
      std::vector<std::size_t> offsets;
      SolverStats stats;
      tracer_.all(batch, hits, offsets, stats);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        ++f.rays;
        std::vector<Meeting> traced = of_tracer(batch[i], {hits.data() + offsets[i], offsets[i + 1] - offsets[i]});
        std::vector<Meeting> truth = of_reference(batch[i]);
        match(batch[i], traced, truth, f);
        f.only_tracer += explain(batch[i], traced, "only the tracer", f);
        f.only_reference += explain(batch[i], truth, "only the reference", f);
      }
    }
  }

 private:
  // Three of four are aimed at the patch.
  Ray ray(Random& random) const {
    const Vec3 d = random_direction(random);
    const PatchChart& chart = charts_[random() % charts_.size()];
    Vec3 at = point_of(chart, point_in(random, {Vec2(0.0), Vec2(1.0)}));
    if (whole(random, 0, 3) == 0) at += 0.2 * size_ * random_direction(random);
    return {at - 2 * size_ * d, d};
  }

  std::vector<Meeting> of_tracer(const Ray& ray, std::span<const Hit> hits) const {
    std::vector<Meeting> all;
    for (const Hit& hit : hits) {
      const SurfacePoint at = tracer_.surface_point(hit);
      Meeting m{.t = hit.t, .cosine = glm::dot(at.n, ray.d), .chart = hit.face, .st = hit.uv, .p = at.p, .n = at.n};
      m.touching = hit.status == HitStatus::tangent;
      // Borders of charts are met on both.
      const bool again = std::any_of(all.begin(), all.end(),
                                     [&](const Meeting& k) { return glm::length(k.p - m.p) <= kSame * size_ && k.cosine * m.cosine > 0; });
      if (!again) all.push_back(m);
    }
    return all;
  }
  std::vector<Meeting> of_reference(const Ray& ray) {
    std::vector<Meeting> all;
    for (const reference::PatchMeeting& k : cut_.all(ray.o, ray.d))
      all.push_back({.t = k.t, .cosine = k.cosine, .chart = k.chart, .st = k.st, .p = k.p, .n = k.n, .touching = k.doubtful});
    return all;
  }

  void match(const Ray& ray, std::vector<Meeting>& traced, std::vector<Meeting>& truth, Found& f) const {
    for (Meeting& m : truth)
      for (Meeting& k : traced) {
        const double apart = glm::length(m.p - k.p);
        const bool touching = m.touching || k.touching;
        const bool flat = std::abs(m.cosine) < kFlat;
        const double same = touching ? 1e3 * kSame : flat ? kAlong / std::abs(m.cosine) : kSame;
        if (k.matched || m.matched || apart > same * size_ || (!touching && m.cosine * k.cosine < 0)) continue;
        m.matched = k.matched = true;
        ++(touching ? f.touching_both : f.both);
        if (!touching) {
          f.flat += flat;
          double& farthest = flat ? f.farthest_flat : f.farthest;
          farthest = std::max(farthest, apart / size_);
        }
        compare_normals(ray, m, k, f);
      }
  }

  void compare_normals(const Ray& ray, const Meeting& m, const Meeting& k, Found& f) const {
    const Tangents at = tangents_of(charts_[m.chart], m.st);
    const double area = glm::length(glm::cross(at.Ss, at.St));
    if (std::abs(m.cosine) < kSteep || area < kApart * size_ * size_) return;
    ++f.normals;
    const double turned = glm::length(glm::cross(m.n, k.n));
    f.most_turned = std::max(f.most_turned, turned);
    if (turned <= kSameNormal && glm::dot(m.n, k.n) > 0) return;
    ++f.normals_differ;
    f.told.add([&] { return fmt::format("normals differ by {:.3g}: {}", turned, text(ray, m)); });
  }

  // How far a surface dips through a ray that it meets so flatly, by its curvature along the ray.
  double dip(const Ray& ray, const Meeting& m) const {
    const Jet2 j = jet_of(charts_[m.chart], m.st);
    const Vec3 along = ray.d - m.cosine * m.n;
    const double E = glm::dot(j.Su, j.Su), F = glm::dot(j.Su, j.Sv), G = glm::dot(j.Sv, j.Sv), det = E * G - F * F;
    const double x = glm::dot(along, j.Su), y = glm::dot(along, j.Sv), a = (G * x - F * y) / det, b = (E * y - F * x) / det;
    const double bend = glm::dot(m.n, a * a * j.Suu + 2 * a * b * j.Suv + b * b * j.Svv);
    return m.cosine * m.cosine / (2 * std::abs(bend));
  }

  // What only one route has. Returns how many are neither by touching nor at the border.
  std::uint64_t explain(const Ray& ray, const std::vector<Meeting>& all, const char* who, Found& f) const {
    const double near = kErrors * error_ + kRounding * size_;
    std::uint64_t left = 0;
    for (const Meeting& m : all) {
      if (m.matched) continue;
      // Two that are missing together: between them the ray is nowhere farther from the surface than this.
      const bool pair = std::any_of(all.begin(), all.end(), [&](const Meeting& k) {
        return !k.matched && k.cosine * m.cosine < 0 && glm::length(k.p - m.p) * std::max(std::abs(k.cosine), std::abs(m.cosine)) <= near;
      });
      const Tangents at = tangents_of(charts_[m.chart], m.st);
      const double to_border = std::min(m.st.x * glm::length(at.Ss), m.st.y * glm::length(at.St));
      if (m.touching || pair || dip(ray, m) <= near) {
        ++f.touching;
        f.steepest_touching = std::max(f.steepest_touching, std::abs(m.cosine));
      } else if (to_border * std::abs(m.cosine) <= near)
        ++f.at_border;
      else {
        ++left;
        f.told.add([&] { return fmt::format("{}, dip {:.3g} error {:.3g}: {}", who, dip(ray, m) / size_, error_ / size_, text(ray, m)); });
      }
    }
    return left;
  }

  std::string text(const Ray& ray, const Meeting& m) const {
    return fmt::format("{} with {} sides, degree {}, parameters {}: chart {} t {:.17g} st {:.17g} {:.17g} n.d {:.3g}, {}",
                       name_of(patch_.basis.kind), patch_.basis.sides, patch_.basis.degree, int(patch_.basis.parameters), m.chart, m.t,
                       m.st.x, m.st.y, m.cosine, text_of(ray));
  }

  NSidedPatch patch_;
  Tracer tracer_;
  reference::PatchIntersector cut_;
  double size_, error_ = 0;
  std::vector<PatchChart> charts_;
};

void examine(PatchKind kind, std::uint64_t rays, bool few, const std::vector<int>& by_mean_value = {5}) {
  Random random(kSeed + static_cast<std::uint64_t>(kind));
  std::vector<NSidedPatch> patches = random_patches(kind, random, few, by_mean_value);
  if (kind == PatchKind::bezier_triangle) patches.push_back(sphere_octant());
  ASSERT_FALSE(patches.empty());
  const std::uint64_t each = (rays + patches.size() - 1) / patches.size();
  Found sums[2];
  in_chunks(patches.size(), [&](std::uint64_t p, std::uint64_t thread) {
    Random own(kSeed + 100 * p);
    Routes(patches[p]).compare(each, own, sums[thread]);
  });
  Found f = sums[0];
  f.add(sums[1]);
  fmt::print(
      "[ measured ] {}: {} patches, error up to {:.2g} of the size; {} rays, {} meetings both ways, farthest {:.2g} of the size ({:.2g} of "
      "the {} with a cosine below {:.0e}); {} touching both ways; on one side only: {} touching (cosines up to {:.2g}), {} at the border, "
      "tracer {}, reference {}; {} normals, turned by {:.2g}\n",
      name_of(kind), f.patches, f.largest_error, f.rays, f.both, f.farthest, f.farthest_flat, f.flat, kFlat, f.touching_both, f.touching,
      f.steepest_touching, f.at_border, f.only_tracer, f.only_reference, f.normals, f.most_turned);
  EXPECT_EQ(f.rays, each * patches.size());
  EXPECT_GE(f.both, f.rays / 2);
  EXPECT_GE(f.normals, f.both / 2);
  EXPECT_EQ(f.only_tracer, 0u);
  EXPECT_EQ(f.only_reference, 0u);
  EXPECT_EQ(f.normals_differ, 0u);
  EXPECT_LE(f.touching, kMostTouching * static_cast<double>(f.both));
  EXPECT_LE(f.at_border, kMostAtBorder * static_cast<double>(f.both));
  f.told.fail(name_of(kind));
}

// Rays through places of a patch that leave its tangent plane by next to nothing: most dip into the patch by less than its spline is away,
// which they may pass altogether.
void meet_places_flatly(PatchKind kind, std::uint64_t rays) {
  constexpr double kBeside = 0.02, kWithin = 1e-13;  // of the chart; sizes, across the surface
  Random random(kSeed);
  std::uint64_t met = 0, flat = 0;
  Told told;
  const std::vector<NSidedPatch> patches = random_patches(kind, random, true);
  for (const NSidedPatch& patch : patches) {
    const Tracer tracer(scene_of({patch}));
    const Placed& placed = tracer.scene().placed.front();
    const double size = tracer.scene().box().diagonal();
    for (std::uint64_t i = 0; i < rays / patches.size(); ++i) {
      const Face& face = placed.part->faces[random() % placed.part->faces.size()];
      const Vec2 st = point_in(random, {Vec2(kBeside), Vec2(1 - kBeside)});
      const Vec3 n = unit_normal(face.surface, st, face.domain), d = random_direction(random);
      const double cosine = std::pow(10.0, between(random, -4, -2));
      const Vec3 along = glm::normalize(glm::normalize(d - glm::dot(d, n) * n) + cosine * n);
      const Ray ray{placed.to_world.point(point(face.surface, st)) - size * along, along};
      std::vector<Hit> hits;
      std::vector<std::size_t> offsets;
      SolverStats stats;
      tracer.all({&ray, 1}, hits, offsets, stats);
      ++flat;
      const bool found = std::any_of(hits.begin(), hits.end(), [&](const Hit& hit) {
        return std::abs((hit.t - size) * cosine_at(tracer, hit, ray)) <= kWithin * size;
      });
      met += found;
      if (!found) told.add([&] { return fmt::format("st {} {}, n.d {:.3g}, {}", st.x, st.y, cosine, text_of(ray)); });
    }
  }
  fmt::print("[ measured ] {}: {} of {} places met flatly\n", name_of(kind), met, flat);
  EXPECT_EQ(met, flat) << name_of(kind);
  told.fail(name_of(kind));
}

class PatchRoutes : public testing::TestWithParam<int> {};
class PatchRoutesSlow : public testing::TestWithParam<int> {};
// The bounds of kinds with any number of sides take long.
TEST_P(PatchRoutes, MeetTheSamePlaces) {
  const auto kind = static_cast<PatchKind>(GetParam());
  examine(kind, kind < PatchKind::generalised_bezier ? 20000 : 4000, true);
}
TEST_P(PatchRoutes, MeetPlacesFlatly) { meet_places_flatly(static_cast<PatchKind>(GetParam()), 10000); }
TEST_P(PatchRoutesSlow, MeetTheSamePlacesOnMorePatches) {
  const std::uint64_t rays = wanted("ISOPHOTE_RAYS", 6000);
  const std::vector<int> few{4, 7}, all{3, 4, 5, 6, 7, 8};
  examine(static_cast<PatchKind>(GetParam()), rays, false, rays < 100000 ? few : all);
}
const auto kNames = [](const testing::TestParamInfo<int>& info) {
  std::string name = name_of(static_cast<PatchKind>(info.param));
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
};
INSTANTIATE_TEST_SUITE_P(All, PatchRoutes, testing::Range(0, kPatchKinds), kNames);
INSTANTIATE_TEST_SUITE_P(All, PatchRoutesSlow, testing::Range(0, kPatchKinds), kNames);

}  // namespace
}  // namespace iso::test
