// Stripes and curvatures against closed forms, finite differences and finer pictures.
#include "raytracer/smoothness.h"

#include "raytracer/render.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/smooth_tori.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20241205;
const Box2 kTurns{{0, 0}, {kTwoPi, kTwoPi}};

// z = x y over [-1, 1]^2.
NurbsSurface saddle() {
  NurbsSurface s;
  s.degree_u = s.degree_v = 1;
  s.count_u = s.count_v = 2;
  s.knots_u = s.knots_v = {0, 0, 1, 1};
  s.poles = {{-1, -1, 1, 1}, {-1, 1, -1, 1}, {1, -1, -1, 1}, {1, 1, 1, 1}};
  return s;
}

TraceScene scene_of(std::vector<Face> faces) {
  auto model = std::make_shared<Model>();
  model->parts.emplace_back();
  model->parts[0].faces = std::move(faces);
  model->instances.emplace_back();
  finish(*model);
  TraceScene scene;
  add_model(scene, model, Affine3{});
  return scene;
}

Face face_of(AnySurface surface, const Box2& domain) {
  Face face;
  face.surface = std::move(surface);
  face.domain = domain;
  return face;
}

Hit hit_by(const Tracer& tracer, const Ray& ray) { return nearest(tracer, {ray})[0]; }

Camera orthographic(const Vec3& from, double height) { return *look_at(Projection::orthographic, from, Vec3(0.0), {0.1, 0.2, 1}, height); }

Film picture(const Tracer& tracer, const Camera& camera, const ImageSize& size, const Integrator& integrator, int samples, double spread) {
  const Sampler sampler(1, samples);
  const std::atomic<bool> stop = false;
  return render(tracer, camera, integrator, sampler, {size, samples, 1, kAovNone, {}, spread}, stop, [](int, int) {}).film;
}

// Without a window of its own: so many samples share the pixel that each one is a point.
constexpr int kPoints = 1 << 30;

// ---- derivatives -------------------------------------------------------------------------------------------------------

TEST(Camera, RayDifferentialsAreTheDerivativesOfRays) {
  int checked = 0;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Camera camera = *look_at(projection, {3, -4, 5}, {0.1, 0.2, 0.3}, {0, 0, 1}, 60);
    const ImageSize size{320, 200};
    for (const Vec2 at : {Vec2(0, 0), Vec2(160, 100), Vec2(300.25, 17)}) {
      const RayDifferential d = ray_differential(camera, size, camera_ray(camera, size, at.x, at.y));
      constexpr double h = 1e-4;
      const auto change = [&](Vec2 step, const auto& of) {
        return (of(camera_ray(camera, size, at.x + step.x, at.y + step.y)) - of(camera_ray(camera, size, at.x - step.x, at.y - step.y))) /
               (2 * h);
      };
      const auto o = [](const Ray& r) { return r.o; };
      const auto dir = [](const Ray& r) { return r.d; };
      EXPECT_LT(glm::length(change({h, 0}, o) - d.o_x) + glm::length(change({0, h}, o) - d.o_y), 1e-9);
      EXPECT_LT(glm::length(change({h, 0}, dir) - d.d_x) + glm::length(change({0, h}, dir) - d.d_y), 1e-10);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 6);
}

// One scene for each way to hold a surface; placed by a map that is no similarity, and seen from all sides.
std::vector<TraceScene> shapes() {
  std::vector<TraceScene> scenes;
  scenes.push_back(one_face(Sphere{{}, 1.0}, kWholeSphere));
  scenes.push_back(one_face(Cylinder{{}, 0.8}, {{0, -1}, {kTwoPi, 1}}));
  scenes.push_back(one_face(Cone{{}, 0.9, 0.5}, {{0, -1}, {kTwoPi, 0.5}}));
  scenes.push_back(one_face(Torus{{}, 0.9, 0.35}, kTurns));
  const NurbsSurface wavy = wavy_torus(28, 12);
  scenes.push_back(one_face(wavy, {{wavy.knots_u.front(), wavy.knots_v.front()}, {wavy.knots_u.back(), wavy.knots_v.back()}}));
  scenes.push_back(one_face(saddle(), {{0, 0}, {1, 1}}));
  for (TraceScene& scene : scenes)
    scene.placed[0].to_world = Affine3{Mat3({1.2, 0.1, 0}, {-0.3, 0.9, 0.2}, {0, 0.25, 1}), {0.1, -0.2, 0.3}};
  return scenes;
}

TEST(ShapeOperator, TurnsNormalsAndHasThePrincipalCurvatures) {
  Tally tally("shape operators", kSeed);
  for (const TraceScene& scene : shapes()) {
    const Tracer tracer(scene);
    for (const Hit& hit : nearest(tracer, random_rays(kSeed, 2000, 1.2))) {
      if (!hit) continue;
      const SurfacePoint at = tracer.surface_point(hit);
      const Mat3 S = tracer.shape_operator(hit);
      const double size = std::abs(at.k1) + std::abs(at.k2) + 1;
      const auto trace = [](const Mat3& m) { return m[0][0] + m[1][1] + m[2][2]; };
      tally.within(std::abs(trace(S) - at.k1 - at.k2), 1e-9 * size, [] { return "trace"; });
      tally.within(std::abs(trace(S * S) - at.k1 * at.k1 - at.k2 * at.k2), 1e-8 * size * size, [] { return "trace of the square"; });
      tally.within(glm::length(S * at.n), 1e-9 * size, [] { return "along the normal"; });
    }
  }
  tally.finish_at_least(5000);
}

TEST(Stripes, PhasesChangePerPixelAsTheirGradientSays) {
  Tally tally("gradients", kSeed);
  const ImageSize size{400, 300};
  for (const TraceScene& scene : shapes())
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const StripeKind kind : {StripeKind::zebra, StripeKind::reflection_lines, StripeKind::isophotes}) {
        const Tracer tracer(scene);
        const Camera camera = *look_at(projection, {4, -5, 3}, Vec3(0.0), {0, 0, 1}, projection == Projection::perspective ? 25 : 3);
        const Stripes stripes{kind, camera.right, camera.up, 12, 0.5};
        const auto phase = [&](double x, double y) {
          const Ray ray = camera_ray(camera, size, x, y);
          const Hit hit = hit_by(tracer, ray);
          return hit ? phase_of(stripes, seen_normal(tracer, ray, hit, ray_differential(camera, size, ray))) : StripePhase{std::nan(""), 0};
        };
        for (int i = 0; i < 200; ++i) {
          const double x = 60 + 280 * std::fmod(0.754877666 * i, 1.0), y = 40 + 220 * std::fmod(0.569840291 * i, 1.0), h = 1e-4;
          const StripePhase at = phase(x, y);
          const double dx = (phase(x + h, y).at - phase(x - h, y).at) / (2 * h), dy = (phase(x, y + h).at - phase(x, y - h).at) / (2 * h);
          // Silhouettes, borders, and where the angle starts again do not count.
          if (!finite(dx) || !finite(dy) || at.per_pixel > 20 || std::hypot(dx, dy) > 1000) continue;
          tally.within(std::abs(std::hypot(dx, dy) - at.per_pixel), 1e-6 * (1 + at.per_pixel * at.per_pixel),
                       [&] { return fmt::format("stripes {} at ({}, {}): {:.6g}", int(kind), x, y, at.per_pixel); });
        }
      }
  tally.finish_at_least(2500);
}

// ---- closed forms ------------------------------------------------------------------------------------------------------

TEST(Curvature, ValuesOfThePictureAreTheClosedForms) {
  Tally tally("curvatures", kSeed);
  const auto check = [&](const TraceScene& scene, const auto& truth) {  // (mean, Gauss) at a point and its parameters
    const Tracer tracer(scene);
    for (const Hit& hit : nearest(tracer, random_rays(kSeed + 1, 4000, 1.2))) {
      if (!hit) continue;
      const Curvatures k = tracer.curvatures(hit);
      const Vec2 expected = truth(tracer.surface_point(hit).p, hit.uv);
      tally.within(std::abs(curvature_value(Shade::mean_curvature, k) - expected.x), 1e-11,
                   [&] { return fmt::format("mean {}", expected.x); });
      tally.within(std::abs(curvature_value(Shade::gauss_curvature, k) - expected.y), 1e-11,
                   [&] { return fmt::format("Gauss {}", expected.y); });
    }
  };
  const double R = 0.9, r = 0.35;
  const auto of_torus = [&](const Point3& p, const UV&) {
    const double reach = std::hypot(p.x, p.y), cosine = (reach - R) / r;
    return Vec2((R + 2 * r * cosine) / (2 * r * reach), cosine / (r * reach));
  };
  check(one_face(Sphere{{}, 0.8}, kWholeSphere), [](const Point3&, const UV&) { return Vec2(1.25, 1.5625); });
  check(one_face(Cylinder{{}, 0.8}, {{0, -1}, {kTwoPi, 1}}), [](const Point3&, const UV&) { return Vec2(0.625, 0); });
  check(one_face(Plane{}, {{-1, -1}, {1, 1}}), [](const Point3&, const UV&) { return Vec2(0, 0); });
  check(one_face(Torus{{}, R, r}, kTurns), of_torus);
  check(one_face(as_nurbs(Torus{{}, R, r}, kTurns), {{0, 0}, {4, 4}}), of_torus);
  check(one_face(saddle(), {{0, 0}, {1, 1}}), [](const Point3& p, const UV&) {  // outward is +z: it bulges where z is concave
    const double w = 1 + p.x * p.x + p.y * p.y;
    return Vec2(p.x * p.y / (w * std::sqrt(w)), -1 / (w * w));
  });
  tally.finish_at_least(12000);
}

TEST(Curvature, TheAutomaticRangeFitsWhatIsSeenAndNotThePixels) {
  const Camera camera = orthographic({4, -5, 3}, 6);
  const Tracer sphere(one_face(Sphere{{}, 2.0}, kWholeSphere));
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{160, 120}, ImageSize{77, 99}}) {
    const Range mean = automatic_range(sphere, camera, size, Shade::mean_curvature);
    const Range gauss = automatic_range(sphere, camera, size, Shade::gauss_curvature);
    EXPECT_DOUBLE_EQ(mean.hi, 0.5);
    EXPECT_DOUBLE_EQ(gauss.hi, 0.5);  // from 0.25 up to the next of 1, 2, 5
    EXPECT_EQ(mean.lo, -mean.hi);
    EXPECT_EQ(gauss.lo, -gauss.hi);
  }
  const Tracer plane(one_face(Plane{}, {{-2, -2}, {2, 2}}));
  EXPECT_DOUBLE_EQ(automatic_range(plane, camera, {64, 48}, Shade::mean_curvature).hi, 0.5);  // 2 / diagonal is 0.354
}

// n . a is constant on circles about a: which pixel lies in which band is known.
TEST(Stripes, IsophotesOfASphereAreCircles) {
  const Tracer tracer(one_face(Sphere{{}, 1.0}, kWholeSphere));
  const ImageSize size{240, 240};
  const Camera camera = orthographic({3, -4, 2}, 2.2);
  const Stripes stripes{StripeKind::isophotes, glm::normalize(Vec3(0.3, -0.8, 0.6)), {}, 8, 0.3};
  const Film film = picture(tracer, camera, size, iso::stripes(tracer, stripes, {camera, size, 1}), 1, 0);
  float darkest = 9, lightest = 0;
  for (const glm::vec4& p : film.rgba)
    if (p.a > 0) darkest = std::min(darkest, p.r), lightest = std::max(lightest, p.r);
  int inside = 0, outside = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Vec2 at = Vec2(x + 0.5 - 120, 120 - y - 0.5) * (2.2 / 240);
      if (glm::length(at) > 0.9) continue;  // beyond, a pixel is no small step
      const Vec3 n = at.x * camera.right + at.y * camera.up + std::sqrt(1 - glm::dot(at, at)) * camera.back;
      const double phase = 8 * glm::dot(n, stripes.axis), off = std::abs(phase - std::round(phase));
      const float red = film.rgba[static_cast<std::size_t>(y) * 240 + static_cast<std::size_t>(x)].r;
      // The phase in the window goes no farther than this: 1.02 pixels to each side, a step on the sphere grows by 1 / cosine; curved.
      const double window = 1.1 * 8 * 1.02 * (2.2 / 240) / glm::dot(n, camera.back);
      if (std::abs(off - 0.15) <= window) continue;
      EXPECT_EQ(red, off < 0.15 ? darkest : lightest) << x << " " << y;
      ++(off < 0.15 ? inside : outside);
    }
  EXPECT_GT(outside, 5000);
  EXPECT_GT(inside, 2000);
}

TEST(Stripes, ZebraOnAPlaneSeenInParallelIsUniform) {
  const Tracer tracer(one_face(Plane{}, {{-1, -1}, {1, 1}}));
  const ImageSize size{160, 120};
  int dark = 0, light = 0;
  for (const double height : {1.0, 1.5, 2.5, 4.0, 7.0}) {
    const Camera camera = orthographic({3, -4, height}, 3);
    for (const StripeKind kind : {StripeKind::zebra, StripeKind::reflection_lines}) {
      const Stripes stripes{kind, camera.right, camera.up, 16, 0.5};
      const Film film = picture(tracer, camera, size, iso::stripes(tracer, stripes, {camera, size, 1}), 1, 0);
      std::vector<float> seen;
      for (const glm::vec4& p : film.rgba)
        if (p.a > 0) seen.push_back(p.r);
      ASSERT_GT(seen.size(), 1000u);
      for (const float s : seen) ASSERT_EQ(s, seen.front());
      (seen.front() > 0.5f ? light : dark) += 1;
    }
  }
  EXPECT_GT(dark, 0);
  EXPECT_GT(light, 0);
}

// ---- pictures ----------------------------------------------------------------------------------------------------------

double apart(const Film& a, const Film& b) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (a.rgba[i].a < 1 || b.rgba[i].a < 1) continue;
    sum += std::pow(double(a.rgba[i].g) - double(b.rgba[i].g), 2);
    ++count;
  }
  EXPECT_GE(count, 3000);
  return std::sqrt(sum / count);
}

// One filtered sample against many points, in stripes of many and of few pixels.
TEST(Stripes, OneFilteredSampleIsNearManyAndFarBetterThanOnePoint) {
  const NurbsSurface wavy = wavy_torus(28, 12);
  const TraceScene scenes[] = {one_face(Torus{{}, 0.9, 0.35}, kTurns),
                               one_face(wavy, {{wavy.knots_u.front(), wavy.knots_v.front()}, {wavy.knots_u.back(), wavy.knots_v.back()}})};
  const ImageSize size{160, 120};
  const Camera camera = *look_at(Projection::perspective, {4, -5, 3}, Vec3(0.0), {0, 0, 1}, 20);
  int pictures = 0;
  for (const TraceScene& scene : scenes)
    for (const StripeKind kind : {StripeKind::zebra, StripeKind::reflection_lines, StripeKind::isophotes}) {
      const Tracer tracer(scene);
      const Stripes s{kind, camera.right, camera.up, 12, 0.4};
      const Integrator points = stripes(tracer, s, {camera, size, kPoints});
      const Film truth = picture(tracer, camera, size, points, 256, 1);
      const double sharp = apart(picture(tracer, camera, size, points, 1, 0), truth);
      const double one = apart(picture(tracer, camera, size, stripes(tracer, s, {camera, size, 1}), 1, 0), truth);
      const double many = apart(picture(tracer, camera, size, stripes(tracer, s, {camera, size, 64}), 64, stripe_spread(64)), truth);
      const double four = apart(picture(tracer, camera, size, stripes(tracer, s, {camera, size, 4}), 4, stripe_spread(4)), truth);
      fmt::print(
          "[ measured ] stripes {}: rms from 256 points: one point {:.4f}, one filtered {:.4f}, 4 filtered {:.4f}, 64 filtered {:.4f}\n",
          int(kind), sharp, one, four, many);
      EXPECT_LT(one, 0.35 * sharp);
      EXPECT_LT(four, 0.35 * sharp);
      EXPECT_LT(many, 0.1 * sharp);
      ++pictures;
    }
  EXPECT_EQ(pictures, 6);
}

TEST(Stripes, SmoothMeshesLookLikeTheirSurfaceAndFlatOnesLikeTheirFacets) {
  const ImageSize size{120, 120};
  const Camera camera = orthographic({4, -5, 3}, 2.2);
  const Stripes s{StripeKind::zebra, camera.right, camera.up, 8, 0.5};
  TraceScene scene = sphere_by_grid(128, 64);
  const auto seen = [&](const TraceScene& what) {
    const Tracer tracer(what);
    return picture(tracer, camera, size, stripes(tracer, s, {camera, size, 1}), 1, 0);
  };
  EXPECT_LT(apart(seen(scene), seen(exact(scene))), 0.03);
  scene.mesh_shading = MeshShading::flat;
  const Tracer flat(scene);
  int facets = 0;
  for (const Ray& ray : random_rays(kSeed, 1000)) {
    const Hit hit = hit_by(flat, ray);
    if (!hit) continue;
    EXPECT_EQ(phase_of(s, seen_normal(flat, ray, hit, {.o_x = {1, 0, 0}, .o_y = {0, 1, 0}})).per_pixel, 0);
    ++facets;
  }
  EXPECT_GT(facets, 300);
}

// ---- G0, G1, G2 --------------------------------------------------------------------------------------------------------

// The phases a hair to the left and to the right of x = 0, seen along a line of sight that is the same for both.
struct Step {
  StripePhase left, right;
};
Step step_at(const TraceScene& scene, StripeKind kind) {
  const Tracer tracer(scene);
  const Camera camera = orthographic({1, -2, 4}, 3);
  const ImageSize size{300, 300};
  const Vec3 axis = glm::normalize(Vec3(1, 1.5, 0.3));
  const Stripes stripes{kind, axis, any_perpendicular(axis), 12, 0.5};
  const auto phase = [&](double x) {
    const Ray ray{Vec3(x, 0.1, 0) + 5.0 * camera.back, -camera.back};
    const Hit hit = hit_by(tracer, ray);
    EXPECT_TRUE(hit);
    return phase_of(stripes, seen_normal(tracer, ray, hit, ray_differential(camera, size, ray)));
  };
  return {phase(-1e-7), phase(1e-7)};
}

TEST(Stripes, JumpAtSharpEdgesAndKinkWhereOnlyCurvatureJumps) {
  const Face flat = face_of(Plane{{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {{-1, -1}, {1, 1}});
  // Beside it a plane that goes down, and a cylinder of radius 1 about the y axis that touches the plane where it begins.
  const Vec3 down = glm::normalize(Vec3(1, 0, -0.4));
  const Face slope = face_of(Plane{{{0, 0, 0}, down, {0, 1, 0}, glm::cross(down, Vec3(0, 1, 0))}}, {{0, -1}, {1, 1}});
  const Face round = face_of(Cylinder{{{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, 1}, {{0, -1}, {1, 1}});
  for (const StripeKind kind : {StripeKind::zebra, StripeKind::reflection_lines, StripeKind::isophotes}) {
    const Step sharp = step_at(scene_of({flat, slope}), kind), tangent = step_at(scene_of({flat, round}), kind);
    EXPECT_GT(std::abs(sharp.left.at - sharp.right.at), 0.2) << int(kind);
    EXPECT_LT(std::abs(tangent.left.at - tangent.right.at), 1e-5) << int(kind);
    EXPECT_EQ(tangent.left.per_pixel, 0) << int(kind);
    EXPECT_GT(tangent.right.per_pixel, 0.01) << int(kind);
  }

  // Across the patches of a surface with continuous curvature they do neither.
  const NurbsSurface wavy = wavy_torus(28, 12);
  const Tracer tracer(one_face(wavy, {{wavy.knots_u.front(), wavy.knots_v.front()}, {wavy.knots_u.back(), wavy.knots_v.back()}}));
  Tally tally("patch borders", kSeed);
  for (int u = 1; u < 28; ++u) {
    const UV at{double(u), 0.3 + 0.4 * u};
    const auto phase = [&](double shift) {
      const Hit hit{.t = 1, .uv = at + UV(shift, 0), .placed = 0, .face = 0};
      const SurfacePoint p = tracer.surface_point(hit);
      const Vec3 d = glm::normalize(Vec3(-0.3, 0.5, -0.8));
      return phase_of({StripeKind::zebra, {1, 0, 0}, {0, 1, 0}, 12, 0.5},
                      seen_normal(tracer, {p.p - d, d}, hit, {.o_x = any_perpendicular(d), .o_y = glm::cross(d, any_perpendicular(d))}));
    };
    const StripePhase left = phase(-1e-9), right = phase(1e-9);
    tally.within(std::abs(left.at - right.at), 1e-6, [&] { return fmt::format("a jump at u = {}", u); });
    tally.within(std::abs(left.per_pixel - right.per_pixel), 1e-5 * (1 + left.per_pixel),
                 [&] { return fmt::format("a kink at u = {}", u); });
  }
  tally.finish(54);
}

}  // namespace
}  // namespace iso::test
