// The patch of corner interpolators.
#pragma once

#include "patches/surface/kinds/side_values-inl.h"

namespace iso {

// Charrot-Gregory, five points a corner as in gregory-inl.h. Side k has the cubic curve p_k and the field t_k = 3 sum_j B_j (q_j - p_j),
// q_j its second row. In corner k the sum over both sides' ribbons, less what they have in common, with u along side k + 1 and v back along
// side k [Charrot, Gregory 1984; Hettinga 2021, 8.2.5 and its erratum]:
//
//   c_k = p_(k+1)(u) + v t_(k+1)(u) + p_k(1 - v) + u t_k(1 - v) - v_k - u t_k(1) - v t_(k+1)(0) - u v (v t_(k+1)'(0) - u t_k'(1)) / (u + v)
//
// and the corners weigh as the squared distances from all sides but their own. The distances are lengths (`distance`), or h of Wachspress's
// or of mean value coordinates; u = d_k / (d_k + d_(k+2)), v = d_(k+1) / (d_(k-1) + d_(k+1)) of the same distances.
//
// Along side k, with derivatives of the two corners' parameters: p_k' and t_k combined, the latter with a positive factor.
template <class T>
void add_corner_interpolator(int n, int k, const T& u, const T& u1, const T& v, const T& v1, const T& share_of_corner, T* W) {
  const int before = (k + n - 1) % n, after = (k + 1) % n;
  const int own[5] = {5 * k, 5 * k + 1, 5 * k + 2, 5 * k + 3, 5 * k + 4};
  // Boundary and second row from the corner on, along side k + 1 and back along side k.
  const int p_next[4] = {own[0], own[1], 5 * after + 2, 5 * after}, q_next[4] = {own[2], own[3], 5 * after + 4, 5 * after + 1};
  const int p_own[4] = {own[0], own[2], 5 * before + 1, 5 * before}, q_own[4] = {own[1], own[4], 5 * before + 3, 5 * before + 2};
  T U[4], V[4];
  bernstein_weights(3, u, u1, U);
  bernstein_weights(3, v, v1, V);
  const auto add = [&](int point, const T& w) { W[point] = W[point] + share_of_corner * w; };
  const auto field = [&](int q, int p, const T& w) {
    const T part = share_of_corner * w;
    W[q] = W[q] + part;
    W[p] = W[p] - part;
  };
  const T u3 = u * 3.0, v3 = v * 3.0, one(1.0);
  for (int j = 0; j < 4; ++j) {
    add(p_next[j], U[j]);
    add(p_own[j], j == 0 ? V[j] - one : V[j]);
    field(q_next[j], p_next[j], v3 * (j == 0 ? U[j] - one : U[j]));
    field(q_own[j], p_own[j], u3 * (j == 0 ? V[j] - one : V[j]));
  }
  // t_(k+1)'(0) and -t_k'(1) are both 9 times the second difference at the corner.
  const T uv = u * v * 9.0, none = uv * 0.0, minus = none - uv;
  T twist_next, twist_own;
  if (k == 0) {  // u and v vanish together at corner 0 only, of this chart
    twist_next = blend(v, u, minus, none);
    twist_own = blend(u, v, minus, none);
  } else {
    const T part = minus / (u + v);
    twist_next = part * v;
    twist_own = part * u;
  }
  field(q_next[1], p_next[1], twist_next);
  field(p_next[0], q_next[0], twist_next);
  field(q_own[1], p_own[1], twist_own);
  field(p_own[0], q_own[0], twist_own);
}

template <class T>
void charrot_gregory_weights(const DomainPoint<T>& x, SideParameters parameters, T* W) {
  const int n = x.sides;
  const std::array<T, kMostSides> d = parameters == SideParameters::distance ? x.distance : side_values(x, parameters).h;
  std::array<T, kMostSides> corner = products_without_two(n, d);
  T sum(0.0);
  for (int k = 0; k < n; ++k) {
    corner[k] = corner[k] * corner[k];
    sum = sum + corner[k];
  }
  const T scale = T(1.0) / sum;
  for (int m = 0; m < 5 * n; ++m) W[m] = T(0.0);
  std::array<T, kMostSides> u, u_rest;  // v of a corner is 1 - u of the one before
  for (int k = 0; k < n; ++k) shares(d[k], d[(k + 2) % n], u[k], u_rest[k]);
  for (int k = 0; k < n; ++k) {
    const int before = (k + n - 1) % n;
    add_corner_interpolator(n, k, u[k], u_rest[k], u_rest[before], u[before], corner[k] * scale, W);
  }
}

}  // namespace iso
