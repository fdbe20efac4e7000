// The pictures of a comparison: equal tracers differ nowhere, a mesh inside its sphere only where it must, numbers are painted as they are.
#include <tbb/task_arena.h>

#include <numeric>

#include "raytracer/cmd/compare_pictures.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/paths.h"
#include "tests/support/tally.h"

namespace iso::test {
namespace {

constexpr ImageSize kSize{96, 96};

// Down on the unit sphere about the origin.
PictureSettings from_above(const Vec3& at = Vec3(0.0)) {
  PictureSettings settings;
  settings.camera = *look_at(Projection::orthographic, at + Vec3(0, 0, 5), at, {0, 1, 0}, 2.4);
  settings.size = kSize;
  settings.samples = 8;
  return settings;
}

struct Made {
  DirectPicture direct;
  MeshPictures mesh;

  const PictureFile& file(const std::string& key) const {
    for (const PictureFile& f : mesh.files)
      if (f.picture.key == key) return f;
    ADD_FAILURE() << "no picture " << key;
    return mesh.files.front();
  }
};

Made pictures(const TraceScene& exact_scene, const TraceScene& mesh_scene, const PictureSettings& settings,
              const SurfaceField& deviation = {}, const SurfaceField& angle = {}) {
  const Tracer exact(exact_scene), mesh(mesh_scene);
  const std::atomic<bool> stop = false;
  double last = 0;
  const PictureProgress progress{stop, [&](double share) { last = std::max(last, share); }};
  auto direct = picture_direct(exact, settings, progress);
  EXPECT_TRUE(direct);
  auto made = pictures_of({&mesh, "m", true, deviation, angle}, exact, *direct, settings, progress);
  EXPECT_TRUE(made);
  EXPECT_EQ(last, 1.0);
  return {std::move(*direct), std::move(*made)};
}

// The picture as a screen shows it.
Image decoded(const PictureFile& file) {
  const TemporaryDir dir;
  const std::string path = dir.path() / "p.png";
  std::FILE* out = std::fopen(path.c_str(), "wb");
  EXPECT_EQ(std::fwrite(file.picture.png.data(), 1, file.picture.png.size(), out), file.picture.png.size());
  std::fclose(out);
  auto image = read_image(path);
  EXPECT_TRUE(image);
  EXPECT_EQ(image->width, kSize.width);
  EXPECT_EQ(image->height, kSize.height);
  return std::move(*image);
}

std::size_t count_of(const Image& image, const glm::vec4& colour) {
  return static_cast<std::size_t>(std::count_if(image.rgba.begin(), image.rgba.end(), [&](const glm::vec4& p) {
    return glm::all(glm::lessThan(glm::abs(p - colour), glm::vec4(1.0f / 255)));
  }));
}

TEST(ComparePictures, EqualTracersDifferNowhere) {
  const TraceScene scene = exact(sphere_by_octahedron(0));
  const Made made = pictures(scene, scene, from_above());
  const ReportImages& images = made.mesh.images;
  EXPECT_EQ(images.difference.max, 0);
  EXPECT_EQ(images.difference.differ, 0u);
  EXPECT_EQ(images.difference.psnr, kInf);
  EXPECT_EQ(images.flip_ldr, 0);
  EXPECT_EQ(images.silhouette_pixels, 0u);
  const Image difference = decoded(made.file("difference")), outline = decoded(made.file("silhouette"));
  EXPECT_EQ(count_of(difference, glm::vec4(128.0f / 255, 128.0f / 255, 128.0f / 255, 1.0f)), difference.rgba.size());
  const std::size_t both = count_of(outline, glm::vec4(silhouette_legend().colours[2], 1.0f));
  EXPECT_EQ(both + count_of(outline, glm::vec4(0.0f)), outline.rgba.size());
  EXPECT_NEAR(double(both), kPi * 40 * 40, 100);  // a pixel is 2.4 / 96 wide
}

TEST(ComparePictures, AMeshInsideItsSphereIsMissedAtTheSilhouetteOnly) {
  const TraceScene mesh = sphere_by_octahedron(1);
  PictureSettings settings = from_above();
  settings.background.kind = BackgroundKind::sky;
  const Made made = pictures(exact(mesh), mesh, settings);
  const ReportLegend legend = silhouette_legend();
  const Image outline = decoded(made.file("silhouette"));
  EXPECT_EQ(count_of(outline, glm::vec4(legend.colours[0], 1.0f)), made.mesh.images.silhouette_pixels);
  EXPECT_EQ(count_of(outline, glm::vec4(legend.colours[1], 1.0f)), 0u);
  // Seen from above the mesh is the octagon in the circle: 2.828 of 3.142.
  const double missing = (kPi - 2 * std::sqrt(2.0)) * 40 * 40;
  EXPECT_NEAR(double(made.mesh.images.silhouette_pixels), missing, 0.1 * missing);
  EXPECT_GT(made.mesh.images.difference.max, 0.1);
  EXPECT_LT(made.mesh.images.difference.psnr, 40);
  EXPECT_GT(made.mesh.images.flip_ldr, 0);
  // The sky lies under both pictures, and pixels of nothing but sky are equal.
  EXPECT_LT(made.mesh.images.difference.differ, 60u * 96u);
  for (const glm::vec4& p : made.direct.seen.rgba) ASSERT_NEAR(p.a, 1, 1e-6);
}

TEST(ComparePictures, FieldsArePaintedAsTheyAre) {
  const TraceScene scene = exact(sphere_by_octahedron(0));
  PictureSettings settings = from_above();
  settings.unit = "mm";
  settings.deviation_scale = 1.0;
  const auto across = [](const Point3& p, const Vec3&, std::int32_t placed, std::int32_t face) {
    EXPECT_EQ(placed, 0);
    EXPECT_EQ(face, 0);
    EXPECT_NEAR(glm::length(p), 1, 1e-14) << "the point is exact";
    return p.x < 0 ? std::nan("") : std::hypot(p.x, p.y);
  };
  const Made made = pictures(scene, scene, settings, across,
                             [](const Point3& p, const Vec3&, int, int) { return std::acos(std::clamp(p.z, -1.0, 1.0)); });
  const Image image = decoded(made.file("deviation"));
  const ReportLegend& legend = *made.file("deviation").picture.legend;
  EXPECT_EQ(legend.hi, 1);
  EXPECT_EQ(legend.unit, "mm");
  Tally tally("pixels");
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const Vec2 at = (Vec2(x, y) + 0.5 - 48.0) / 40.0;
      const glm::vec4& p = image.rgba[static_cast<std::size_t>(y * kSize.width + x)];
      const double r = glm::length(at);
      if (std::abs(r - 1) < 0.08 || std::abs(at.x) < 0.08) continue;
      const glm::vec4 expected = r > 1 ? glm::vec4(0.0f) : glm::vec4(scale_colour(legend, at.x < 0 ? std::nan("") : r), 1.0f);
      // Four samples within the filter: a pixel and a half of the scale.
      tally.within(glm::length(p - expected), 0.05, [&] { return fmt::format("pixel {} {}", x, y); });
    }
  tally.finish_at_least(7000);
  const ReportLegend& angle = *made.file("normals").picture.legend;
  EXPECT_EQ(angle.unit, "degrees");
  EXPECT_GT(angle.hi, 70);
  EXPECT_LE(angle.hi, 90);
  EXPECT_NE(made.file("deviation").exr.find("deviation"), std::string::npos) << "the numbers are in the file too";
}

TEST(ComparePictures, ForeignMeshesAreMetLikeOursAndHaveTheNormalsOfTheirTriangles) {
  const TraceScene ours = sphere_by_octahedron(3);
  const Vec3 far{1e5, -2e5, 3e4};
  ForeignMesh foreign;
  foreign.file = "theirs.stl";
  for (const Point3& p : ours.placed[0].mesh->points) foreign.points.push_back(p + far);
  foreign.triangles = ours.placed[0].mesh->triangles;  // the octahedron has a node a point
  TraceScene scene;
  scene.placed.push_back(placed_foreign(foreign));
  const Tracer tracer(scene), reference(ours);
  EXPECT_LT(glm::length(scene.box().lo - (far - 1.0)), 1e-9);
  std::vector<Ray> rays = random_rays(11, 20000), moved = rays;
  for (Ray& ray : moved) ray.o += far;
  const std::vector<Hit> hits = nearest(tracer, moved), expected = nearest(reference, rays);
  Tally tally("hits", 11);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i] || !expected[i]) {
      tally.check(bool(hits[i]) == bool(expected[i]) || glm::length(glm::cross(rays[i].o, rays[i].d)) > 0.9, [] { return "a miss"; });
      continue;
    }
    const SurfacePoint at = tracer.surface_point(hits[i]);
    tally.within(std::abs(hits[i].t - expected[i].t), 1e-7, [] { return "distance"; });
    tally.check(glm::length(at.n - at.ng) < 1e-14 && hits[i].face == 0, [] { return "a normal of the triangle"; });
  }
  tally.finish_at_least(20000);
  EXPECT_EQ(Tracer({{placed_foreign({})}}).build_stats().triangles, 0u) << "a mesh without triangles is nothing";
}

TEST(ComparePictures, FacetsShowEdgesWhereTheyAreLegible) {
  const auto darkest = [](int levels) {
    const TraceScene mesh = sphere_by_octahedron(levels);
    const Made made = pictures(exact(mesh), mesh, from_above());
    const Image image = decoded(made.file("facets"));
    // Near the middle, where facets face the eye.
    float least = 1;
    for (int y = 40; y < 56; ++y)
      for (int x = 40; x < 56; ++x) least = std::min(least, image.rgba[static_cast<std::size_t>(y * kSize.width + x)].g);
    return least;
  };
  const float edges = darkest(1), fine = darkest(6);
  EXPECT_LT(edges, 0.7f);
  EXPECT_GT(fine, edges + 0.05f);
}

TEST(ComparePictures, AreTheSameForAnyNumberOfThreadsAndEndWhenToldTo) {
  const TraceScene mesh = sphere_by_octahedron(2);
  const auto field = [](const Point3& p, const Vec3&, int, int) { return p.z; };
  Made one, two;
  tbb::task_arena(1).execute([&] { one = pictures(exact(mesh), mesh, from_above(), field); });
  tbb::task_arena(2).execute([&] { two = pictures(exact(mesh), mesh, from_above(), field); });
  ASSERT_EQ(one.mesh.files.size(), 5u);
  for (std::size_t i = 0; i < one.mesh.files.size(); ++i) {
    EXPECT_EQ(one.mesh.files[i].exr, two.mesh.files[i].exr);
    EXPECT_EQ(one.mesh.files[i].picture.png, two.mesh.files[i].picture.png);
    EXPECT_EQ(one.mesh.files[i].picture.file, "m-" + one.mesh.files[i].picture.key + ".exr");
  }
  const std::atomic<bool> stop = true;
  const auto stopped = picture_direct(Tracer(exact(mesh)), from_above(), {stop, {}});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, Exit::interrupted);
}

TEST(ComparePictures, TheScaleIsEvenAndHoldsItsEnds) {
  const ReportLegend legend{"", "", 1, 3, even_scale()};
  EXPECT_EQ(scale_colour(legend, -kInf), legend.colours.front());
  EXPECT_EQ(scale_colour(legend, 7), legend.colours.back());
  EXPECT_LT(glm::length(scale_colour(legend, 2) - legend.colours[8]), 1e-6);
  // Brightness rises all along.
  float last = -1;
  for (double x = 1; x <= 3; x += 0.01) {
    const float bright = glm::dot(scale_colour(legend, x), Colour(0.2126f, 0.7152f, 0.0722f));
    EXPECT_GT(bright, last);
    last = bright;
  }
}

}  // namespace
}  // namespace iso::test
