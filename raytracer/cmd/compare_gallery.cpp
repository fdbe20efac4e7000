// Pictures and charts of a comparison's page.
#include <fmt/format.h>

#include "raytracer/cmd/compare_charts.h"
#include "raytracer/cmd/compare_figures.h"
#include "raytracer/cmd/compare_sections.h"
#include "raytracer/cmd/page_text.h"

namespace iso {
namespace {

// ---- pictures -----------------------------------------------------------------------------------------------------------

const ReportPicture* picture_named(const std::vector<ReportPicture>& pictures, const char* key) {
  for (const ReportPicture& picture : pictures)
    if (picture.key == key && !picture.png.empty()) return &picture;
  return nullptr;
}

std::string img(const CompareReport& report, const ReportPicture& picture, const std::string& alt, const std::string& attributes) {
  return fmt::format("<img{} width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">\n", attributes, report.size.width,
                     report.size.height, escaped(alt), base64(picture.png));
}

// What the colours of a picture mean: kinds by name, or a scale from `lo` to `hi`.
std::string legend_html(const ReportLegend& legend) {
  std::string text;
  if (!legend.labels.empty()) {
    for (std::size_t i = 0; i < std::min(legend.labels.size(), legend.colours.size()); ++i)
      text += fmt::format("<li><span class=\"swatch\" style=\"background:{}\"></span> {}</li>\n", hex_of(legend.colours[i]),
                          escaped(legend.labels[i]));
    return "<ul class=\"kinds\">\n" + text + "</ul>\n";
  }
  for (const Colour& colour : legend.colours) text += "," + hex_of(colour);
  if (legend.colours.size() < 2) return {};
  const std::string unit = legend.unit.empty() ? "" : " " + escaped(legend.unit);
  const double middle = 0.5 * (legend.lo + legend.hi);
  return fmt::format(
      "<div class=\"scale\"><div class=\"bar\" style=\"background:linear-gradient(to right{})\"></div><div class=\"ends\">"
      "<span>{}{}</span><span>{}</span><span>{}{}</span></div></div>\n",
      text, shown(legend.lo), unit, figure_text(middle), shown(legend.hi), unit);
}

std::string legend_text(const ReportLegend* legend) {
  if (!legend || legend->colours.empty()) return {};
  if (legend->labels.empty())
    return fmt::format(", colours from {} to {}{}{}", figure_text(legend->lo), figure_text(legend->hi), legend->unit.empty() ? "" : " ",
                       legend->unit);
  std::string text = ", colours for ";
  for (const std::string& label : legend->labels) text += (&label == &legend->labels.front() ? "" : "; ") + label;
  return text;
}

std::string exr_link(const ReportPicture& picture) {
  if (picture.file.empty()) return {};
  return fmt::format(" <a class=\"file\" href=\"{}\">{}</a>", link_to(picture.file), escaped(picture.file));
}

std::string figure(const CompareReport& report, const ReportPicture& picture, const std::string& subject,
                   const std::string& attributes = {}) {
  const ReportLegend* legend = legend_of(report, picture);
  return "<figure>\n" + img(report, picture, subject + ": " + picture.title + legend_text(legend), attributes) +
         (legend ? legend_html(*legend) : "") + "<figcaption>" + escaped(picture.title) + exr_link(picture) + "</figcaption>\n</figure>\n";
}

// The tessellated picture; the script lays the exact one over its left part. Without the script it is just the picture.
std::string slider(const CompareReport& report, const ReportPicture& picture, const ReportMesh& mesh, std::size_t number) {
  return fmt::format(
             "<figure class=\"pair\">\n<div class=\"frame\">\n{}<span class=\"side left\" hidden>exact</span>"
             "<span class=\"side right\" hidden>mesh</span></div>\n<p class=\"wipe\" hidden><label for=\"wipe{}\">exact</label>"
             "<input id=\"wipe{}\" type=\"range\" min=\"0\" max=\"1000\" value=\"500\" aria-label=\"How much of the exact picture is "
             "shown\">"
             "<span>mesh</span></p>\n<figcaption>",
             img(report, picture, mesh.label + ": " + picture.title, ""), number, number) +
         escaped(picture.title) + exr_link(picture) + "</figcaption>\n</figure>\n";
}

std::string pictures_of(const CompareReport& report, const ReportMesh& mesh, std::size_t number, bool has_direct) {
  const ReportPicture* tessellated = picture_named(mesh.pictures, "tessellated");
  std::string text, pair;
  for (const ReportPicture& picture : mesh.pictures) {
    if (picture.png.empty()) continue;
    if (has_direct && &picture == tessellated)
      pair = slider(report, picture, mesh, number);
    else
      text += figure(report, picture, mesh.label);
  }
  if (text.empty() && pair.empty()) return {};
  // Of many meshes the first one's are shown, the others' unfold.
  constexpr std::size_t kFew = 2;
  const bool open = number == 0 || report.meshes.size() <= kFew;
  return fmt::format("<details class=\"pictures\"{}>\n<summary>", open ? " open" : "") + escaped(mesh.label) +
         "</summary>\n<div class=\"gallery\">\n" + pair + text + "</div>\n</details>\n";
}

// ---- charts -------------------------------------------------------------------------------------------------------------

double triangles_of(const ReportMesh& mesh) { return static_cast<double>(mesh.triangles); }
double bytes_of(const ReportMesh& mesh) { return static_cast<double>(mesh.cost.bytes); }
// From the model to the first ray; unknown of meshes that others made.
double seconds_of(const ReportMesh& mesh) {
  return mesh.ours && mesh.cost.tessellate_seconds > 0 ? mesh.cost.tessellate_seconds + mesh.cost.build_seconds : kUnknown;
}

std::string chart_figure(const CompareReport& report, Chart chart, double (*x_of)(const ReportMesh&), const std::string& caption) {
  for (const ReportMesh& mesh : report.meshes)
    chart.points.push_back({mesh.label, x_of(mesh), distance_of(report, mesh.comparison).max, mesh.ours});
  chart.y_title = "largest distance, " + unit_text(report);
  const std::string svg = chart_svg(chart);
  return svg.empty() ? ""
                     : "<figure class=\"chart\">\n" + svg + "<figcaption><strong>" + escaped(chart.title) + ".</strong> " +
                           escaped(caption) + "</figcaption>\n</figure>\n";
}

std::string triangle_chart(const CompareReport& report) {
  Chart chart;
  chart.title = "Error against triangles";
  chart.x_title = "triangles";
  chart.x_unit = ChartUnit::count;
  chart.exact_text = "exact surface: no triangles, error 0";
  chart.guide_text = "error ~ 1 / triangles";
  return chart_figure(report, chart, triangles_of,
                      "The dashed line has slope 2 in the length of a triangle's side: so fast do flat triangles near a curved surface.");
}

std::string time_chart(const CompareReport& report) {
  Chart chart;
  chart.title = "Error against time to the first ray";
  chart.x_title = "tessellation and build";
  chart.x_unit = ChartUnit::seconds;
  chart.exact_text = "exact surface: error 0";
  if (report.direct.build_seconds > 0) {
    chart.exact_x = report.direct.build_seconds;
    chart.exact_text += " after " + figure_text(report.direct.build_seconds) + " s";
  }
  return chart_figure(report, chart, seconds_of, "Meshes of others are left out: how long they took to make is not known.");
}

std::string memory_chart(const CompareReport& report) {
  Chart chart;
  chart.title = "Error against memory";
  chart.x_title = "memory that is traced";
  chart.x_unit = ChartUnit::bytes;
  chart.exact_text = "exact surface: error 0";
  if (report.direct.bytes > 0) {
    chart.exact_x = static_cast<double>(report.direct.bytes);
    chart.exact_text += " in " + bytes_text(report.direct.bytes);
  }
  chart.guide_text = "error ~ 1 / memory";
  return chart_figure(report, chart, bytes_of, "Circles are our meshes, diamonds those of others, the square is the exact surface.");
}

}  // namespace

std::string picture_section(const CompareReport& report) {
  const ReportPicture* direct = picture_named(report.pictures, "direct");
  std::string exact, text;
  for (const ReportPicture& picture : report.pictures)
    if (!picture.png.empty()) exact += figure(report, picture, "Exact surface", &picture == direct ? " id=\"direct\"" : "");
  for (std::size_t m = 0; m < report.meshes.size(); ++m) text += pictures_of(report, report.meshes[m], m, direct != nullptr);
  if (exact.empty() && text.empty()) return {};
  if (!exact.empty()) exact = "<h3>Exact surface</h3>\n<div class=\"gallery\">\n" + exact + "</div>\n";
  return "<section id=\"pictures\">\n<h2>Pictures</h2>\n" + text + exact + "</section>\n";
}

std::string chart_section(const CompareReport& report) {
  const std::string text = triangle_chart(report) + time_chart(report) + memory_chart(report);
  if (text.empty()) return {};
  const std::string slope =
      report.slope == 0 ? ""
                        : "<p class=\"soft\">Slope of error (root mean square) against width of the triangles, both as logarithms: " +
                              shown(report.slope) + ". Flat triangles have 2.</p>\n";
  return "<section id=\"charts\">\n<h2>Error against effort</h2>\n<div class=\"charts\">\n" + text + "</div>\n" + slope + "</section>\n";
}

}  // namespace iso
