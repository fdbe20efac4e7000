// The page of a comparison: one HTML file that needs nothing beside it.
#include <fmt/format.h>

#include "raytracer/cmd/compare_figures.h"
#include "raytracer/cmd/compare_sections.h"
#include "raytracer/cmd/page_text.h"

namespace iso {
namespace {

// Nothing is fetched, whatever a name in a file tries.
constexpr const char* kPolicy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

std::string top(const CompareReport& report) {
  std::string text = "<header>\n<p class=\"kicker\">Isophote: mesh against exact surface</p>\n<h1>" +
                     escaped(report.verdict.empty() ? "No verdict" : report.verdict) + "</h1>\n<p class=\"soft\">" +
                     (report.model.empty() ? "" : escaped(report.model) + ", ") + shown_count(report.faces) +
                     (report.faces == 1 ? " face" : " faces") + ", diagonal " + shown(report.diagonal) + " " + escaped(unit_text(report)) +
                     "</p>\n";
  if (!report.failures.empty()) {
    text += "<ul class=\"findings\">\n";
    for (const std::string& line : report.failures) text += "<li><strong class=\"tag fault\">failed</strong> " + escaped(line) + "</li>\n";
    text += "</ul>\n";
  }
  if (!report.advice.empty()) text += "<p class=\"advice\"><strong>Advice</strong> " + escaped(report.advice) + "</p>\n";
  return text + "</header>\n";
}

// Links to the sections that are there.
std::string contents(const std::string& body) {
  const char* names[][2] = {{"meshes", "Meshes"}, {"strategies", "Strategies"}, {"pictures", "Pictures"}, {"images", "Differences"},
                            {"cost", "Cost"},     {"charts", "Charts"},         {"faces", "Faces"},       {"method", "Method"}};
  std::string text = "<nav aria-label=\"Sections\">";
  for (const auto& [id, name] : names)
    if (body.find(fmt::format("<section id=\"{}\">", id)) != std::string::npos) text += fmt::format("<a href=\"#{}\">{}</a> ", id, name);
  return text + "</nav>\n";
}

std::string term(const std::string& name, const std::string& html) { return "<dt>" + name + "</dt><dd>" + html + "</dd>\n"; }

// How fine the reference was for each mesh, and how far its figures can be trusted.
std::string references(const CompareReport& report) {
  std::string text;
  const std::string unit = escaped(unit_text(report));
  for (const ReportMesh& mesh : report.meshes) {
    const MeshComparison& c = mesh.comparison;
    text += "<li>" + escaped(mesh.label) + ": " + shown_count(c.reference_triangles) + " triangles, no farther than " +
            shown(c.reference_bound) + " " + unit + " from the surface; compared in " + shown(c.seconds) + " s</li>\n";
  }
  return text.empty() ? "" : term("Reference", "<ul class=\"plain\">\n" + text + "</ul>");
}

std::string method(const CompareReport& report) {
  double gap = 0;
  for (const ReportMesh& mesh : report.meshes) gap = std::max(gap, mesh.comparison.model_gap);
  std::string list =
      term("Distances",
           "Both ways, by closest points: the surface is held as a finer mesh of our own with a proven distance, the closest points are "
           "found "
           "on it and polished on the exact surface. The largest one is attained at a point; mean, root mean square and 99.9 % are over "
           "area, from samples.") +
      term("Proof",
           "Pieces of a triangle are compared with single triangles of the other mesh, from which the distance is convex: it is largest at "
           "the "
           "pieces' corners. To that comes the distance of our own mesh from the surface.") +
      references(report);
  if (!report.meshes.empty())
    list += term("The model's own gap", "Its edges are up to " + shown(gap) + " " + escaped(unit_text(report)) +
                                            " off their faces; no mesh can be nearer than that to all of them.");
  if (!report.view.empty()) list += term("Camera", escaped(report.view));
  if (report.samples > 0) {
    list += term("Pictures", fmt::format("{} x {} pixels, ", report.size.width, report.size.height) +
                                 shown_count(static_cast<std::uint64_t>(report.samples)) + " samples a pixel, seed " +
                                 shown_count(report.seed));
    if (report.pixel > 0)
      list += term("A pixel", shown(report.pixel) + " " + escaped(unit_text(report)) + " wide at the middle of the model");
  }
  list += term("Version", "Isophote " + escaped(report.version));
  if (!report.command.empty()) list += term("Command", "<code>" + escaped(report.command) + "</code>");
  return "<section id=\"method\">\n<h2>How this was measured</h2>\n<dl>\n" + list + "</dl>\n</section>\n";
}

}  // namespace

std::string compare_page(const CompareReport& report) {
  const std::string body = mesh_section(report) + strategy_section(report) + picture_section(report) + image_section(report) +
                           cost_section(report) + chart_section(report) + face_section(report) + method(report);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n" +
         fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n", kPolicy) + "<title>" +
         escaped(shortened(report.model, 80)) + ": mesh against exact surface</title>\n<style>\n" + kPageStyle +
         "</style>\n</head>\n<body>\n" + top(report) + contents(body) + "<main>\n" + body + "</main>\n<script>\n" + kPageScript +
         "</script>\n</body>\n</html>\n";
}

}  // namespace iso
