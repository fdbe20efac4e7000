// From linear Rec. 709 to a screen's code values, through OpenColorIO; its only source file.
#pragma once

#include <string>

#include "raytracer/image_io.h"

namespace iso {

struct DisplayOptions {
  double exposure = 0;        // stops
  std::string view = "srgb";  // built in: "srgb" (the exact curve), "aces" (ACES 1.0 SDR film look), "raw" (no curve)
  std::string display;        // with a configuration file: empty is its default
  std::string config;         // an OCIO configuration file; empty: built in
};

// In place; colours are taken premultiplied and left not multiplied with their alpha, alpha itself is kept.
Status apply_display(Image& image, const DisplayOptions& options);

}  // namespace iso
