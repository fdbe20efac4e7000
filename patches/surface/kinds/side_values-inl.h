// What the kinds with any number of sides are made of: for each side a parameter s along it and a distance h from it, both in [0, 1].
#pragma once

#include "patches/surface/kinds/domain-inl.h"

namespace iso {

// Of side k from v_(k-1) to v_k, with generalised barycentric coordinates phi: s = phi_k / (phi_(k-1) + phi_k), h = the sum of the other
// phi_j [Hettinga 2021, 2.3.5]. On the side s is the fraction of its length and h is 0; h grows linearly along the neighbours. `s_rest` and
// `h_rest` are 1 - s and 1 - h. Where s has no limit (n = 3, at the corner opposite) h_rest vanishes to first order.
template <class T>
struct SideValues {
  std::array<T, kMostSides> s, s_rest, h, h_rest;
};

// Entry j: the product of all values but those of sides j and j + 1, which meet in corner j.
template <class T>
std::array<T, kMostSides> products_without_two(int n, const std::array<T, kMostSides>& value) {
  std::array<T, kMostSides + 1> before, after;  // before[k]: of 0 .. k - 1; after[k]: of k .. n - 1
  before[0] = T(1.0);
  after[n] = T(1.0);
  for (int k = 0; k < n; ++k) before[k + 1] = k == 0 ? value[0] : before[k] * value[k];
  for (int k = n - 1; k >= 0; --k) after[k] = k == n - 1 ? value[k] : value[k] * after[k + 1];
  std::array<T, kMostSides> product;
  for (int j = 0; j + 1 < n; ++j) product[j] = j == 0 ? after[2] : j + 2 == n ? before[j] : before[j] * after[j + 2];
  T middle = value[1];
  for (int k = 2; k + 1 < n; ++k) middle = middle * value[k];
  product[n - 1] = middle;
  return product;
}

// What mean value coordinates are made of: the coordinate of corner j is (T_j + T_(j+1)) / |v_j - x|, with T_k the tangent of half the
// angle that side k takes up [Floater 2003; Hettinga 2021, eq. 2.9]. T_k = N_k / D_k; D_k takes the place of the distance from side k in
// Wachspress's products, and factor_j = (N_j D_(j+1) + N_(j+1) D_j) / |v_j - x| is what the coordinate has beside them. No limit at a
// corner.
template <class T>
struct MeanValueParts {
  std::array<T, kMostSides> divisor, factor;
};
template <class T>
MeanValueParts<T> mean_value_parts(const DomainPoint<T>& x) {
  using std::sqrt;
  const int n = x.sides;
  std::array<T, kMostSides> length, numerator;
  std::array<std::array<T, 2>, kMostSides> corner;  // v_k - x
  MeanValueParts<T> parts;
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < 2; ++c) corner[k][c] = x.to_corner(k, c);
  for (int k = 0; k < n; ++k) length[k] = sqrt(corner[k][0] * corner[k][0] + corner[k][1] * corner[k][1]);
  const Vec2 side = domain_rates(n).corner[1];
  const double squared_side = glm::dot(side, side);
  for (int k = 0; k < n; ++k) {
    const int from = (k + n - 1) % n;
    const T lengths = length[from] * length[k], dot = corner[from][0] * corner[k][0] + corner[from][1] * corner[k][1];
    const T& distance = x.distance[k];
    // (1 - cos) / sin is told on the side itself, sin / (1 + cos) where the side is seen from its end.
    numerator[k] = where_positive(dot, distance * squared_side, lengths - dot);
    parts.divisor[k] = where_positive(dot, lengths + dot, distance);
  }
  for (int j = 0; j < n; ++j) {
    const int next = (j + 1) % n;
    parts.factor[j] = (numerator[j] * parts.divisor[next] + numerator[next] * parts.divisor[j]) / length[j];
  }
  return parts;
}

// Of Wachspress's coordinates, or of mean value coordinates. Factors that all coordinates of a fraction have in common are left out of it,
// so that nothing is 0 / 0 on other sides.
template <class T>
SideValues<T> side_values(const DomainPoint<T>& x, SideParameters parameters) {
  const int n = x.sides;
  const bool mean_value = parameters == SideParameters::mean_value;
  MeanValueParts<T> parts;
  if (mean_value) parts = mean_value_parts(x);
  const std::array<T, kMostSides>& divisor = mean_value ? parts.divisor : x.distance;
  std::array<T, kMostSides> phi = products_without_two(n, divisor);
  if (mean_value)
    for (int j = 0; j < n; ++j) phi[j] = phi[j] * parts.factor[j];
  T sum = phi[0];
  for (int j = 1; j < n; ++j) sum = sum + phi[j];
  const T scale = T(1.0) / sum;
  for (int j = 0; j < n; ++j) phi[j] = phi[j] * scale;

  SideValues<T> of;
  for (int k = 0; k < n; ++k) {
    const int from = (k + n - 1) % n, next = (k + 1) % n;
    T end = divisor[from], start = divisor[next];
    if (mean_value) {
      end = end * parts.factor[k];
      start = start * parts.factor[from];
    }
    shares(end, start, of.s[k], of.s_rest[k]);
    T others = phi[next];
    for (int j = 2; j + 1 < n; ++j) others = others + phi[(k + j) % n];
    of.h[k] = others;
    of.h_rest[k] = phi[from] + phi[k];
  }
  return of;
}

}  // namespace iso
