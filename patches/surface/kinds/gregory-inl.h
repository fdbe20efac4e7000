// The Gregory quadrilateral and the Gregory triangle.
//
// Points of all kinds with pairs: five a corner (k = 0 .. n - 1, point 5 k + j): the corner; the boundary point next to it on side k + 1;
// the boundary point next to it on side k; and the pair of inner points, the one of side k + 1 first.
#pragma once

#include "patches/surface/kinds/bezier_triangle-inl.h"

namespace iso {

// Gregory quadrilateral, twenty points. A bicubic patch whose inner points are blended pairs [Hettinga 2021, 2.3.4]: the one of side k + 1
// counts there (t = 0), the other on side k.
template <class T>
void gregory_quad_weights(const T& s, const T& t, T* W) {
  const T u = 0.5 * s, v = 0.5 * t;  // from corner 0 along side 1, and along side 0
  const T one(1.0), u1 = one - u, v1 = one - v;
  T U[4], V[4];
  bernstein_weights(3, u, u1, U);
  bernstein_weights(3, v, v1, V);
  // Corner k: its place in the net, the place of its neighbour on side k + 1, and on side k; its distances from sides k + 1 and k.
  struct Corner {
    int i, j, along_i, along_j, back_i, back_j;
    const T *from_next, *from_own;
  };
  const Corner corners[4] = {
      {0, 0, 1, 0, 0, 1, &v, &u}, {3, 0, 3, 1, 2, 0, &u1, &v}, {3, 3, 2, 3, 3, 2, &v1, &u1}, {0, 3, 0, 2, 1, 3, &u, &v1}};
  for (int k = 0; k < 4; ++k) {
    const Corner& c = corners[k];
    const int inner_i = c.i == 0 ? 1 : 2, inner_j = c.j == 0 ? 1 : 2;
    W[5 * k] = U[c.i] * V[c.j];
    W[5 * k + 1] = U[c.along_i] * V[c.along_j];
    W[5 * k + 2] = U[c.back_i] * V[c.back_j];
    // The point of side k + 1 weighs as much as the distance from side k.
    const T inner = U[inner_i] * V[inner_j], none = inner * 0.0;
    W[5 * k + 3] = blend(*c.from_own, *c.from_next, inner, none);
    W[5 * k + 4] = blend(*c.from_own, *c.from_next, none, inner);
  }
}

// Gregory triangle, fifteen points. The boundary points are of cubic curves; raised to degree four they are the border of a quartic Bezier
// triangle, whose three inner points are blended pairs [Longhi 1985; Hettinga 2021, 2.3.4]. With coordinates (a, b, c) of the corner,
// the next and the one before, the pair of side k + 1 (c = 0) weighs as (1 - c) b to (1 - b) c.
//
// Along side k (e its coordinate that vanishes, f that of its start, u that of its end): the derivative with f falling as e grows is
// 4 sum_j B_j^3(u) (r_j - q_j), q_j the quartic points of the side, r_1 and r_2 its inner points, r_0 and r_3 the quartic points next to
// its ends on the other sides.
template <class T>
void gregory_triangle_weights(const DomainPoint<T>& x, T* W) {
  std::array<T, 15> quartic;
  bezier_triangle_weights(4, x, quartic.data());
  const T coordinate[3] = {x.distance[2] * (2.0 / 3), x.distance[0] * (2.0 / 3), x.distance[1] * (2.0 / 3)};
  // The quartic point with given powers of the coordinates of corner k, of the next and of the one before.
  const auto point = [&](int k, int next, int before) -> const T& {
    const int power[3] = {4 - next - before, next, before};  // of corners k, k + 1, k + 2
    return quartic[triangle_index(4, power[(4 - k) % 3], power[(5 - k) % 3])];
  };
  for (int k = 0; k < 3; ++k) {
    const T &a = coordinate[k], &b = coordinate[(k + 1) % 3], &c = coordinate[(k + 2) % 3];
    W[5 * k] = point(k, 0, 0) + (point(k, 1, 0) + point(k, 0, 1)) * 0.25;
    W[5 * k + 1] = point(k, 1, 0) * 0.75 + point(k, 2, 0) * 0.5;
    W[5 * k + 2] = point(k, 0, 1) * 0.75 + point(k, 0, 2) * 0.5;
    const T of_next = (a + b) * b, of_own = (a + c) * c, none = a * 0.0;
    const T& inner = point(k, 1, 1);
    W[5 * k + 3] = blend(of_next, of_own, inner, none);
    W[5 * k + 4] = blend(of_next, of_own, none, inner);
  }
}

}  // namespace iso
