#include "raytracer/cmd/compare_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "raytracer/sampling.h"

namespace iso {
namespace {

constexpr int kRounds = 3;
constexpr int kMostRays = 1 << 18;  // a round

// Million rays a second, the median of some rounds.
double rate_of(const Tracer& tracer, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  if (rays.empty()) return 0;
  hits.resize(rays.size());
  std::vector<double> seconds;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    SolverStats stats;
    tracer.nearest(rays, hits, Tracer::Order::coherent, stats);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + kRounds / 2, seconds.end());
  return 1e-6 * static_cast<double>(rays.size()) / std::max(seconds[kRounds / 2], 1e-9);
}

// Pixels in small blocks, so that neighbours in the array are neighbours in the picture.
std::vector<Ray> primary_rays(const Camera& camera, const ImageSize& size) {
  constexpr int kBlock = 8;
  const double all = static_cast<double>(size.width) * size.height;
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(all / kMostRays))));
  std::vector<Ray> rays;
  for (int by = 0; by < size.height; by += kBlock * step)
    for (int bx = 0; bx < size.width; bx += kBlock * step)
      for (int y = by; y < std::min(size.height, by + kBlock * step); y += step)
        for (int x = bx; x < std::min(size.width, bx + kBlock * step); x += step)
          rays.push_back(camera_ray(camera, size, x + 0.5, y + 0.5));
  return rays;
}

}  // namespace

ReportCost cost_of(const Tracer& tracer, const Camera& camera, const ImageSize& size) {
  ReportCost cost;
  cost.build_seconds = tracer.build_stats().seconds;
  cost.bytes = tracer.build_stats().bytes;
  const std::vector<Ray> primary = primary_rays(camera, size);
  std::vector<Hit> hits;
  cost.primary_rate = rate_of(tracer, primary, hits);

  std::vector<Ray> bounce;
  const Sampler sampler(0, kMaxSamples);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i]) continue;
    const SurfacePoint at = tracer.surface_point(hits[i]);
    if (glm::length(at.ng) == 0) continue;
    const Vec3 n = glm::dot(at.ng, primary[i].d) > 0 ? -at.ng : at.ng;
    const auto number = static_cast<std::uint32_t>(i);
    bounce.push_back(secondary_ray(hits[i], at, cosine_hemisphere(n, sampler.pair({number % 4096, number / 4096, 0}, Dimension::sky))));
  }
  std::vector<Hit> bounced;
  cost.bounce_rate = rate_of(tracer, bounce, bounced);
  return cost;
}

std::string machine_text(int threads) {
  std::ifstream info("/proc/cpuinfo");
  std::string processor;
  for (std::string line; processor.empty() && std::getline(info, line);)
    if (line.starts_with("model name")) processor = line.substr(std::min(line.size(), line.find(':') + 2)) + ", ";
  return fmt::format("{}{} thread{}", processor, threads, threads == 1 ? "" : "s");
}

}  // namespace iso
