#include "raytracer/render.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include "raytracer/filter.h"

namespace iso {
namespace {

constexpr int kTile = 32;   // pixels
constexpr int kPacket = 4;  // rays are queued in blocks of 4 x 4 pixels: one packet of 16
constexpr int kPass = 16;   // samples per pixel in one batch: 16 384 rays, which stay in the cache

struct Tile {
  int x0, y0, x1, y1;
};

// The pixels of a tile, block by block.
std::vector<glm::ivec2> pixels_in_blocks(const Tile& tile) {
  std::vector<glm::ivec2> pixels;
  for (int by = tile.y0; by < tile.y1; by += kPacket)
    for (int bx = tile.x0; bx < tile.x1; bx += kPacket)
      for (int y = by; y < std::min(by + kPacket, tile.y1); ++y)
        for (int x = bx; x < std::min(bx + kPacket, tile.x1); ++x) pixels.emplace_back(x, y);
  return pixels;
}

class TileRenderer {
 public:
  TileRenderer(const Tracer& tracer, const Camera& camera, const Integrator& integrator, const Sampler& sampler,
               const RenderSettings& settings, const std::atomic<bool>& stop)
      : tracer_(tracer), camera_(camera), integrator_(integrator), sampler_(sampler), settings_(settings), stop_(stop) {}

  // False if it was stopped before its end; nothing is written to the film then.
  bool operator()(const Tile& tile, Film& film, SolverStats& stats) const {
    const std::vector<glm::ivec2> pixels = pixels_in_blocks(tile);
    std::vector<glm::dvec4> sums(pixels.size(), glm::dvec4(0.0));
    for (int first = 0; first < settings_.samples; first += kPass) {
      if (stop_.load(std::memory_order_relaxed)) return false;
      add_pass(pixels, first, std::min(first + kPass, settings_.samples), sums, stats);
    }
    for (std::size_t i = 0; i < pixels.size(); ++i)
      film.set_colour(pixels[i].x, pixels[i].y, glm::vec4(sums[i] / double(settings_.samples)));
    if (settings_.aovs != kAovNone) write_data(pixels, film, stats);
    return true;
  }

 private:
  // Samples [first, last) of every pixel: rays of one block and one sample number lie next to each other.
  void add_pass(const std::vector<glm::ivec2>& pixels, int first, int last, std::vector<glm::dvec4>& sums, SolverStats& stats) const {
    std::vector<SampleId> samples;
    std::vector<Ray> rays;
    std::vector<std::size_t> owners;
    std::vector<glm::vec4> colours;
    constexpr std::size_t kBlockPixels = kPacket * kPacket;
    for (std::size_t block = 0; block < pixels.size(); block += kBlockPixels)
      for (int s = first; s < last; ++s)
        for (std::size_t i = block; i < std::min(block + kBlockPixels, pixels.size()); ++i) {
          const SampleId id{static_cast<std::uint32_t>(pixels[i].x), static_cast<std::uint32_t>(pixels[i].y),
                            static_cast<std::uint32_t>(s)};
          const Vec2 at = Vec2(pixels[i]) + 0.5 + offset(id);
          samples.push_back(id);
          rays.push_back(camera_ray(camera_, settings_.size, at.x, at.y));
          owners.push_back(i);
          colours.push_back(background_at(settings_.background, (pixels[i].y + 0.5) / settings_.size.height));
        }

    // Trace, shade, and fold in the order of the array.
    std::vector<Hit> hits(rays.size());
    tracer_.nearest(rays, hits, Tracer::Order::coherent, stats);
    integrator_({samples, rays, hits}, colours, stats);
    for (std::size_t k = 0; k < colours.size(); ++k) sums[owners[k]] += glm::dvec4(colours[k]);
  }

  Vec2 offset(const SampleId& id) const { return settings_.spread * filter_.offset(sampler_.pair(id, Dimension::filter)); }

  // One more ray through each pixel's centre: data must not be blended.
  void write_data(const std::vector<glm::ivec2>& pixels, Film& film, SolverStats& stats) const {
    std::vector<Ray> rays;
    for (const glm::ivec2& pixel : pixels) rays.push_back(camera_ray(camera_, settings_.size, pixel.x + 0.5, pixel.y + 0.5));
    std::vector<Hit> hits(rays.size());
    tracer_.nearest(rays, hits, Tracer::Order::coherent, stats);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!hits[i]) continue;
      const SurfacePoint at = tracer_.surface_point(hits[i]);
      const double depth = -glm::dot(at.p - camera_.position, camera_.back);
      film.set_data(pixels[i].x, pixels[i].y, {at.n, at.p, depth, hits[i].uv, hits[i].placed, hits[i].face});
    }
  }

  const Tracer& tracer_;
  const Camera& camera_;
  const Integrator& integrator_;
  const Sampler& sampler_;
  const RenderSettings& settings_;
  const std::atomic<bool>& stop_;
  PixelFilter filter_;
};

}  // namespace

glm::vec4 background_at(const Background& background, double y) {
  switch (background.kind) {
    case BackgroundKind::transparent:
      return glm::vec4(0.0f);
    case BackgroundKind::plain:
      return glm::vec4(background.colour, 1.0f);
    case BackgroundKind::sky:
      return glm::vec4(glm::mix(Colour(0.42f, 0.48f, 0.56f), Colour(0.84f, 0.85f, 0.86f), static_cast<float>(y)), 1.0f);
  }
  ISO_CHECK(!"a background");
}

RenderResult render(const Tracer& tracer, const Camera& camera, const Integrator& integrator, const Sampler& sampler,
                    const RenderSettings& settings, const std::atomic<bool>& stop, const std::function<void(int, int)>& tile_done) {
  const int columns = (settings.size.width + kTile - 1) / kTile, rows = (settings.size.height + kTile - 1) / kTile;
  RenderResult result{.film = Film(settings.size, settings.aovs), .tiles = columns * rows};
  std::vector<SolverStats> stats(static_cast<std::size_t>(result.tiles));
  std::atomic<int> done = 0;
  const TileRenderer render_tile(tracer, camera, integrator, sampler, settings, stop);

  // Tiles are independent; statistics are added up in the order of the tiles.
  const auto body = [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i < range.end(); ++i) {
      const int x0 = i % columns * kTile, y0 = i / columns * kTile;
      const Tile tile{x0, y0, std::min(x0 + kTile, settings.size.width), std::min(y0 + kTile, settings.size.height)};
      if (stop.load() || !render_tile(tile, result.film, stats[static_cast<std::size_t>(i)])) continue;
      tile_done(++done, result.tiles);
    }
  };
  tbb::parallel_for(tbb::blocked_range<int>(0, result.tiles, 1), body, tbb::simple_partitioner());
  for (const SolverStats& s : stats) result.stats += s;
  result.tiles_done = done;
  return result;
}

}  // namespace iso
