// What shading is told of meshes: normals, sides, and where the rays start that leave them; and the pictures that come of it.
#include "raytracer/camera.h"
#include "raytracer/render.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20241122;
constexpr int kRays = 100000;

TEST(MeshShading, NormalsAreSmoothOrFlatAndPointOutwardInEveryInstance) {
  const Vec3 z = glm::normalize(Vec3(1, 2, 3)), x = any_perpendicular(z), y = glm::cross(z, x);
  const Affine3 placements[] = {{}, {Mat3(x, y, z), {5, 6, 7}}, {Mat3(x, -y, z), {-1, 0, 2}}, {3.0 * Mat3(-x, -y, -z), {0, 1, 0}}};
  Tally tally("normals", kSeed);
  for (const Affine3& placed : placements)
    for (const MeshShading shading : {MeshShading::smooth, MeshShading::flat}) {
      TraceScene scene = sphere_by_octahedron(2);
      scene.placed[0].to_world = placed;
      scene.mesh_shading = shading;
      const Tracer tracer(scene);
      const std::vector<Ray> rays = random_rays(kSeed + 5, 20000, 3, placed.translation);
      std::vector<Hit> hits = nearest(tracer, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i]) continue;
        const SurfacePoint at = tracer.surface_point(hits[i]);
        const Vec3 radial = glm::normalize(at.p - placed.translation);
        const Triangle& t = mesh_of(tracer).triangles[hits[i].primitive];
        const auto corner = [&](int k) { return placed.point(mesh_of(tracer).corner(t, k)); };
        const Vec3 facet = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        tally.check(glm::dot(at.ng, rays[i].d) < 0, [&] { return "the outside is met, but the triangle's normal says inside"; });
        tally.within(1 - std::abs(glm::dot(at.ng, facet)), 1e-13, [&] { return "the triangle's normal"; });
        const Vec3& expected = shading == MeshShading::flat ? at.ng : radial;
        tally.within(glm::length(at.n - expected), shading == MeshShading::flat ? 1e-15 : 0.03, [&] { return "the normal for shading"; });
        // The triangle's tangents, in the sense of the exact surface's.
        const double scale = glm::length(placed.vector({1, 0, 0})), cosine = std::cos(hits[i].uv.y);
        tally.within(std::abs(glm::dot(at.Su, at.ng)) + std::abs(glm::dot(at.Sv, at.ng)), 1e-13 * scale, [&] { return "tangents"; });
        const bool at_seam = mesh_of(tracer).nodes[t[0]].uv.x == 0 || mesh_of(tracer).nodes[t[1]].uv.x == 0 ||
                             mesh_of(tracer).nodes[t[2]].uv.x == 0 || cosine < 0.7;
        if (!at_seam) tally.within(std::abs(glm::length(at.Sv) / scale - 1), 0.15, [&] { return "length of Sv"; });
      }
    }
  tally.finish_at_least(8 * 20000);
}

// A node without a normal has its triangle's; normals that point into the material are not believed.
TEST(MeshShading, MissingAndWrongNormalsAreTheTriangles) {
  for (const double factor : {0.0, -1.0}) {
    TraceScene scene = sphere_by_octahedron(2);
    auto mesh = std::make_shared<PartMesh>(*scene.placed[0].mesh);
    for (MeshNode& node : mesh->nodes) node.normal *= factor;
    scene.placed[0].mesh = mesh;
    const Tracer tracer(scene);
    const std::vector<Ray> rays = random_rays(kSeed + 6, 5000);
    for (const Hit& hit : nearest(tracer, rays)) {
      if (!hit) continue;
      const SurfacePoint at = tracer.surface_point(hit);
      EXPECT_LT(glm::length(at.n - at.ng), 1e-14);
    }
  }
}

// ---- secondary rays ----------------------------------------------------------------------------------------------------

TEST(MeshShading, RaysThatLeaveAMeshDoNotMeetTheTriangleTheyLeave) {
  const struct {
    double scale;
    Vec3 at;
  } wheres[] = {{1e-6, Vec3(0.0)}, {1.0, Vec3(0.0)}, {1e4, Vec3(0.0)}, {1.0, {7e6, -3e6, 1e3}}, {1e-3, {1e3, 2e3, 0}}};
  for (const auto& where : wheres)
    for (const MeshShading shading : {MeshShading::smooth, MeshShading::flat}) {
      TraceScene scene = sphere_by_octahedron(5);
      scene.mesh_shading = shading;
      scene.placed[0].to_world = Affine3{Mat3(where.scale), where.at};
      const Tracer tracer(scene);
      // Starts anywhere, and some exactly on edges and corners: what leaves those inward may graze the neighbour.
      std::vector<Ray> rays = random_rays(kSeed + 7, kRays, where.scale, where.at), out, in;
      std::size_t anywhere = 0;
      for (const Ray& ray : rays_at_edges(mesh_of(tracer), kSeed, 20000)) rays.push_back({where.at + where.scale * ray.o, ray.d});
      std::mt19937_64 random(kSeed);
      const std::vector<Hit> hits = nearest(tracer, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit& hit = hits[i];
        if (i == kRays) anywhere = out.size();
        if (!hit) continue;
        const SurfacePoint at = tracer.surface_point(hit);
        Vec3 d = random_direction(random);
        if (glm::dot(d, at.ng) < 0) d = -d;
        out.push_back(secondary_ray(hit, at, d));
        in.push_back(secondary_ray(hit, at, -d));
      }
      std::size_t acne = 0, leaks = 0;
      for (const std::uint8_t blocked : occluded(tracer, out)) acne += blocked;
      const std::vector<std::uint8_t> met = occluded(tracer, in);
      for (std::size_t i = 0; i < anywhere; ++i) leaks += !met[i];
      EXPECT_GE(anywhere, 60000u);
      EXPECT_GE(out.size(), anywhere + 15000);
      EXPECT_EQ(acne, 0u) << "at scale " << where.scale << " at x = " << where.at.x;
      EXPECT_EQ(leaks, 0u) << "at scale " << where.scale << " at x = " << where.at.x;
    }
}

// Of the points of a coarse sphere that are lit by their normals, the share that the facets keep in the dark.
double dark_share(Terminator terminator) {
  TraceScene scene = sphere_by_grid(16, 8);
  scene.terminator = terminator;
  const Tracer tracer(scene);
  const Vec3 light = glm::normalize(Vec3(1, -2, 1.5));
  std::vector<Ray> shadow;
  std::size_t dark = 0;
  for (const Hit& hit : nearest(tracer, random_rays(kSeed + 8, kRays))) {
    if (!hit) continue;
    const SurfacePoint at = tracer.surface_point(hit);
    if (glm::dot(at.n, light) <= 0) continue;
    if (glm::dot(at.side, light) < 0)
      ++dark;
    else
      shadow.push_back(secondary_ray(hit, at, light));
  }
  const double lit = static_cast<double>(shadow.size() + dark);
  for (const std::uint8_t blocked : occluded(tracer, shadow)) dark += blocked;
  EXPECT_GE(lit, 20000);
  return static_cast<double>(dark) / lit;
}

TEST(MeshShading, ASoftTerminatorLightsTheFacetsThatTheNormalsLight) {
  const double faceted = dark_share(Terminator::faceted), softened = dark_share(Terminator::softened);
  fmt::print("[ measured ] dark among the points lit by their normals: {:.4f} faceted, {:.4f} softened\n", faceted, softened);
  EXPECT_GE(faceted, 0.04);
  EXPECT_LE(softened, 0.002);
}

// Seen from the hollow side of a bowl, directions above the normal's horizon but under the triangle do not come through.
TEST(MeshShading, NothingLeaksThroughATriangleBelowItsHorizon) {
  for (const Terminator terminator : {Terminator::faceted, Terminator::softened}) {
    TraceScene scene = sphere_by_grid(16, 4, 0.0);
    scene.terminator = terminator;
    const Tracer tracer(scene);
    std::mt19937_64 random(kSeed);
    std::vector<Ray> into, under;
    for (int i = 0; i < kRays; ++i) {
      const Vec3 d = random_direction(random);
      into.push_back({{0, 0, -0.2}, d});
    }
    std::size_t told = 0;
    const std::vector<Hit> hits = nearest(tracer, into);
    for (std::size_t i = 0; i < into.size(); ++i) {
      if (!hits[i]) continue;
      const SurfacePoint at = tracer.surface_point(hits[i]);
      ASSERT_GT(glm::dot(at.ng, into[i].d), 0);
      // Between the two horizons, if they part.
      const Vec3 across = at.n - glm::dot(at.n, at.ng) * at.ng;
      if (glm::length(across) < 1e-3) continue;
      const Vec3 d = glm::normalize(-glm::normalize(across) + 0.5 * glm::length(across) * at.ng);
      if (!(glm::dot(at.n, d) < 0 && glm::dot(at.ng, d) > 0)) continue;
      if (glm::dot(at.side, d) > 0)
        ++told;  // shading is told that the direction is on the other side
      else
        under.push_back(secondary_ray(hits[i], at, d));
    }
    EXPECT_GE(told + under.size(), 30000u);
    EXPECT_EQ(told == 0, terminator == Terminator::softened);
    std::size_t leaks = 0;
    for (const std::uint8_t blocked : occluded(tracer, under)) leaks += !blocked;
    EXPECT_EQ(leaks, 0u) << "of " << under.size();
  }
}

// ---- pictures ----------------------------------------------------------------------------------------------------------

Film picture(const TraceScene& scene, Shade shade) {
  const Tracer tracer(scene);
  const ImageSize size{96, 96};
  const Camera camera = *look_at(Projection::perspective, {4, -5, 3}, Vec3(0.0), {0, 0, 1}, 20);
  const Sampler sampler(1, 16);
  const Lights lights = default_lights(camera.right, camera.up, camera.back);
  const Integrator integrator =
      shade == Shade::clay ? clay(tracer, lights, sampler) : inspection(tracer, shade, {-camera.back, camera.position, {1, 9}});
  const std::atomic<bool> stop = false;
  return render(tracer, camera, integrator, sampler, {size, 16, 1, kAovNone, {}}, stop, [](int, int) {}).film;
}

// Root mean square over the pixels that both pictures cover.
double apart(const Film& a, const Film& b) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x);
      const glm::vec4 p = a.rgba[i], q = b.rgba[i];
      if (p.a < 1 || q.a < 1) continue;
      const glm::vec3 d = glm::vec3(p) - glm::vec3(q);
      sum += glm::dot(d, d) / 3;
      ++count;
    }
  EXPECT_GE(count, 3000);
  return std::sqrt(sum / count);
}

TEST(MeshShading, PicturesOfMeshesComeNearTheExactOnes) {
  TraceScene coarse = sphere_by_grid(24, 12), soft = coarse, flat = coarse;
  soft.terminator = Terminator::softened;
  flat.mesh_shading = MeshShading::flat;
  const TraceScene fine = sphere_by_grid(256, 128);
  const Film truth = picture(exact(coarse), Shade::clay);
  const double off_coarse = apart(picture(coarse, Shade::clay), truth), off_soft = apart(picture(soft, Shade::clay), truth),
               off_flat = apart(picture(flat, Shade::clay), truth), off_fine = apart(picture(fine, Shade::clay), truth);
  fmt::print("[ measured ] clay, rms from the exact picture: coarse {:.4f}, softened {:.4f}, flat {:.4f}, fine {:.4f}\n", off_coarse,
             off_soft, off_flat, off_fine);
  EXPECT_LT(off_soft, 0.7 * off_coarse);
  EXPECT_LT(off_coarse, off_flat);
  EXPECT_LT(off_fine, 0.3 * off_coarse);
  for (const Shade shade : {Shade::uv, Shade::faces, Shade::kinds, Shade::curvature, Shade::normals, Shade::depth})
    EXPECT_LT(apart(picture(fine, shade), picture(exact(fine), shade)), 0.01) << kShadeNames[static_cast<std::size_t>(shade)];
}

}  // namespace
}  // namespace iso::test
