// `isophote display IN.exr -o out.png`: a picture for the screen.
#include <memory>

#include "patches/files/output_file.h"
#include "raytracer/cmd/command.h"
#include "raytracer/display_transform.h"

namespace iso {
namespace {

struct Options {
  std::string input, output;
  DisplayOptions display;
};

Exit display(const Options& options) {
  if (const auto writable = check_writable(options.output); !writable) return fail(writable.error());
  auto image = read_image(options.input);
  if (!image) return fail(image.error());
  if (const auto applied = apply_display(*image, options.display); !applied) return fail(applied.error());
  const auto written = write_image_8bit(options.output, *image);
  return written ? Exit::done : fail(written.error());
}

}  // namespace

void add_display_command(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("display", "a rendered picture as PNG or JPEG for the screen");
  command->add_option("IN", options->input, "OpenEXR picture, linear Rec. 709")->required();
  command->add_option("-o,--output", options->output, "PNG or JPEG file to write")->required();
  command->add_option("--exposure", options->display.exposure, "brighter (+) or darker (-), in stops")->check(CLI::Range(-64.0, 64.0));
  const auto* view = command->add_option("--view", options->display.view,
                                         "srgb (exact curve, colours as in the file), aces (film look), raw; or a view of --ocio [srgb]");
  const auto* ocio =
      command->add_option("--ocio", options->display.config, "OpenColorIO configuration to use instead of the built-in views");
  command->add_option("--display", options->display.display, "display of that configuration")->needs("--ocio");
  command->callback([options, view, ocio, &exit] {
    if (ocio->count() > 0 && view->count() == 0) options->display.view.clear();  // the configuration's own default
    exit = display(*options);
  });
}

}  // namespace iso
