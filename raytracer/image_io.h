// Pictures through OpenImageIO; its only source file.
#pragma once

#include <string>
#include <vector>

#include "patches/base/result.h"
#include "patches/base/vec.h"

namespace iso {

struct Image {
  int width = 0, height = 0;
  bool has_alpha = false;
  std::vector<glm::vec4> rgba;  // row by row from the upper left; alpha 1 if the file has none
};

// The colour of a picture: channels R G B (A) if it has these names, else its first ones; grey is spread. Linear and premultiplied in EXR.
// Other formats: display-encoded, multiplied with alpha as they are.
Result<Image> read_image(const std::string& path);

// The same as light, linear and premultiplied, whatever the format: values in floating point are taken as that already, whole numbers (PNG,
// JPEG ...) as sRGB code values, which are decoded before they are multiplied with alpha.
Result<Image> read_linear_image(const std::string& path);

// Eight bits a channel, values clamped to [0, 1], display-encoded, alpha not multiplied in. The name's ending tells the format; a format
// without alpha shows the picture over black.
Status write_image_8bit(const std::string& path, const Image& image);

// The bytes of such a picture as PNG.
Result<std::string> encode_png(const Image& image);

}  // namespace iso
