// Closed surfaces of one face, made by formula: tori and a sphere with poles. Each lies about a core, a circle about the z axis or a point,
// within a reach of which nothing of the surface is found: so what lies inside is known without tracing.
#pragma once

#include <string>
#include <vector>

#include "tests/support/random_shapes.h"
#include "tests/support/solids.h"

namespace iso::test {

// The k-th Bezier point of a closed uniform cubic B-spline with control points P(0), P(1), ...
template <class P>
Vec3 closed_cubic_point(int k, const P& at) {
  const int i = k / 3;
  if (k % 3 == 1) return (2.0 * at(i) + at(i + 1)) / 3.0;
  if (k % 3 == 2) return (at(i) + 2.0 * at(i + 1)) / 3.0;
  return (at(i - 1) + 4.0 * at(i) + at(i + 1)) / 6.0;
}

// A torus with waves on its tube: round x across bicubic patches, curvature continuous.
inline NurbsSurface wavy_torus(int round, int across) {
  // Few control points cannot carry short waves.
  const int waves = std::min(7, round / 4);
  const auto control_point = [&](int i, int j) {
    const double u = kTwoPi * i / round, v = kTwoPi * j / across;
    const double tube = 0.4 * (1 + 0.12 * std::sin(waves * u) * std::cos(5 * v) + 0.05 * std::sin((2 * waves - 1) * u + 3 * v));
    const double reach = 1 + tube * std::cos(v);
    return Vec3(reach * std::cos(u), reach * std::sin(u), tube * std::sin(v));
  };
  const auto knots = [](int spans) {
    std::vector<double> k{0.0};
    for (int i = 0; i <= spans; ++i) k.insert(k.end(), 3, i);
    k.push_back(spans);
    return k;
  };
  NurbsSurface s;
  s.degree_u = s.degree_v = 3;
  s.count_u = 3 * round + 1;
  s.count_v = 3 * across + 1;
  s.closed_u = s.closed_v = true;
  s.knots_u = knots(round);
  s.knots_v = knots(across);
  for (int i = 0; i < s.count_u; ++i)
    for (int j = 0; j < s.count_v; ++j) {
      // The last row is the first one again, bit for bit.
      const Vec3 p = closed_cubic_point(i % (3 * round), [&](int a) {
        return closed_cubic_point(j % (3 * across), [&](int b) { return control_point((a + round) % round, (b + across) % across); });
      });
      s.poles.emplace_back(p, 1.0);
    }
  return s;
}

// A torus of 4 x 4 rational biquadratic patches.
inline NurbsSurface rational_torus() {
  NurbsSurface s = as_nurbs(Torus{{}, 1, 0.4}, {{0, 0}, {kTwoPi, kTwoPi}});
  // The seams again, bit for bit.
  const auto pole = [&](int i, int j) -> Vec4& { return s.poles[static_cast<std::size_t>(i * s.count_v + j)]; };
  for (int i = 0; i < s.count_u; ++i) pole(i, s.count_v - 1) = pole(i, 0);
  for (int j = 0; j < s.count_v; ++j) pole(s.count_u - 1, j) = pole(0, j);
  s.closed_u = s.closed_v = true;
  return s;
}

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
