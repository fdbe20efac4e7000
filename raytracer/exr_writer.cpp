#include "raytracer/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/core.h>
#include <half.h>

#include <cstring>

namespace iso {
namespace {

// A file in memory, so that the disk sees whole files only.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(std::string& bytes) : Imf::OStream("memory"), bytes_(bytes) {}
  void write(const char c[], int n) override {
    const std::size_t end = at_ + static_cast<std::size_t>(n);
    if (bytes_.size() < end) bytes_.resize(end);
    std::memcpy(bytes_.data() + at_, c, static_cast<std::size_t>(n));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t pos) override { at_ = pos; }

 private:
  std::string& bytes_;
  std::size_t at_ = 0;
};

Imath::M44f to_imath(const Matrix44& m) {
  Imath::M44f result;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) result[i][j] = static_cast<float>(m[i][j]);
  return result;
}

Imf::Header header_for(const Film& film, const ImageInfo& info) {
  Imf::Header header(film.size().width, film.size().height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::addChromaticities(header, Imf::Chromaticities());  // Rec. 709, D65
  Imf::addWorldToCamera(header, to_imath(info.world_to_camera));
  Imf::addWorldToNDC(header, to_imath(info.world_to_ndc));
  if (!info.comments.empty()) Imf::addComments(header, info.comments);
  header.insert("software", Imf::StringAttribute("Isophote " + info.version));
  header.insert("colorInteropID", Imf::StringAttribute("lin_rec709_scene"));

  const auto text = [&](const char* name, const std::string& value) { header.insert(name, Imf::StringAttribute(value)); };
  text("isophote/version", info.version);
  text("isophote/mode", info.mode);
  text("isophote/shade", info.shade);
  text("isophote/units", info.units);
  text("isophote/sceneHash", info.scene_hash);
  text("isophote/seed", fmt::format("{}", info.seed));  // 64 bits do not fit an int attribute
  header.insert("isophote/samples", Imf::IntAttribute(info.samples));
  header.insert("isophote/complete", Imf::IntAttribute(info.complete ? 1 : 0));
  return header;
}

// Declares channels and points the frame buffer at them.
class Channels {
 public:
  Channels(Imf::Header& header, std::size_t width) : header_(header), width_(width) {}
  const Imf::FrameBuffer& buffer() const { return buffer_; }

  // One channel of an array of pixels with `stride` values each, starting at `first`.
  template <class T>
  void add(const char* name, const T* first, std::size_t stride = 1) {
    constexpr Imf::PixelType kType = std::is_same_v<T, half> ? Imf::HALF : Imf::FLOAT;
    header_.channels().insert(name, Imf::Channel(kType));
    char* base = const_cast<char*>(reinterpret_cast<const char*>(first));  // OpenEXR reads through the same type it writes through
    buffer_.insert(name, Imf::Slice(kType, base, stride * sizeof(T), stride * sizeof(T) * width_));
  }

 private:
  Imf::Header& header_;
  std::size_t width_;
  Imf::FrameBuffer buffer_;
};

std::vector<half> to_half(const std::vector<glm::vec4>& rgba) {
  std::vector<half> values;
  values.reserve(4 * rgba.size());
  for (const glm::vec4& pixel : rgba)
    for (int c = 0; c < 4; ++c) values.emplace_back(std::clamp(pixel[c], -float(HALF_MAX), float(HALF_MAX)));
  return values;
}

void add_layers(Channels& channels, const Film& film) {
  const char* const kNormal[] = {"N.X", "N.Y", "N.Z"};
  const char* const kPosition[] = {"P.X", "P.Y", "P.Z"};
  for (int c = 0; c < 3; ++c) {
    if (!film.n.empty()) channels.add(kNormal[c], &film.n[0][c], 3);
    if (!film.p.empty()) channels.add(kPosition[c], &film.p[0][c], 3);
  }
  if (!film.z.empty()) channels.add("Z", film.z.data());
  if (!film.uv.empty()) {
    channels.add("uv.u", &film.uv[0].x, 2);
    channels.add("uv.v", &film.uv[0].y, 2);
  }
  if (!film.instance.empty()) channels.add("id.instance", film.instance.data());
  if (!film.face.empty()) channels.add("id.face", film.face.data());
  for (const NamedPlane& plane : film.planes) channels.add(plane.name.c_str(), plane.values.data());
}

}  // namespace

Result<std::string> encode_exr(const Film& film, const ImageInfo& info, int threads) {
  try {
    std::string bytes;
    MemoryStream stream(bytes);
    Imf::Header header = header_for(film, info);
    const std::vector<half> rgba = to_half(film.rgba);
    Channels channels(header, static_cast<std::size_t>(film.size().width));
    const char* const kColour[] = {"R", "G", "B", "A"};
    for (std::size_t c = 0; c < 4; ++c) channels.add(kColour[c], rgba.data() + c, 4);
    add_layers(channels, film);

    // The destructor writes the table of line offsets.
    Imf::setGlobalThreadCount(threads);
    {
      Imf::OutputFile file(stream, header, threads);
      file.setFrameBuffer(channels.buffer());
      file.writePixels(film.size().height);
    }
    return bytes;
  } catch (const std::exception& e) {
    return read_write_error({}, fmt::format("OpenEXR could not encode the picture: {}", e.what()));
  }
}

}  // namespace iso
