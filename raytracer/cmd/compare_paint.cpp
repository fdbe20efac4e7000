#include "raytracer/cmd/compare_paint.h"

#include <algorithm>
#include <cmath>

#include "raytracer/srgb.h"

namespace iso {
namespace {

constexpr Colour rgb(unsigned hex) {
  return {static_cast<float>(hex >> 16 & 255) / 255, static_cast<float>(hex >> 8 & 255) / 255, static_cast<float>(hex & 255) / 255};
}

// How wide a pixel is at a point that a ray meets, world units across the line of sight.
double pixel_width(const Camera& camera, const ImageSize& size, const Point3& p) {
  const double height = 2 * camera.half_height / size.height;
  return camera.projection == Projection::orthographic ? height : height * -glm::dot(p - camera.position, camera.back);
}

// How strongly an edge of the hit's triangle shows: 1 on it, 0 away from it or where triangles are too small for edges.
double edge_strength(const Placed& placed, const Hit& hit, double pixel) {
  constexpr double kEdge = 0.7;    // pixels from the middle of an edge to where it ends
  constexpr double kLegible = 10;  // pixels of a triangle's height from which edges show fully
  if (!placed.mesh || hit.primitive < 0) return 0;
  const Triangle& triangle = placed.mesh->triangles[static_cast<std::size_t>(hit.primitive)];
  Point3 corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = placed.to_world.point(placed.mesh->corner(triangle, k));
  const double area = glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));  // twice
  const double weights[] = {1.0 - hit.weights.x - hit.weights.y, hit.weights.x, hit.weights.y};
  double nearest = kInf, lowest = kInf;
  for (int k = 0; k < 3; ++k) {
    const double height = area / glm::length(corner[(k + 1) % 3] - corner[(k + 2) % 3]);
    nearest = std::min(nearest, weights[k] * height);
    lowest = std::min(lowest, height);
  }
  if (!(pixel > 0) || !finite(nearest)) return 0;
  return std::clamp(2 - 2 * nearest / (kEdge * pixel), 0.0, 1.0) * std::min(1.0, lowest / (kLegible * pixel));
}

// What the screen shows over black; black for what is not a number.
glm::vec3 code_values(const glm::vec4& pixel) {
  const auto code = [](float light) { return light > 0 ? srgb_from_linear(std::min(light, 1.0f)) : 0.0f; };
  return {code(pixel.r), code(pixel.g), code(pixel.b)};
}

template <class F>
Integrator painted(const Tracer& tracer, F value_of) {
  return [&tracer, value_of](const PrimaryHits& batch, std::span<glm::vec4> out, SolverStats&) {
    for (std::size_t i = 0; i < batch.hits.size(); ++i) {
      const Hit& hit = batch.hits[i];
      if (!hit) continue;
      const double value = value_of(tracer.surface_point(hit), hit);
      out[i] = finite(value) ? glm::vec4(static_cast<float>(value), 1.0f, 0.0f, 1.0f) : glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
    }
  };
}

bool covered(const glm::vec4& pixel) { return pixel.a > 0.5f; }

}  // namespace

Integrator painted_field(const Tracer& tracer, const SurfaceField& field) {
  return painted(tracer, [field](const SurfacePoint& at, const Hit& hit) { return field(at.p, at.n, hit.placed, hit.face); });
}

Integrator painted_mean_curvature(const Tracer& tracer) {
  return painted(tracer, [](const SurfacePoint& at, const Hit&) { return 0.5 * (at.k1 + at.k2); });
}

std::vector<double> field_values(const Film& film) {
  std::vector<double> values;
  values.reserve(film.rgba.size());
  for (const glm::vec4& pixel : film.rgba) values.push_back(pixel.g > 0 ? double(pixel.r) / double(pixel.g) : std::nan(""));
  return values;
}

Integrator facets(const Tracer& tracer, const Camera& camera, const ImageSize& size) {
  constexpr Colour kPaint{0.62f, 0.66f, 0.70f}, kInk{0.05f, 0.09f, 0.16f};
  constexpr double kAmbient = 0.22, kInkShare = 0.55;
  return [=, &tracer](const PrimaryHits& batch, std::span<glm::vec4> out, SolverStats&) {
    for (std::size_t i = 0; i < batch.hits.size(); ++i) {
      const Hit& hit = batch.hits[i];
      if (!hit) continue;
      const SurfacePoint at = tracer.surface_point(hit);
      const double facing = finite(at.ng) ? std::abs(glm::dot(at.ng, glm::normalize(batch.rays[i].d))) : 0;
      const Placed& placed = tracer.scene().placed[static_cast<std::size_t>(hit.placed)];
      const double edge = kInkShare * edge_strength(placed, hit, pixel_width(camera, size, at.p));
      const Colour lit = static_cast<float>(kAmbient + (1 - kAmbient) * facing) * kPaint;
      out[i] = glm::vec4(glm::mix(lit, kInk, static_cast<float>(edge)), 1.0f);
    }
  };
}

Colour scale_colour(const ReportLegend& legend, double value) {
  constexpr Colour kUnknown = rgb(0x9a9a9a);
  if (std::isnan(value) || legend.colours.empty()) return kUnknown;
  const double share = legend.hi > legend.lo ? std::clamp((value - legend.lo) / (legend.hi - legend.lo), 0.0, 1.0) : 0.0;
  const double at = share * static_cast<double>(legend.colours.size() - 1);
  const auto i = static_cast<std::size_t>(at), next = std::min(i + 1, legend.colours.size() - 1);
  return glm::mix(legend.colours[i], legend.colours[next], static_cast<float>(at - static_cast<double>(i)));
}

Image scale_picture(const std::vector<double>& values, const Image& alpha, const ReportLegend& legend) {
  Image image{alpha.width, alpha.height, true, {}};
  image.rgba.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float a = alpha.rgba[i].a;
    image.rgba.push_back(a > 0 ? glm::vec4(scale_colour(legend, values[i]), a) : glm::vec4(0.0f));
  }
  return image;
}

ReportLegend silhouette_legend() {
  return {"silhouette", "", 0, 0, {rgb(0x0072b2), rgb(0xe69f00), rgb(0xb9bec4)}, {"exact surface only", "mesh only", "both"}};
}

Image silhouette_picture(const Image& exact, const Image& mesh) {
  const ReportLegend legend = silhouette_legend();
  Image image{exact.width, exact.height, true, {}};
  image.rgba.reserve(exact.rgba.size());
  for (std::size_t i = 0; i < exact.rgba.size(); ++i) {
    const bool a = covered(exact.rgba[i]), b = covered(mesh.rgba[i]);
    const std::size_t kind = a && b ? 2 : b ? 1 : 0;
    image.rgba.push_back(a || b ? glm::vec4(legend.colours[kind], 1.0f) : glm::vec4(0.0f));
  }
  return image;
}

DifferencePicture difference_picture(const Image& exact, const Image& mesh) {
  constexpr double kWithin = 0.99, kLargestGain = 1024;
  std::vector<glm::vec3> differences;
  std::vector<float> sizes;
  for (std::size_t i = 0; i < exact.rgba.size(); ++i) {
    differences.push_back(code_values(mesh.rgba[i]) - code_values(exact.rgba[i]));
    const glm::vec3 size = glm::abs(differences.back());
    if (const float largest = std::max({size.r, size.g, size.b}); largest > 0) sizes.push_back(largest);
  }
  DifferencePicture result{{exact.width, exact.height, false, {}}, 1};
  if (!sizes.empty()) {
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(kWithin * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    while (result.gain < kLargestGain && 2 * result.gain * double(*at) <= 0.5) result.gain *= 2;
  }
  for (const glm::vec3& d : differences)
    result.picture.rgba.emplace_back(glm::clamp(0.5f + static_cast<float>(result.gain) * d, 0.0f, 1.0f), 1.0f);
  return result;
}

}  // namespace iso
