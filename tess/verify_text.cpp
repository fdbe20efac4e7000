#include <fmt/format.h>

#include "tess/verify.h"

namespace iso {
namespace {

void add_finding(std::string& text, const char* what, const Finding& finding) {
  if (finding.count == 0) return;
  text += fmt::format("{:>12}  {}\n", finding.count, what);
  for (const MeshPlace& place : finding.places) {
    text += place.triangle < 0 && place.face >= 0 ? "              at"
                                                  : fmt::format("              at {} {} {}", place.at.x, place.at.y, place.at.z);
    if (place.face >= 0) text += fmt::format(" face {}", place.face);
    if (place.triangle >= 0) text += fmt::format(" triangle {}", place.triangle);
    text += "\n";
  }
}

void add_topology(std::string& text, const TopologyReport& report) {
  add_finding(text, "edges of more than two triangles", report.non_manifold_edges);
  add_finding(text, "edges whose two triangles run the same way", report.misoriented_edges);
  add_finding(text, "points whose triangles form more than one fan", report.non_manifold_points);
  add_finding(text, "triangles without area", report.zero_area);
  add_finding(text, "triangles that repeat one before", report.duplicates);
  add_finding(text, "ends of open edges inside another open edge", report.t_junctions);
  add_finding(text, "points of no triangle", report.isolated_points);
}

std::string counts(const TopologyReport& report) {
  return fmt::format("{} points, {} triangles, {} edges, {} of them open\n", report.points, report.triangles, report.edges,
                     report.open_edges.count);
}

}  // namespace

std::string text_of(const TopologyReport& report) {
  std::string text = counts(report);
  add_finding(text, "open edges", report.open_edges);
  add_topology(text, report);
  return text + (report.closed() ? "closed\n" : report.sound() ? "sound, but open\n" : "not sound\n");
}

std::string text_of(const MeshReport& report) {
  std::string text = fmt::format("{} faces, {} nodes, ", report.faces, report.nodes) + counts(report.topology);
  if (report.shapes.triangles > 0)
    text += fmt::format("smallest angle {:.3g} degrees, {:.3g} % of the triangles under {} degree\n", report.shapes.smallest_angle,
                        100 * report.shapes.sliver_share(), kSliver);
  add_finding(text, "open edges where the model is open", report.free_edges);
  add_finding(text, "cracks: open edges where the model is not", report.cracks);
  add_topology(text, report.topology);
  add_finding(text, "triangles folded against their normals", report.folded);
  add_finding(text, "triangles turned or without area in (u, v)", report.turned);
  add_finding(text, "triangles that overlap one before in (u, v)", report.overlapping);
  add_finding(text, "faces without triangles", report.empty_faces);
  return text + (report.sound() ? "sound\n" : "not sound\n");
}

}  // namespace iso
