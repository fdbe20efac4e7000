#include "tests/bench/uniform_mesh.h"

#include "patches/base/check.h"
#include "patches/surface/bezier_patch.h"
#include "tests/bench/timing.h"

namespace iso::bench {
namespace {

// Bernstein weights of the parameters first, first + step, ...
class Weights {
 public:
  Weights(int degree, double first, double step, int count) : stride_(static_cast<std::size_t>(degree) + 1), count_(count) {
    values_.resize(stride_ * static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) set(&values_[stride_ * static_cast<std::size_t>(k)], degree, first + k * step);
  }
  int count() const { return count_; }
  const double* at(int k) const { return &values_[stride_ * static_cast<std::size_t>(k)]; }

 private:
  static void set(double* b, int degree, double t) {
    b[0] = 1;
    for (int d = 1; d <= degree; ++d) {
      b[d] = t * b[d - 1];
      for (int i = d - 1; i > 0; --i) b[i] = t * b[i - 1] + (1 - t) * b[i];
      b[0] *= 1 - t;
    }
  }
  std::size_t stride_;
  int count_;
  std::vector<double> values_;
};

// A row of the surface's points: s fixed, t as the weights say.
using Row = std::vector<Vec3>;
Row row_of(const BezierPatch& patch, double s, const Weights& weights) {
  const Weights in_s(patch.pu, s, 0, 1);
  std::vector<Vec4> curve(static_cast<std::size_t>(patch.pv) + 1, Vec4(0.0));
  for (int i = 0; i <= patch.pu; ++i)
    for (int j = 0; j <= patch.pv; ++j) curve[static_cast<std::size_t>(j)] += in_s.at(0)[i] * patch.at(i, j);
  Row row;
  row.reserve(static_cast<std::size_t>(weights.count()));
  for (int k = 0; k < weights.count(); ++k) {
    Vec4 sum(0.0);
    for (std::size_t j = 0; j < curve.size(); ++j) sum += weights.at(k)[j] * curve[j];
    row.push_back(Vec3(sum) / sum.w);
  }
  return row;
}

struct Cells {
  int s = 1, t = 1;
  long count() const { return static_cast<long>(s) * t; }
  bool operator==(const Cells&) const = default;
};

// Largest distance of the samples from the plane of a triangle.
double distance_from_plane(const Vec3& a, const Vec3& b, const Vec3& c, const std::array<Vec3, 4>& samples) {
  const Vec3 cross = glm::cross(b - a, c - a);
  const double area = glm::length(cross);
  if (!(area > 0)) return 0;  // collapsed: no ray hits it
  double most = 0;
  for (const Vec3& p : samples) most = std::max(most, std::abs(glm::dot(p - a, cross)));
  return most / area;
}

// Measured at the middle and the mid-sides of both triangles of each cell, a b d and c d b:   d -- c
//                                                                                            a -- b   (s to the right, t up)
double error_of(const BezierPatch& patch, const Cells& cells) {
  const double ds = 1.0 / cells.s, dt = 1.0 / cells.t;
  const Weights at_points(patch.pv, 0, dt, cells.t + 1), between(patch.pv, dt / 2, dt, cells.t), third(patch.pv, dt / 3, dt, cells.t),
      two_thirds(patch.pv, 2 * dt / 3, dt, cells.t);
  double most = 0;
  Row points = row_of(patch, 0, at_points), sides = row_of(patch, 0, between);
  for (int i = 0; i < cells.s; ++i) {
    const Row next_points = row_of(patch, (i + 1) * ds, at_points), next_sides = row_of(patch, (i + 1) * ds, between);
    const Row across = row_of(patch, (i + 0.5) * ds, at_points), diagonal = row_of(patch, (i + 0.5) * ds, between);
    const Row lower = row_of(patch, (i + 1. / 3) * ds, third), upper = row_of(patch, (i + 2. / 3) * ds, two_thirds);
    for (std::size_t j = 0; j < sides.size(); ++j) {
      const Vec3 &a = points[j], &b = next_points[j], &c = next_points[j + 1], &d = points[j + 1];
      most = std::max(most, distance_from_plane(a, b, d, {lower[j], across[j], sides[j], diagonal[j]}));
      most = std::max(most, distance_from_plane(c, d, b, {upper[j], across[j + 1], next_sides[j], diagonal[j]}));
    }
    points = next_points;
    sides = next_sides;
  }
  return most;
}

// How many cells the bending in s and in t asks for: half the tolerance for each, |n . Sss| / (8 cells^2) and so on [Filip et al. 1986];
// the second derivatives are differences of samples.
Vec2 cells_wanted(const BezierPatch& patch, double tolerance) {
  constexpr int kSteps = 8;
  const Weights weights(patch.pv, 0, 1.0 / kSteps, kSteps + 1);
  std::vector<Row> p;
  for (int i = 0; i <= kSteps; ++i) p.push_back(row_of(patch, static_cast<double>(i) / kSteps, weights));
  Vec2 bend{0.0};
  for (std::size_t i = 1; i < kSteps; ++i)
    for (std::size_t j = 1; j < kSteps; ++j) {
      const Vec3 n = glm::cross(p[i + 1][j] - p[i - 1][j], p[i][j + 1] - p[i][j - 1]);
      if (!(glm::length(n) > 0)) continue;
      const Vec3 ss = p[i + 1][j] - 2.0 * p[i][j] + p[i - 1][j], tt = p[i][j + 1] - 2.0 * p[i][j] + p[i][j - 1];
      bend = glm::max(bend, glm::abs(Vec2(glm::dot(n, ss), glm::dot(n, tt))) / glm::length(n));
    }
  constexpr double kLeast = 0.1;  // a twisted piece has no bending along its parameters
  return glm::max(static_cast<double>(kSteps) * glm::sqrt(bend / (4 * tolerance)), Vec2(kLeast));
}

// The error falls with the square of the number of cells: that law says where to look next.
Cells coarsest_grid(const BezierPatch& patch, double tolerance, double& error) {
  constexpr double kNearEnough = 0.95;
  const Vec2 wanted = cells_wanted(patch, tolerance);
  Cells best, last{0, 0};
  error = kInf;
  for (double factor = 1;;) {
    const Vec2 count = glm::max(glm::ceil(factor * wanted), Vec2(1.0));
    const Cells cells{static_cast<int>(count.x), static_cast<int>(count.y)};
    ISO_CHECK(cells.count() < 100'000'000);
    if (error <= tolerance && cells.count() >= best.count()) return best;
    const double found = cells == last ? kInf : error_of(patch, cells);
    if (found <= tolerance) {
      best = cells;
      error = found;
      if (found > kNearEnough * tolerance || cells.count() == 1) return best;
    }
    factor *= cells == last ? 1.02 : std::sqrt(found / tolerance) * (found > tolerance ? 1.005 : 0.995);
    last = cells;
  }
}

BezierPatch in_world(BezierPatch patch, const Affine3& to_world) {
  for (Vec4& p : patch.net) p = Vec4(to_world.linear * Vec3(p) + p.w * to_world.translation, p.w);
  return patch;
}

void add(const BezierPatch& patch, const Cells& cells, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  const auto rows = static_cast<std::uint32_t>(cells.s) + 1, columns = static_cast<std::uint32_t>(cells.t) + 1;
  const Weights weights(patch.pv, 0, 1.0 / cells.t, cells.t + 1);
  for (int i = 0; i <= cells.s; ++i)
    for (const Vec3& p : row_of(patch, static_cast<double>(i) / cells.s, weights)) mesh.points.push_back(p);
  for (std::uint32_t i = 0; i + 1 < rows; ++i)
    for (std::uint32_t j = 0; j + 1 < columns; ++j) {
      const std::uint32_t a = first + i * columns + j, b = a + columns, c = b + 1, d = a + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({c, d, b});
    }
  mesh.grids.push_back({first, rows, columns});
}

}  // namespace

TriangleMesh mesh_uniformly(const TraceScene& scene, double tolerance) {
  struct Piece {
    BezierPatch patch;
    Cells cells;
    double error;
  };
  std::vector<Piece> pieces;
  TriangleMesh mesh;
  for (const Placed& placed : scene.placed)
    for (const Face& face : placed.part->faces) {
      ISO_CHECK(face.loops.empty());
      for (const BezierPiece& piece : bezier_pieces(face.surface, face.domain)) {
        Piece& p = pieces.emplace_back(Piece{in_world(piece.patch, placed.to_world), {}, 0});
        p.cells = coarsest_grid(p.patch, tolerance, p.error);
        mesh.error = std::max(mesh.error, p.error);
      }
    }
  mesh.usual_error = mesh.error;
  // The search for the grids is no part of the time: a mesher with a good bound needs none.
  mesh.seconds = seconds_of([&] {
    for (const Piece& p : pieces) add(p.patch, p.cells, mesh);
  });
  return mesh;
}

}  // namespace iso::bench
