#include "raytracer/cmd/compare_pictures.h"

#include <fmt/format.h>

#include <algorithm>

#include "raytracer/difference_pictures.h"
#include "raytracer/display_transform.h"
#include "raytracer/exr_writer.h"
#include "raytracer/srgb.h"

namespace iso {
namespace {

// Light that a display-encoded picture stands for, premultiplied.
Image linear_of(Image image) {
  for (glm::vec4& p : image.rgba) p = glm::vec4(p.a * glm::vec3(linear_from_srgb(p.r), linear_from_srgb(p.g), linear_from_srgb(p.b)), p.a);
  return image;
}

Image over_background(const Image& bare, const Background& background) {
  Image seen = bare;
  seen.has_alpha = background.kind == BackgroundKind::transparent;
  const auto width = static_cast<std::size_t>(bare.width);
  for (std::size_t i = 0; i < seen.rgba.size(); ++i) {
    const double y = (static_cast<double>(i / width) + 0.5) / bare.height;
    seen.rgba[i] += (1 - seen.rgba[i].a) * background_at(background, y);
  }
  return seen;
}

// All pictures of one call: what they share, and how far they are.
class Pictures {
 public:
  Pictures(const PictureSettings& settings, const PictureProgress& progress, int films)
      : settings_(settings), progress_(progress), films_(films) {}

  Result<Film> film(const Tracer& tracer, const Integrator& integrator, const Sampler& sampler, int samples, unsigned aovs) {
    const RenderSettings request{settings_.size, samples, settings_.seed, aovs, {}};
    const auto tell = [this](int done, int all) {
      if (progress_.done) progress_.done((films_done_ + static_cast<double>(done) / all) / films_);
    };
    RenderResult result = render(tracer, settings_.camera, integrator, sampler, request, progress_.stop, tell);
    ++films_done_;
    if (!result.complete()) return Error{Exit::interrupted, {}, {}, "interrupted while the pictures were made"};
    return std::move(result.film);
  }
  // As the look lights it, with all layers.
  Result<Film> lit(const Tracer& tracer) {
    const Sampler sampler(settings_.seed, settings_.samples);
    return film(tracer, settings_.look(tracer, settings_.camera, sampler), sampler, settings_.samples, kAovAll);
  }
  Result<Film> painted(const Tracer& tracer, const Integrator& integrator, int samples) {
    return film(tracer, integrator, Sampler(settings_.seed, samples), samples, kAovNone);
  }

  Image image_of(const Film& film) const { return {settings_.size.width, settings_.size.height, true, film.rgba}; }

  Result<PictureFile> file(const std::string& name, ReportPicture picture, const Image& shown, Film film, const std::string& mode) const {
    const auto png = encode_png(shown);
    if (!png) return png.error();
    ImageInfo info;
    info.version = settings_.version;
    info.mode = mode;
    info.shade = picture.key;
    info.units = settings_.unit;
    info.comments = picture.title;
    info.seed = settings_.seed;
    info.samples = settings_.samples;
    info.world_to_camera = world_to_camera(settings_.camera);
    const auto exr = encode_exr(film, info, settings_.threads);
    if (!exr) return exr.error();
    picture.file = (name.empty() ? "" : name + "-") + picture.key + ".exr";
    picture.png = *png;
    return PictureFile{std::move(picture), *exr};
  }
  // A picture that is lit: its film with the background under it.
  Result<PictureFile> lit_file(const std::string& name, ReportPicture picture, const Image& seen, Film film,
                               const std::string& mode) const {
    Image shown = seen;
    if (const auto applied = apply_display(shown, {}); !applied) return applied.error();
    film.rgba = seen.rgba;
    return file(name, std::move(picture), shown, std::move(film), mode);
  }
  // A picture made for the screen; `plane`: the numbers behind its colours.
  Result<PictureFile> drawn_file(const std::string& name, ReportPicture picture, const Image& shown, NamedPlane plane = {}) const {
    Film film(settings_.size, kAovNone);
    film.rgba = linear_of(shown).rgba;
    if (!plane.values.empty()) film.planes.push_back(std::move(plane));
    return file(name, std::move(picture), shown, std::move(film), "comparison");
  }

 private:
  const PictureSettings& settings_;
  const PictureProgress& progress_;
  int films_, films_done_ = 0;
};

// Zero if nothing is known.
double largest_of(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values)
    if (value > largest) largest = value;
  return largest;
}

struct FieldToPaint {
  const char *key, *title, *plane;
  const SurfaceField& field;
  std::string unit;
  double factor;  // from the field's unit to the one that is shown
  std::optional<double> scale;
  std::optional<ReportLegend> legend = {};  // in place of one from 0 to `scale`
};

Result<PictureFile> field_file(Pictures& pictures, const std::string& name, const Tracer& exact, const FieldToPaint& what, int samples) {
  const auto film = pictures.painted(exact, painted_field(exact, what.field), samples);
  if (!film) return film.error();
  std::vector<double> values = field_values(*film);
  NamedPlane plane{what.plane, {}};
  for (double& value : values) plane.values.push_back(static_cast<float>(value *= what.factor));
  ReportLegend legend{what.key, what.unit, 0, largest_of(values), even_scale()};
  if (what.scale) legend.hi = what.factor * *what.scale;
  if (what.legend) legend = *what.legend;
  bool unknown = false;
  for (std::size_t i = 0; i < values.size(); ++i) unknown = unknown || (std::isnan(values[i]) && film->rgba[i].a > 0);
  ReportPicture picture{what.key, what.title + std::string(unknown ? "; grey: not known" : ""), {}, {}, std::move(legend)};
  const Image shown = scale_picture(values, pictures.image_of(*film), *picture.legend);
  return pictures.drawn_file(name, std::move(picture), shown, std::move(plane));
}

ReportImages images_of(const DirectPicture& direct, const Image& bare, const Image& seen) {
  ReportImages images;
  images.difference = difference_of(direct.seen, seen);
  images.flip_ldr = flip_ldr(direct.seen, seen).mean;
  images.flip_hdr = flip_hdr(direct.seen, seen).mean;
  images.silhouette_pixels = silhouette_difference(direct.bare, bare);
  return images;
}

Result<PictureFile> difference_file(const Pictures& pictures, const std::string& name, const Image& exact, const Image& mesh) {
  const DifferencePicture difference = difference_picture(exact, mesh);
  const double end = 0.5 / difference.gain;
  std::string title = "The mesh's picture less the exact one's";
  if (difference.gain > 1) title += fmt::format(", {} times as strong", difference.gain);
  ReportLegend legend{"difference", "of white", -end, end, {Colour(0.0f), Colour(1.0f)}};
  ReportPicture picture{"difference", title, {}, {}, std::move(legend)};
  auto file = pictures.drawn_file(name, std::move(picture), difference.picture);
  if (!file) return file.error();
  // The file has the raw differences, not the enlarged ones.
  auto raw = encode_difference(exact, mesh);
  if (!raw) return raw.error();
  file->exr = std::move(*raw);
  return file;
}

Result<PictureFile> silhouette_file(const Pictures& pictures, const std::string& name, const Image& exact, const Image& mesh) {
  ReportPicture picture{"silhouette", "Silhouettes", {}, {}, silhouette_legend()};
  return pictures.drawn_file(name, std::move(picture), silhouette_picture(exact, mesh));
}

Result<PictureFile> facets_file(Pictures& pictures, const MeshToShow& mesh, const PictureSettings& settings) {
  const auto film = pictures.painted(*mesh.tracer, facets(*mesh.tracer, settings.camera, settings.size), settings.samples);
  if (!film) return film.error();
  ReportPicture picture{"facets", "The triangles, lit from the eye", {}, {}};
  return pictures.lit_file(mesh.name, std::move(picture), pictures.image_of(*film), *film, "tessellated");
}

}  // namespace

Integrator clay_look(const Tracer& tracer, const Camera& camera, const Sampler& sampler) {
  return clay(tracer, default_lights(camera.right, camera.up, camera.back), sampler);
}

Placed placed_foreign(const ForeignMesh& foreign) {
  Box3 box;
  for (const Point3& p : foreign.points) box.include(p);
  // Held about its own middle, as parts are.
  const Point3 middle = foreign.points.empty() ? Point3(0.0) : box.middle();

  auto mesh = std::make_shared<PartMesh>();
  for (const Point3& p : foreign.points) {
    mesh->nodes.push_back({static_cast<std::uint32_t>(mesh->points.size()), UV(0.0), Vec3(0.0)});
    mesh->points.push_back(p - middle);
  }
  mesh->triangles = foreign.triangles;
  mesh->first_node.push_back(static_cast<std::uint32_t>(mesh->nodes.size()));
  mesh->first_triangle.push_back(static_cast<std::uint32_t>(mesh->triangles.size()));

  auto part = std::make_shared<Part>();
  Face face;
  face.domain = {UV(0.0), UV(1.0)};
  part->name = foreign.file;
  part->faces.push_back(std::move(face));
  part->box = box.empty() ? box : Box3{box.lo - middle, box.hi - middle};
  Placed placed;
  placed.part = std::move(part);
  placed.to_world.translation = middle;
  placed.name = foreign.file;
  placed.mesh = std::move(mesh);
  return placed;
}

void paint_evenly(TraceScene& scene) {
  constexpr Colour kNeutral{0.93f, 0.885f, 0.82f};
  for (Placed& placed : scene.placed) {
    placed.colour = kNeutral;
    placed.colour_overrides = true;
  }
}

Result<DirectPicture> picture_direct(const Tracer& exact, const PictureSettings& settings, const PictureProgress& progress) {
  Pictures pictures(settings, progress, 1);
  auto film = pictures.lit(exact);
  if (!film) return film.error();
  DirectPicture direct;
  direct.bare = pictures.image_of(*film);
  direct.seen = over_background(direct.bare, settings.background);
  auto file = pictures.lit_file({}, {"direct", "The exact surface", {}, {}}, direct.seen, std::move(*film), "direct");
  if (!file) return file.error();
  direct.file = std::move(*file);
  return direct;
}

Result<PictureFile> picture_curvature(const Tracer& exact, const PictureSettings& settings, const PictureProgress& progress) {
  Pictures pictures(settings, progress, 1);
  const auto film = pictures.painted(exact, painted_mean_curvature(exact), settings.painted_samples);
  if (!film) return film.error();
  const std::vector<double> values = field_values(*film);
  NamedPlane plane{"H", {}};
  std::vector<double> known;
  for (const double value : values) {
    plane.values.push_back(static_cast<float>(value));
    if (finite(value)) known.push_back(value);
  }
  std::sort(known.begin(), known.end());
  const std::size_t left_out = known.size() / 100;
  ReportLegend legend{"mean-curvature", "1/" + (settings.unit.empty() ? std::string("model unit") : settings.unit), 0, 0, even_scale()};
  if (!known.empty()) legend.lo = known[left_out], legend.hi = known[known.size() - 1 - left_out];
  ReportPicture picture{"mean-curvature", "Mean curvature, positive where the surface bends toward its outward normal", {}, {}, legend};
  const Image shown = scale_picture(values, pictures.image_of(*film), *picture.legend);
  return pictures.drawn_file({}, std::move(picture), shown, std::move(plane));
}

Result<MeshPictures> pictures_of(const MeshToShow& mesh, const Tracer& exact, const DirectPicture& direct, const PictureSettings& settings,
                                 const PictureProgress& progress) {
  Pictures pictures(settings, progress, 2 + bool(mesh.deviation) + bool(mesh.normal_error) + bool(mesh.curvature));
  MeshPictures result;
  const auto film = pictures.lit(*mesh.tracer);
  if (!film) return film.error();
  const Image bare = pictures.image_of(*film), seen = over_background(bare, settings.background);
  result.images = images_of(direct, bare, seen);

  // Each is made when the ones before could be.
  const char* title = mesh.smooth ? "The mesh, with normals of the surface" : "The mesh, with normals of its triangles";
  std::vector<std::function<Result<PictureFile>()>> steps{
      [&] {
        return pictures.lit_file(mesh.name, {"tessellated", title, {}, {}}, seen, *film, "tessellated");
      },
      [&] { return difference_file(pictures, mesh.name, direct.seen, seen); },
      [&] { return silhouette_file(pictures, mesh.name, direct.bare, bare); }};
  const std::string unit = settings.unit.empty() ? "model units" : settings.unit;
  const FieldToPaint distance{
      "deviation", "Distance of the mesh, on the exact surface", "deviation", mesh.deviation, unit, 1, settings.deviation_scale};
  const FieldToPaint angle{
      "normals", "Angle between the mesh and the exact surface", "angle", mesh.normal_error, "degrees", 180 / kPi, settings.normal_scale};
  const FieldToPaint curvature{
      "discrete-curvature", "Discrete mean curvature of the mesh, on the exact surface", "H", mesh.curvature, {}, 1, {},
      mesh.curvature_scale};
  for (const FieldToPaint* field : {&distance, &angle, &curvature})
    if (field->field) steps.push_back([&, field] { return field_file(pictures, mesh.name, exact, *field, settings.painted_samples); });
  steps.push_back([&] { return facets_file(pictures, mesh, settings); });
  for (const auto& step : steps) {
    auto file = step();
    if (!file) return file.error();
    result.files.push_back(std::move(*file));
  }
  return result;
}

}  // namespace iso
