// Closed surfaces of one face, made by formula: tori and a sphere with poles. Each lies about a core, a circle about the z axis or a point,
// within a reach of which nothing of the surface is found: so what lies inside is known without tracing.
#pragma once

#include <string>
#include <vector>

#include "tests/support/random_shapes.h"
#include "tests/support/smooth_tori.h"

namespace iso::test {

struct ClosedSurface {
  std::string name;
  NurbsSurface surface;
  Box2 domain;
  double core = 0;   // radius of the core
  double reach = 0;  // of its surroundings that are free
  double size = 0;   // diagonal

  ClosedSurface(std::string called, NurbsSurface s) : name(std::move(called)), surface(std::move(s)), domain(natural_domain(surface)) {
    constexpr int kSamples = 200;
    constexpr double kSafe = 0.9;  // for what lies between the samples
    Box3 box;
    Range radii;
    const auto sampled = [&](const auto& take) {
      for (int i = 0; i <= kSamples; ++i)
        for (int j = 0; j <= kSamples; ++j) take(point(surface, domain.lo + domain.size() * Vec2(i, j) / double(kSamples)));
    };
    sampled([&](const Vec3& p) {
      box.include(p);
      radii.include(std::hypot(p.x, p.y));
    });
    size = box.diagonal();
    const bool is_ring = radii.lo > 0.1 * radii.hi;
    core = is_ring ? radii.middle() : 0;
    double nearest = kInf;
    sampled([&](const Vec3& p) { nearest = std::min(nearest, glm::length(p - core_near(p))); });
    reach = kSafe * nearest;
  }

  Vec3 core_near(const Vec3& p) const {
    const double r = std::hypot(p.x, p.y);
    return core == 0 ? Vec3(0.0) : Vec3(core * p.x / r, core * p.y / r, 0);
  }
  // Outward is away from the core.
  Vec3 outward(const Vec3& n, const Vec3& p) const { return glm::dot(n, p - core_near(p)) < 0 ? -n : n; }
  Vec3 at(UV uv) const { return point(surface, uv); }
};

inline constexpr int kClosedSurfaces = 4;
inline constexpr const char* kClosedNames[kClosedSurfaces]{"BicubicTorus", "RationalTorus", "SphereWithPoles", "WavyTorus"};

inline ClosedSurface closed_surface(int index) {
  switch (index) {
    case 0:
      return {"bicubic torus", wavy_torus(8, 4)};
    case 1:
      return {"rational torus", rational_torus()};
    case 2:
      return {"sphere with poles", as_nurbs(Sphere{{}, 1.0}, {{0, -kPi / 2}, {kTwoPi, kPi / 2}})};
    default:
      return {"wavy torus", wavy_torus(64, 32)};
  }
}

}  // namespace iso::test
