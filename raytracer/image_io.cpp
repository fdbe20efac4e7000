#include "raytracer/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <filesystem>

#include "patches/files/output_file.h"
#include "raytracer/film.h"
#include "raytracer/srgb.h"

namespace iso {
namespace {

// Where the four channels of the result come from; -1: none.
struct ChannelMap {
  int r = 0, g = 0, b = 0, a = -1;
};

ChannelMap channels_of(const OIIO::ImageSpec& spec) {
  const int r = spec.channelindex("R"), g = spec.channelindex("G"), b = spec.channelindex("B");
  if (r >= 0 && g >= 0 && b >= 0) return {r, g, b, spec.channelindex("A")};
  if (spec.nchannels >= 3) return {0, 1, 2, spec.alpha_channel};
  return {0, 0, 0, spec.alpha_channel};
}

// A picture as its file has it.
struct Stored {
  Image image;
  bool code_values = false;   // whole numbers in the file
  bool unmultiplied = false;  // with alpha
};

Result<Stored> read_stored(const std::string& path, const OIIO::ImageSpec& config) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) return read_write_error(path, "no such file");
  const auto input = OIIO::ImageInput::open(path, &config);
  if (!input) return bad_input(path, {}, fmt::format("not a picture that can be read: {}", OIIO::geterror()));
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0 || static_cast<long long>(spec.width) * spec.height > kMaxPixels || spec.nchannels > 1024)
    return bad_input(path, {}, fmt::format("a picture of {} x {} x {} values is not supported", spec.width, spec.height, spec.nchannels));

  const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<float> values(count * channels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
    return bad_input(path, {}, fmt::format("damaged: {}", input->geterror()));

  const ChannelMap map = channels_of(spec);
  Stored stored{{spec.width, spec.height, map.a >= 0, std::vector<glm::vec4>(count)},
                !spec.format.is_floating_point(),
                spec.get_int_attribute("oiio:UnassociatedAlpha") != 0};
  for (std::size_t i = 0; i < count; ++i) {
    const float* v = &values[i * channels];
    stored.image.rgba[i] = {v[map.r], v[map.g], v[map.b], map.a >= 0 ? v[map.a] : 1.0f};
  }
  return stored;
}

}  // namespace

Result<Image> read_image(const std::string& path) {
  auto stored = read_stored(path, {});
  if (!stored) return stored.error();
  return std::move(stored->image);
}

Result<Image> read_linear_image(const std::string& path) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  auto stored = read_stored(path, config);
  if (!stored) return stored.error();
  if (!stored->code_values) return std::move(stored->image);
  for (glm::vec4& pixel : stored->image.rgba) {
    const float inside = stored->unmultiplied || pixel.a <= 0 ? 1.0f : pixel.a;
    for (int c = 0; c < 3; ++c) pixel[c] = linear_from_srgb(pixel[c] / inside) * pixel.a;
  }
  return std::move(stored->image);
}

namespace {

// Of a picture as write_image_8bit describes; `path` tells the format.
Result<std::string> encode_8bit(const std::string& path, const Image& image) {
  const auto output = OIIO::ImageOutput::create(path);
  if (!output || !output->supports("ioproxy"))
    return Error{Exit::bad_command_line, path, {}, "not a name of a picture format that can be written; try .png or .jpg"};
  const bool alpha = image.has_alpha && output->supports("alpha");
  const int channels = alpha ? 4 : 3;
  OIIO::ImageSpec spec(image.width, image.height, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 95);

  // Into memory first: the disk sees whole files only.
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  if (!output->set_ioproxy(&memory) || !output->open(path, spec))
    return read_write_error(path, fmt::format("cannot be encoded: {}", output->geterror()));
  std::vector<float> values;
  values.reserve(image.rgba.size() * static_cast<std::size_t>(channels));
  for (const glm::vec4& pixel : image.rgba)
    for (int c = 0; c < channels; ++c) values.push_back(alpha ? pixel[c] : pixel[c] * pixel.a);
  if (!output->write_image(OIIO::TypeDesc::FLOAT, values.data()) || !output->close())
    return read_write_error(path, fmt::format("cannot be encoded: {}", output->geterror()));
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace

Status write_image_8bit(const std::string& path, const Image& image) {
  const auto bytes = encode_8bit(path, image);
  if (!bytes) return bytes.error();
  return write_whole_file(path, *bytes);
}

Result<std::string> encode_png(const Image& image) { return encode_8bit("picture.png", image); }

}  // namespace iso
