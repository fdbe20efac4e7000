// Patches with any number of sides for tests: every basis there is, random points, and evaluation from the weights.
#pragma once

#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "patches/surface/patch_chart.h"

namespace iso::test {

inline const std::vector<int>& tested_sides() {
  static const std::vector<int> all{3, 4, 5, 6, 7, 8, 10, 16};
  return all;
}

// Every kind with every number of sides, degree and choice of parameters that it has, as far as tests go.
inline std::vector<PatchBasis> every_basis() {
  std::vector<PatchBasis> all;
  for (int kind = 0; kind < kPatchKinds; ++kind)
    for (int sides : tested_sides())
      for (int degree = 1; degree <= 8; ++degree)
        for (SideParameters parameters : {SideParameters::wachspress, SideParameters::mean_value, SideParameters::distance}) {
          const PatchBasis basis{static_cast<PatchKind>(kind), sides, degree, parameters};
          if (problem_of(basis).empty()) all.push_back(basis);
        }
  return all;
}

inline std::string told(const PatchBasis& basis) {
  constexpr const char* kParameters[] = {"wachspress", "mean value", "distance"};
  return std::string(name_of(basis.kind)) + ", " + std::to_string(basis.sides) + " sides, degree " + std::to_string(basis.degree) + ", " +
         kParameters[static_cast<int>(basis.parameters)];
}

class Numbers {
 public:
  explicit Numbers(unsigned seed) : engine_(seed) {}
  double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  Vec2 in_chart() { return {(*this)(0, 1), (*this)(0, 1)}; }
  Vec3 vector() { return {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; }
  std::vector<Vec3> points(const PatchBasis& basis) {
    std::vector<Vec3> all(point_count(basis));
    for (Vec3& p : all) p = vector();
    return all;
  }

 private:
  std::mt19937_64 engine_;
};

inline std::vector<double> weights(const PatchBasis& basis, const Vec2& st) {
  std::vector<double> W(point_count(basis));
  weights_at(basis, st, std::span<double>(W));
  return W;
}
inline std::vector<Dual2> dual_weights(const PatchBasis& basis, const Vec2& st) {
  std::vector<Dual2> W(point_count(basis));
  weights_at(basis, st, std::span<Dual2>(W));
  return W;
}
inline Vec3 point_at(const PatchBasis& basis, const std::vector<Vec3>& points, const Vec2& st) {
  const std::vector<double> W = weights(basis, st);
  Vec3 sum(0.0);
  for (std::size_t m = 0; m < W.size(); ++m) sum += W[m] * points[m];
  return sum;
}
// Su, Sv: the derivatives in s and t of the chart of corner 0.
inline Jet2 jet_at(const PatchBasis& basis, const std::vector<Vec3>& points, const Vec2& st) {
  const std::vector<Dual2> W = dual_weights(basis, st);
  Jet2 jet;
  for (std::size_t m = 0; m < W.size(); ++m) {
    jet.S += W[m].f * points[m];
    jet.Su += W[m].u * points[m];
    jet.Sv += W[m].v * points[m];
    jet.Suu += W[m].uu * points[m];
    jet.Suv += W[m].uv * points[m];
    jet.Svv += W[m].vv * points[m];
  }
  return jet;
}

// The points as seen from the next corner.
inline std::vector<Vec3> turned(const PatchBasis& basis, const std::vector<Vec3>& points) {
  std::vector<Vec3> all;
  for (int m : points_from_next_corner(basis)) all.push_back(points[m]);
  return all;
}

// A Bezier curve at u by de Casteljau.
inline Vec3 curve_at(std::vector<Vec3> points, double u) {
  for (std::size_t left = points.size() - 1; left > 0; --left)
    for (std::size_t i = 0; i < left; ++i) points[i] = (1 - u) * points[i] + u * points[i + 1];
  return points[0];
}
inline std::vector<Vec3> chosen(const std::vector<Vec3>& points, const std::vector<int>& indices) {
  std::vector<Vec3> all;
  for (int m : indices) all.push_back(points[m]);
  return all;
}
inline std::vector<Vec3> legs(const std::vector<Vec3>& points) {
  std::vector<Vec3> all;
  for (std::size_t i = 1; i < points.size(); ++i) all.push_back(static_cast<double>(points.size() - 1) * (points[i] - points[i - 1]));
  return all;
}

// Columns: the derivatives of the domain's point in s and t, which is bilinear.
struct DomainFrame {
  Vec2 by_s, by_t;
};
inline DomainFrame domain_frame(int sides, const Vec2& st) {
  return {domain_point(sides, {1, st.y}) - domain_point(sides, {0, st.y}), domain_point(sides, {st.x, 1}) - domain_point(sides, {st.x, 0})};
}

}  // namespace iso::test
