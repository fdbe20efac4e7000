#include "patches/io/side_curves.h"

#include <algorithm>
#include <cmath>

#include "patches/base/check.h"

namespace iso {
namespace {

std::vector<double> bernstein_values(int degree, double t) {
  std::vector<double> B(static_cast<std::size_t>(degree) + 1, 0.0);
  B[0] = 1;
  for (std::size_t d = 1; d < B.size(); ++d) {
    B[d] = t * B[d - 1];
    for (std::size_t i = d - 1; i > 0; --i) B[i] = (1 - t) * B[i] + t * B[i - 1];
    B[0] *= 1 - t;
  }
  return B;
}

Vec3 point_at(const std::vector<Vec3>& points, double t) {
  const std::vector<double> B = bernstein_values(static_cast<int>(points.size()) - 1, t);
  Vec3 p(0.0);
  for (std::size_t i = 0; i < B.size(); ++i) p += B[i] * points[i];
  return p;
}

// The control points over [a, b]: the blossom at (a, .. a, b, .. b).
std::vector<Vec3> restricted(const std::vector<Vec3>& points, double a, double b) {
  std::vector<Vec3> part;
  for (std::size_t j = 0; j < points.size(); ++j) {
    std::vector<Vec3> work = points;
    for (std::size_t level = 1; level < points.size(); ++level) {
      const double t = level <= j ? b : a;
      for (std::size_t i = 0; i + level < points.size(); ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
    }
    part.push_back(work[0]);
  }
  return part;
}

// A piece of the B-spline, over [a, b] of the unit parameter.
struct Piece {
  std::vector<Vec3> points;
  double a, b;
};

std::vector<Piece> unit_pieces(const NurbsCurve<Vec3>& curve) {
  const double t0 = curve.knots[static_cast<std::size_t>(curve.degree)], t1 = curve.knots[curve.poles.size()];
  std::vector<Piece> pieces;
  for (const BezierSpan<Vec3>& span : bezier_spans(Curve3(curve), t0, t1)) {
    Piece piece{{}, (span.map.a - t0) / (t1 - t0), (span.map.b - t0) / (t1 - t0)};
    for (const Vec4& h : span.points) piece.points.push_back(project(h));
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

// Solves A X = R, A symmetric and positive definite, by Cholesky's factors; A is row by row.
void solve(std::vector<double>& A, std::vector<Vec3>& R) {
  const std::size_t n = R.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) A[j * n + j] -= A[j * n + k] * A[j * n + k];
    ISO_CHECK(A[j * n + j] > 0);
    A[j * n + j] = std::sqrt(A[j * n + j]);
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) A[i * n + j] -= A[i * n + k] * A[j * n + k];
      A[i * n + j] /= A[j * n + j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) R[i] -= A[i * n + k] * R[k];
    R[i] /= A[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) R[i] -= A[k * n + i] * R[k];
    R[i] /= A[i * n + i];
  }
}

// The two points at either end are given by the ends and the derivatives there; least squares finds the rest.
std::vector<Vec3> fitted(const std::vector<Piece>& pieces, int degree) {
  constexpr int kSamples = 32;  // of a piece: three times the coefficients of the highest degree
  const auto d = static_cast<std::size_t>(degree);
  std::vector<Vec3> points(d + 1, Vec3(0.0));
  const auto end_step = [&](const Piece& p, const Vec3& difference) {
    return difference * (static_cast<double>(p.points.size() - 1) / (p.b - p.a) / degree);
  };
  const Piece &first = pieces.front(), &last = pieces.back();
  points[0] = first.points[0];
  points[1] = points[0] + end_step(first, first.points[1] - first.points[0]);
  points[d] = last.points.back();
  points[d - 1] = points[d] - end_step(last, last.points.back() - last.points[last.points.size() - 2]);

  const std::size_t inner = d - 3;
  std::vector<double> A(inner * inner, 0.0);
  std::vector<Vec3> R(inner, Vec3(0.0));
  for (const Piece& piece : pieces)
    for (int i = 0; i < kSamples; ++i) {
      const double share = (i + 0.5) / kSamples;
      const std::vector<double> B = bernstein_values(degree, piece.a + share * (piece.b - piece.a));
      const Vec3 rest = point_at(piece.points, share) - B[0] * points[0] - B[1] * points[1] - B[d - 1] * points[d - 1] - B[d] * points[d];
      for (std::size_t j = 0; j < inner; ++j) {
        R[j] += (piece.b - piece.a) * B[j + 2] * rest;
        for (std::size_t k = 0; k < inner; ++k) A[j * inner + k] += (piece.b - piece.a) * B[j + 2] * B[k + 2];
      }
    }
  solve(A, R);
  std::copy(R.begin(), R.end(), points.begin() + 2);
  return points;
}

// In parts so short that control points lie close to the curve.
double distance_bound(const std::vector<Piece>& pieces, const std::vector<Vec3>& points) {
  constexpr int kParts = 8;
  double largest = 0;
  for (const Piece& piece : pieces) {
    const std::vector<Vec3> wanted = elevated_to(static_cast<int>(points.size()) - 1, piece.points);
    std::vector<Vec3> difference = restricted(points, piece.a, piece.b);
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= wanted[i];
    for (int part = 0; part < kParts; ++part)
      for (const Vec3& d : restricted(difference, double(part) / kParts, double(part + 1) / kParts))
        largest = std::max(largest, glm::length(d));
  }
  return largest;
}

}  // namespace

int pieces_of(const NurbsCurve<Vec3>& curve) { return static_cast<int>(breakpoints(curve.knots, curve.degree).size()) - 1; }

std::vector<Vec3> elevated_to(int degree, std::vector<Vec3> points) {
  ISO_CHECK(static_cast<int>(points.size()) <= degree + 1);
  while (static_cast<int>(points.size()) <= degree) {
    const auto n = static_cast<double>(points.size());
    std::vector<Vec3> raised{points.front()};
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double share = static_cast<double>(i) / n;
      raised.push_back(share * points[i - 1] + (1 - share) * points[i]);
    }
    raised.push_back(points.back());
    points = std::move(raised);
  }
  return points;
}

SideCurve bezier_side(const NurbsCurve<Vec3>& curve, int degree) {
  const std::vector<Piece> pieces = unit_pieces(curve);
  if (pieces.size() == 1) return {elevated_to(degree, pieces[0].points), 0};
  ISO_CHECK(degree >= std::max(curve.degree, 3));
  SideCurve side{fitted(pieces, degree), 0};
  side.error = distance_bound(pieces, side.points);
  return side;
}

}  // namespace iso
