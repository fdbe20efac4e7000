#include "raytracer/cmd/golden.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "patches/files/output_file.h"
#include "raytracer/cmd/load_models.h"
#include "raytracer/cmd/scene_view.h"
#include "raytracer/difference_pictures.h"

namespace iso {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr ImageSize kGoldenSize{160, 120};
constexpr int kGoldenSamples = 16;
constexpr int kGoldenSeeds = 16;
constexpr const char* kTestNames[] = {"exact", "noise"};

struct Judging {
  GoldenTest test;
  GoldenLimits limits;
  const char* reason;
};
const Judging& judging_for(Shade shade) {
  static const Judging kNoise{
      GoldenTest::noise,
      {4, 0.2, 8, 5.5},
      "z as in raytracer/picture_noise.h. 140 pictures with other seeds, 20 of each noisy scene of the gallery, had z up to "
      "5.84, up to 0.037 % of the pixels beyond 4, and blocks up to 4.22."};
  static const Judging kSolver{
      GoldenTest::exact,
      {0x1p-10, 5, 0.07, 0},
      "The same seed gives the same picture but for rounding. What is shown is the number of Newton steps, which differs "
      "between instruction sets with and without fused multiplication: 3.1 % of the pixels by more than 2^-10, none by "
      "more than 0.057. One of 16 samples may also fall to the other side of an edge: 0.07."};
  static const Judging kExact{
      GoldenTest::exact,
      {0x1p-10, 0.1, 0.07, 0},
      "The same seed gives the same picture but for rounding: 2^-10 is two steps of a half near 1; AVX-512, AVX2, SSE4 "
      "and SSSE3 were within a quarter of it. One of 16 samples may fall to the other side of an edge: 0.07."};
  return shade == Shade::clay ? kNoise : shade == Shade::solver ? kSolver : kExact;
}

std::string file_in(const GoldenPlace& place, const char* name) { return (fs::path(place.folder) / name).string(); }

Golden new_golden(const SceneEntry& scene) {
  const Judging& judging = judging_for(scene.shade);
  Golden golden;
  golden.size = kGoldenSize;
  golden.samples = kGoldenSamples;
  golden.seed = scene.seed;
  golden.test = judging.test;
  golden.seeds = judging.test == GoldenTest::noise ? kGoldenSeeds : 1;
  golden.limits = judging.limits;
  golden.reason = judging.reason;
  return golden;
}

std::string to_json(const Golden& golden, const std::string& name) {
  Json json{{"scene", name}, {"why", golden.why}};
  json["command"] = fmt::format("isophote render scenes/{}.json --size {}x{} --samples {} --seed {} --aov none -o {}.exr", name,
                                golden.size.width, golden.size.height, golden.samples, golden.seed, name);
  json["width"] = golden.size.width;
  json["height"] = golden.size.height;
  json["samples"] = golden.samples;
  json["seed"] = golden.seed;
  json["seeds"] = golden.seeds;
  json["test"] = kTestNames[static_cast<std::size_t>(golden.test)];
  json["soft"] = golden.limits.soft;
  json["percent"] = golden.limits.percent;
  json["hard"] = golden.limits.hard;
  if (golden.test == GoldenTest::noise) json["block"] = golden.limits.block;
  json["reason"] = golden.reason;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<Golden> golden_from_json(const std::string& text, const std::string& path) {
  try {
    const Json json = Json::parse(text);
    Golden golden;
    golden.why = json.at("why");
    golden.reason = json.at("reason");
    golden.size = {json.at("width"), json.at("height")};
    golden.samples = json.at("samples");
    golden.seed = json.at("seed");
    golden.seeds = json.at("seeds");
    const std::string test = json.at("test");
    golden.test = test == kTestNames[1] ? GoldenTest::noise : GoldenTest::exact;
    golden.limits = {json.at("soft"), json.at("percent"), json.at("hard"), json.value("block", 0.0)};
    const bool sane = golden.size.width > 0 && golden.size.height > 0 && golden.samples > 0 && golden.samples <= kMaxSamples;
    if (!sane || golden.seeds < (golden.test == GoldenTest::noise ? 2 : 1) || (test != kTestNames[0] && test != kTestNames[1]))
      return bad_input(path, {}, "found a size, samples, seeds or test that no golden has; `compare --accept` makes it anew");
    return golden;
  } catch (const nlohmann::json::exception& e) {
    return bad_input(path, {}, e.what());
  }
}

Result<Image> read_golden_image(const GoldenPlace& place, const char* name, const ImageSize& size) {
  auto image = read_image(file_in(place, name));
  if (image && (image->width != size.width || image->height != size.height))
    return bad_input(file_in(place, name), {},
                     fmt::format("{} x {} pixels; expected {} x {}", image->width, image->height, size.width, size.height));
  return image;
}

Status write_exr(const std::string& path, const Image& image, const std::string& comment) {
  const auto bytes = encode_image(image, comment);
  return bytes ? write_whole_file(path, *bytes) : Status(bytes.error());
}

Status write_golden(const GoldenPlace& place, const Golden& golden) {
  std::error_code code;
  fs::create_directories(place.folder, code);
  const bool noise = golden.test == GoldenTest::noise;
  const std::string what = noise ? fmt::format("mean of {} seeds", golden.seeds) : "one seed";
  if (const auto written = write_exr(file_in(place, "image.exr"), golden.image, what); !written) return written;
  if (noise) {
    const auto written = write_exr(file_in(place, "deviation.exr"), golden.deviation, "standard deviation among the seeds");
    if (!written) return written;
  }
  return write_whole_file(file_in(place, "golden.json"), to_json(golden, place.name));
}

// Renders with the golden's size, samples and seeds.
Status make_pictures(const GoldenPlace& place, Golden& golden) {
  std::vector<GoldenPicture> wanted;
  for (int k = 0; k < golden.seeds; ++k) wanted.push_back({golden.size, golden.samples, golden.seed + static_cast<std::uint64_t>(k)});
  auto pictures = render_scene_pictures(place.scene_file, wanted);
  if (!pictures) return pictures.error();
  if (golden.test == GoldenTest::exact) {
    golden.image = std::move(pictures->front());
    return Done{};
  }
  NoiseModel model = noise_model(*pictures, golden.samples);
  golden.image = std::move(model.mean);
  golden.deviation = std::move(model.deviation);
  return Done{};
}

Status leave_failure(const Golden& golden, const Image& got, const std::string& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  const fs::path dir(folder);
  if (const auto written = write_exr(dir / "got.exr", got, "got"); !written) return written;
  if (const auto written = write_exr(dir / "expected.exr", golden.image, "expected"); !written) return written;
  return write_image_8bit(dir / "difference.png", signed_difference(golden.image, got).picture);
}

std::string colour_text(const glm::vec4& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g}, {:.4g})", v.r, v.g, v.b, v.a); }

const glm::vec4& pixel_at(const Image& image, const PixelPlace& at) {
  return image.rgba[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(at.x)];
}

void judge_exact(const Golden& golden, const Image& picture, GoldenVerdict& verdict) {
  const ImageDifference difference = difference_of(golden.image, picture);
  verdict.worst_value = difference.max;
  verdict.worst = difference.worst;
  verdict.percent_over_soft = 100 * double(pixels_over(golden.image, picture, golden.limits.soft)) / double(picture.rgba.size());
}

void judge_noise(const Golden& golden, const Image& picture, GoldenVerdict& verdict) {
  const NoiseFigures figures = noise_figures({golden.image, golden.deviation, golden.seeds, golden.samples}, picture, golden.limits.soft);
  verdict.worst_value = figures.z_max;
  verdict.worst = figures.worst;
  verdict.percent_over_soft = 100 * double(figures.over_soft) / double(picture.rgba.size());
  verdict.worst_block = figures.block_z_max;
  if (figures.block_z_max > golden.limits.block)
    verdict.broken.push_back(fmt::format("the sum over the block of {} x {} pixels at ({}, {}) has z {:.4g}; {:g} is allowed", kNoiseBlock,
                                         kNoiseBlock, figures.worst_block.x, figures.worst_block.y, figures.block_z_max,
                                         golden.limits.block));
}

// What there is to say when a golden is made anew.
std::string told_change(const Golden* old, const Golden& golden) {
  if (!old) return "there was none before";
  if (old->size.width != golden.size.width || old->size.height != golden.size.height) return "the old one had another size";
  const GoldenVerdict verdict = judge(*old, golden.image);
  return fmt::format("worst pixel ({}, {}): old {}, new {}, {} {:.4g}; {:.3g} % of the pixels over {:g}", verdict.worst.x, verdict.worst.y,
                     colour_text(pixel_at(old->image, verdict.worst)), colour_text(pixel_at(golden.image, verdict.worst)),
                     old->test == GoldenTest::noise ? "z" : "difference", verdict.worst_value, verdict.percent_over_soft, old->limits.soft);
}

Exit say(const Error& error) {
  fmt::print(stderr, "isophote: {}\n", error.text());
  return error.kind;
}

}  // namespace

Result<GoldenPlace> golden_place(const std::string& scene) {
  const fs::path file = scene.ends_with(".json") ? fs::path(scene) : fs::path("scenes") / (scene + ".json");
  std::error_code code;
  if (!fs::is_regular_file(file, code)) return read_write_error(file.string(), "no such scene");
  const fs::path tree = fs::absolute(file).lexically_normal().parent_path().parent_path();
  const std::string name = file.stem().string();
  return GoldenPlace{name, file.string(), (tree / "reference" / "golden" / name).string()};
}

Result<Golden> read_golden(const GoldenPlace& place) {
  const std::string path = file_in(place, "golden.json");
  const auto text = read_text(path);
  if (!text) return text.error();
  auto golden = golden_from_json(*text, path);
  if (!golden) return golden;
  auto image = read_golden_image(place, "image.exr", golden->size);
  if (!image) return image.error();
  golden->image = std::move(*image);
  if (golden->test == GoldenTest::exact) return golden;
  auto deviation = read_golden_image(place, "deviation.exr", golden->size);
  if (!deviation) return deviation.error();
  golden->deviation = std::move(*deviation);
  return golden;
}

Result<std::vector<Image>> render_scene_pictures(const std::string& scene_file, const std::vector<GoldenPicture>& wanted) {
  auto scene = read_scene(scene_file);
  if (!scene) return scene.error();
  auto loaded = load_models(scene->models, scene->hash_text);
  if (!loaded) return loaded.error();
  const Tracer tracer(std::move(loaded->scene));
  std::vector<Image> pictures;
  for (const GoldenPicture& w : wanted) {
    scene->size = w.size;
    scene->samples = w.samples;
    scene->seed = w.seed;
    const Camera camera = camera_for(scene->camera, tracer, w.size);
    const Sampler sampler(w.seed, w.samples);
    const SceneLook look = look_for(*scene, tracer, camera, sampler, loaded->unit);
    const std::atomic<bool> stop = false;
    RenderResult result = render(tracer, camera, look.integrator, sampler, settings_for(*scene, kAovNone), stop, [](int, int) {});
    if (look.legend) draw_legend(*look.legend, result.film);
    pictures.push_back({w.size.width, w.size.height, true, std::move(result.film.rgba)});
  }
  return pictures;
}

GoldenVerdict judge(const Golden& golden, const Image& picture) {
  GoldenVerdict verdict;
  golden.test == GoldenTest::exact ? judge_exact(golden, picture, verdict) : judge_noise(golden, picture, verdict);
  const char* what = golden.test == GoldenTest::exact ? "differs by" : "has z";
  if (verdict.worst_value > golden.limits.hard)
    verdict.broken.push_back(fmt::format("pixel ({}, {}) {} {:.4g}; {:g} is allowed; got {}, expected {}", verdict.worst.x, verdict.worst.y,
                                         what, verdict.worst_value, golden.limits.hard, colour_text(pixel_at(picture, verdict.worst)),
                                         colour_text(pixel_at(golden.image, verdict.worst))));
  if (verdict.percent_over_soft > golden.limits.percent)
    verdict.broken.push_back(fmt::format("{:.3g} % of the pixels are over {:g}; {:g} % may be; the worst is ({}, {}), which {} {:.4g}",
                                         verdict.percent_over_soft, golden.limits.soft, golden.limits.percent, verdict.worst.x,
                                         verdict.worst.y, what, verdict.worst_value));
  return verdict;
}

Result<GoldenVerdict> check_golden(const std::string& scene, std::uint64_t other_seed, const std::string& failures) {
  const auto place = golden_place(scene);
  if (!place) return place.error();
  const auto golden = read_golden(*place);
  if (!golden) return golden.error();
  const bool noise = golden->test == GoldenTest::noise;
  const std::uint64_t seed = golden->seed + (noise ? static_cast<std::uint64_t>(golden->seeds) + other_seed : 0);
  const auto got = render_scene_pictures(place->scene_file, {{golden->size, golden->samples, seed}});
  if (!got) return got.error();
  GoldenVerdict verdict = judge(*golden, got->front());
  if (verdict.broken.empty()) return verdict;
  const std::string folder = (fs::path(failures) / place->name).string();
  if (const auto left = leave_failure(*golden, got->front(), folder); !left) return left.error();
  verdict.broken.push_back(fmt::format("{}: got.exr, expected.exr, difference.png", folder));
  return verdict;
}

Exit accept_golden(const std::string& scene, const std::string& why) {
  if (why.find_first_not_of(" \t\r\n") == std::string::npos)
    return say({Exit::bad_command_line, {}, {}, "--accept needs --why: the reason for which the new picture is right"});
  const auto place = golden_place(scene);
  if (!place) return say(place.error());
  const auto entry = read_scene(place->scene_file);
  if (!entry) return say(entry.error());
  const auto old = read_golden(*place);
  if (!old && old.error().kind != Exit::read_write) return say(old.error());
  Golden golden = new_golden(*entry);
  if (old && old->test == golden.test) {
    golden.limits = old->limits;
    golden.reason = old->reason;
  }
  golden.why = why;
  if (const auto made = make_pictures(*place, golden); !made) return say(made.error());
  if (const auto written = write_golden(*place, golden); !written) return say(written.error());
  fmt::print("{}: {} x {}, {} samples, {} seeds; {}\n", place->name, golden.size.width, golden.size.height, golden.samples, golden.seeds,
             told_change(old ? &*old : nullptr, golden));
  return Exit::done;
}

}  // namespace iso
