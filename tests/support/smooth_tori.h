// Closed surfaces of smooth patches, made by formula.
#pragma once

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

}  // namespace iso::test
