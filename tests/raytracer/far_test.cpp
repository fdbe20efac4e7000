// A part seven kilometres from the origin, its geometry rewritten there or placed by a location, is met like the same part at home.
#include "tests/support/load.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr int kWidth = 640, kHeight = 480;

// What a picture of clay would show of a hit: whether, how far, and which way the surface turns.
struct Seen {
  bool hit = false;
  double t = 0;
  Vec3 n{0.0};
};

// An orthographic picture along `d` of the scene's box, from rays given in the scene's own coordinates.
std::vector<Seen> picture(const Tracer& tracer, const Vec3& middle, double size, const Vec3& d) {
  const Vec3 right = glm::normalize(glm::cross(d, Vec3(0.3, -0.8, 0.1))), up = glm::cross(right, d);
  std::vector<Ray> rays;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      rays.push_back(
          {middle - size * d + size * ((x + 0.5) / kHeight - 0.5 * kWidth / kHeight) * right + size * ((y + 0.5) / kHeight - 0.5) * up, d});
  std::vector<Hit> hits(rays.size());
  SolverStats stats;
  tracer.nearest(rays, hits, Tracer::Order::coherent, stats);
  std::vector<Seen> seen;
  for (const Hit& hit : hits) seen.push_back(hit ? Seen{true, hit.t, tracer.surface_point(hit).n} : Seen{});
  return seen;
}

struct Difference {
  int hit = 0, silhouette = 0, depth = 0, shade = 0;
  double worst_depth = 0;
  int pixels() const { return silhouette + depth + shade; }
};

// Depth counts from 1e-6 of the size (the coordinates there carry 1e-9 mm), shades from 2/255 in a coordinate of the normal.
Difference differ(const std::vector<Seen>& a, const std::vector<Seen>& b, double size) {
  Difference d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    d.hit += a[i].hit;
    if (a[i].hit != b[i].hit) {
      ++d.silhouette;
    } else if (a[i].hit) {
      const double depth = std::abs(a[i].t - b[i].t) / size;
      const Vec3 turn = glm::abs(a[i].n - b[i].n);
      if (depth > 1e-6)
        ++d.depth;
      else if (std::max({turn.x, turn.y, turn.z}) > 2.0 * 2 / 255)
        ++d.shade;
      else
        d.worst_depth = std::max(d.worst_depth, depth);
    }
  }
  return d;
}

void compare(const char* far_file) {
  const Tracer home = tracer_of(load(data("cad/occt-screw.step")));
  const Tracer away = tracer_of(load(data(std::string("cad/") + far_file)));
  // The placed file states the shift.
  const Vec3 shift{4.5e6, 5.3e6, 1.2e5};
  const Box3 box = home.scene().box(), far_box = away.scene().box();
  const double size = box.diagonal();
  EXPECT_LE(glm::length(far_box.middle() - box.middle() - shift), 1e-3 * size) << "the file is not where this test looks";
  int shown = 0;
  for (const Vec3& d : {Vec3(-1, -1, -1), Vec3(1, -0.3, -0.2), Vec3(0.1, 0.2, 1)}) {
    const Vec3 along = glm::normalize(d);
    const auto a = picture(home, box.middle(), 1.1 * size, along), b = picture(away, box.middle() + shift, 1.1 * size, along);
    const Difference diff = differ(a, b, size);
    fmt::print(
        "[ measured ] {} along ({}, {}, {}): {} of {} pixels hit; differ: {} at silhouettes, {} in depth, {} in shade; depth elsewhere to "
        "{:.2g} of the size\n",
        far_file, d.x, d.y, d.z, diff.hit, a.size(), diff.silhouette, diff.depth, diff.shade, diff.worst_depth);
    EXPECT_LE(diff.pixels(), kWidth * kHeight / 1000);
    EXPECT_GE(diff.hit, kWidth * kHeight / 20);
    ++shown;
  }
  EXPECT_EQ(shown, 3);
}

TEST(Far, BakedScrewLooksLikeTheScrew) { compare("far-screw-baked.step"); }
TEST(Far, PlacedScrewLooksLikeTheScrew) { compare("far-screw-placed.brep"); }

}  // namespace
}  // namespace iso::test
