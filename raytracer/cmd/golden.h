// Golden pictures: what a scene looked like when somebody last agreed, small, in reference/golden/NAME beside the folder of its scene file:
//
//   golden.json    how it was made and why it was accepted, how a picture is judged, the limits and their reason
//   image.exr      exact shades: the picture of one seed; the others: the mean of pictures with several seeds
//   deviation.exr  only of the others: the standard deviation among these seeds (raytracer/picture_noise.h)
//
// A scene is told by its file, or by NAME for scenes/NAME.json. Errors: no such scene or golden (Exit::read_write), a golden.json that is
// not as above (Exit::bad_input), and those of reading and rendering scenes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raytracer/camera.h"
#include "raytracer/picture_noise.h"

namespace iso {

struct GoldenPlace {
  std::string name, scene_file, folder;
};
Result<GoldenPlace> golden_place(const std::string& scene);

// exact: the same seed gives the same picture but for rounding; noise: another seed gives another picture of the same kind.
enum class GoldenTest { exact, noise };

struct GoldenLimits {
  double soft = 0, percent = 0;  // so many percent of the pixels may be over `soft`
  double hard = 0;               // none over this
  double block = 0;              // noise: no block of pixels over this
};

struct Golden {
  std::string why, reason;  // of the picture; of the limits
  ImageSize size;
  int samples = 0;
  std::uint64_t seed = 0;  // the first one
  int seeds = 1;
  GoldenTest test = GoldenTest::exact;
  GoldenLimits limits;  // exact: of absolute values; noise: of z
  Image image, deviation;
};
Result<Golden> read_golden(const GoldenPlace& place);

// The scene's picture, its colour only, with a size and samples that are not the scene's. One reading for any number of pictures.
struct GoldenPicture {
  ImageSize size;
  int samples = 16;
  std::uint64_t seed = 0;
};
Result<std::vector<Image>> render_scene_pictures(const std::string& scene_file, const std::vector<GoldenPicture>& wanted);

struct GoldenVerdict {
  double worst_value = 0;           // exact: of the absolute differences; noise: of z
  PixelPlace worst;                 // its pixel
  double percent_over_soft = 0;     // of the pixels
  double worst_block = 0;           // noise
  std::vector<std::string> broken;  // what is beyond its limit, one line each
};
// The picture has the golden's size.
GoldenVerdict judge(const Golden& golden, const Image& picture);

// Renders the scene and judges it. Noise is judged with a seed that has no part in the golden: `other_seed` counts from 0. If it fails,
// got.exr, expected.exr and difference.png are left in `failures`/NAME, and the last line of `broken` names the folder.
Result<GoldenVerdict> check_golden(const std::string& scene, std::uint64_t other_seed, const std::string& failures);

// `isophote compare --accept SCENE --why TEXT`: makes the golden anew, says the old and the new worst pixel; limits and reason of an old
// one are kept. Exit::bad_command_line if `why` is blank; errors are said.
Exit accept_golden(const std::string& scene, const std::string& why);

}  // namespace iso
