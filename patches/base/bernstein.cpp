#include "patches/base/bernstein.h"

namespace iso {

void bernstein_basis(int degree, double s, BernsteinBasis& b) {
  const double r = 1 - s;
  b.B[0] = 1;
  for (int n = 1; n <= degree; ++n) {
    if (n == degree)  // derivative from the functions of one degree less
      for (int i = 0; i <= degree; ++i) b.D[i] = degree * ((i > 0 ? b.B[i - 1] : 0.0) - (i < degree ? b.B[i] : 0.0));
    double carried = 0;
    for (int i = 0; i < n; ++i) {
      const double value = b.B[i];
      b.B[i] = carried + r * value;
      carried = s * value;
    }
    b.B[n] = carried;
  }
  if (degree == 0) b.D[0] = 0;
}

std::vector<double> bernstein_product(const std::vector<double>& a, const std::vector<double>& b) {
  const int m = static_cast<int>(a.size()) - 1, n = static_cast<int>(b.size()) - 1;
  const auto choose = [](int top, int k) {
    double c = 1;
    for (int i = 1; i <= k; ++i) c = c * (top - k + i) / i;
    return c;
  };
  std::vector<double> product(m + n + 1, 0.0);
  for (int i = 0; i <= m; ++i)
    for (int j = 0; j <= n; ++j) product[i + j] += a[i] * b[j] * choose(m, i) * choose(n, j) / choose(m + n, i + j);
  return product;
}

namespace {

int sign_changes(const std::vector<double>& c) {
  int changes = 0;
  double last = 0;
  for (const double x : c) {
    if (x == 0) continue;
    if (last != 0 && (x > 0) != (last > 0)) ++changes;
    last = x;
  }
  return changes;
}

// The only sign change of c in [0, 1], by bisection on the value.
double bisect(const std::vector<double>& c) {
  double lo = 0, hi = 1;
  const bool rising = bernstein_value(c, 0.0) < 0 || bernstein_value(c, 1.0) > 0;
  for (int step = 0; step < 60 && hi - lo > kEps; ++step) {
    const double mid = 0.5 * (lo + hi);
    ((bernstein_value(c, mid) < 0) == rising ? lo : hi) = mid;
  }
  return 0.5 * (lo + hi);
}

// Descartes' rule bounds the roots by the sign changes; halve until it says none or one.
void collect_roots(const std::vector<double>& c, double lo, double hi, std::vector<double>& roots) {
  const int changes = sign_changes(c);
  if (changes == 0) return;
  if (changes == 1 || hi - lo < 1e-12) {
    roots.push_back(lo + (hi - lo) * bisect(c));
    return;
  }
  std::vector<double> left, right;
  bernstein_split(c, 0.5, left, right);
  const double mid = 0.5 * (lo + hi);
  collect_roots(left, lo, mid, roots);
  if (left.back() == 0) roots.push_back(mid);
  collect_roots(right, mid, hi, roots);
}

}  // namespace

std::vector<double> bernstein_roots(const std::vector<double>& c) {
  std::vector<double> roots;
  collect_roots(c, 0, 1, roots);
  std::erase_if(roots, [](double s) { return s <= 0 || s >= 1; });
  return roots;
}

}  // namespace iso
