// Tables that depend on a degree alone, made when first asked for.
#pragma once

#include <array>
#include <utility>

#include "patches/base/bspline_basis.h"

namespace iso {

template <class T, T (*make)(int), int degree>
const T& of_this_degree() {
  static const T made = make(degree);
  return made;
}

template <class T, T (*make)(int), int... degrees>
const T& of_one_degree(int degree, std::integer_sequence<int, degrees...>) {
  static constexpr std::array<const T& (*)(), sizeof...(degrees)> kGet{&of_this_degree<T, make, degrees>...};
  return kGet[static_cast<std::size_t>(degree)]();
}

// What `make(degree)` makes, for degrees up to kMaxDegree; safe from all threads.
template <class T, T (*make)(int)>
const T& of_degree(int degree) {
  return of_one_degree<T, make>(degree, std::make_integer_sequence<int, kMaxDegree + 1>());
}

}  // namespace iso
