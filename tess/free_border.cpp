#include "tess/free_border.h"

#include "patches/base/bernstein.h"
#include "tess/box_tree.h"

namespace iso {
namespace {

using Span = std::vector<Vec3>;  // homogeneous control points of a plane curve

// Parameters at which a rational curve comes within `tolerance` of a point, found by halving its hull until it is as small as that.
class NearbyParameters {
 public:
  NearbyParameters(const Vec2& point, double tolerance) : point_(point), tolerance_(tolerance) {}

  void search(const Span& span, double t0, double t1) {
    Box2 box;
    for (const Vec3& h : span) box.include(project(h));
    if (!box.inflated(tolerance_).contains(point_)) return;
    const double middle = 0.5 * (t0 + t1);
    if (box.diagonal() <= tolerance_ || middle <= t0 || middle >= t1) return add(t0, t1);
    Span left, right;
    bernstein_split(span, 0.5, left, right);
    search(left, t0, middle);
    search(right, middle, t1);
  }
  const std::vector<Range>& found() const { return found_; }

 private:
  // Neighbouring parts are one find.
  void add(double t0, double t1) {
    if (!found_.empty() && found_.back().hi == t0) {
      found_.back().hi = t1;
    } else {
      found_.push_back({t0, t1});
    }
  }

  Vec2 point_;
  double tolerance_;
  std::vector<Range> found_;
};

// The places of a node that are the same up to periods.
std::vector<UV> images(const UV& uv, const Vec2& period) {
  std::vector<UV> all{uv};
  for (int axis = 0; axis < 2; ++axis) {
    if (period[axis] == 0) continue;
    for (std::size_t i = 0, n = all.size(); i < n; ++i)
      for (const double by : {-period[axis], period[axis]}) {
        all.push_back(all[i]);
        all.back()[axis] += by;
      }
  }
  return all;
}

using Stations = std::vector<std::pair<double, std::uint32_t>>;  // nodes by where they lie along a curve

// Nodes of one point in a row (where a closed curve ends, each is the other's image) are all neighbours of the next point's nodes.
void pair_neighbours(Stations& stations, std::span<const MeshNode> nodes, NodePairs& pairs) {
  std::sort(stations.begin(), stations.end());
  const auto point = [&](std::size_t i) { return nodes[stations[i].second].point; };
  std::size_t before = 0, begin = 0;  // of the point before this one, and of this one
  for (std::size_t i = 1; i < stations.size(); ++i) {
    if (point(i) != point(i - 1)) before = begin, begin = i;
    for (std::size_t k = before; k < begin; ++k) pairs.emplace(std::minmax(stations[k].second, stations[i].second));
  }
}

// The spans of a trim curve and the boxes of their hulls.
struct Spans {
  std::vector<BezierSpan<Vec2>> spans;
  BoxTree<Vec2> tree;

  explicit Spans(const TrimCurve& trim)
      : spans(bezier_spans(trim.curve, std::min(trim.t0, trim.t1), std::max(trim.t0, trim.t1))), tree(boxes_of(spans)) {}
  static std::vector<Box2> boxes_of(const std::vector<BezierSpan<Vec2>>& all) {
    std::vector<Box2> boxes(all.size());
    for (std::size_t s = 0; s < all.size(); ++s)
      for (const Vec3& h : all[s].points) boxes[s].include(project(h));
    return boxes;
  }
};

// Curves of a loop may meet within the file's tolerance only, and the node there has the (u, v) of one of them: the nodes at `before` and
// `after`, where its neighbours end and begin, count as its ends.
void add_ends(const TrimCurve& trim, double spans, const UV& before, const UV& after, double tolerance, std::span<const MeshNode> nodes,
              Stations& stations) {
  const bool rises = trim.t0 < trim.t1;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (glm::length(nodes[i].uv - before) <= tolerance) stations.emplace_back(rises ? 0 : spans, i);
    if (glm::length(nodes[i].uv - after) <= tolerance) stations.emplace_back(rises ? spans : 0, i);
  }
}

void pair_along(const TrimCurve& trim, const UV& before, const UV& after, const Vec2& period, double tolerance,
                std::span<const MeshNode> nodes, NodePairs& pairs) {
  const Spans curve(trim);
  Stations stations;
  add_ends(trim, static_cast<double>(curve.spans.size()), before, after, tolerance, nodes, stations);
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (const UV& uv : images(nodes[i].uv, period)) {
      std::vector<std::uint32_t> close;
      curve.tree.for_each_touching(Box2{uv, uv}.inflated(tolerance), [&](std::uint32_t s) { close.push_back(s); });
      std::sort(close.begin(), close.end());
      NearbyParameters near(uv, tolerance);
      for (const std::uint32_t s : close) near.search(curve.spans[s].points, s, s + 1.0);
      for (const Range& r : near.found()) stations.emplace_back(r.middle(), i);
    }
  pair_neighbours(stations, nodes, pairs);
}

// The four sides of the domain, but those at which the surface closes.
void pair_along_domain(const Face& face, const Vec2& period, double tolerance, std::span<const MeshNode> nodes, NodePairs& pairs) {
  for (int axis = 0; axis < 2; ++axis) {
    const bool closes = period[axis] > 0 && face.domain.size()[axis] >= period[axis] * (1 - kOnBorder);
    if (closes) continue;
    for (const double side : {face.domain.lo[axis], face.domain.hi[axis]}) {
      Stations stations;
      for (std::uint32_t i = 0; i < nodes.size(); ++i)
        if (std::abs(nodes[i].uv[axis] - side) <= tolerance) stations.emplace_back(nodes[i].uv[1 - axis], i);
      pair_neighbours(stations, nodes, pairs);
    }
  }
}

}  // namespace

NodePairs free_neighbours(const Face& face, std::span<const Edge> edges, std::span<const MeshNode> nodes) {
  NodePairs pairs;
  const Vec2 period = periods(face.surface);
  const double tolerance = kOnBorder * face.domain.diagonal();
  if (face.loops.empty()) pair_along_domain(face, period, tolerance, nodes, pairs);
  for (const TrimLoop& loop : face.loops)
    for (std::size_t i = 0, n = loop.curves.size(); i < n; ++i) {
      const TrimCurve &trim = loop.curves[i], &last = loop.curves[(i + n - 1) % n], &next = loop.curves[(i + 1) % n];
      if (trim.edge < 0 || edges[static_cast<std::size_t>(trim.edge)].uses == 1)
        pair_along(trim, jet(last.curve, last.t1).C, jet(next.curve, next.t0).C, period, tolerance, nodes, pairs);
    }
  return pairs;
}

}  // namespace iso
