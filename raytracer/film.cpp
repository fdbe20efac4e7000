#include "raytracer/film.h"

namespace iso {

Film::Film(const ImageSize& size, unsigned aovs) : size_(size), aovs_(aovs) {
  const std::size_t count = static_cast<std::size_t>(size.width) * size.height;
  rgba.assign(count, glm::vec4(0.0f));
  if (aovs & kAovNormal) n.assign(count, glm::vec3(0.0f));
  if (aovs & kAovPosition) p.assign(count, glm::vec3(0.0f));
  if (aovs & kAovDepth) z.assign(count, std::numeric_limits<float>::infinity());
  if (aovs & kAovUv) uv.assign(count, glm::vec2(0.0f));
  if (aovs & kAovId) {
    instance.assign(count, -1.0f);
    face.assign(count, -1.0f);
  }
}

void Film::set_colour(int x, int y, const glm::vec4& premultiplied) { rgba[at(x, y)] = premultiplied; }

void Film::set_data(int x, int y, const PixelData& data) {
  const std::size_t i = at(x, y);
  if (aovs_ & kAovNormal) n[i] = data.n;
  if (aovs_ & kAovPosition) p[i] = data.p;
  if (aovs_ & kAovDepth) z[i] = static_cast<float>(data.z);
  if (aovs_ & kAovUv) uv[i] = data.uv;
  if (aovs_ & kAovId) {
    instance[i] = static_cast<float>(data.instance);
    face[i] = static_cast<float>(data.face);
  }
}

}  // namespace iso
