// The weights of patterns, tabulated: multisided.h.
#include <map>

#include "patches/base/check.h"
#include "tess/multisided.h"

namespace iso {

CoordinateTable::CoordinateTable(const PatchBasis& basis, std::span<const ChartPlace> places)
    : basis_(basis), columns_(static_cast<std::size_t>(point_count(basis))) {
  std::map<std::pair<double, double>, std::uint32_t> known;
  std::vector<Dual2> W(columns_);
  for (const ChartPlace& place : places) {
    const auto [at, is_new] = known.try_emplace({place.st.x, place.st.y}, static_cast<std::uint32_t>(rows_));
    uses_.push_back({at->second, place.corner});
    if (!is_new) continue;
    ++rows_;
    weights_at(basis, place.st, std::span<Dual2>(W));
    for (const Dual2& w : W) {
      W_.push_back(w.f);
      Ws_.push_back(w.u);
      Wt_.push_back(w.v);
    }
  }
}

namespace {

// The control points as seen from each corner, homogeneous.
std::vector<std::vector<Vec4>> from_all_corners(const PatchBasis& basis, std::span<const Vec3> points, std::span<const double> weights) {
  const std::vector<int> turn = points_from_next_corner(basis);
  std::vector<std::vector<Vec4>> all(static_cast<std::size_t>(basis.sides));
  for (std::size_t m = 0; m < points.size(); ++m) {
    const double w = weights.empty() ? 1.0 : weights[m];
    all[0].push_back(Vec4(w * points[m], w));
  }
  for (std::size_t k = 1; k < all.size(); ++k)
    for (const int m : turn) all[k].push_back(all[k - 1][static_cast<std::size_t>(m)]);
  return all;
}

Vec4 product(const double* row, const std::vector<Vec4>& points) {
  Vec4 sum{0.0};
  for (std::size_t m = 0; m < points.size(); ++m) sum += row[m] * points[m];
  return sum;
}

}  // namespace

std::vector<CoordinateTable::At> CoordinateTable::evaluate(std::span<const Vec3> points, std::span<const double> weights) const {
  ISO_CHECK(points.size() == columns_);
  const auto seen = from_all_corners(basis_, points, weights);
  std::vector<At> out;
  out.reserve(uses_.size());
  for (const Use& use : uses_) {
    const std::vector<Vec4>& P = seen[static_cast<std::size_t>(use.corner)];
    const std::size_t row = use.row * columns_;
    const Vec4 h = product(&W_[row], P), hs = product(&Ws_[row], P), ht = product(&Wt_[row], P);
    if (weights.empty()) {
      out.push_back({Vec3(h), Vec3(hs), Vec3(ht)});
      continue;
    }
    const Vec3 S = Vec3(h) / h.w;
    out.push_back({S, (Vec3(hs) - hs.w * S) / h.w, (Vec3(ht) - ht.w * S) / h.w});
  }
  return out;
}

std::vector<Vec3> CoordinateTable::places(std::span<const Vec3> points, std::span<const double> weights) const {
  ISO_CHECK(points.size() == columns_);
  const auto seen = from_all_corners(basis_, points, weights);
  std::vector<Vec3> out;
  out.reserve(uses_.size());
  for (const Use& use : uses_) {
    const Vec4 h = product(&W_[use.row * columns_], seen[static_cast<std::size_t>(use.corner)]);
    out.push_back(weights.empty() ? Vec3(h) : Vec3(h) / h.w);
  }
  return out;
}

}  // namespace iso
