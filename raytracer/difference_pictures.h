// Pictures of how two pictures differ.
#pragma once

#include "raytracer/image_metrics.h"

namespace iso {

// Display-encoded, for write_image_8bit: grey where `test` shows what `reference` shows, brighter where it is brighter. Differences are
// those of code values over black, times half of `gain`, which is such that the largest one reaches black or white; 1 if there is none.
struct SignedDifference {
  Image picture;
  double gain = 1;
};
SignedDifference signed_difference(const Image& reference, const Image& test);

// FLIP in false colours, 0 black over violet and orange to 1 pale yellow; display-encoded. The map's size is the one of its pictures.
Image flip_picture(const FlipMap& map, int width, int height);

// test - reference as an OpenEXR file: the raw differences of R G B A in half. Fails only if OpenEXR does.
Result<std::string> encode_difference(const Image& reference, const Image& test);

// A picture as an OpenEXR file with R G B A in half. `comment` says what it is; may be empty.
Result<std::string> encode_image(const Image& image, const std::string& comment);

}  // namespace iso
