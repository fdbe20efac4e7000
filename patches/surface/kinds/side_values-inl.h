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

// Entry j: what the mean value coordinate of corner j has beside Wachspress's product of distances, times a common factor: with T_k the
// tangent of half the angle that side k takes up, (T_j + T_(j+1)) d_j d_(j+1) / |v_j - x| [Floater 2003; Hettinga 2021, eq. 2.9]. No limit
// at a corner.
template <class T>
std::array<T, kMostSides> mean_value_factors(const DomainPoint<T>& x) {
  using std::sqrt;
  const int n = x.sides;
  std::array<T, kMostSides> length, tangent;        // tangent[k]: of side k, times d_k, the same for all sides but for a factor
  std::array<std::array<T, 2>, kMostSides> corner;  // v_k - x
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < 2; ++c) corner[k][c] = x.to_corner(k, c);
  for (int k = 0; k < n; ++k) length[k] = sqrt(corner[k][0] * corner[k][0] + corner[k][1] * corner[k][1]);
  for (int k = 0; k < n; ++k) {
    const int from = (k + n - 1) % n;
    tangent[k] = length[from] * length[k] - (corner[from][0] * corner[k][0] + corner[from][1] * corner[k][1]);
  }
  std::array<T, kMostSides> factor;
  for (int j = 0; j < n; ++j) {
    const int next = (j + 1) % n;
    factor[j] = (tangent[j] * x.distance[next] + tangent[next] * x.distance[j]) / length[j];
  }
  return factor;
}

// Of Wachspress's coordinates, or of mean value coordinates. Factors that all coordinates of a fraction have in common are left out of it,
// so that nothing is 0 / 0 on other sides.
template <class T>
SideValues<T> side_values(const DomainPoint<T>& x, SideParameters parameters) {
  const int n = x.sides;
  std::array<T, kMostSides> phi = products_without_two(n, x.distance), factor;
  const bool mean_value = parameters == SideParameters::mean_value;
  if (mean_value) {
    factor = mean_value_factors(x);
    for (int j = 0; j < n; ++j) phi[j] = phi[j] * factor[j];
  }
  T sum = phi[0];
  for (int j = 1; j < n; ++j) sum = sum + phi[j];
  const T scale = T(1.0) / sum;
  for (int j = 0; j < n; ++j) phi[j] = phi[j] * scale;

  SideValues<T> of;
  for (int k = 0; k < n; ++k) {
    const int from = (k + n - 1) % n, next = (k + 1) % n;
    T end = x.distance[from], start = x.distance[next];
    if (mean_value) {
      end = end * factor[k];
      start = start * factor[from];
    }
    of.s[k] = share(end, start);
    of.s_rest[k] = share(start, end);
    T others = phi[next];
    for (int j = 2; j + 1 < n; ++j) others = others + phi[(k + j) % n];
    of.h[k] = others;
    of.h_rest[k] = phi[from] + phi[k];
  }
  return of;
}

}  // namespace iso
