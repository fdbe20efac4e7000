// How far hits lie from the surface they name, in shares of the scene's size: the point on the ray against S(u, v). S is evaluated by the
// surface itself (de Boor), not by the polynomials the tracer solves.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "raytracer/tracer.h"

namespace iso::test {

inline constexpr double kMostResidual = 1e-12;
// Cosine between ray and normal below which a ray grazes: rounding moves the hit along the ray by its inverse.
inline constexpr double kGrazingCosine = 1e-3;

inline std::string text_of(const Ray& r) {
  return fmt::format("o ({:.17g} {:.17g} {:.17g}) d ({:.17g} {:.17g} {:.17g})", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
}

inline double cosine_at(const Tracer& tracer, const Hit& hit, const Ray& ray) {
  return glm::dot(tracer.surface_point(hit).n, ray.d) / glm::length(ray.d);
}

class Residuals {
 public:
  // `cosine`: between ray and normal. Grazing hits are only counted.
  void add(const Tracer& tracer, const Ray& ray, const Hit& hit, double cosine, double size) {
    if (!(std::abs(cosine) > kGrazingCosine)) {
      ++grazing_;
      return;
    }
    const Placed& placed = tracer.scene().placed[static_cast<std::size_t>(hit.placed)];
    const Vec3 p = placed.to_world.point(point(tracer.face(hit).surface, hit.uv));
    const double residual = glm::length(ray.o + hit.t * ray.d - p) / size;
    ++count_;
    const double bin = kPerDecade * (std::log10(std::max(residual, 1e-20)) + 20);
    ++bins_[static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0))];
    if (!(residual <= worst_)) {
      worst_ = residual;
      worst_case_ = fmt::format("face {} uv {:.17g} {:.17g} t {:.17g} status {} n.d {:.3g}: {}", hit.face, hit.uv.x, hit.uv.y, hit.t,
                                int(hit.status), cosine, text_of(ray));
    }
  }

  void add(const Residuals& o) {
    for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += o.bins_[i];
    count_ += o.count_;
    grazing_ += o.grazing_;
    if (!(o.worst_ <= worst_)) {
      worst_ = o.worst_;
      worst_case_ = o.worst_case_;
    }
  }

  std::uint64_t count() const { return count_; }

  void finish(const std::string& name) const {
    fmt::print("[ measured ] {}: residual of {} hits: largest {:.2g} of the size, 99.99th percentile below {:.2g}; {} grazing hits apart\n",
               name, count_, worst_, percentile(0.9999), grazing_);
    EXPECT_LE(worst_, kMostResidual) << name << ", " << worst_case_;
    EXPECT_LE(grazing_, (count_ + grazing_) / 100) << name;
  }

 private:
  static constexpr int kPerDecade = 20, kBins = 20 * kPerDecade;

  // The upper end of its bin.
  double percentile(double share) const {
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i)
      if (static_cast<double>(seen += bins_[i]) >= share * static_cast<double>(count_))
        return std::min(worst_, std::pow(10.0, (static_cast<double>(i) + 1) / kPerDecade - 20));
    return worst_;
  }

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0, grazing_ = 0;
  double worst_ = 0;
  std::string worst_case_;
};

}  // namespace iso::test
