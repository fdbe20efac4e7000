#include "raytracer/cmd/mesh_report.h"

#include <fmt/format.h>

#include <cmath>

namespace iso {
namespace {

// "48 310".
std::string grouped(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), " ");
  return digits;
}

std::string counted(std::uint64_t n, const char* one, const char* many) { return grouped(n) + " " + (n == 1 ? one : many); }

// "face 17", with the part before it where there are several.
std::string face_text(const MeshFigures& figures, std::size_t part, int face) {
  const Part& p = *figures.parts[part].part;
  std::string text;
  if (figures.parts.size() > 1) text = fmt::format("part {}{}, ", part, p.name.empty() ? "" : fmt::format(" '{}'", p.name));
  text += fmt::format("face {}", face);
  const std::string& name = p.faces[static_cast<std::size_t>(face)].name;
  return name.empty() ? text : text + fmt::format(" '{}'", name);
}

class Broken {
 public:
  explicit Broken(const MeshFigures& figures) : figures_(figures) {}

  std::vector<std::string> lines() {
    for (std::size_t p = 0; p < figures_.parts.size(); ++p) {
      for (std::size_t f = 0; f < figures_.parts[p].faces.size(); ++f) add_face(p, static_cast<int>(f), figures_.parts[p].faces[f]);
      add_part(p, figures_.parts[p]);
    }
    return std::move(lines_);
  }

 private:
  void add_face(std::size_t p, int f, const FaceFigures& face) {
    const FaceReport& r = face.report;
    const auto say = [&](const std::string& what) { lines_.push_back(face_text(figures_, p, f) + ": " + what); };
    if (!r.failure.empty()) say("no triangles: " + r.failure);
    if (!face.within || r.unresolved > 0)
      say(fmt::format("distance bound {}, beyond the tolerance {}: {} could not be divided", length(r.bound),
                      length(figures_.settings.distance), counted(static_cast<std::uint64_t>(r.unresolved), "triangle", "triangles")));
    if (face.within && !std::isfinite(r.bound)) say("distance bound unknown");
    if (r.crossings > 0) say(counted(static_cast<std::uint64_t>(r.crossings), "side", "sides") + " of its border cross others");
    if (r.at_folds > 0)
      say(fmt::format("the surface itself folds at {:.6g} {:.6g} {:.6g}: {} against its normals there", r.fold.x, r.fold.y, r.fold.z,
                      counted(static_cast<std::uint64_t>(r.at_folds), "triangle lies", "triangles lie")));
    if (r.folded > r.at_folds)
      say(counted(static_cast<std::uint64_t>(r.folded - r.at_folds), "triangle", "triangles") + " turned against the surface");
    if (face.contradicts)
      say(fmt::format("measured {}, more than the proven {}: a defect of isophote", length(face.measured), length(r.bound)));
  }

  void add_part(std::size_t p, const PartFigures& part) {
    if (part.unresolved_edges > 0)
      lines_.push_back(fmt::format("{} of edges could not be divided to come within the tolerance",
                                   counted(static_cast<std::uint64_t>(part.unresolved_edges), "segment", "segments")));
    bool model_branches = false;
    for (const Edge& edge : part.part->edges) model_branches = model_branches || edge.uses > 2;
    const MeshReport& c = part.check;
    const TopologyReport& t = c.topology;
    add_finding(p, c.cracks, "open edge where the model is closed", "open edges where the model is closed");
    if (!model_branches) add_finding(p, t.non_manifold_edges, "edge of more than two triangles", "edges of more than two triangles");
    add_finding(p, t.misoriented_edges, "edge whose triangles run the same way", "edges whose triangles run the same way");
    add_finding(p, t.duplicates, "triangle twice", "triangles twice");
    add_finding(p, t.zero_area, "triangle without area", "triangles without area");
    add_finding(p, t.t_junctions, "end of an open edge inside another", "ends of open edges inside others");
    // Those where the surface folds are told with their faces.
    std::uint64_t at_folds = 0;
    for (const FaceFigures& face : part.faces) at_folds += static_cast<std::uint64_t>(face.report.at_folds);
    if (c.folded.count > at_folds)
      add_finding(p, c.folded, "triangle folded against its normals", "triangles folded against their normals");
    add_finding(p, c.turned, "triangle turned or without area in (u, v)", "triangles turned or without area in (u, v)");
    add_finding(p, c.overlapping, "triangle that overlaps another in (u, v)", "triangles that overlap others in (u, v)");
  }

  void add_finding(std::size_t p, const Finding& finding, const char* one, const char* many) {
    if (finding.count == 0) return;
    std::string line = counted(finding.count, one, many);
    if (!finding.places.empty()) {
      const MeshPlace& at = finding.places.front();
      line += fmt::format("{} at {:.6g} {:.6g} {:.6g}", finding.count > 1 ? ", the first" : "", at.at.x, at.at.y, at.at.z);
      if (at.face >= 0) line += ", " + face_text(figures_, p, at.face);
    }
    lines_.push_back(line);
  }

  std::string length(double x) const { return length_text(x, figures_.unit); }

  const MeshFigures& figures_;
  std::vector<std::string> lines_;
};

}  // namespace

MeshTotals totals_of(const MeshFigures& figures) {
  MeshTotals all;
  for (std::size_t p = 0; p < figures.parts.size(); ++p) {
    const PartFigures& part = figures.parts[p];
    all.placements += static_cast<std::uint64_t>(part.placements);
    all.faces += part.faces.size();
    all.triangles += part.check.topology.triangles;
    all.points += part.check.topology.points;
    all.open_edges += part.check.topology.open_edges.count;
    all.free_edges += part.check.free_edges.count;
    all.cracks += part.check.cracks.count;
    all.bound = std::max(all.bound, part.all.report.bound);
    all.offset = std::max(all.offset, part.all.report.offset);
    all.worst_angle = std::max(all.worst_angle, part.all.worst_angle);
    if (part.worst_face < 0 || part.all.measured <= all.measured) continue;
    all.measured = part.all.measured;
    all.worst_part = static_cast<int>(p);
  }
  return all;
}

std::string length_text(double length, const std::string& unit) {
  if (!std::isfinite(length)) return "unknown";
  return fmt::format("{:.3g}{}{}", length, unit.empty() ? "" : " ", unit);
}

namespace {

// What was joined, turned and left out, if anything.
std::string repairs_text(const MeshFigures& figures) {
  std::uint64_t joined = 0, turned = 0, copies = 0;
  double widest = 0;
  for (const PartFigures& part : figures.parts) {
    joined += static_cast<std::uint64_t>(part.joins.joined);
    turned += static_cast<std::uint64_t>(part.turned);
    for (const FaceFigures& face : part.faces) copies += face.report.copy_of >= 0;
    widest = std::max(widest, part.joins.widest);
  }
  std::string text;
  if (joined > 0)
    text += fmt::format("; {} of edges joined, up to {} apart", counted(joined, "pair", "pairs"), length_text(widest, figures.unit));
  if (turned > 0)
    text += fmt::format("; {} turned to the side of {} neighbours", counted(turned, "face", "faces"), turned == 1 ? "its" : "their");
  if (copies > 0) text += fmt::format("; {} left out that {} others", counted(copies, "face", "faces"), copies == 1 ? "repeats" : "repeat");
  return text;
}

}  // namespace

std::string summary_text(const MeshFigures& figures) {
  const MeshTotals all = totals_of(figures);
  std::string text;
  if (figures.parts.size() > 1 || all.placements != figures.parts.size())
    text = fmt::format("{} in {}, ", counted(figures.parts.size(), "part", "parts"), counted(all.placements, "place", "places"));
  text += fmt::format("{}, {}, {}", counted(all.faces, "face", "faces"), counted(all.triangles, "triangle", "triangles"),
                      counted(all.open_edges, "open edge", "open edges"));
  if (all.open_edges > 0 && all.cracks == 0) text += ", as in the model";
  if (all.cracks > 0) text += fmt::format(" ({} where the model is closed)", grouped(all.cracks));
  text += repairs_text(figures);
  text += fmt::format("; distance bound {}, measured {}", length_text(all.bound, figures.unit), length_text(all.measured, figures.unit));
  if (all.worst_part >= 0) {
    const PartFigures& worst = figures.parts[static_cast<std::size_t>(all.worst_part)];
    text += fmt::format(" at {} ({:.4g}, {:.4g})", face_text(figures, static_cast<std::size_t>(all.worst_part), worst.worst_face),
                        worst.all.worst_uv.x, worst.all.worst_uv.y);
  }
  return text + fmt::format("; edges' own gap {}", length_text(all.offset, figures.unit));
}

std::vector<std::string> broken_promises(const MeshFigures& figures) { return Broken(figures).lines(); }

}  // namespace iso
