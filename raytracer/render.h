// Scene to film: tiles over all cores, each one a wavefront of ray batches. Same bytes for any number of threads.
#pragma once

#include <atomic>

#include "raytracer/film.h"
#include "raytracer/shading.h"

namespace iso {

enum class BackgroundKind { transparent, plain, sky };
struct Background {
  BackgroundKind kind = BackgroundKind::transparent;
  Colour colour{0.0f};  // plain only
};

// What the camera sees where it hits nothing, at height y in [0, 1] from the top of the picture.
glm::vec4 background_at(const Background& background, double y);

struct RenderSettings {
  ImageSize size;
  int samples = 16;  // per pixel, 1 ... kMaxSamples
  std::uint64_t seed = 0;
  unsigned aovs = kAovAll;
  Background background;
  double spread = 1;  // of the pixel filter: less where the integrator filters its samples itself; 0 puts them in the pixel's middle
};

struct RenderResult {
  Film film;
  SolverStats stats{};
  int tiles = 0, tiles_done = 0;  // tiles that were not done are transparent black
  bool complete() const { return tiles_done == tiles; }
};

// Renders with the threads of the surrounding TBB arena. When `stop` becomes true no further tile is begun and unfinished ones are
// dropped. `tile_done(done, all)` is called from any thread, several at once.
RenderResult render(const Tracer& tracer, const Camera& camera, const Integrator& integrator, const Sampler& sampler,
                    const RenderSettings& settings, const std::atomic<bool>& stop, const std::function<void(int, int)>& tile_done);

}  // namespace iso
