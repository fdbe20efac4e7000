// Rays aimed at the edges that two faces of a CAD model share, and into the gap there, from outside the model: none slips through. Each is
// traced with an open end, where something nearer may stop it, and as a window about the target, where only a hit at the target counts: so
// it is of no matter what lies before or behind. Left out are rays that enter one face and leave the other (they touch the edge, so
// rounding decides), and flat ones. $ISOPHOTE_RAYS sets the number of rays of the slow suite.
#include "tests/support/brl_cad_models.h"
#include "tests/support/load.h"
#include "tests/support/random_shapes.h"
#include "tests/support/residuals.h"
#include "tests/support/solids.h"
#include "tests/support/told.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240713;
constexpr std::uint64_t kChunk = 8192;
constexpr std::size_t kStations = 20000;  // on all edges together, about
constexpr double kEnds = 1e-3;            // of an edge's length: vertices, where more than two faces meet, are left out
constexpr double kLeastCosine = 0.125;    // the trim regions widen gaps for flat rays as far as this (TrimRegion::kMostStretch)
// Targets lie at most this far beside the edge, in sizes: at the edge itself, or a little off it.
constexpr double kAtEdge = 1e-12, kBeside = 1e-9;
constexpr double kRounding = 1e-11;   // sizes
constexpr double kMostBeside = 2e-5;  // of the rays
constexpr double kNear = 2;           // see `reach`

// A point of an edge as each of the two faces has it, with the outward normals.
struct Station {
  Vec3 p[2], n[2];
  double gap = 0;
};

// One of the two curves that an edge traces, run through with s from 0 to 1.
struct Use {
  const Face* face = nullptr;
  const TrimCurve* curve = nullptr;

  UV uv(double s) const { return jet(curve->curve, curve->t0 + s * (curve->t1 - curve->t0)).C; }
  Vec3 at(double s) const { return point(face->surface, uv(s)); }
  Vec3 outward(double s) const { return (face->reversed ? -1.0 : 1.0) * unit_normal(face->surface, uv(s), face->domain); }
};

// The parameter of the point of `use` nearest to p: the best of many samples, then smaller and smaller steps.
double nearest_on(const Use& use, const std::vector<Vec3>& samples, const Vec3& p) {
  const auto last = static_cast<double>(samples.size() - 1);
  std::size_t k = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (glm::length(samples[i] - p) < glm::length(samples[k] - p)) k = i;
  double best = static_cast<double>(k) / last, least = glm::length(samples[k] - p);
  for (double step = 0.5 / last; step > 1e-16; step *= 0.5)
    for (const double s : {best - step, best + step})
      if (s >= 0 && s <= 1)
        if (const double distance = glm::length(use.at(s) - p); distance < least) {
          best = s;
          least = distance;
          break;
        }
  return best;
}

void add_stations(const Use& a, const Use& b, const Edge& edge, std::size_t count, Random& random, std::vector<Station>& stations) {
  constexpr int kSamples = 256;
  std::vector<Vec3> samples;
  for (int i = 0; i <= kSamples; ++i) samples.push_back(b.at(static_cast<double>(i) / kSamples));
  for (std::size_t i = 0; i < count; ++i) {
    const double s = between(random, kEnds, 1 - kEnds);
    const Vec3 p = a.at(s);
    const double other = nearest_on(b, samples, p);
    stations.push_back({{p, b.at(other)}, {a.outward(s), b.outward(other)}, edge.gap});
  }
}

// Of all edges with two uses, seams of one face included.
std::vector<Station> stations_of(const Part& part) {
  std::vector<std::vector<Use>> uses(part.edges.size());
  for (const Face& face : part.faces)
    for (const TrimLoop& loop : face.loops)
      for (const TrimCurve& curve : loop.curves)
        if (curve.edge >= 0) uses[static_cast<std::size_t>(curve.edge)].push_back({&face, &curve});
  std::vector<Station> stations;
  Random random(kSeed);
  for (std::size_t e = 0; e < uses.size(); ++e)
    if (uses[e].size() == 2 && !part.edges[e].degenerate)
      add_stations(uses[e][0], uses[e][1], part.edges[e], kStations / uses.size() + 1, random, stations);
  return stations;
}

struct Found {
  std::uint64_t rays = 0, at_target = 0, first = 0, leaked = 0, leaked_window = 0, touching = 0;
  double worst = 0;  // distance of a hit from its target, of what is allowed
  Told told;

  void add(const Found& o) {
    rays += o.rays;
    at_target += o.at_target;
    first += o.first;
    leaked += o.leaked;
    leaked_window += o.leaked_window;
    touching += o.touching;
    worst = std::max(worst, o.worst);
    told.add(o.told);
  }
};

class Subject {
 public:
  explicit Subject(std::shared_ptr<const Model> model)
      : tracer_(tracer_of(std::move(model))),
        placed_(tracer_.scene().placed.front()),
        size_(placed_.part->box.diagonal()),
        stations_(stations_of(*placed_.part)) {}

  std::size_t stations() const { return stations_.size(); }

  Found chunk(std::uint64_t number, double most_aside) const {
    Random random(kSeed + number);
    Found f;
    std::vector<Ray> open, window;
    std::vector<double> reach;
    while (open.size() < kChunk)
      if (const auto aimed = aim(random, most_aside, f)) {
        open.push_back(aimed->ray);
        const double t = 2 * size_;
        window.push_back({aimed->ray.o, aimed->ray.d, t - aimed->reach, t + aimed->reach});
        reach.push_back(aimed->reach);
      }
    std::vector<Hit> first(open.size()), at(open.size());
    SolverStats stats;
    tracer_.nearest(open, first, Tracer::Order::scattered, stats);
    tracer_.nearest(window, at, Tracer::Order::scattered, stats);
    for (std::size_t i = 0; i < open.size(); ++i) look(open[i], first[i], at[i], reach[i], f);
    return f;
  }

 private:
  struct Aimed {
    Ray ray;
    double reach = 0;
  };

  // `reach`: how far from the target, along the ray, the surface may be met: the gap and the way beside it, seen at the flattest angle.
  std::optional<Aimed> aim(Random& random, double most_aside, Found& f) const {
    const Station& s = stations_[random() % stations_.size()];
    const Vec3 d = random_direction(random);
    const double c0 = glm::dot(s.n[0], d), c1 = glm::dot(s.n[1], d), flattest = std::min(std::abs(c0), std::abs(c1));
    if (!(flattest >= kLeastCosine)) return std::nullopt;
    if (c0 * c1 < 0) {
      ++f.touching;
      return std::nullopt;
    }
    const double aside = size_ * most_aside * std::pow(10.0, between(random, -4, 0));
    const Vec3 target = s.p[0] + between(random, 0, 1) * (s.p[1] - s.p[0]) + aside * random_direction(random);
    const Ray ray{placed_.to_world.point(target - 2 * size_ * d), placed_.to_world.vector(d)};
    return Aimed{ray, kNear * (s.gap + aside + kRounding * size_) / flattest};
  }

  void look(const Ray& ray, const Hit& first, const Hit& at, double reach, Found& f) const {
    ++f.rays;
    const double t = 2 * size_;
    const auto tell = [&](const char* what, const Hit& hit) {
      f.told.add([&] { return fmt::format("{}: target t {:.17g} +- {:.3g}, hit t {:.17g}, {}", what, t, reach, hit.t, text_of(ray)); });
    };
    if (!first || first.t > t + reach) {
      ++f.leaked;
      tell("nothing at or before the target", first);
    }
    f.first += first && std::abs(first.t - t) <= reach;
    if (!at) {
      ++f.leaked_window;
      return tell("nothing at the target", at);
    }
    ++f.at_target;
    f.worst = std::max(f.worst, std::abs(at.t - t) / reach);
  }

  Tracer tracer_;
  const Placed& placed_;
  double size_;
  std::vector<Station> stations_;
};

Found shoot(const std::string& name, const Subject& subject, std::uint64_t rays, double most_aside) {
  const std::uint64_t chunks = (rays + kChunk - 1) / kChunk;
  Found sums[2];
  in_chunks(chunks, [&](std::uint64_t c, std::uint64_t thread) { sums[thread].add(subject.chunk(c, most_aside)); });
  Found f = sums[0];
  f.add(sums[1]);
  fmt::print(
      "[ measured ] {}: {} stations, {} rays ({} that would touch left out): {} hit at the target, {} there first; leaked {}, in a window "
      "{}; farthest {:.2g} of what is allowed\n",
      name, subject.stations(), f.rays, f.touching, f.at_target, f.first, f.leaked, f.leaked_window, f.worst);
  EXPECT_EQ(f.rays, chunks * kChunk);
  EXPECT_GE(f.first, f.rays / 10) << name << ": hardly a ray comes to a seam";
  return f;
}

void expect_no_leak(const char* name, std::uint64_t rays) {
  const auto model = std::find_if(kBrlCadModels.begin(), kBrlCadModels.end(), [&](const auto& m) { return std::string(m.name) == name; });
  ASSERT_NE(model, kBrlCadModels.end());
  const auto path = path_of(*model);
  if (!path) GTEST_SKIP() << model->file << " is in the larger collection, which is not here";
  const Subject subject(load(*path));
  const Found f = shoot(name, subject, rays, kAtEdge);
  EXPECT_EQ(f.leaked, 0u) << name;
  EXPECT_EQ(f.leaked_window, 0u) << name;
  f.told.fail(name);
  // Beside the edge, by up to 1e-9 of the size, a few rays slip past the nacelle's lip: 4 of a million, 13 in their windows. The slow
  // second way (reference/trimmed_roots.h) meets the surfaces there only beyond their loops, or doubtfully; why is not known.
  const Found beside = shoot(std::string(name) + ", beside the edge", subject, rays, kBeside);
  EXPECT_LE(static_cast<double>(beside.leaked_window), kMostBeside * static_cast<double>(beside.rays)) << name;
}

class Seams : public testing::TestWithParam<const char*> {};
class SeamsSlow : public testing::TestWithParam<const char*> {};
TEST_P(Seams, NoRaySlipsThrough) { expect_no_leak(GetParam(), 100000); }
TEST_P(SeamsSlow, NoneOfAMillionRaysSlipsThrough) { expect_no_leak(GetParam(), wanted("ISOPHOTE_RAYS", 1000000)); }
const auto kNames = [](const testing::TestParamInfo<const char*>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
};
// One part each with edges that two faces share: neither the assembly nor the hull's three shells.
constexpr const char* kSubjects[] = {"tigl-nacelle", "linkrods", "screw", "nist-mbe-pmi-03", "netgen-frame"};
INSTANTIATE_TEST_SUITE_P(All, Seams, testing::ValuesIn(kSubjects), kNames);
INSTANTIATE_TEST_SUITE_P(All, SeamsSlow, testing::ValuesIn(kSubjects), kNames);

// Two cubic patches that end `gap` apart, and the edge between them lies on the border of both: there neither surface went on, so that rays
// slipped through gaps of any size.
std::shared_ptr<const Model> two_patches(double gap) {
  auto model = std::make_shared<Model>();
  Part& part = model->parts.emplace_back();
  for (const double start : {-1 - gap, 0.0}) {
    NurbsSurface s;
    s.degree_u = s.degree_v = 3;
    s.count_u = s.count_v = 4;
    s.knots_u = s.knots_v = {0, 0, 0, 0, 1, 1, 1, 1};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) s.poles.push_back({start + i / 3.0, j / 3.0, 0.1 * (j * (3 - j)), 1});
    Face& face = part.faces.emplace_back();
    face.surface = s;
    face.domain = natural_domain(s);
    TrimLoop& loop = face.loops.emplace_back();
    const UV corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int shared = start < 0 ? 1 : 3;  // the side that faces the other patch
    for (int k = 0; k < 4; ++k) {
      const UV from = corners[k], to = corners[(k + 1) % 4];
      const int edge = k == shared ? 0 : static_cast<int>(part.edges.size()) + (part.edges.empty() ? 1 : 0);
      if (edge >= static_cast<int>(part.edges.size())) part.edges.resize(static_cast<std::size_t>(edge) + 1);
      loop.curves.push_back({Line<Vec2>{from, to - from}, 0, 1, edge});
      ++part.edges[static_cast<std::size_t>(edge)].uses;
    }
  }
  model->instances.emplace_back();
  finish(*model);
  return model;
}
TEST(SeamsOnBorders, NoRaySlipsThroughWhereSurfacesEnd) {
  for (const double gap : {0.0, 1e-12, 1e-9, 1e-6, 1e-5}) {
    const Found f = shoot(fmt::format("two patches {} apart", gap), Subject(two_patches(gap)), 50000, kBeside);
    EXPECT_EQ(f.leaked, 0u) << gap;
    EXPECT_EQ(f.leaked_window, 0u) << gap;
    f.told.fail(fmt::format("two patches {} apart", gap));
  }
}

// The test itself: where gaps are left open rays do slip through.
TEST(SeamsLeftOpen, RaysSlipThroughAndAreFound) {
  Model open = *load(occt_data("step/linkrods.step"));
  for (Edge& edge : open.parts.front().edges) edge.closing = 0;
  const Found f = shoot("linkrods with open gaps", Subject(std::make_shared<const Model>(std::move(open))), 100000, kAtEdge);
  EXPECT_GE(f.leaked, 100u);
  EXPECT_GE(f.leaked_window, f.leaked);
}

}  // namespace
}  // namespace iso::test
