// `isophote diff A B`: how far picture B is from A, in numbers and pictures.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "patches/files/output_file.h"
#include "raytracer/cmd/command.h"
#include "raytracer/difference_pictures.h"

namespace iso {
namespace {

struct Options {
  std::string a, b, difference, flip_map;
  std::optional<double> soft, hard, percent, flip;
  bool json = false;
};

struct Measured {
  int width = 0, height = 0;
  ImageDifference difference;
  FlipMap ldr;
  std::optional<FlipMap> hdr;  // of two EXR
  std::optional<std::uint64_t> over_soft, over_hard;

  double pixels() const { return double(width) * height; }
  const FlipMap& map() const { return hdr ? *hdr : ldr; }
};

bool is_exr(const std::string& path) { return path.ends_with(".exr") || path.ends_with(".EXR"); }

std::string counted(std::uint64_t pixels) { return fmt::format("{} {}", pixels, pixels == 1 ? "pixel" : "pixels"); }

std::string extent(const Image& image) {
  return fmt::format("{} x {} pixels, channels {}", image.width, image.height, image.has_alpha ? "R G B A" : "R G B");
}

Measured measure(const Options& options, const Image& a, const Image& b) {
  Measured m{a.width, a.height, difference_of(a, b), flip_ldr(a, b), {}, {}, {}};
  if (is_exr(options.a) && is_exr(options.b)) m.hdr = flip_hdr(a, b);
  if (options.soft) m.over_soft = pixels_over(a, b, *options.soft);
  if (options.hard) m.over_hard = pixels_over(a, b, *options.hard);
  return m;
}

std::string to_text(const Options& options, const Measured& m) {
  const ImageDifference& d = m.difference;
  const auto percent = [&](std::uint64_t n) { return fmt::format("{} ({:.3g} %)", counted(n), 100 * double(n) / m.pixels()); };
  const auto flip = [](const FlipMap& f) {
    return fmt::format("mean {:.4g}, max {:.4g} at ({}, {})", f.mean, f.max, f.worst.x, f.worst.y);
  };
  std::string text = d.differ == 0 ? fmt::format("equal: {} x {} pixels\n", m.width, m.height)
                                   : fmt::format("max {:.4g} at ({}, {}), mean {:.4g}, RMSE {:.4g}, PSNR {:.2f} dB; not equal: {}\n", d.max,
                                                 d.worst.x, d.worst.y, d.mean, d.rmse, d.psnr, percent(d.differ));
  text += fmt::format("FLIP {}\n", flip(m.ldr));
  if (m.hdr) text += fmt::format("HDR-FLIP {}\n", flip(*m.hdr));
  if (m.over_soft) text += fmt::format("over {:g} (soft): {}\n", *options.soft, percent(*m.over_soft));
  if (m.over_hard) text += fmt::format("over {:g} (hard): {}\n", *options.hard, percent(*m.over_hard));
  return text;
}

std::string to_json(const Options& options, const Measured& m, bool kept) {
  using Json = nlohmann::ordered_json;  // numbers that are not finite become null
  const ImageDifference& d = m.difference;
  const auto place = [](const PixelPlace& p) { return Json{p.x, p.y}; };
  const auto flip = [&](const FlipMap& f) { return Json{{"mean", f.mean}, {"max", f.max}, {"worst", place(f.worst)}}; };
  Json json{{"a", options.a}, {"b", options.b}, {"size", {m.width, m.height}}, {"equal", d.differ == 0}, {"max", d.max}};
  json.update({{"worst", place(d.worst)}, {"mean", d.mean}, {"rmse", d.rmse}, {"psnr", d.psnr}, {"differ", d.differ}});
  json["flip_ldr"] = flip(m.ldr);
  if (m.hdr) json["flip_hdr"] = flip(*m.hdr);
  if (m.over_soft) json["soft"] = {{"limit", *options.soft}, {"pixels", *m.over_soft}, {"percent_allowed", options.percent.value_or(0)}};
  if (m.over_hard) json["hard"] = {{"limit", *options.hard}, {"pixels", *m.over_hard}};
  if (options.flip) json["flip_limit"] = *options.flip;
  json["kept"] = kept;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

// What is beyond its limit; without limits every difference is.
std::vector<std::string> broken_limits(const Options& options, const Measured& m) {
  std::vector<std::string> broken;
  const double allowed = options.percent.value_or(0), found = m.over_soft ? 100 * double(*m.over_soft) / m.pixels() : 0;
  if (found > allowed)
    broken.push_back(fmt::format("{:.3g} % of the pixels differ by more than {:g}; {:g} % may", found, *options.soft, allowed));
  if (m.over_hard.value_or(0) > 0)
    broken.push_back(fmt::format("over {:g}: {}, the worst, ({}, {}), by {:.4g}", *options.hard, counted(*m.over_hard),
                                 m.difference.worst.x, m.difference.worst.y, m.difference.max));
  const double mean = std::max(m.ldr.mean, m.hdr ? m.hdr->mean : 0);
  if (options.flip && mean > *options.flip) broken.push_back(fmt::format("mean FLIP is {:.4g}; {:g} is allowed", mean, *options.flip));
  if (!options.soft && !options.hard && !options.flip && m.difference.differ > 0)
    broken.push_back(fmt::format("not equal in {}", counted(m.difference.differ)));
  return broken;
}

Status write_pictures(const Options& options, const Image& a, const Image& b, const Measured& m) {
  if (is_exr(options.difference)) {
    const auto bytes = encode_difference(a, b);
    if (!bytes) return bytes.error();
    if (const auto written = write_whole_file(options.difference, *bytes); !written) return written;
  } else if (!options.difference.empty()) {
    const SignedDifference difference = signed_difference(a, b);
    if (const auto written = write_image_8bit(options.difference, difference.picture); !written) return written;
    if (!options.json) fmt::print(stderr, "{}: differences of code values times {:.3g}\n", options.difference, 0.5 * difference.gain);
  }
  return options.flip_map.empty() ? Status(Done{}) : write_image_8bit(options.flip_map, flip_picture(m.map(), m.width, m.height));
}

Exit diff(const Options& options) {
  for (const std::string& path : {options.difference, options.flip_map}) {
    const Status writable = path.empty() ? Done{} : check_writable(path);
    if (!writable) return fail(writable.error());
  }
  const auto a = read_linear_image(options.a);
  if (!a) return fail(a.error());
  const auto b = read_linear_image(options.b);
  if (!b) return fail(b.error());
  if (a->width != b->width || a->height != b->height || a->has_alpha != b->has_alpha)
    return fail(bad_input(options.b, {}, fmt::format("{}; expected those of {}: {}", extent(*b), options.a, extent(*a))));

  const Measured m = measure(options, *a, *b);
  const auto broken = broken_limits(options, m);
  const auto told = write_stdout(options.json ? to_json(options, m, broken.empty()) : to_text(options, m));
  if (!told) return fail(told.error());
  if (const auto written = write_pictures(options, *a, *b, m); !written) return fail(written.error());
  return tell_broken(broken, options.b);
}

}  // namespace

void add_diff_command(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("diff", "how far two pictures are apart; exit code 1 if beyond the limits, or if they differ at all");
  command->add_option("A", options->a, "the picture that is right: EXR, PNG, JPEG ...; compared as light, code values are decoded")
      ->required();
  command->add_option("B", options->b, "the one that is compared with it")->required();
  const auto limit = CLI::Range(0.0, 1e30);
  auto* soft = command->add_option("--soft", options->soft, "--percent of the pixels may differ by more than this")->check(limit);
  command->add_option("--percent", options->percent, "of the pixels that may [0]")->check(CLI::Range(0.0, 100.0))->needs(soft);
  command->add_option("--hard", options->hard, "no pixel may differ by more than this")->check(limit);
  command->add_option("--flip", options->flip, "most that mean FLIP may be; of two EXR also HDR-FLIP")->check(CLI::Range(0.0, 1.0));
  command->add_option("-o,--output", options->difference, "picture of B - A: around grey, or raw in an .exr");
  command->add_option("--flip-map", options->flip_map, "picture of FLIP (HDR-FLIP of two EXR): black is equal");
  command->add_flag("--json", options->json, "as JSON");
  command->callback([options, &exit] { exit = diff(*options); });
}

}  // namespace iso
