// What the page of a comparison tells in tables.
#include <fmt/format.h>

#include <functional>

#include "raytracer/cmd/compare_figures.h"
#include "raytracer/cmd/compare_sections.h"
#include "raytracer/cmd/page_text.h"

namespace iso {
namespace {

constexpr double kDegrees = 180 / kPi;
constexpr std::size_t kFacesShown = 50;
constexpr const char* kNothing = "<td class=\"none\">–</td>";

std::string td(const std::string& html) { return "<td>" + html + "</td>"; }

// A table that scrolls in a box of its own; `label` names the box for those who do not see it.
std::string boxed(const std::string& label, const std::string& table) {
  return fmt::format("<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n{}</div>\n", label, table);
}

// ---- a row a figure, a column a mesh ------------------------------------------------------------------------------------

// The cell of a mesh, <td> included.
using Cell = std::function<std::string(const ReportMesh&)>;
struct Row {
  std::string name;  // HTML
  Cell cell;
};

std::string unit_span(const std::string& unit) { return unit.empty() ? "" : " <span class=\"unit\">" + escaped(unit) + "</span>"; }
Row number_row(const std::string& name, const std::string& unit, std::function<double(const ReportMesh&)> value) {
  return {name + unit_span(unit), [value = std::move(value)](const ReportMesh& m) { return td(shown(value(m))); }};
}
Row count_row(const std::string& name, std::function<std::uint64_t(const ReportMesh&)> value) {
  return {name, [value = std::move(value)](const ReportMesh& m) { return td(shown_count(value(m))); }};
}
// A number that only some meshes have: 0 and NaN are none.
Row optional_row(const std::string& name, const std::string& unit, std::function<double(const ReportMesh&)> value) {
  return {name + unit_span(unit), [value = std::move(value)](const ReportMesh& m) {
            const double x = value(m);
            return x > 0 ? td(shown(x)) : std::string(kNothing);
          }};
}

// `extra`: of the column before the meshes, a cell for each row; empty: there is no such column.
std::string group(const CompareReport& report, const std::string& name, const std::vector<Row>& rows,
                  const std::vector<std::string>& extra = {}) {
  const std::size_t columns = report.meshes.size() + 1 + !extra.empty();
  std::string text = "<tbody>\n";
  if (!name.empty())
    text += fmt::format("<tr class=\"group\"><th scope=\"rowgroup\" colspan=\"{}\"><span>{}</span></th></tr>\n", columns, name);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += "<tr><th scope=\"row\">" + rows[r].name + "</th>" + (extra.empty() ? "" : extra[r]);
    for (const ReportMesh& mesh : report.meshes) text += rows[r].cell(mesh);
    text += "</tr>\n";
  }
  return text + "</tbody>\n";
}

std::string head(const CompareReport& report, const std::string& extra = {}) {
  std::string text = "<thead><tr><td></td>";
  if (!extra.empty()) text += "<th scope=\"col\">" + extra + "</th>";
  for (const ReportMesh& mesh : report.meshes)
    text += "<th scope=\"col\">" + escaped(shortened(mesh.label, 32)) + (mesh.ours ? "" : " <span class=\"unit\">foreign</span>") + "</th>";
  return text + "</tr></thead>\n";
}

std::string distance_rows(const CompareReport& report) {
  const std::string unit = unit_text(report);
  const auto distance = [&](double MeshDistance::*member) {
    return [&report, member](const ReportMesh& m) { return distance_of(report, m.comparison).*member; };
  };
  std::vector<Row> rows{number_row("<strong>Largest</strong>, found", unit, distance(&MeshDistance::max)),
                        number_row("Largest", "diagonals of the model", distance(&MeshDistance::diagonals))};
  if (report.pixel > 0) rows.push_back(number_row("Largest", "pixels of the camera", distance(&MeshDistance::pixels)));
  rows.insert(rows.end(),
              {number_row("99.9 % are within", unit, distance(&MeshDistance::p999)),
               number_row("Root mean square", unit, distance(&MeshDistance::rms)), number_row("Mean", unit, distance(&MeshDistance::mean)),
               number_row("<strong>Proven</strong>: none is farther", unit, distance(&MeshDistance::bound)),
               number_row("Proof is right to", unit, [](const ReportMesh& m) { return m.comparison.reference_bound; }),
               optional_row("Promised when it was made", unit, [](const ReportMesh& m) { return m.guaranteed.value_or(kUnknown); })});
  return group(report, "Distance, of both ways the larger", rows);
}

std::string shape_rows(const CompareReport& report) {
  const auto shapes = [](const ReportMesh& m) -> const TriangleShapes& { return m.comparison.all.shapes; };
  const std::vector<Row> angles{
      number_row("Largest", "degrees", [](const ReportMesh& m) { return kDegrees * m.comparison.all.worst_angle; }),
      number_row("Mean", "degrees", [](const ReportMesh& m) { return kDegrees * m.comparison.all.mean_angle; })};
  const std::vector<Row> edges{
      count_row("Faces without mesh, whole or in part", [](const ReportMesh& m) { return missing_faces(m.comparison); }),
      count_row("Faces that were not measured", [](const ReportMesh& m) { return m.comparison.unmeasured_faces; }),
      count_row("Open edges", [](const ReportMesh& m) { return m.comparison.topology.open_edges.count; }),
      count_row("of them where the model ends", [](const ReportMesh& m) { return m.comparison.free_edges; }),
      number_row("Widest gap", unit_text(report), [](const ReportMesh& m) { return m.comparison.widest_gap; }),
      count_row("Non-manifold edges", [](const ReportMesh& m) { return m.comparison.topology.non_manifold_edges.count; }),
      number_row("Smallest angle", "degrees", [=](const ReportMesh& m) { return smallest_angle(shapes(m)); }),
      count_row("Slivers, under 1 degree", [=](const ReportMesh& m) { return shapes(m).slivers; })};
  return group(report, "Angle between triangles and surface", angles) + group(report, "Faces, edges and triangles", edges);
}

std::string mesh_table(const CompareReport& report) {
  const std::vector<Row> rows{optional_row("Tolerance asked for", unit_text(report), [](const ReportMesh& m) { return m.tolerance; }),
                              count_row("Triangles", [](const ReportMesh& m) { return m.triangles; }),
                              count_row("Points", [](const ReportMesh& m) { return m.points; })};
  return boxed("Meshes and their distances",
               "<table>\n" + head(report) + group(report, "", rows) + distance_rows(report) + shape_rows(report) + "</table>\n");
}

// ---- what is wrong ------------------------------------------------------------------------------------------------------

std::string finding(const char* kind, const std::string& name, const std::string& sentence) {
  return fmt::format("<li><strong class=\"tag {}\">{}</strong> {}</li>\n", kind, escaped(name), escaped(sentence));
}

std::string findings(const ReportMesh& mesh) {
  std::string list;
  for (const FaultFound& found : mesh.comparison.faults) {
    const char* severity = name_of(severity_of(found.fault));
    list += finding(severity, std::string(severity) + ": " + name_of(found.fault), found.text);
  }
  for (const std::string& line : mesh.broken) list += finding("fault", "not kept", line);
  for (const std::string& line : mesh.notes) list += finding("note", "note", line);
  const std::uint64_t unmeasured = mesh.comparison.unmeasured_faces;
  if (unmeasured > 0)
    list += finding("warning", "not measured",
                    fmt::format("{} of the model could not be measured: nothing is known of {}.",
                                unmeasured == 1 ? "1 face" : count_text(unmeasured) + " faces", unmeasured == 1 ? "it" : "them"));
  const bool clean = mesh.comparison.faults.empty() && mesh.broken.empty() && unmeasured == 0;
  if (clean) list = finding("good", "no faults found", "") + list;
  std::string text = "<article class=\"mesh\">\n<h3>" + escaped(mesh.label) + "</h3>\n<div>\n";
  if (!mesh.verdict.empty()) text += "<p>" + escaped(mesh.verdict) + "</p>\n";
  if (!mesh.file.empty() && mesh.file != mesh.label) text += "<p class=\"soft\">" + escaped(mesh.file) + "</p>\n";
  return text + "<ul class=\"findings\">\n" + list + "</ul>\n</div>\n</article>\n";
}

// ---- pictures, cost -----------------------------------------------------------------------------------------------------

// A row of the image metrics; meshes without pictures have none.
Row image_row(const std::string& name, const std::string& unit, std::function<std::string(const ReportImages&)> html) {
  return {name + unit_span(unit),
          [html = std::move(html)](const ReportMesh& m) { return m.pictures.empty() ? std::string(kNothing) : td(html(m.images)); }};
}

std::string psnr_text(double psnr) { return std::isinf(psnr) && psnr > 0 ? "infinite: equal" : shown(psnr); }

std::string cost_cells(const ReportCost& cost, int row) {
  const auto measured = [](double x) { return x > 0 ? td(shown(x)) : std::string(kNothing); };
  switch (row) {
    case 0:
      return measured(cost.tessellate_seconds);
    case 1:
      return measured(cost.build_seconds);
    case 2:
      return measured(cost.primary_rate);
    case 3:
      return measured(cost.bounce_rate);
    default:
      return cost.bytes > 0 ? td(shown_bytes(cost.bytes)) : std::string(kNothing);
  }
}

// ---- faces --------------------------------------------------------------------------------------------------------------

std::string face_row(const CompareReport& report, const MeshComparison& comparison, std::size_t i) {
  const FaceComparison& f = comparison.faces[i];
  const double share = covered_share(f);
  std::string text = "<tr><th scope=\"row\">" + escaped(shortened(face_name(report, comparison, i), 60)) + "</th>";
  text += td(shown(worst_distance(f))) + td(shown(f.to_surface.max)) + td(shown(f.to_mesh.max));
  text += td(shown(kDegrees * f.worst_angle)) + td(shown_count(f.triangles));
  text += finite(share) ? td(shown(share, figure_text(100 * share) + " %")) : kNothing;
  return text + td(shown_count(f.open_edges)) + "</tr>\n";
}

std::string face_table(const CompareReport& report, const ReportMesh& mesh) {
  const MeshComparison& c = mesh.comparison;
  const std::string unit = escaped(unit_text(report));
  std::string text = "<table class=\"faces\">\n<thead><tr><th scope=\"col\">Face</th>";
  text += "<th scope=\"col\">Largest distance, " + unit + "</th>";
  for (const char* name : {"of the mesh from the surface", "of the surface from the mesh", "Largest angle, degrees", "Triangles",
                           "Area under triangles", "Open edges"})
    text += fmt::format("<th scope=\"col\">{}</th>", name);
  text += "</tr></thead>\n<tbody>\n";
  for (const std::size_t i : worst_faces(c, kFacesShown)) text += face_row(report, c, i);
  return boxed("Worst faces", text + "</tbody>\n</table>\n");
}

}  // namespace

std::string unit_text(const CompareReport& report) { return report.unit.empty() ? "model units" : report.unit; }

std::string mesh_section(const CompareReport& report) {
  if (report.meshes.empty()) return {};
  std::string text = "<section id=\"meshes\">\n<h2>Meshes</h2>\n<div class=\"meshes\">\n";
  for (const ReportMesh& mesh : report.meshes) text += findings(mesh);
  return text + "</div>\n" + mesh_table(report) +
         "<p class=\"soft\">Found: attained at a point. Proven: no point of the mesh is farther from the surface and no point of the "
         "surface "
         "farther from the mesh, right to the error stated below it. This proof takes any mesh and knows nothing of how it was made; the "
         "promise of the mesh's maker, where there is one, rests on that and is often closer.</p>\n</section>\n";
}

std::string strategy_section(const CompareReport& report) {
  bool any = false;
  for (const ReportMesh& mesh : report.meshes) any = any || !mesh.strategy.empty();
  if (!any) return {};
  const std::string per_unit = report.unit.empty() ? "1/model unit" : "1/" + report.unit;
  const auto curvature = [](double CurvatureError::*member) {
    return [member](const ReportMesh& m) { return m.curvature ? (*m.curvature).*member : kUnknown; };
  };
  const std::vector<Row> rows{
      count_row("Triangles", [](const ReportMesh& m) { return m.triangles; }),
      number_row("Distance, found", unit_text(report), [&](const ReportMesh& m) { return distance_of(report, m.comparison).max; }),
      optional_row("Distance, proven when it was made", unit_text(report),
                   [](const ReportMesh& m) { return m.guaranteed.value_or(kUnknown); }),
      optional_row("Mean curvature, largest error", per_unit, curvature(&CurvatureError::max)),
      optional_row("Mean curvature, root mean square error", per_unit, curvature(&CurvatureError::rms)),
      optional_row("Mean curvature of the surface, largest", per_unit, curvature(&CurvatureError::largest)),
      count_row("Points it was taken at", [](const ReportMesh& m) { return m.curvature ? m.curvature->points : 0; })};
  return "<section id=\"strategies\">\n<h2>Strategies</h2>\n" +
         boxed("Strategies", "<table>\n" + head(report) + group(report, "", rows) + "</table>\n") +
         "<p class=\"soft\">The discrete mean curvature, by cotangents, at points inside patches against the surface's: where triangles "
         "change their size abruptly it goes wrong, however near they are.</p>\n</section>\n";
}

std::string image_section(const CompareReport& report) {
  bool any = false;
  for (const ReportMesh& mesh : report.meshes) any = any || !mesh.pictures.empty();
  if (!any) return {};
  const std::vector<Row> rows{
      image_row("FLIP", "0 to 1, mean", [](const ReportImages& i) { return shown(i.flip_ldr); }),
      image_row("HDR-FLIP", "0 to 1, mean", [](const ReportImages& i) { return shown(i.flip_hdr); }),
      image_row("PSNR", "dB", [](const ReportImages& i) { return psnr_text(i.difference.psnr); }),
      image_row("Root mean square", "linear", [](const ReportImages& i) { return shown(i.difference.rmse); }),
      image_row("Largest difference", "linear", [](const ReportImages& i) { return shown(i.difference.max); }),
      image_row("Largest difference", "at pixel",
                [](const ReportImages& i) { return fmt::format("{}, {}", i.difference.worst.x, i.difference.worst.y); }),
      image_row("Pixels that differ", "", [](const ReportImages& i) { return shown_count(i.difference.differ); }),
      image_row("Silhouette: pixels in one only", "", [](const ReportImages& i) { return shown_count(i.silhouette_pixels); })};
  return "<section id=\"images\">\n<h2>How the pictures differ</h2>\n" +
         boxed("Differences of pictures", "<table>\n" + head(report) + group(report, "", rows) + "</table>\n") +
         "<p class=\"soft\">Against the picture of the exact surface, with equal camera, light and samples.</p>\n</section>\n";
}

std::string cost_section(const CompareReport& report) {
  if (report.meshes.empty()) return {};
  const char* names[][2] = {{"Tessellation", "s"},
                            {"Building the tracer", "s"},
                            {"Primary rays", "Mray/s"},
                            {"Bounces", "Mray/s"},
                            {"Memory that is traced", ""}};
  std::vector<Row> rows;
  std::vector<std::string> direct;
  for (int r = 0; r < 5; ++r) {
    rows.push_back({names[r][0] + unit_span(names[r][1]), [r](const ReportMesh& m) { return cost_cells(m.cost, r); }});
    direct.push_back(r == 0 ? "<td>none needed</td>" : cost_cells(report.direct, r));
  }
  std::string text = "<section id=\"cost\">\n<h2>Cost</h2>\n" +
                     boxed("Cost", "<table>\n" + head(report, "Exact surface") + group(report, "", rows, direct) + "</table>\n");
  if (!report.machine.empty()) text += "<p class=\"soft\">Measured on " + escaped(report.machine) + ".</p>\n";
  return text + "</section>\n";
}

std::string face_section(const CompareReport& report) {
  std::string text;
  for (const ReportMesh& mesh : report.meshes) {
    if (mesh.comparison.faces.empty()) continue;
    const std::size_t all = mesh.comparison.faces.size();
    const std::string told = all > kFacesShown ? fmt::format("the worst {} of {} faces", kFacesShown, count_text(all))
                                               : fmt::format("{} {}, the worst first", all, all == 1 ? "face" : "faces");
    text += "<details>\n<summary>" + escaped(mesh.label) + ": " + told + "</summary>\n" + face_table(report, mesh) + "</details>\n";
  }
  if (text.empty()) return {};
  return "<section id=\"faces\">\n<h2>Faces</h2>\n" + text +
         "<p class=\"soft\">All faces are in <a href=\"./table.csv\">table.csv</a> and <a href=\"./report.json\">report.json</a>.</p>\n"
         "</section>\n";
}

}  // namespace iso
