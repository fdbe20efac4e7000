// Exact sums: an expansion is a number written as a sum of doubles whose bits do not overlap, so that its largest term has its sign
// [Shewchuk 1997, sections 2.2 to 2.6]. Exact for round-to-even as long as no product of two terms overflows or has bits below 2^-1074.
#pragma once

#include <array>
#include <cmath>

namespace iso {

// N is the largest number of terms. Terms are not zero and grow in magnitude; a sum without terms is zero.
template <int N>
struct Expansion {
  std::array<double, N> term{};
  int size = 0;

  void push(double x) {
    if (x != 0) term[size++] = x;
  }
  int sign() const { return size == 0 ? 0 : (term[size - 1] > 0 ? 1 : -1); }
};

// a + b and a b as rounded value and what rounding took away.
struct Rounded {
  double value, rest;
};
inline Rounded two_sum(double a, double b) {
  const double s = a + b, of_b = s - a;
  return {s, (a - (s - of_b)) + (b - of_b)};
}
inline Rounded two_product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

inline Expansion<2> exact_difference(double a, double b) {
  const Rounded d = two_sum(a, -b);
  Expansion<2> e;
  e.push(d.rest);
  e.push(d.value);
  return e;
}

// The sum of two expansions: their terms in order of magnitude through one chain of additions [Shewchuk 1997, theorem 13].
template <int Most, int N, int M>
Expansion<Most> sum(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<Most> s;
  double carry = 0;
  for (int i = 0, j = 0; i < e.size || j < f.size;) {
    const bool from_e = j == f.size || (i < e.size && std::abs(e.term[i]) < std::abs(f.term[j]));
    const Rounded r = two_sum(carry, from_e ? e.term[i++] : f.term[j++]);
    s.push(r.rest);
    carry = r.value;
  }
  s.push(carry);
  return s;
}

// An expansion times a double [Shewchuk 1997, theorem 19].
template <int N>
Expansion<2 * N> scaled(const Expansion<N>& e, double by) {
  Expansion<2 * N> s;
  double carry = 0;
  for (int i = 0; i < e.size; ++i) {
    const Rounded product = two_product(e.term[i], by);
    const Rounded low = two_sum(carry, product.rest);
    const Rounded high = two_sum(product.value, low.value);
    s.push(low.rest);
    s.push(high.rest);
    carry = high.value;
  }
  s.push(carry);
  return s;
}

template <int N, int M>
Expansion<N + M> operator+(const Expansion<N>& e, const Expansion<M>& f) {
  return sum<N + M>(e, f);
}
template <int N>
Expansion<N> operator-(Expansion<N> e) {
  for (int i = 0; i < e.size; ++i) e.term[i] = -e.term[i];
  return e;
}
template <int N, int M>
Expansion<2 * N * M> operator*(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<2 * N * M> product;
  for (int j = 0; j < f.size; ++j) product = sum<2 * N * M>(product, scaled(e, f.term[j]));
  return product;
}

}  // namespace iso
