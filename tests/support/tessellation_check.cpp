#include "tests/support/tessellation_check.h"

#include <array>
#include <map>

#include "tess/boundary.h"
#include "tess/verify.h"
#include "tests/support/mesh_distance.h"

namespace iso::test {

namespace {

class Checker {
 public:
  Checker(const Part& part, const PartTessellation& made, double tolerance) : part_(part), made_(made), tolerance_(tolerance) {}

  void topology() {
    const MeshReport r = verify(part_, made_.mesh, notes_of(made_));
    const TopologyReport& t = r.topology;
    open_edges();
    add("free edge called a crack", r.cracks);
    if (!shares_edges()) add("edge of three", t.non_manifold_edges);
    if (!is_turned_model()) add("runs the wrong way", t.misoriented_edges);
    add("no area", t.zero_area);
    add("duplicate", t.duplicates);
    add("folded", r.folded);
    add("turned", r.turned);
    add("overlapping", r.overlapping);
    add("empty face", r.empty_faces);
    if (closed() && t.open_edges.count) add("open though closed", t.open_edges);
  }

  void reports() {
    if (made_.unresolved_edges) add("edge unresolved", -1, made_.unresolved_edges, "");
    for (std::size_t f = 0; f < made_.faces.size(); ++f) {
      const FaceReport& r = made_.faces[f];
      const int face = static_cast<int>(f);
      if (!(r.bound <= tolerance_)) add("bound", face, r.bound / tolerance_, "");
      if (r.unresolved) add("unresolved", face, r.unresolved, "");
      if (r.crossings) add("crossings", face, r.crossings, "");
      if (!r.failure.empty()) add("failed", face, 1, r.failure);
    }
  }

  void distances(int samples, Random& random) {
    const double rounding = 1e-12 * (part_.box.diagonal() + glm::length(part_.box.middle()));
    std::vector<double> allowed;
    for (const FaceReport& r : made_.faces) allowed.push_back(std::min(tolerance_, r.bound * (1 + 1e-6)) + r.offset + rounding);
    for (const FarSample& s : search_distances(part_, made_.mesh, allowed, samples, random).beyond)
      add(std::string(s.to_mesh ? "surface far from mesh" : "mesh far from surface") +
              (s.distance > tolerance_ + made_.faces[static_cast<std::size_t>(s.face)].offset ? "" : ", within T"),
          s.face, s.distance / tolerance_,
          fmt::format("uv ({:.9g}, {:.9g}) {:.4g} of what is reported", s.uv.x, s.uv.y, s.distance / s.allowed));
  }

  std::vector<Defect> defects;

 private:
  // Open edges whose ends do not lie on one edge that the model leaves free.
  void open_edges() {
    std::vector<PointTriangle> triangles;
    for (const auto& [a, b, c] : made_.mesh.triangles)
      triangles.push_back({made_.mesh.nodes[a].point, made_.mesh.nodes[b].point, made_.mesh.nodes[c].point});
    std::vector<OpenEdge> open;
    check_topology(made_.mesh.points, triangles, {}, &open);
    Finding cracks;
    std::string where;
    for (const OpenEdge& e : open) {
      const Triangle& t = made_.mesh.triangles[e.triangle];
      const Point3 &a = made_.mesh.corner(t, e.corner), &b = made_.mesh.corner(t, (e.corner + 1) % 3);
      const auto after = std::upper_bound(made_.mesh.first_triangle.begin(), made_.mesh.first_triangle.end(), e.triangle);
      const int face = static_cast<int>(after - made_.mesh.first_triangle.begin()) - 1;
      if (on_free_edge(face, a, b, cracks.count == 0 ? &where : nullptr)) continue;
      cracks.add({0.5 * (a + b), e.triangle, face});
    }
    add("crack", cracks);
    if (cracks.count) defects.back().where += where;
  }

  bool on_free_edge(int f, const Point3& a, const Point3& b, std::string* nearest) const {
    const Face& face = part_.faces[static_cast<std::size_t>(f)];
    if (face.loops.empty()) return true;
    const double within = made_.faces[static_cast<std::size_t>(f)].offset + 1e-7 * part_.box.diagonal();
    double least = kInf;
    for (const TrimLoop& loop : face.loops)
      for (const TrimCurve& c : loop.curves) {
        const double d = std::max(distance_to_curve(face, c, a), distance_to_curve(face, c, b));
        const Edge* edge = c.edge < 0 ? nullptr : &part_.edges[static_cast<std::size_t>(c.edge)];
        if (d <= within && (!edge || edge->uses == 1)) return true;
        if (d < least && nearest) {
          least = d;
          *nearest = edge ? fmt::format(", edge {} at {:.2g} used {} times{}, gap {:.2g}", c.edge, d / tolerance_, edge->uses,
                                        edge->degenerate ? ", degenerate" : "", edge->gap / tolerance_)
                          : ", a curve without an edge";
        }
      }
    return false;
  }

  static double distance_to_curve(const Face& face, const TrimCurve& c, const Point3& p) {
    constexpr int kSteps = 512, kHalvings = 40;  // curves may stand still along some of their length
    const auto distance = [&](double s) { return glm::length(point(face.surface, jet(c.curve, c.t0 + (c.t1 - c.t0) * s).C) - p); };
    std::array<double, kSteps + 1> at;
    for (int i = 0; i <= kSteps; ++i) at[static_cast<std::size_t>(i)] = distance(double(i) / kSteps);
    // Downhill from each place that is lower than its neighbours: a closed curve comes back to where it starts.
    double nearest = kInf;
    for (std::size_t k = 0; k <= kSteps; ++k) {
      if ((k > 0 && at[k - 1] < at[k]) || (k < kSteps && at[k + 1] < at[k])) continue;
      double best = double(k) / kSteps, least = at[k], step = 1.0 / kSteps;
      for (int i = 0; i < kHalvings; ++i, step *= 0.5)
        for (const double s : {best - step, best + step})
          if (const double d = distance(std::clamp(s, 0.0, 1.0)); d < least) least = d, best = std::clamp(s, 0.0, 1.0);
      nearest = std::min(nearest, least);
    }
    return nearest;
  }

  // Whether the model itself runs an edge twice in one direction.
  bool is_turned_model() const {
    const Boundary boundary(part_);
    for (const BoundaryEdge& edge : boundary.edges) {
      int ways = 0;
      for (const int u : edge.uses) {
        const EdgeUse& use = boundary.uses[static_cast<std::size_t>(u)];
        ways += use.forward != part_.faces[static_cast<std::size_t>(use.face)].reversed ? 1 : -1;
      }
      if (edge.uses.size() == 2 && ways != 0 && !edge.degenerate) return true;
    }
    return false;
  }

  void add(const std::string& what, int face, double figure, const std::string& where) {
    defects.push_back({what, 0, face, face >= 0 ? kind_name(part_.faces[static_cast<std::size_t>(face)].surface) : "", figure, where});
  }

  // One row for all of a kind, with its first place.
  void add(const std::string& what, const Finding& finding) {
    if (finding.count == 0) return;
    const MeshPlace& at = finding.places.front();
    std::string where;
    if (at.triangle >= 0) {
      UV uv(0.0);
      for (const std::uint32_t n : made_.mesh.triangles[static_cast<std::size_t>(at.triangle)]) uv += made_.mesh.nodes[n].uv / 3.0;
      where = fmt::format("uv ({:.9g}, {:.9g})", uv.x, uv.y);
    }
    std::map<int, int> faces;
    for (const MeshPlace& p : finding.places) ++faces[p.face];
    where += ", faces";
    for (const auto& [face, count] : faces) where += fmt::format(" {}", face);
    add(what, at.face, static_cast<double>(finding.count), where);
  }

  bool closed() const {
    for (const Edge& e : part_.edges)
      if (e.uses < 2 && !e.degenerate) return false;
    for (const Face& f : part_.faces) {
      if (f.loops.empty()) return false;
      for (const TrimLoop& loop : f.loops)
        for (const TrimCurve& c : loop.curves)
          if (c.edge < 0) return false;
    }
    return true;
  }
  bool shares_edges() const {
    for (const Edge& e : part_.edges)
      if (e.uses > 2 && !e.degenerate) return true;
    return false;
  }

  const Part& part_;
  const PartTessellation& made_;
  double tolerance_;
};

}  // namespace

std::string text_of(const Defect& d) {
  return fmt::format("{:<24} part {} face {:>4} {:<10} {:>10.4g}  {}", d.what, d.part, d.face, d.kind, d.figure, d.where);
}

std::vector<Defect> defects_of(const Part& part, const PartTessellation& made, double tolerance, int samples, Random& random) {
  Checker checker(part, made, tolerance);
  checker.topology();
  checker.reports();
  checker.distances(samples, random);
  return std::move(checker.defects);
}

}  // namespace iso::test
