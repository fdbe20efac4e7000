// Patches of ribbons with any number of sides: generalised Bezier and generalised Gregory.
//
// Side k has a ribbon, sum_(j,r) b_jr B_j(s_k) B_r(h_k), j along it, r inward; where ribbons of neighbours share a point, the one counts as
// much as the distance from the other's side. A central point takes what is missing to 1 [Varady, Salvi, Kariko 2016, as published with
// their models; Hettinga 2021, 2.3.5 and its erratum]. For n = 4 they are the tensor product Bezier and the Gregory patch.
//
// Along side k, h_k = 0: the boundary curve C(s_k), and for any direction the derivative C'(s_k) ds_k + R(s_k) dh_k with
// R = d sum_j B_j(s_k) (b_j1 - b_j0).
//
// Weights are not negative for n = 4 .. 13 (measured on grids, degrees 3 to 15): in the convex hull of the points. The central point's goes
// down to -2e-4 for n = 14 .. 16 with Wachspress's coordinates, and for n = 3 it is negative all over, -1/9 at the centre for degree 3.
#pragma once

#include "patches/surface/kinds/side_values-inl.h"

namespace iso {

inline constexpr int kMostRibbonDegree = 15;

// The Bernstein polynomials of all sides: along[k][j] B_j(s_k), inward[k][r] B_r(h_k).
template <class T, int kMost>
struct RibbonWeights {
  int sides, degree;
  SideValues<T> at;
  std::array<std::array<T, kMost + 1>, kMostSides> along, inward;
  std::array<T, kMostSides> per_distance;  // [k], not for corner 0: 1 / (h_k + h_(k+1))

  RibbonWeights(int degree_, const DomainPoint<T>& x, SideParameters parameters)
      : sides(x.sides), degree(degree_), at(side_values(x, parameters)) {
    for (int k = 0; k < sides; ++k) {
      bernstein_weights(degree, at.s[k], at.s_rest[k], along[k].data());
      bernstein_weights(degree, at.h[k], at.h_rest[k], inward[k].data());
      if (k > 0) per_distance[k] = T(1.0) / (at.h[k] + at.h[(k + 1) % sides]);
    }
  }
  // The weight in its own ribbon of side k's point j in row r.
  T in_ribbon(int k, int j, int r) const { return along[k][j] * inward[k][r]; }
  // A point near corner k: X what it weighs in the ribbon of side k + 1, Y in the one of side k.
  T at_corner(int k, const T& X, const T& Y) const {
    const T &from_own = at.h[k], &from_next = at.h[(k + 1) % sides];
    // Both vanish at corner 0, in whose chart we are, and at no other place of it.
    if (k == 0) return blend(from_own, from_next, X, Y);
    return (from_own * X + from_next * Y) * per_distance[k];
  }
  // The weight of corner k itself. Near corner 0 it is 1 less a blend of small numbers, since the difference of the two near 1 is all
  // rounding.
  T of_corner(int k) const {
    const int next = (k + 1) % sides;
    if (k != 0) return at_corner(k, in_ribbon(next, 0, 0), in_ribbon(k, degree, 0));
    const T lost_next = lost(at.s[next], at.s_rest[next], at.h[next], at.h_rest[next]);
    const T lost_own = lost(at.s_rest[k], at.s[k], at.h[k], at.h_rest[k]);
    return T(1.0) - at_corner(k, lost_next, lost_own);
  }

 private:
  // 1 - (1 - s)^d (1 - h)^d, as a multiple of s + h - s h.
  T lost(const T& s, const T& s_rest, const T& h, const T& h_rest) const {
    const T left = s_rest * h_rest;
    T sum(1.0);
    for (int k = 1; k < degree; ++k) sum = sum * left + T(1.0);
    return (s + h * s_rest) * sum;
  }
};

// Generalised Gregory, degree 3: five points a corner as in gregory-inl.h, and the central point last.
template <class T>
void generalised_gregory_weights(const DomainPoint<T>& x, SideParameters parameters, T* W) {
  const RibbonWeights<T, 3> ribbon(3, x, parameters);
  const T none(0.0);
  T rest(1.0);
  for (int k = 0; k < x.sides; ++k) {
    const int next = (k + 1) % x.sides;
    T* of = W + 5 * k;
    of[0] = ribbon.of_corner(k);
    of[1] = ribbon.at_corner(k, ribbon.in_ribbon(next, 1, 0), ribbon.in_ribbon(k, 3, 1));
    of[2] = ribbon.at_corner(k, ribbon.in_ribbon(next, 0, 1), ribbon.in_ribbon(k, 2, 0));
    of[3] = ribbon.at_corner(k, ribbon.in_ribbon(next, 1, 1), none);
    of[4] = ribbon.at_corner(k, none, ribbon.in_ribbon(k, 2, 1));
    for (int j = 0; j < 5; ++j) rest = rest - of[j];
  }
  W[5 * x.sides] = rest;
}

// Generalised Bezier, degree d >= 3, l = floor((d + 1) / 2) rows a side. The order of the .gbp files: the central point; then row by row,
// r = 0 .. l - 1, sides 1, 2, .. n, and on each the points j = r .. d - 1 - r from corner side - 1 on. The others of a ribbon are its
// neighbours': (j, r) of side k + 1 with j <= r is (d - r, j) of side k.
inline int ribbon_rows(int degree) { return (degree + 1) / 2; }
// The number of point (j, r) of a side, r <= j < d - r.
inline int ribbon_index(int sides, int degree, int side, int j, int r) {
  return 1 + sides * r * (degree + 1 - r) + ((side + sides - 1) % sides) * (degree - 2 * r) + j - r;
}

// The blends: where both indices are below 2 by the distances; on the diagonals beyond, halves; between the diagonals the ribbon's own.
template <int kMost, class T>
void generalised_bezier_weights_to(int degree, const DomainPoint<T>& x, SideParameters parameters, T* W) {
  const RibbonWeights<T, kMost> ribbon(degree, x, parameters);
  const int n = x.sides, d = degree;
  T rest(1.0);
  for (int k = 0; k < n; ++k) {
    const int own = k, next = (k + 1) % n;  // at corner k
    for (int r = 0; r < ribbon_rows(d); ++r) {
      for (int j = r; j < d - r; ++j) {
        T& w = W[ribbon_index(n, d, next, j, r)];
        const bool at_start = r < 2 && j < 2, at_end = r == 0 && j == d - 1;
        if (r == 0 && j == 0)
          w = ribbon.of_corner(k);
        else if (at_start)
          w = ribbon.at_corner(k, ribbon.in_ribbon(next, j, r), ribbon.in_ribbon(own, d - r, j));
        else if (at_end)
          w = ribbon.at_corner(next, ribbon.in_ribbon((next + 1) % n, 0, 1), ribbon.in_ribbon(next, j, r));
        else if (j == r)
          w = (ribbon.in_ribbon(next, r, r) + ribbon.in_ribbon(own, d - r, r)) * 0.5;
        else
          w = ribbon.in_ribbon(next, j, r);
        rest = rest - w;
      }
    }
  }
  W[0] = rest;
}

template <class T>
void generalised_bezier_weights(int degree, const DomainPoint<T>& x, SideParameters parameters, T* W) {
  if (degree <= 5) return generalised_bezier_weights_to<5>(degree, x, parameters, W);
  generalised_bezier_weights_to<kMostRibbonDegree>(degree, x, parameters, W);
}

}  // namespace iso
