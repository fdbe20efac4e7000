#include "raytracer/bezier_solve.h"

#include <array>

#include "patches/base/bspline_basis.h"

namespace iso {

namespace {

// Subdivision stops at windows where Newton's map contracts by this.
constexpr double kCertified = 0.6;
constexpr int kMostNewtonSteps = 16;
constexpr int kMostCells = 20000;
// Of the patch: folds are told no more exactly.
constexpr double kSmallestPassed = 0x1p-20;
// Where rounding alone could move a root by more than this share of its window, the Jacobian is too near singular for Newton to decide.
constexpr double kDoubtfulBorder = 0.25;

struct Mat2 {
  double a, b, c, d;  // rows (a b), (c d)

  double det() const { return a * d - b * c; }
  Vec2 times(const Vec2& x) const { return {a * x.x + b * x.y, c * x.x + d * x.y}; }
};

// False where the matrix is singular beyond use.
bool invert(const Mat2& m, Mat2& inverse) {
  const double det = m.det();
  if (!(std::abs(det) > 1e-300)) return false;
  inverse = {m.d / det, -m.b / det, -m.c / det, m.a / det};
  return true;
}

Vec2 row_lengths(const Mat2& m) { return {std::hypot(m.a, m.b), std::hypot(m.c, m.d)}; }

// The two plane equations with derivatives, divided by the weight; and what t needs.
struct PlaneJet {
  Vec2 F;
  Mat2 J;  // with respect to (s, t)
  HomogeneousJet jet;
};

PlaneJet plane_jet(const BezierPatch& patch, const LocalRay& ray, const Vec2& st) {
  PlaneJet p;
  p.jet = homogeneous_jet(patch, st);
  const auto f = [&](const Vec4& h) { return glm::dot(ray.n1, Vec3(h)) - ray.d1 * h.w; };
  const auto g = [&](const Vec4& h) { return glm::dot(ray.n2, Vec3(h)) - ray.d2 * h.w; };
  const double w = 1 / p.jet.H.w;
  p.F = {w * f(p.jet.H), w * g(p.jet.H)};
  p.J = {w * f(p.jet.Hs), w * f(p.jet.Ht), w * g(p.jet.Hs), w * g(p.jet.Ht)};
  return p;
}

// The point of the window at which |F| is least, to first order, for a root `ab` just beyond the border. Where the ray grazes, the plane
// equations are met to rounding along a valley that crosses the border elsewhere than beside the root: a root beyond a corner may look
// past the corner along either of its borders.
Vec2 nearest_on_border(const Vec2& ab, const Mat2& J) {
  const Vec2 column[2] = {{J.a, J.c}, {J.b, J.d}};
  const Vec2 clamped = glm::clamp(ab, Vec2(-1.0), Vec2(1.0));
  Vec2 nearest = clamped;
  double least = kInf;
  for (const int held : {0, 1}) {
    if (clamped[held] == ab[held]) continue;
    const int free = 1 - held;
    Vec2 at = clamped;
    const double along = glm::dot(column[free], column[free]);
    if (along > 0) at[free] = ab[free] - glm::dot(column[held], column[free]) / along * (clamped[held] - ab[held]);
    at = glm::clamp(at, Vec2(-1.0), Vec2(1.0));
    const double off = glm::length(J.times(at - ab));
    if (off < least) nearest = at;
    least = std::min(least, off);
  }
  return nearest;
}

enum class NewtonEnd { converged, left_window, failed };

// Newton from ab on the true polynomials. Converged: residual at rounding level, or the last step so small that the next would vanish.
NewtonEnd newton(const BezierPatch& patch, const LocalRay& ray, const Window& window, Vec2 ab, double overlap, const Vec2& border,
                 SolverStats& stats, Root& root) {
  const double rounding = 4 * kEps * ray.scale;
  double last_step = kInf;
  for (int step = 1; step <= kMostNewtonSteps; ++step) {
    const Vec2 st = window.to_unit(ab);
    const PlaneJet p = plane_jet(patch, ray, st);
    ++stats.newton_steps;
    const Mat2 J{p.J.a * window.half.x, p.J.b * window.half.y, p.J.c * window.half.x, p.J.d * window.half.y};
    Mat2 inverse;
    if (!invert(J, inverse)) return NewtonEnd::failed;
    const Vec2 delta = -inverse.times(p.F);
    const double size = std::max(std::abs(delta.x), std::abs(delta.y));
    const bool at_rounding = glm::length(p.F) <= rounding;
    if (at_rounding || size < 1e-9) {
      // The last step is applied to the parameters and, to first order, to the point.
      const Vec2 move = at_rounding && size > 1e-6 ? Vec2(0.0) : delta;
      ab += move;
      const Vec4 h = p.jet.H + window.half.x * move.x * p.jet.Hs + window.half.y * move.y * p.jet.Ht;
      root = {window.to_unit(ab), ray.t_of(project(h)), HitStatus::fallback, static_cast<std::uint16_t>(step)};
      if (std::max(std::abs(ab.x), std::abs(ab.y)) <= 1 + overlap) return NewtonEnd::converged;
      if (std::abs(ab.x) > 1 + border.x || std::abs(ab.y) > 1 + border.y) return NewtonEnd::left_window;
      // Beyond the border by what rounding may do: it is a root of the window if the border itself meets the ray to rounding.
      const Vec2 held = window.to_unit(nearest_on_border(ab, J));
      const PlaneJet at_border = plane_jet(patch, ray, held);
      root = {held, ray.t_of(project(at_border.jet.H)), HitStatus::fallback, static_cast<std::uint16_t>(step)};
      return glm::length(at_border.F) <= 4 * rounding ? NewtonEnd::converged : NewtonEnd::left_window;
    }
    if (!(size < 1e3) || (step > 4 && size > 2 * last_step)) return NewtonEnd::failed;
    last_step = size;
    ab = glm::clamp(ab + delta, Vec2(-1.5), Vec2(1.5));
  }
  return NewtonEnd::failed;
}

// What is proven of F over a window: x -> x - inverse F(x) contracts by rho in the norm max |x_i| / weights_i.
struct Certificate {
  Mat2 inverse;
  Vec2 weights{1.0};
  double rho = 1;
};

// Newton ended at `outside`, a root beyond the window. That does not rule out another one inside, this does: a root r of the window lies
// within rho / (1 - rho) |z - y| of z = y - inverse F(y), for the window's point y nearest to `outside`; so none exists if that ball misses
// the window. `border` is what rounding may do: the root found is the same one, on the side of the neighbour.
bool proves_empty(const BezierPatch& patch, const LocalRay& ray, const Window& window, const Certificate& c, const Vec2& outside,
                  const Vec2& border) {
  if (!(c.rho < 1)) return false;
  const Vec2 y = glm::clamp((outside - window.middle) / window.half, Vec2(-1.0), Vec2(1.0));
  const PlaneJet p = plane_jet(patch, ray, window.to_unit(y));
  const Vec2 step = c.inverse.times(p.jet.H.w * p.F), z = y - step;
  const double moved = std::max(std::abs(step.x) / c.weights.x, std::abs(step.y) / c.weights.y);
  const Vec2 radius = c.weights * (c.rho / (1 - c.rho) * moved);
  return std::abs(z.x) > 1 - border.x + radius.x || std::abs(z.y) > 1 - border.y + radius.y;
}

// ---- subdivision -------------------------------------------------------------------------------------------------------

// The coefficients of (f, g) over a window: a tensor-product Bernstein net of 2-vectors on a shared stack.
class Subdivision {
 public:
  Subdivision(const BezierPatch& patch, const LocalRay& ray, SolverStats& stats, std::vector<Root>& roots, double overlap,
              PassedFolds* passed)
      : patch_(patch),
        ray_(ray),
        stats_(stats),
        roots_(roots),
        overlap_(overlap),
        passed_(passed),
        stride_(patch_.net.size()),
        first_root_(roots.size()) {}

  void run(const Window& leaf) {
    nets_.resize(stride_);
    for (std::size_t i = 0; i < stride_; ++i) {
      const Vec4& h = patch_.net[i];
      nets_[i] = {glm::dot(ray_.n1, Vec3(h)) - ray_.d1 * h.w, glm::dot(ray_.n2, Vec3(h)) - ray_.d2 * h.w};
      largest_weight_ = std::max(largest_weight_, h.w);
    }
    restrict_to(leaf);
    windows_.assign(1, leaf);
    for (int cells = 0; !windows_.empty(); ++cells) {
      ++stats_.fallback_cells;
      if (cells >= kMostCells) {
        // The ray runs along the surface (a ruling, say): what is left touches it, and one root tells so.
        ++stats_.fallback_out_of_budget;
        add_touching(windows_.back());
        windows_.clear();
        return;
      }
      visit();
    }
  }

 private:
  Vec2* top() { return &nets_[(windows_.size() - 1) * stride_]; }

  // Cuts the net in the first slot down to a window.
  void restrict_to(const Window& w) {
    for (const int c : {0, 1}) {
      const double lo = w.middle[c] - w.half[c], hi = w.middle[c] + w.half[c];
      if (hi < 1) cut(c, hi, true);
      if (lo > 0) cut(c, lo / hi, false);
    }
  }
  void cut(int direction, double at, bool keep_low) {
    const int pv = patch_.pv, lines = direction == 0 ? pv : patch_.pu, degree = direction == 0 ? patch_.pu : pv;
    const std::size_t step = direction == 0 ? static_cast<std::size_t>(pv) + 1 : 1,
                      across = direction == 0 ? 1 : static_cast<std::size_t>(pv) + 1;
    for (int k = 0; k <= lines; ++k) {
      Vec2* row = &nets_[static_cast<std::size_t>(k) * across];
      for (int level = 1; level <= degree; ++level) {
        if (keep_low)
          for (int i = degree; i >= level; --i) row[i * step] = (1 - at) * row[(i - 1) * step] + at * row[i * step];
        else
          for (int i = 0; i <= degree - level; ++i) row[i * step] = (1 - at) * row[i * step] + at * row[(i + 1) * step];
      }
    }
  }

  // What the equations, their sum and their difference reach over a window.
  struct Reach {
    Vec2 lo{kInf}, hi{-kInf};
    Range sum, difference;

    bool misses(double margin) const {
      return lo.x > margin || hi.x < -margin || lo.y > margin || hi.y < -margin || sum.lo > 2 * margin || sum.hi < -2 * margin ||
             difference.lo > 2 * margin || difference.hi < -2 * margin;
    }
  };
  Reach reach_of(const Vec2* net) const {
    Reach reach;
    for (std::size_t i = 0; i < stride_; ++i) {
      reach.lo = glm::min(reach.lo, net[i]);
      reach.hi = glm::max(reach.hi, net[i]);
      reach.sum.include(net[i].x + net[i].y);
      reach.difference.include(net[i].x - net[i].y);
    }
    return reach;
  }

  void visit() {
    const Window window = windows_.back();
    const Vec2* net = top();
    const double rounding = 8 * kEps * ray_.scale * largest_weight_;
    const Reach reach = reach_of(net);
    if (reach.misses(rounding) || misses_across(net, rounding)) {
      if (!passed_ || reach.misses(rounding + passed_->within) || misses_across(net, rounding + passed_->within) || !pass(net, window))
        windows_.pop_back();
      return;
    }
    const Vec2 &lo = reach.lo, &hi = reach.hi;
    const bool at_rounding = std::max(std::max(-lo.x, hi.x), std::max(-lo.y, hi.y)) <= 2 * rounding;
    if (at_rounding || std::max(window.half.x, window.half.y) < 1e-15) {
      add_touching(window);
      windows_.pop_back();
      return;
    }
    int direction = 0;
    if (certified(net, window, direction)) {
      windows_.pop_back();
      return;
    }
    split(window, direction);
  }

  // Where a ray grazes, (f, g) run along a narrow band that lies in any direction: does the origin lie beside it?
  bool misses_across(const Vec2* net, double rounding) const {
    const Vec2 diagonal = net[stride_ - 1] - net[0], other = net[stride_ - 1 - patch_.pv] - net[patch_.pv];
    const Vec2 along = glm::dot(diagonal, diagonal) >= glm::dot(other, other) ? diagonal : other;
    const double length = glm::length(along);
    if (!(length > 0)) return false;
    const Vec2 across = Vec2(-along.y, along.x) / length;
    Range band;
    for (std::size_t i = 0; i < stride_; ++i) band.include(glm::dot(across, net[i]));
    return band.lo > 2 * rounding || band.hi < -2 * rounding;
  }

  // In the norm of the eigenvector the contraction is the eigenvalue; where that is degenerate, in the plain norm the largest row sum.
  static Certificate certificate_of(const Mat2& M, const Mat2& inverse, double eigenvalue) {
    const Vec2 vector{M.b, eigenvalue - M.a};
    if (vector.x > 1e-12 * eigenvalue && vector.y > 1e-12 * eigenvalue) return {inverse, vector, eigenvalue};
    return {inverse, Vec2(1.0), std::max(M.a + M.b, M.c + M.d)};
  }

  // The linear model of the equations, its columns, how far their derivatives stray from it, and in which direction they are longer.
  struct Slopes {
    Vec2 s, t, stray_s, stray_t;
    int longer;

    // M = |J0^-1| E; below one, its largest eigenvalue proves the map one-to-one.
    Mat2 strays(const Mat2& inverse) const {
      const auto entry = [](double x, double y, const Vec2& stray) { return std::abs(x) * stray.x + std::abs(y) * stray.y; };
      return {entry(inverse.a, inverse.b, stray_s), entry(inverse.a, inverse.b, stray_t), entry(inverse.c, inverse.d, stray_s),
              entry(inverse.c, inverse.d, stray_t)};
    }
  };
  Slopes slopes_of(const Vec2* net, const Window& window) const {
    const int pu = patch_.pu, pv = patch_.pv;
    Vec2 slo{kInf}, shi{-kInf}, tlo{kInf}, thi{-kInf};
    for (int i = 0; i <= pu; ++i)
      for (int j = 0; j <= pv; ++j) {
        const Vec2* at = net + static_cast<std::size_t>(i) * (pv + 1) + j;
        if (i < pu) {
          const Vec2 d = 0.5 * pu * (at[pv + 1] - at[0]);
          slo = glm::min(slo, d);
          shi = glm::max(shi, d);
        }
        if (j < pv) {
          const Vec2 d = 0.5 * pv * (at[1] - at[0]);
          tlo = glm::min(tlo, d);
          thi = glm::max(thi, d);
        }
      }
    const auto largest = [](const Vec2& a, const Vec2& b) {
      return std::max(std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)));
    };
    int longer = largest(slo, shi) >= largest(tlo, thi) ? 0 : 1;
    if (window.half[longer] < 1e-15) longer = 1 - longer;
    return {0.5 * (slo + shi), 0.5 * (tlo + thi), 0.5 * (shi - slo), 0.5 * (thi - tlo), longer};
  }
  static double largest_eigenvalue(const Mat2& M) { return 0.5 * (M.a + M.d) + std::sqrt(0.25 * (M.a - M.d) * (M.a - M.d) + M.b * M.c); }

  // A window that the ray misses, but not by as much as asked for. False: it has no fold. Where it is nearly flat its middle is told.
  bool pass(const Vec2* net, const Window& window) {
    const Slopes slopes = slopes_of(net, window);
    Mat2 inverse;
    if (invert({slopes.s.x, slopes.t.x, slopes.s.y, slopes.t.y}, inverse) && largest_eigenvalue(slopes.strays(inverse)) < kCertified)
      return false;
    const Vec2 bend = slopes.stray_s + slopes.stray_t;
    if (std::max(bend.x, bend.y) <= passed_->within || std::max(window.half.x, window.half.y) < kSmallestPassed) {
      passed_->at.push_back(window.middle);
      return false;
    }
    split(window, slopes.longer);
    return true;
  }

  // True if the window holds no root, or one that has been found. Else `direction` is the one to split.
  bool certified(const Vec2* net, const Window& window, int& direction) {
    const Slopes slopes = slopes_of(net, window);
    direction = slopes.longer;
    Mat2 inverse;
    if (!invert({slopes.s.x, slopes.t.x, slopes.s.y, slopes.t.y}, inverse)) return false;
    const Mat2 M = slopes.strays(inverse);
    const double contraction = largest_eigenvalue(M);
    if (!(contraction < kCertified)) return false;
    const Vec2 kappa{M.a + M.b, M.c + M.d};
    const Vec2 border = overlap_ + 16 * kEps * ray_.scale * largest_weight_ * row_lengths(inverse);
    if (std::max(border.x, border.y) > kDoubtfulBorder) return false;
    const PlaneJet middle = plane_jet(patch_, ray_, window.middle);
    const Vec2 linear = -inverse.times(middle.jet.H.w * middle.F);
    if (std::abs(linear.x) > (1 + border.x) * (1 + kappa.x) || std::abs(linear.y) > (1 + border.y) * (1 + kappa.y)) return true;
    Root root;
    const NewtonEnd end = newton(patch_, ray_, window, linear, overlap_, border, stats_, root);
    if (end == NewtonEnd::failed) return false;
    if (end == NewtonEnd::left_window) return proves_empty(patch_, ray_, window, certificate_of(M, inverse, contraction), root.st, border);
    add(root);
    return true;
  }

  // Both halves; the low one takes the place of the whole.
  void split(const Window& window, int direction) {
    const std::size_t base = (windows_.size() - 1) * stride_;
    nets_.resize(std::max(nets_.size(), base + 2 * stride_));
    Vec2 *low = &nets_[base], *high = &nets_[base + stride_];
    const int pv = patch_.pv, lines = direction == 0 ? pv : patch_.pu, degree = direction == 0 ? patch_.pu : pv;
    const std::size_t step = direction == 0 ? static_cast<std::size_t>(pv) + 1 : 1,
                      across = direction == 0 ? 1 : static_cast<std::size_t>(pv) + 1;
    for (int k = 0; k <= lines; ++k) {
      Vec2 *a = low + static_cast<std::size_t>(k) * across, *b = high + static_cast<std::size_t>(k) * across;
      std::array<Vec2, kMaxDegree + 1> work;
      for (int i = 0; i <= degree; ++i) work[i] = a[i * step];
      for (int level = 0; level <= degree; ++level) {
        a[level * step] = work[0];
        b[(degree - level) * step] = work[degree - level];
        for (int i = 0; i + level < degree; ++i) work[i] = 0.5 * (work[i] + work[i + 1]);
      }
    }
    Window half = window;
    half.half[direction] *= 0.5;
    half.middle[direction] = window.middle[direction] - half.half[direction];
    windows_.back() = half;
    half.middle[direction] = window.middle[direction] + half.half[direction];
    windows_.push_back(half);
  }

  void add_touching(const Window& window) {
    const PlaneJet p = plane_jet(patch_, ray_, window.middle);
    add({window.middle, ray_.t_of(project(p.jet.H)), HitStatus::tangent, 0});
  }

  // A touching root swallows its like nearby; simple roots at one place of the ray and of the patch are one.
  void add(const Root& root) {
    const double near = root.status == HitStatus::tangent ? 1e-7 : 1e-12;
    for (std::size_t i = first_root_; i < roots_.size(); ++i) {
      const Root& other = roots_[i];
      const bool same_kind = other.status == root.status;
      const bool same_t = std::abs(other.t - root.t) * std::sqrt(1 / ray_.inverse_dd) <= near * ray_.scale;
      if (same_kind && same_t && (root.status == HitStatus::tangent || glm::length(other.st - root.st) <= 1e-7)) return;
    }
    roots_.push_back(root);
  }

  const BezierPatch& patch_;
  const LocalRay& ray_;
  SolverStats& stats_;
  std::vector<Root>& roots_;
  double overlap_;
  PassedFolds* passed_;  // or null
  std::size_t stride_, first_root_;
  double largest_weight_ = 0;
  static thread_local std::vector<Vec2> nets_;
  static thread_local std::vector<Window> windows_;
};

thread_local std::vector<Vec2> Subdivision::nets_;
thread_local std::vector<Window> Subdivision::windows_;

}  // namespace

void roots_in_window(const BezierPatch& patch, const Window& window, const LocalRay& ray, SolverStats& stats, std::vector<Root>& roots,
                     double overlap, PassedFolds* passed) {
  ++stats.fallbacks;
  Subdivision(patch, ray, stats, roots, overlap, passed).run(window);
}

}  // namespace iso
