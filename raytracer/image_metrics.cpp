#include "raytracer/image_metrics.h"

#include <tbb/parallel_for.h>

#include "patches/base/vec.h"
#include "raytracer/srgb.h"

namespace iso {
namespace {

void check_sizes(const Image& a, const Image& b) {
  ISO_CHECK(a.width == b.width && a.height == b.height && a.rgba.size() == b.rgba.size());
}

// How far two values are apart: equal ones are not, whatever they are; else what is not a number is infinitely far from everything.
double apart(float a, float b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  const double d = std::abs(double(a) - double(b));
  return std::isnan(d) ? kInf : d;
}

double worst_channel(const glm::vec4& a, const glm::vec4& b) {
  return std::max({apart(a.r, b.r), apart(a.g, b.g), apart(a.b, b.b), apart(a.a, b.a)});
}

// What a screen shows of a value.
double shown(float light) { return light > 0 ? srgb_from_linear(std::min(light, 1.0f)) : 0.0; }

double square(double x) { return x * x; }

struct Sums {
  double max = 0, absolute = 0, squared = 0, shown_squared = 0;
  int worst = 0;
  std::uint64_t differ = 0;
};

Sums sums_of_row(const glm::vec4* a, const glm::vec4* b, int width) {
  Sums sums;
  for (int x = 0; x < width; ++x) {
    const double worst = worst_channel(a[x], b[x]);
    sums.differ += worst > 0;
    if (worst > sums.max) {
      sums.max = worst;
      sums.worst = x;
    }
    for (int c = 0; c < 3; ++c) {
      const double d = apart(a[x][c], b[x][c]);
      sums.absolute += d;
      sums.squared += square(d);
      if (d > 0) sums.shown_squared += square(shown(a[x][c]) - shown(b[x][c]));
    }
  }
  return sums;
}

// Counts pixels by rows, in parallel.
template <class Wanted>
std::uint64_t count_pixels(const Image& a, const Image& b, Wanted wanted) {
  check_sizes(a, b);
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(a.height));
  tbb::parallel_for(std::size_t{0}, counts.size(), [&](std::size_t y) {
    const std::size_t begin = y * static_cast<std::size_t>(a.width), end = begin + static_cast<std::size_t>(a.width);
    for (std::size_t i = begin; i < end; ++i) counts[y] += wanted(a.rgba[i], b.rgba[i]);
  });
  std::uint64_t count = 0;
  for (const std::uint64_t c : counts) count += c;
  return count;
}

}  // namespace

ImageDifference difference_of(const Image& a, const Image& b) {
  check_sizes(a, b);
  std::vector<Sums> rows(static_cast<std::size_t>(a.height));
  const auto width = static_cast<std::size_t>(a.width);
  tbb::parallel_for(std::size_t{0}, rows.size(),
                    [&](std::size_t y) { rows[y] = sums_of_row(a.rgba.data() + y * width, b.rgba.data() + y * width, a.width); });

  // Rows are added in their order, so that the sums do not depend on the threads.
  ImageDifference result;
  Sums all;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    if (rows[y].max > result.max) {
      result.max = rows[y].max;
      result.worst = {rows[y].worst, static_cast<int>(y)};
    }
    all.absolute += rows[y].absolute;
    all.squared += rows[y].squared;
    all.shown_squared += rows[y].shown_squared;
    result.differ += rows[y].differ;
  }
  const double values = 3.0 * static_cast<double>(std::max<std::size_t>(a.rgba.size(), 1));
  result.mean = all.absolute / values;
  result.rmse = std::sqrt(all.squared / values);
  result.psnr = -10 * std::log10(all.shown_squared / values);
  return result;
}

std::uint64_t pixels_over(const Image& a, const Image& b, double limit) {
  return count_pixels(a, b, [limit](const glm::vec4& p, const glm::vec4& q) { return worst_channel(p, q) > limit; });
}

std::uint64_t silhouette_difference(const Image& a, const Image& b) {
  return count_pixels(a, b, [](const glm::vec4& p, const glm::vec4& q) { return (p.a > 0.5f) != (q.a > 0.5f); });
}

}  // namespace iso
