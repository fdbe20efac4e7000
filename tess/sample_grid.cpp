#include "tess/sample_grid.h"

#include <algorithm>

namespace iso {

namespace {

// Cells of a box are at most this many times longer than wide in space: thinner triangles help nobody.
constexpr double kMostAspect = 40;

// A division must save this share of the cells.
constexpr double kLeastSaving = 0.15;

constexpr int kMostDepth = 24;

// Boxes of more cells than this are divided so often to see whether it pays.
constexpr double kTrialCells = 64;
constexpr int kTrialDepth = 5;
constexpr double kLeastTrialSaving = 0.02;  // small savings add up
constexpr double kMostCells = 1e8;
constexpr int kUnbounded = 1000000;  // columns and rows of a box without bounds

// What the cells of a grid cost: e = 1/2 sum l_i l_j d_ij^T H d_ij for the two triangles of a cell, cut along the better diagonal.
struct CellForm {
  double uu = 0, uv = 0, vv = 0;  // largest magnitudes over the box
  bool saddle = false;            // uu and vv of opposite sign all over the box

  double error(double du, double dv) const {
    const double x = uu * du * du, y = vv * dv * dv, z = 2 * uv * du * dv;
    const double long_side = saddle ? std::max(x, y) : x + y;
    return (long_side + z) / 8;
  }
};

CellForm form_of(const Bend& bend, const FaceShape& shape) {
  // Where no normal is certain (poles, creases) the whole second derivative counts.
  const auto pick = [](const Range& r, double M) { return std::min(r.magnitude(), M); };
  CellForm form{pick(bend.uu, bend.Muu), pick(bend.uv, bend.Muv), pick(bend.vv, bend.Mvv), false};
  form.saddle = (bend.uu.lo >= 0 && bend.vv.hi <= 0) || (bend.uu.hi <= 0 && bend.vv.lo >= 0);
  if (std::holds_alternative<Plane>(shape.face().surface)) form = {};
  return form;
}

// The fewest cells whose error is within the tolerance.
void fit(SampleGrid& grid, const CellForm& form, double tolerance) {
  const Vec2 size = grid.box.size();
  const auto rows_for = [&](double columns) {
    double rows = std::max(1.0, std::ceil(std::sqrt(form.vv * size.y * size.y / (8 * tolerance))));
    for (int i = 0; i < 64 && form.error(size.x / columns, size.y / rows) > tolerance; ++i)
      rows = std::max(rows + 1, std::ceil(rows * 1.05));
    return rows;
  };
  const double least = std::max(1.0, std::ceil(std::sqrt(form.uu * size.x * size.x / (8 * tolerance))));
  double best = kInf, columns_best = least, rows_best = 1;
  double columns = least;
  for (int i = 0; i < 24; ++i) {
    if (form.error(size.x / columns, 0) <= tolerance) {
      const double rows = rows_for(columns);
      if (form.error(size.x / columns, size.y / rows) <= tolerance && columns * rows < best) {
        best = columns * rows;
        columns_best = columns;
        rows_best = rows;
      }
      if (rows <= 1) break;
    }
    columns = std::max(columns + 1, std::ceil(columns * 1.08));
  }
  grid.columns = static_cast<int>(std::min(columns_best, kUnbounded - 1.0));
  grid.rows = static_cast<int>(std::min(rows_best, kUnbounded - 1.0));
}

// Long cells are cut across.
void limit_aspect(SampleGrid& grid, const FaceShape& shape) {
  const Jet2 at = jet2(shape.face().surface, grid.box.middle());
  const double width = glm::length(at.Su) * grid.box.size().x / grid.columns, height = glm::length(at.Sv) * grid.box.size().y / grid.rows;
  if (grid.columns == 1 && grid.rows == 1) return;
  if (!(width > 0 && height > 0) || !shape.is_regular({at.S, at.Su, at.Sv})) return;  // cells without area have no aspect
  if (width > kMostAspect * height)
    grid.columns = static_cast<int>(std::min(1e6, std::ceil(grid.columns * width / (kMostAspect * height))));
  if (height > kMostAspect * width) grid.rows = static_cast<int>(std::min(1e6, std::ceil(grid.rows * height / (kMostAspect * width))));
}

class Divider {
 public:
  Divider(const FaceShape& shape, double tolerance) : shape_(shape), tolerance_(tolerance) {}

  // Adds the grids of a box and gives the number of their cells.
  double divide(const SampleGrid& grid, int depth) {
    const double cells = double(grid.columns) * grid.rows;
    if (cells > 1 && depth < kMostDepth) {
      SampleGrid best[2];
      double least = kInf;
      const bool unbounded = grid.columns == kUnbounded;
      for (int axis = 0; axis < 2; ++axis) {
        SampleGrid half[2];
        if (unbounded && !has_crease(grid.box, axis)) continue;
        if (!cut(grid.box, axis, half[0].box, half[1].box)) continue;
        for (SampleGrid& h : half) fitted(h);
        const double sum = double(half[0].columns) * half[0].rows + double(half[1].columns) * half[1].rows;
        // Where neither direction saves anything yet they take turns.
        const bool no_better = least < kInf && std::min(sum, least) > (1 - kLeastTrialSaving) * cells;
        if (no_better ? depth % 2 == 0 : sum < least) {
          least = sum;
          best[0] = half[0];
          best[1] = half[1];
        }
      }
      // A box of many cells may hide what only shows further down: it is divided on trial.
      const bool on_trial = depth < kTrialDepth && cells > kTrialCells && least < kInf;
      if (least < (1 - kLeastSaving) * cells || on_trial || (cells > kMostCells && least < kInf)) {
        const std::size_t before = grids.size();
        const double sum = divide(best[0], depth + 1) + divide(best[1], depth + 1);
        if (sum < (1 - (on_trial ? kLeastTrialSaving : kLeastSaving)) * cells) return sum;
        grids.resize(before);
      }
    }
    grids.push_back(grid);
    if (grid.columns == kUnbounded) grids.back().columns = grids.back().rows = 1;
    return grid.columns == kUnbounded ? 1 : cells;
  }

  // Where nothing is bounded (a crease inside) the box must be divided.
  void fitted(SampleGrid& grid) const {
    const CellForm form = form_of(shape_.bend().over(grid.box), shape_);
    if (finite(form.uu) && finite(form.uv) && finite(form.vv))
      fit(grid, form, tolerance_);
    else
      grid.columns = grid.rows = kUnbounded;
  }

  std::vector<SampleGrid> grids;

 private:
  bool has_crease(const Box2& box, int axis) const {
    const auto& creases = shape_.creases(axis);
    return std::any_of(creases.begin(), creases.end(), [&](double c) { return c > box.lo[axis] && c < box.hi[axis]; });
  }

  // Halves, at a crease if there is one inside.
  bool cut(const Box2& box, int axis, Box2& low, Box2& high) const {
    double at = box.middle()[axis];
    const auto& creases = shape_.creases(axis);
    double least = kInf;
    for (double c : creases)
      if (c > box.lo[axis] && c < box.hi[axis] && std::abs(c - box.middle()[axis]) < least) {
        least = std::abs(c - box.middle()[axis]);
        at = c;
      }
    if (!(at > box.lo[axis] && at < box.hi[axis])) return false;
    low = high = box;
    low.hi[axis] = high.lo[axis] = at;
    return true;
  }

  const FaceShape& shape_;
  double tolerance_;
};

}  // namespace

SampleGrids sample_grids(const FaceShape& shape, const Box2& domain, double tolerance) {
  Divider divider(shape, tolerance);
  SampleGrid whole{domain};
  divider.fitted(whole);
  divider.divide(whole, 0);
  SampleGrids result{std::move(divider.grids), Vec2(1.0)};
  for (SampleGrid& grid : result.grids) limit_aspect(grid, shape);

  // The mean cell, weighted by the number of cells; a face that is one cell is measured in space.
  double log_width = 0, log_height = 0, count = 0;
  for (const SampleGrid& grid : result.grids) {
    const double n = double(grid.columns) * grid.rows;
    const Vec2 cell = grid.box.size() / Vec2(grid.columns, grid.rows);
    log_width += n * std::log(std::max(cell.x, 1e-300));
    log_height += n * std::log(std::max(cell.y, 1e-300));
    count += n;
  }
  result.scale = {std::exp(-log_width / count), std::exp(-log_height / count)};
  if (count <= 1) {
    const Jet2 at = jet2(shape.face().surface, domain.middle());
    const double u = glm::length(at.Su), v = glm::length(at.Sv);
    if (u > 0 && v > 0) result.scale = {u, v};
  }
  return result;
}

}  // namespace iso
