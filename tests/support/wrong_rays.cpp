#include "tests/support/wrong_rays.h"

#include <fmt/format.h>

#include <map>

#include "reference/trimmed_roots.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/solids.h"

namespace iso::test {
namespace {

// Depths may differ by this many times what the mesh is off, along the normal: the deviation is measured at four points of a triangle only.
constexpr double kDeviationFactor = 3;
// A triangle that is off by more than this many deflections makes candidates.
constexpr double kMostDeflections = 2;
// Where a ray meets the surface at less than this cosine, depth says nothing more.
constexpr double kLeastCosine = 0.02;
// How far two computations of a root may lie apart, in sizes, for a ray that meets the surface head on.
constexpr double kSameRoot = 1e-11;
// Cosine below which a ray counts as touching: there rounding decides whether it meets the surface.
constexpr double kTouching = 1e-5;
constexpr std::size_t kMostTold = 10;

double sane(double cosine) { return std::isnan(cosine) ? kLeastCosine : std::max(kLeastCosine, std::abs(cosine)); }

std::string text_of(const Ray& ray, const Hit& hit) {
  std::string text = fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}: ", ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z);
  return text + (hit ? fmt::format("part {} face {} t {:.17g}", hit.placed, hit.face, hit.t) : "miss");
}

// A meeting with one of the placed parts; t of the world.
struct PlacedMeeting : reference::Meeting {
  std::int32_t placed = -1;
  bool in_doubt() const { return doubtful || side == reference::Side::border || !(std::abs(cosine) >= kTouching); }
};

std::string text_of(const PlacedMeeting& m) {
  constexpr const char* kSides[] = {"inside", "border", "outside"};
  return fmt::format(" [part {} face {} t {:.17g} n.d {:.3g} {}{}]", m.placed, m.face, m.t, m.cosine,
                     kSides[static_cast<std::size_t>(m.side)], m.doubtful ? " doubtful" : "");
}

}  // namespace

struct RayJudge::State {
  State(OcctMesh m, const Tracer& t) : mesh(std::move(m)), scene(mesh), tracer(t), size(t.scene().box().diagonal()) {
    for (const Placed& placed : t.scene().placed) roots.try_emplace(placed.part.get(), *placed.part);
  }

  const OcctMesh mesh;
  const MeshScene scene;
  const Tracer& tracer;
  const double size;
  std::map<const Part*, reference::TrimmedRoots> roots;

  std::vector<PlacedMeeting> meetings(const Ray& ray) const {
    std::vector<PlacedMeeting> all;
    const auto& placed = tracer.scene().placed;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Affine3 back = inverse(placed[i].to_world);
      const Vec3 o = back.point(ray.o), d = back.vector(ray.d);
      const double stretch = glm::length(d);
      for (reference::Meeting& m : roots.at(placed[i].part.get()).all(o, d / stretch)) {
        m.t /= stretch;
        all.push_back({m, static_cast<std::int32_t>(i)});
      }
    }
    std::sort(all.begin(), all.end(), [](const PlacedMeeting& a, const PlacedMeeting& b) { return a.t < b.t; });
    return all;
  }

  double apart(const PlacedMeeting& m) const { return kSameRoot * size / std::max(kTouching, std::abs(m.cosine)); }

  Ruling decide(const std::vector<PlacedMeeting>& all, const Hit& hit, bool& lost) const {
    bool doubt = false, met = false, met_firmly = false;
    lost = true;
    for (const PlacedMeeting& m : all) {
      if (m.side == reference::Side::outside) continue;
      if (hit && std::abs(m.t - hit.t) <= apart(m)) {
        met = true;
        met_firmly = met_firmly || !m.in_doubt();
      } else if (m.t < hit.t) {
        if (!m.in_doubt()) return Ruling::wrong;
        doubt = true;
      }
    }
    lost = false;
    if (hit && !met) return Ruling::wrong;
    return doubt || (hit && !met_firmly) ? Ruling::undecided : Ruling::right;
  }

  // Whether the mesh shows the same, as far as it can be trusted: `tight` if it is off by little more than it was asked to be at most, else
  // `loose`, as far as it is measured to be off.
  enum class Agreement : std::uint8_t { none, loose, tight };
  Agreement agreement(const Ray& ray, const Hit& ours) const {
    const MeshHit theirs = scene.nearest(ray);
    if (!ours || !theirs) return !ours && !theirs ? Agreement::tight : Agreement::none;
    const MeshTriangle& triangle = mesh.triangles[static_cast<std::size_t>(theirs.triangle)];
    const Vec3 a = mesh.points[triangle.corners[0]], b = mesh.points[triangle.corners[1]], c = mesh.points[triangle.corners[2]];
    const double cosine =
        std::min(sane(glm::dot(glm::normalize(glm::cross(b - a, c - a)), ray.d)), sane(glm::dot(tracer.surface_point(ours).n, ray.d)));
    const auto within = [&](double off) { return std::abs(ours.t - theirs.t) <= (kDeviationFactor * off + scene.rounding()) / cosine; };
    const double measured = std::max(static_cast<double>(triangle.deviation), mesh.deflection);
    if (within(std::min(measured, kMostDeflections * mesh.deflection))) return Agreement::tight;
    return within(measured) ? Agreement::loose : Agreement::none;
  }

  void tell(const char* what, const Ray& ray, const Hit& hit, RayCounts& counts) const {
    if (counts.told.size() >= kMostTold) return;
    std::string text = fmt::format("{}: {}, meetings:", what, text_of(ray, hit));
    for (const PlacedMeeting& m : meetings(ray))
      if (m.side != reference::Side::outside || std::abs(m.t - hit.t) <= apart(m)) text += text_of(m);
    counts.told.push_back(std::move(text));
  }
};

std::vector<Ray> rays_through(const Box3& box, std::uint64_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = share(random), y = share(random), z = share(random);
    const Vec3 d = random_direction(random);
    rays.push_back({box.lo + box.size() * Vec3(x, y, z) - 1.5 * box.diagonal() * d, d});
  }
  return rays;
}

RayJudge::RayJudge(OcctMesh mesh, const Tracer& tracer) : state_(std::make_unique<State>(std::move(mesh), tracer)) {}
RayJudge::~RayJudge() = default;
const OcctMesh& RayJudge::mesh() const { return state_->mesh; }

Ruling RayJudge::decide(const Ray& ray, const Hit& hit) const {
  bool lost = false;
  return state_->decide(state_->meetings(ray), hit, lost);
}

RayCounts RayJudge::count(std::span<const Ray> rays, std::span<const Hit> hits, std::size_t sample_step) const {
  RayCounts counts;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ++counts.rays;
    counts.hits += static_cast<bool>(hits[i]);
    const auto agreement = state_->agreement(rays[i], hits[i]);
    const bool agrees = agreement == State::Agreement::tight;
    if (agrees && i % sample_step != 0) continue;
    bool lost = false;
    const Ruling ruling = state_->decide(state_->meetings(rays[i]), hits[i], lost);
    if (agrees) {
      ++counts.sampled;
      counts.sample_wrong += ruling == Ruling::wrong;
    } else {
      ++counts.candidates;
      counts.loose += agreement == State::Agreement::loose;
      ++(ruling == Ruling::right ? counts.mesh_wrong : ruling == Ruling::undecided ? counts.undecided : lost ? counts.lost : counts.extra);
    }
    if (ruling == Ruling::wrong) state_->tell("wrong", rays[i], hits[i], counts);
    if (!agrees && ruling == Ruling::undecided) state_->tell("undecided", rays[i], hits[i], counts);
  }
  return counts;
}

bool is_closed(const TraceScene& scene) {
  for (const Placed& placed : scene.placed) {
    for (const Face& face : placed.part->faces)
      if (face.solid < 0) return false;
    for (const Edge& edge : placed.part->edges)
      if (!edge.degenerate && edge.uses != 2) return false;
  }
  return !scene.placed.empty();
}

}  // namespace iso::test
