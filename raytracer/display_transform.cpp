#include "raytracer/display_transform.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

namespace iso {
namespace {

namespace OCIO = OCIO_NAMESPACE;

OCIO::TransformRcPtr exposure_transform(double stops) {
  const double k = std::exp2(stops);
  const double scale[16] = {k, 0, 0, 0, 0, k, 0, 0, 0, 0, k, 0, 0, 0, 0, 1};
  const auto transform = OCIO::MatrixTransform::Create();
  transform->setMatrix(scale);
  return transform;
}

OCIO::TransformRcPtr builtin(const char* style, OCIO::TransformDirection direction = OCIO::TRANSFORM_DIR_FORWARD) {
  const auto transform = OCIO::BuiltinTransform::Create();
  transform->setStyle(style);
  transform->setDirection(direction);
  return transform;
}

// The sRGB curve by its definition.  [IEC 61966-2-1]
OCIO::TransformRcPtr srgb_curve() {
  const auto transform = OCIO::ExponentWithLinearTransform::Create();
  transform->setGamma({2.4, 2.4, 2.4, 1});
  transform->setOffset({0.055, 0.055, 0.055, 0});
  transform->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
  return transform;
}

Result<OCIO::ConstProcessorRcPtr> builtin_processor(const DisplayOptions& options) {
  const auto group = OCIO::GroupTransform::Create();
  const auto add = [&](const OCIO::TransformRcPtr& transform) { group->appendTransform(transform); };
  add(exposure_transform(options.exposure));
  if (options.view == "srgb") {
    add(srgb_curve());
  } else if (options.view == "aces") {
    add(builtin("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", OCIO::TRANSFORM_DIR_INVERSE));
    add(builtin("ACEScg_to_ACES2065-1"));
    add(builtin("ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0"));
    add(builtin("DISPLAY - CIE-XYZ-D65_to_sRGB"));
  } else if (options.view != "raw") {
    return Error{Exit::bad_command_line, {}, {}, fmt::format("unknown view '{}'; expected srgb, aces or raw", options.view)};
  }
  return OCIO::Config::CreateRaw()->getProcessor(group);
}

// The name under which the configuration knows linear Rec. 709; else its scene-linear role.
std::string source_space(const OCIO::ConstConfigRcPtr& config) {
  for (const char* name :
       {"lin_rec709_scene", "lin_rec709", "Linear Rec.709 (sRGB)", "lin_srgb", "Utility - Linear - sRGB", "Utility - Linear - Rec.709"})
    if (config->getColorSpace(name)) return name;
  return OCIO::ROLE_SCENE_LINEAR;
}

Result<OCIO::ConstProcessorRcPtr> config_processor(const DisplayOptions& options) {
  const auto config = OCIO::Config::CreateFromFile(options.config.c_str());
  const std::string display = options.display.empty() ? config->getDefaultDisplay() : options.display;
  const std::string view = options.view.empty() ? config->getDefaultView(display.c_str()) : options.view;
  const auto transform = OCIO::DisplayViewTransform::Create();
  transform->setSrc(source_space(config).c_str());
  transform->setDisplay(display.c_str());
  transform->setView(view.c_str());
  const auto group = OCIO::GroupTransform::Create();
  group->appendTransform(exposure_transform(options.exposure));
  group->appendTransform(transform);
  return config->getProcessor(group);
}

}  // namespace

Status apply_display(Image& image, const DisplayOptions& options) {
  try {
    const auto processor = options.config.empty() ? builtin_processor(options) : config_processor(options);
    if (!processor) return processor.error();

    // Curves act on the colour of what is seen, not on its product with the coverage.
    for (glm::vec4& pixel : image.rgba)
      if (pixel.a > 0 && pixel.a != 1) pixel = glm::vec4(glm::vec3(pixel) / pixel.a, pixel.a);
    OCIO::PackedImageDesc pixels(image.rgba.data(), image.width, image.height, 4);
    (*processor)->getDefaultCPUProcessor()->apply(pixels);
    return Done{};
  } catch (const OCIO::Exception& e) {
    return bad_input(options.config, {}, fmt::format("OpenColorIO: {}", e.what()));
  }
}

}  // namespace iso
