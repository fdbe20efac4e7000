#include "tests/support/sewing_checks.h"

#include <map>

#include "tess/boundary.h"
#include "tess/tessellate.h"
#include "tess/verify.h"
#include "tests/support/sewing_model.h"

namespace iso::test {
namespace {

// A use's curve in space, to be measured from.
class SpaceCurve {
 public:
  SpaceCurve(const Part& part, const EdgeUse& use) : surface_(&part.faces[static_cast<std::size_t>(use.face)].surface), use_(&use) {
    for (int i = 0; i <= kPlaces; ++i) {
      places_.push_back(at(static_cast<double>(i) / kPlaces));
      if (i > 0) length_ += glm::length(places_[places_.size() - 1] - places_[places_.size() - 2]);
    }
  }
  Point3 at(double share) const { return point(*surface_, uv_at(*use_, share)); }
  double length() const { return length_; }
  const std::vector<Point3>& places() const { return places_; }
  const Point3& from() const { return places_.front(); }
  const Point3& to() const { return places_.back(); }

  // From p: the nearest of many places, then by thirds around it; not looked at closely where it is more than `most` for certain.
  double distance(const Point3& p, double most = kInf) const {
    std::size_t near = 0;
    for (std::size_t i = 1; i < places_.size(); ++i)
      if (glm::length(places_[i] - p) < glm::length(places_[near] - p)) near = i;
    double lo = std::max(0.0, (static_cast<double>(near) - 1) / kPlaces), hi = std::min(1.0, (static_cast<double>(near) + 1) / kPlaces);
    const double step = glm::length(at(hi) - at(lo));
    if (glm::length(places_[near] - p) > most + step) return kInf;
    for (int i = 0; i < 60; ++i) {
      const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
      if (glm::length(at(a) - p) < glm::length(at(b) - p))
        hi = b;
      else
        lo = a;
    }
    return std::min({glm::length(at(lo) - p), glm::length(places_.front() - p), glm::length(places_.back() - p)});
  }

 private:
  static constexpr int kPlaces = 64;
  const AnySurface* surface_;
  const EdgeUse* use_;
  std::vector<Point3> places_;
  double length_ = 0;
};

// Places that are none of those that the sewing compares.
constexpr int kBetween = 23;

double farthest(const SpaceCurve& from, const SpaceCurve& to) {
  double worst = 0;
  for (int i = 0; i <= kBetween; ++i) worst = std::max(worst, to.distance(from.at(static_cast<double>(i) / kBetween)));
  return worst;
}

class Checks {
 public:
  Checks(const Part& part, double sew) : part_(part), size_(part.box.diagonal()), before_(part, -1), after_(part, sew) {
    for (const EdgeUse& use : after_.uses) curves_.emplace_back(part, use);
  }

  std::string all(SewingCounts& counts) const {
    std::string wrong = counts_agree();
    if (wrong.empty()) wrong = uses_agree();
    if (wrong.empty()) wrong = loops_go_on();
    if (wrong.empty()) wrong = joined_are_near();
    if (wrong.empty()) wrong = near_are_joined(counts);
    const JoinReport& joins = after_.joins;
    counts.free_edges += joins.free_edges, counts.joined += joins.joined, counts.split += joins.split;
    counts.open += static_cast<int>(joins.open.size()), counts.collapsed += joins.collapsed;
    return wrong;
  }

  const JoinReport& joins() const { return after_.joins; }

 private:
  const EdgeUse& use(int u) const { return after_.uses[static_cast<std::size_t>(u)]; }
  const SpaceCurve& curve(int u) const { return curves_[static_cast<std::size_t>(u)]; }
  static bool of_file(const EdgeUse& a, const EdgeUse& b) {
    return a.curve.edge == b.curve.edge && (a.curve.edge >= 0 || a.face == b.face);
  }

  // Every free edge, and every piece of one, is one of a joined pair, open, or a point.
  std::string counts_agree() const {
    const JoinReport& joins = after_.joins;
    int free = 0, open = 0, points = 0;
    for (const BoundaryEdge& edge : before_.edges) free += edge.uses.size() == 1 && has_length(before_, edge);
    for (const BoundaryEdge& edge : after_.edges)
      if (edge.uses.size() == 1 && has_length(after_, edge)) ++(edge.degenerate ? points : open);
    if (joins.free_edges != free) return fmt::format("{} free edges told, not {}", joins.free_edges, free);
    if (static_cast<int>(joins.open.size()) != open) return fmt::format("{} open borders told, not {}", joins.open.size(), open);
    if (2 * joins.joined + open + points != joins.free_edges + joins.split)
      return fmt::format("2 x {} joined, {} open and {} points are not {} free edges split {} times", joins.joined, open, points,
                         joins.free_edges, joins.split);
    return {};
  }

  // What has none takes no part, unless the sewing makes it a point.
  bool has_length(const Boundary& boundary, const BoundaryEdge& edge) const {
    return SpaceCurve(part_, boundary.uses[static_cast<std::size_t>(edge.uses[0])]).length() > 1e-11 * size_;
  }

  // Each use is one of its edge; more than two the file gave, and one edge is of one solid.
  std::string uses_agree() const {
    std::map<int, int> of_part_edge;
    for (const EdgeUse& u : before_.uses)
      if (u.curve.edge >= 0) ++of_part_edge[u.curve.edge];
    std::vector<int> seen(after_.uses.size(), 0);
    for (std::size_t e = 0; e < after_.edges.size(); ++e) {
      const auto& uses = after_.edges[e].uses;
      for (const int u : uses) {
        if (use(u).edge != static_cast<int>(e)) return fmt::format("use {} does not know its edge {}", u, e);
        ++seen[static_cast<std::size_t>(u)];
        if (uses.size() > 2 && !of_file(use(uses[0]), use(u))) return fmt::format("edge {} has {} uses", e, uses.size());
        if (!of_file(use(uses[0]), use(u)) && solid(use(uses[0])) != solid(use(u))) return fmt::format("edge {} is of two solids", e);
      }
      if (uses.size() > 2 && of_part_edge[use(uses[0]).curve.edge] != static_cast<int>(uses.size()))
        return fmt::format("edge {} has {} uses", e, uses.size());
    }
    for (std::size_t u = 0; u < seen.size(); ++u)
      if (seen[u] != 1) return fmt::format("use {} is {} times in edges", u, seen[u]);
    return {};
  }
  int solid(const EdgeUse& u) const { return part_.faces[static_cast<std::size_t>(u.face)].solid; }

  // Pieces of a curve follow each other and cover it.
  std::string loops_go_on() const {
    for (std::size_t f = 0; f < after_.loops.size(); ++f)
      for (std::size_t l = 0; l < after_.loops[f].size(); ++l) {
        const auto &loop = after_.loops[f][l], &old = before_.loops[f][l];
        std::size_t k = 0;
        for (const int o : old) {
          const TrimCurve& whole = before_.uses[static_cast<std::size_t>(o)].curve;
          double at = whole.t0;
          do {
            if (k == loop.size()) return fmt::format("face {} loop {} ends early", f, l);
            const TrimCurve& piece = use(loop[k++]).curve;
            if (piece.t0 != at || piece.edge != whole.edge) return fmt::format("face {} loop {} leaps at {}", f, l, k - 1);
            at = piece.t1;
          } while (at != whole.t1);
        }
        if (k != loop.size()) return fmt::format("face {} loop {} goes on too far", f, l);
      }
    return {};
  }

  // join_edges.h: ends within twice the tolerance, places between within it, or both within the gaps of edges with the same ends.
  double allowed(double length) const {
    constexpr double kRounding = 1e-12;
    return std::max(2 * after_.joins.tolerance, std::min(1e-4 * size_, 1e-3 * length)) + kRounding * size_;
  }
  std::string joined_are_near() const {
    double widest = 0;
    for (std::size_t e = 0; e < after_.edges.size(); ++e) {
      const auto& uses = after_.edges[e].uses;
      if (uses.size() != 2 || of_file(use(uses[0]), use(uses[1]))) continue;
      const SpaceCurve &a = curve(uses[0]), &b = curve(uses[1]);
      const double apart = std::max(farthest(a, b), farthest(b, a)),
                   ends = std::max(glm::length(a.from() - b.from()), glm::length(a.to() - b.to()));
      const bool is_short = std::max(a.length(), b.length()) <= 8 * after_.joins.tolerance;  // see join_short_edges of boundary.cpp
      if (apart > (is_short ? 8 * after_.joins.tolerance : allowed(std::max(a.length(), b.length()))))
        return fmt::format("the uses of edge {} are {} tolerances apart, {} long", e, apart / after_.joins.tolerance,
                           a.length() / after_.joins.tolerance);
      if (!is_short && ends > allowed(std::max(a.length(), b.length())))
        return fmt::format("the ends of edge {} are {} tolerances apart", e, ends / after_.joins.tolerance);
      if (!is_short) widest = std::max(widest, apart);
    }
    if (widest > after_.joins.widest + 0.05 * after_.joins.tolerance + 1e-12 * size_)
      return fmt::format("the widest gap is {} tolerances, not {}", widest / after_.joins.tolerance,
                         after_.joins.widest / after_.joins.tolerance);
    return {};
  }

  // No two open edges run within half the tolerance of each other where they could be joined.
  std::string near_are_joined(SewingCounts& counts) const {
    std::vector<int> open;
    for (const BoundaryEdge& edge : after_.edges)
      if (edge.uses.size() == 1 && !edge.degenerate) open.push_back(edge.uses[0]);
    for (std::size_t i = 0; i < open.size(); ++i)
      for (std::size_t j = i + 1; j < open.size(); ++j) {
        if (use(open[i]).face == use(open[j]).face || solid(use(open[i])) != solid(use(open[j]))) continue;
        ++counts.compared;
        const double together = run_together(curve(open[i]), curve(open[j]));
        if (together > 0)
          return fmt::format("open edges of faces {} and {} run together for {} tolerances", use(open[i]).face, use(open[j]).face,
                             together / after_.joins.tolerance);
      }
    return {};
  }

  // How far one runs within half the tolerance of the other, from a vertex of either to a vertex of either; 0 if that is too short to
  // count: for short edges, and for curves that only touch.
  double run_together(const SpaceCurve& a, const SpaceCurve& b) const {
    const double tolerance = after_.joins.tolerance, half = 0.5 * tolerance;
    // A vertex is told only to the next place: of fewer than four, both ends of the run could be one.
    const double enough =
        std::max(24 * tolerance + 4 * std::sqrt(tolerance * size_), 4 * a.length() / static_cast<double>(a.places().size()));
    if (!touch(a, b, half)) return 0;
    const auto& places = a.places();
    std::vector<char> near(places.size());
    for (std::size_t i = 0; i < near.size(); ++i) near[i] = b.distance(places[i], half) <= half;
    // Of two neighbours of which one is near, the vertex of the other curve lies between them, if there is one.
    const auto ends_at = [&](std::size_t in, std::size_t out) {
      const double step = glm::length(places[in] - places[out]) + half;
      return std::min(glm::length(places[in] - b.from()), glm::length(places[in] - b.to())) <= step;
    };
    for (std::size_t i = 0, end = 0; i < near.size(); i = end + 1) {
      double together = 0;
      for (end = i; end < near.size() && near[end]; ++end)
        if (end > i) together += glm::length(places[end] - places[end - 1]);
      if (together > enough && (i == 0 || ends_at(i, i - 1)) && (end == near.size() || ends_at(end - 1, end))) return together;
    }
    return 0;
  }

  static bool touch(const SpaceCurve& a, const SpaceCurve& b, double within) {
    Box3 box_a, box_b;
    for (const Point3& p : a.places()) box_a.include(p);
    for (const Point3& p : b.places()) box_b.include(p);
    for (int axis = 0; axis < 3; ++axis)
      if (box_a.lo[axis] > box_b.hi[axis] + within || box_b.lo[axis] > box_a.hi[axis] + within) return false;
    return true;
  }

  const Part& part_;
  double size_;
  Boundary before_, after_;
  std::vector<SpaceCurve> curves_;
};

std::string mesh_holds(const SewingModel& model, SewingCounts& counts) {
  constexpr double kDistance = 0.05;
  const Part& part = model.faces.part;
  const PartTessellation made = tessellate(part, {kDistance * model.unit, 0, kInf, model.sew});
  const MeshReport report = verify(part, made.mesh, notes_of(made));
  counts.triangles += static_cast<int>(made.mesh.triangles.size());
  for (std::size_t f = 0; f < made.faces.size(); ++f) {
    const FaceReport& face = made.faces[f];
    if (!face.failure.empty()) return fmt::format("face {}: {}", f, face.failure);
    if (!(face.bound <= kDistance * model.unit)) return fmt::format("face {}: bound {}", f, face.bound / model.unit);
    if (face.unresolved || face.crossings) return fmt::format("face {}: {} unresolved, {} crossings", f, face.unresolved, face.crossings);
  }
  if (report.cracks.count) return fmt::format("{} cracks", report.cracks.count);
  if (report.topology.open_edges.count != made.free_sides.size())
    return fmt::format("{} sides are open, not {}", report.topology.open_edges.count, made.free_sides.size());
  if (model.shared == 0 && report.topology.non_manifold_edges.count)
    return fmt::format("{} edges of three triangles", report.topology.non_manifold_edges.count);
  return {};
}

// The faces from the last to the first.
std::string order_does_not_matter(const SewingModel& model, const JoinReport& joins) {
  Part turned = model.faces.part;
  std::reverse(turned.faces.begin(), turned.faces.end());
  const JoinReport other = Boundary(turned, model.sew).joins;
  if (other.joined != joins.joined || other.split != joins.split || other.open.size() != joins.open.size())
    return fmt::format("{} joined, {} split, {} open, but {}, {}, {} in another order", joins.joined, joins.split, joins.open.size(),
                       other.joined, other.split, other.open.size());
  return {};
}

}  // namespace

std::string run_sewing(std::span<const std::uint8_t> bytes, SewingCounts& counts) {
  const SewingModel model = sewing_model(bytes);
  ++counts.models;
  counts.shared += model.shared;
  if (model.faces.part.faces.empty()) return {};
  const Checks checks(model.faces.part, model.sew);
  std::string wrong = checks.all(counts);
  if (wrong.empty()) wrong = mesh_holds(model, counts);
  if (wrong.empty()) wrong = order_does_not_matter(model, checks.joins());
  return wrong;
}

}  // namespace iso::test
