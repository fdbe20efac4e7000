// Sphere, cylinder, cone and torus, in closed form and as rational B-splines, against the textbook in long double.
#include "reference/quadrics.h"
#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20240613;

struct Shape {
  std::string name;
  AnySurface surface;
  Box2 domain;
  std::vector<Vec3> targets;  // poles, apex, points of the seam
};

Frame tilted() {
  Frame f;
  f.O = {3, -2, 5};
  f.X = glm::normalize(Vec3(1, 2, -0.5));
  f.Y = glm::normalize(glm::cross(Vec3(0.3, -0.2, 1), f.X));
  f.Z = glm::cross(f.X, f.Y);
  return f;
}

std::vector<Shape> shapes() {
  const Frame f = tilted();
  std::vector<Shape> out;
  out.push_back({"sphere", Sphere{f, 1.7}, natural_domain(Sphere{}), {f.O + 1.7 * f.Z, f.O - 1.7 * f.Z}});
  out.push_back({"cylinder", Cylinder{f, 0.8}, {{0, -1}, {kTwoPi, 2}}, {}});
  const Cone cone{f, 1.3, 0.5};
  const double apex = -cone.r / std::sin(cone.half_angle);
  out.push_back({"cone", cone, {{0, apex}, {kTwoPi, 0.5}}, {point(cone, {0, apex})}});
  out.push_back({"torus", Torus{f, 2, 0.7}, natural_domain(Torus{}), {f.O}});
  for (Shape& s : out)
    for (int i = 0; i < 20; ++i)
      for (int quarter = 0; quarter < 4; ++quarter)
        s.targets.push_back(point(s.surface, {quarter * kPi / 2, s.domain.lo.y + (i + 0.5) / 20 * s.domain.size().y}));
  return out;
}

// Two rays in three go anywhere, one is aimed at a pole, an apex or the seam: exactly, or missing it by 1e-16 .. 1e-3.
std::vector<Ray> rays_for(const Shape& shape, double size, const Vec3& centre, int count, Random& random) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Ray ray = random_ray(random, centre, 0.55 * size);
    if (i % 3 == 2) {
      const Vec3 off = i % 2 ? Vec3(0.0) : std::pow(10.0, between(random, -16, -3)) * random_direction(random);
      const Vec3 at = shape.targets[static_cast<std::size_t>(
          whole(random, 0, static_cast<int>(i % 4 ? shape.targets.size() : std::min<std::size_t>(2, shape.targets.size())) - 1))];
      ray.o = at + off - 2.0 * size * ray.d;
    }
    if (i % 5 == 0) ray.d *= std::pow(10.0, between(random, -3, 3));  // t counts in directions of any length
    rays.push_back(ray);
  }
  return rays;
}

std::string text(const Ray& r) {
  return fmt::format("o ({:.17g} {:.17g} {:.17g}) d ({:.17g} {:.17g} {:.17g})", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
}

// A ray is undecided where rounding decides: it all but touches the surface, or meets an open border or the apex within 1e-8.
bool undecided(const Shape& shape, const reference::Meetings& truth, const Ray& ray, double size) {
  if (truth.half_chord * glm::length(ray.d) < 1e-5 * size) return true;
  for (const auto& m : truth.at) {
    if (std::abs(m.cosine) < 1e-5) return true;
    if (std::holds_alternative<Sphere>(shape.surface)) continue;
    for (const double border : {shape.domain.lo.y, shape.domain.hi.y})
      if (std::abs(m.v - border) < 1e-8 * size) return true;
  }
  return false;
}

// One form of a shape (closed form or NURBS) and what it answered to a batch.
struct Form {
  const char* name;
  Tracer tracer;
  std::vector<Hit> hits;
  std::vector<std::size_t> offsets;

  std::span<const Hit> of(std::size_t ray) const { return {hits.data() + offsets[ray], offsets[ray + 1] - offsets[ray]}; }
};

class Examination {
 public:
  Examination(Shape shape, std::uint64_t seed)
      : shape_(std::move(shape)),
        nurbs_(as_nurbs(shape_.surface, shape_.domain)),
        forms_{Form{"closed form", Tracer(one_face(shape_.surface, shape_.domain)), {}, {}},
               Form{"NURBS", Tracer(one_face(nurbs_, natural_domain(nurbs_))), {}, {}}},
        box_(bounds(shape_.surface, shape_.domain)),
        size_(box_.diagonal()),
        random_(seed),
        error_(shape_.name + ": error along the normal", seed),
        known_(shape_.name + ": number of hits", seed),
        same_(shape_.name + ": closed form = NURBS", seed),
        first_(shape_.name + ": nearest and occluded agree with all", seed),
        apex_(shape_.name + ": nothing slips through the apex", seed) {}

  void run(int count) {
    for (int done = 0; done < count; done += 10000) {
      const std::vector<Ray> rays = rays_for(shape_, size_, box_.middle(), std::min(10000, count - done), random_);
      for (Form& form : forms_) trace(form, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) compare(rays[i], i);
    }
    finish(static_cast<std::uint64_t>(count));
  }

 private:
  // All hits lie on the surface; nearest and occluded say the same as all.
  void trace(Form& form, const std::vector<Ray>& rays) {
    form.tracer.all(rays, form.hits, form.offsets, stats_);
    std::vector<Hit> nearest(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    form.tracer.nearest(rays, nearest, Tracer::Order::scattered, stats_);
    form.tracer.occluded(rays, blocked, Tracer::Order::scattered, stats_);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto hits = form.of(i);
      const bool agree = hits.empty() ? !nearest[i] && !blocked[i] : nearest[i] && blocked[i] && nearest[i].t == hits[0].t;
      first_.check(agree, [&] {
        return fmt::format("{}: {} hits, nearest t {:.17g}, blocked {}, {}", form.name, hits.size(), nearest[i].t, blocked[i],
                           text(rays[i]));
      });
      for (const Hit& hit : hits) examine(form, rays[i], hit);
    }
  }

  void examine(const Form& form, const Ray& ray, const Hit& hit) {
    ++hits_;
    touching_ += hit.status == HitStatus::tangent;
    const auto say = [&] { return fmt::format("{}, status {}, t {:.17g}, {}", form.name, int(hit.status), hit.t, text(ray)); };
    const reference::LVec3 on_ray = reference::LVec3(ray.o) + static_cast<long double>(hit.t) * reference::LVec3(ray.d);
    for (const reference::LVec3& p : {on_ray, reference::LVec3(form.tracer.surface_point(hit).p)})
      error_.within(static_cast<double>(std::abs(reference::distance_along_normal(shape_.surface, p))), 1e-12 * size_, say);
  }

  double cosine(const Form& form, const Hit& hit, const Ray& ray) const {
    return std::abs(glm::dot(form.tracer.surface_point(hit).n, glm::normalize(ray.d)));
  }

  void compare(const Ray& ray, std::size_t i) {
    const auto a = forms_[0].of(i), b = forms_[1].of(i);
    const auto say = [&] { return fmt::format("{} and {} hits, {}", a.size(), b.size(), text(ray)); };
    check_apex(ray, i);
    if (is_undecided(ray, i)) {
      ++undecided_;
      return;
    }
    // The torus is known to be closed, the others are known.
    bool right = a.size() % 2 == 0 && b.size() % 2 == 0;
    if (!std::holds_alternative<Torus>(shape_.surface)) {
      std::size_t expected = 0;
      for (const auto& m : reference::meetings(shape_.surface, ray.o, ray.d).at)
        expected += std::holds_alternative<Sphere>(shape_.surface) || (m.v >= shape_.domain.lo.y && m.v <= shape_.domain.hi.y) ? 1 : 0;
      right = a.size() == expected && b.size() == expected;
    }
    known_.check(right, say);
    bool equal = a.size() == b.size();
    for (std::size_t k = 0; equal && k < a.size(); ++k) {
      const double apart = std::abs(a[k].t - b[k].t) * glm::length(ray.d) * cosine(forms_[0], a[k], ray) / size_;
      worst_t_ = std::max(worst_t_, apart);
      equal = apart <= 1e-12;
    }
    same_.check(equal, say);
  }

  bool is_undecided(const Ray& ray, std::size_t i) const {
    if (!std::holds_alternative<Torus>(shape_.surface))
      return undecided(shape_, reference::meetings(shape_.surface, ray.o, ray.d), ray, size_);
    for (const Form& form : forms_)
      for (const Hit& hit : form.of(i))
        if (cosine(form, hit, ray) < 1e-5) return true;
    return false;
  }

  // A line that runs into a cone through its apex, or past it within rounding, must meet it there.
  void check_apex(const Ray& ray, std::size_t i) {
    const auto* cone = std::get_if<Cone>(&shape_.surface);
    if (!cone) return;
    const Vec3 apex = shape_.targets[0], d = glm::normalize(ray.d);
    const double past = glm::length(glm::cross(apex - ray.o, d));
    if (past > 1e-9 * size_ || std::abs(glm::dot(d, cone->frame.Z)) < std::cos(0.9 * cone->half_angle)) return;
    for (const Form& form : forms_) {
      bool met = false;
      for (const Hit& hit : form.of(i)) met = met || glm::length(ray.o + hit.t * ray.d - apex) < 1e-6 * size_;
      apex_.check(met, [&] { return fmt::format("{}: a ray that passes the apex at {:.3g} misses it, {}", form.name, past, text(ray)); });
    }
  }

  void finish(std::uint64_t rays) {
    EXPECT_LE(undecided_, rays / 20) << "too few rays were decided";
    EXPECT_GE(hits_, rays);
    error_.finish(2 * hits_);
    known_.finish(rays - undecided_);
    same_.finish(rays - undecided_);
    first_.finish(2 * rays);
    if (std::holds_alternative<Cone>(shape_.surface)) apex_.finish_at_least(rays / 250);
    fmt::print(
        "[ measured ] {}: {} rays, {} hits, {} undecided rays, {} touching hits, largest difference of t across the surface {:.2g} of the "
        "size, "
        "{} fallbacks, {} out of budget\n",
        shape_.name, rays, hits_, undecided_, touching_, worst_t_, stats_.fallbacks, stats_.fallback_out_of_budget);
    EXPECT_EQ(stats_.fallback_out_of_budget, 0u);
  }

  Shape shape_;
  NurbsSurface nurbs_;
  std::array<Form, 2> forms_;
  Box3 box_;
  double size_;
  Random random_;
  Tally error_, known_, same_, first_, apex_;
  SolverStats stats_;
  std::uint64_t hits_ = 0, undecided_ = 0, touching_ = 0;
  double worst_t_ = 0;
};

void examine(const Shape& shape, int count, std::uint64_t seed) { Examination(shape, seed).run(count); }

class Truth : public testing::TestWithParam<int> {};
class TruthSlow : public testing::TestWithParam<int> {};
TEST_P(Truth, HitsAgreeWithTheTextbook) { examine(shapes()[static_cast<std::size_t>(GetParam())], 50000, kSeed); }
TEST_P(TruthSlow, AMillionHitsAgreeWithTheTextbook) { examine(shapes()[static_cast<std::size_t>(GetParam())], 1000000, kSeed + 1); }
const auto kNames = [](const testing::TestParamInfo<int>& info) { return shapes()[static_cast<std::size_t>(info.param)].name; };
INSTANTIATE_TEST_SUITE_P(All, Truth, testing::Range(0, 4), kNames);
INSTANTIATE_TEST_SUITE_P(All, TruthSlow, testing::Range(0, 4), kNames);

}  // namespace
}  // namespace iso::test
