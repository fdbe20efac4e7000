// The nearest hit of a pixel's ray is the first of all roots. Two witnesses: roots by subdivision of the patches and Newton of its own
// (reference/first_root.h, shares nothing with the tracer but the patches) for a sample of the pixels, and the first hit of Tracer::all for
// all of them (which shares the solver, but has no nearest hit that cuts others off). $ISOPHOTE_REFERENCE_RAYS sets the size of the sample.
#include "raytracer/framing.h"
#include "reference/first_root.h"
#include "tests/support/closed_surfaces.h"
#include "tests/support/load.h"
#include "tests/support/residuals.h"
#include "tests/support/tally.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240703;
// How far the two roots may lie apart, in sizes.
constexpr double kSameRoot = 1e-11;

struct Subject {
  std::string name;
  Tracer tracer;
  reference::RootFinder roots;
  double size;
};

// The patches of all faces, as they are placed: moved by a translation, which the finder makes good by moving the rays.
Subject subject(std::string name, TraceScene scene) {
  std::vector<BezierPatch> patches;
  for (const Face& face : scene.placed.front().part->faces)
    for (const BezierPiece& piece : bezier_pieces(face.surface, face.domain)) patches.push_back(piece.patch);
  const double size = scene.box().diagonal();
  return {std::move(name), Tracer(std::move(scene)), reference::RootFinder(std::move(patches)), size};
}

// The closed surfaces, and the teapot.
constexpr int kSubjects = kClosedSurfaces + 1;
Subject subject(int index) {
  if (index < kClosedSurfaces) {
    const ClosedSurface s = closed_surface(index);
    return subject(s.name, one_face(s.surface, s.domain));
  }
  TraceScene scene;
  add_model(scene, load(data("patches/teapot.bpt")), Affine3{});
  return subject("teapot", std::move(scene));
}

// Pixels of three views, each square and in rows of 4 x 4 pixels, so that neighbours in the array are neighbours in the picture.
std::vector<Ray> pixels(const Tracer& tracer, std::uint64_t about) {
  const int side = 4 * static_cast<int>(std::ceil(std::sqrt(static_cast<double>(about) / 3) / 4));
  const ImageSize size{side, side};
  std::vector<Ray> rays;
  for (const View view : {View::iso, View::front, View::top}) {
    const Camera camera = frame_model(tracer, view, Projection::perspective, kDefaultFov, size);
    for (int i = 0; i < side * side; ++i) {
      const int block = i / 16, in = i % 16, x = 4 * (block % (side / 4)) + in % 4, y = 4 * (block / (side / 4)) + in / 4;
      rays.push_back(camera_ray(camera, size, x + 0.5, y + 0.5));
    }
  }
  return rays;
}

bool same(const Hit& a, const Hit& b) { return a.placed == b.placed && a.face == b.face && a.t == b.t && a.uv == b.uv; }

std::string text(const Hit& hit) {
  return fmt::format("t {:.17g} face {} uv {:.17g} {:.17g} status {}", hit.t, hit.face, hit.uv.x, hit.uv.y, int(hit.status));
}

// Against the reference: the same root, unless one of the two grazes. A doubtful root has no cosine and counts as grazing.
struct Sample {
  Tally agree;
  std::uint64_t hits = 0, grazing = 0;
  double apart = 0;

  void check(const Subject& s, const Ray& ray, const Hit& hit) {
    const Affine3 back = inverse(s.tracer.scene().placed.front().to_world);
    const reference::FirstRoot root = s.roots.first(back.point(ray.o), back.vector(ray.d));
    const bool hit_grazes = hit && std::abs(cosine_at(s.tracer, hit, ray)) <= kGrazingCosine;
    const bool root_grazes = root && std::abs(root.cosine) <= kGrazingCosine;
    if (hit_grazes || root_grazes) {
      ++grazing;
      return;
    }
    hits += hit ? 1 : 0;
    const double difference = hit && root ? std::abs(hit.t - root.t) / s.size : 0;
    apart = std::max(apart, difference <= kSameRoot ? difference : 0);
    agree.check(static_cast<bool>(hit) == static_cast<bool>(root) && difference <= kSameRoot, [&] {
      return fmt::format("{}: hit {}, first root t {:.17g} n.d {:.3g}; {}", s.name, text(hit), root.t, root.cosine, text_of(ray));
    });
  }
};

// Nearest hits in both orders and the first of all hits are the same to the last bit.
struct Pictures {
  std::vector<Hit> coherent, scattered;
  std::uint64_t orders_differ = 0, all_differ = 0;
};
Pictures trace(const Subject& s, const std::vector<Ray>& rays, SolverStats& stats) {
  Pictures p{std::vector<Hit>(rays.size()), std::vector<Hit>(rays.size()), 0, 0};
  s.tracer.nearest(rays, p.coherent, Tracer::Order::coherent, stats);
  s.tracer.nearest(rays, p.scattered, Tracer::Order::scattered, stats);
  constexpr std::size_t kBatch = 65536;
  std::vector<Hit> hits;
  std::vector<std::size_t> offsets;
  for (std::size_t first = 0; first < rays.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, rays.size() - first);
    s.tracer.all({rays.data() + first, count}, hits, offsets, stats);
    for (std::size_t i = 0; i < count; ++i) {
      const Hit none, &nearest = p.coherent[first + i], &lowest = offsets[i] < offsets[i + 1] ? hits[offsets[i]] : none;
      const auto tell = [&](const char* what, const Hit& other) {
        ADD_FAILURE() << s.name << ": " << what << ": " << text(nearest) << " and " << text(other) << ", " << text_of(rays[first + i]);
      };
      if (!same(nearest, lowest) && p.all_differ++ < 3) tell("nearest and the first of all", lowest);
      if (!same(nearest, p.scattered[first + i]) && p.orders_differ++ < 3) tell("coherent and scattered", p.scattered[first + i]);
    }
  }
  return p;
}

void examine(const Subject& s, std::uint64_t about, std::uint64_t sample_size) {
  const std::vector<Ray> rays = pixels(s.tracer, about);
  SolverStats stats;
  const Pictures pictures = trace(s, rays, stats);
  Residuals residuals;
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (const Hit& hit = pictures.coherent[i]) {
      ++hits;
      residuals.add(s.tracer, rays[i], hit, cosine_at(s.tracer, hit, rays[i]), s.size);
    }
  Sample sample{Tally(s.name + ": the nearest hit is the first root", kSeed)};
  Random random(kSeed);
  for (std::uint64_t i = 0; i < sample_size; ++i) {
    const std::size_t k = random() % rays.size();
    sample.check(s, rays[k], pictures.coherent[k]);
  }
  fmt::print(
      "[ measured ] {}: {} pixels, {} hit; nearest differs from the first of all {}, coherent from scattered {}; sample of {}: {} hit, {} "
      "grazing apart, roots at most {:.2g} of the size apart\n",
      s.name, rays.size(), hits, pictures.all_differ, pictures.orders_differ, sample_size, sample.hits, sample.grazing, sample.apart);
  residuals.finish(s.name);
  EXPECT_GE(hits, rays.size() / 10) << s.name;
  EXPECT_EQ(pictures.all_differ, 0u) << s.name;
  EXPECT_EQ(pictures.orders_differ, 0u) << s.name;
  EXPECT_LE(sample.grazing, sample_size / 100) << s.name;
  EXPECT_GE(sample.hits, sample_size / 10) << s.name;
  sample.agree.finish(sample_size - sample.grazing);
}

class WrongRoots : public testing::TestWithParam<int> {};
class WrongRootsSlow : public testing::TestWithParam<int> {};
TEST_P(WrongRoots, NoneInPrimaryRays) { examine(subject(GetParam()), 30000, 500); }
TEST_P(WrongRootsSlow, NoneInAMillionPixels) { examine(subject(GetParam()), 1000000, wanted("ISOPHOTE_REFERENCE_RAYS", 20000)); }
const auto kNames = [](const testing::TestParamInfo<int>& info) {
  return std::string(info.param < kClosedSurfaces ? kClosedNames[info.param] : "Teapot");
};
INSTANTIATE_TEST_SUITE_P(All, WrongRoots, testing::Range(0, kSubjects), kNames);
INSTANTIATE_TEST_SUITE_P(All, WrongRootsSlow, testing::Range(0, kSubjects), kNames);

}  // namespace
}  // namespace iso::test
