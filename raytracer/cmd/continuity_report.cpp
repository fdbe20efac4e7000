#include "raytracer/cmd/continuity_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace iso {
namespace {

constexpr double kDegrees = 180 / kPi;

const char* text_of(bool one, const char* singular, const char* plural) { return one ? singular : plural; }

std::string counted(long n, const char* singular, const char* plural) { return fmt::format("{} {}", n, text_of(n == 1, singular, plural)); }

// An edge among those of all parts.
struct Row {
  const PartContinuity* part;
  const EdgeContinuity* edge;
  ContinuityClass known;
};

std::vector<Row> measured_rows(const ContinuityReport& report) {
  std::vector<Row> rows;
  for (const PartContinuity& part : report.parts)
    for (const EdgeContinuity& edge : part.continuity.edges)
      if (edge[Measure::gap].known()) rows.push_back({&part, &edge, class_of(edge, report.settings)});
  return rows;
}

bool is_tangent(const Row& row) { return row.known == ContinuityClass::G1 || row.known == ContinuityClass::G2; }

// By which rows are sorted; the curvature of sharp edges says little, so they come last.
double height(const Row& row, Measure by) {
  const double value = (*row.edge)[by].max;
  return !finite(value) || (by == Measure::curvature && !is_tangent(row)) ? -1 : value;
}

std::string shown(const Row& row, Measure m) {
  const Jump& jump = (*row.edge)[m];
  if (!jump.known() || (m == Measure::curvature && !is_tangent(row))) return "-";
  return fmt::format("{:.3g}", m == Measure::normal ? jump.max * kDegrees : jump.max);
}

std::string face_text(const Part& part, int face) {
  const std::string& name = part.faces[static_cast<std::size_t>(face)].name;
  return name.empty() ? fmt::format("{}", face) : fmt::format("{} '{}'", face, name);
}

std::string faces_text(const Row& row, bool with_part) {
  std::string text;
  for (const EdgeContinuity::Side& side : row.edge->sides) text += (text.empty() ? "" : " | ") + face_text(*row.part->part, side.face);
  return with_part ? fmt::format("{}: {}", row.part->part->name.empty() ? "part" : row.part->part->name, text) : text;
}

// Control characters in names would break the table.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  return text;
}

void append_rows(std::string& out, const ContinuityReport& report, std::vector<Row> rows) {
  const Measure by = report.settings.by;
  std::stable_sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) { return height(a, by) > height(b, by); });
  const std::size_t shown_rows = std::min(rows.size(), static_cast<std::size_t>(report.settings.rows));
  if (shown_rows == 0) return;
  const std::string unit = report.unit.empty() ? "" : " " + report.unit;
  out += fmt::format("{:>7} {:>11} {:>11} {:>11} {:>11}   {:<40} {}\n", "class", "gap" + unit, "off" + unit, "normal deg",
                     "curv. /" + (report.unit.empty() ? std::string("unit") : report.unit),
                     fmt::format("worst {} at", kMeasureNames[static_cast<std::size_t>(by)]), "faces");
  for (std::size_t i = 0; i < shown_rows; ++i) {
    const Row& row = rows[i];
    const Point3 p = row.part->to_model.point((*row.edge)[by].place);
    const std::string place = (*row.edge)[by].known() ? fmt::format("{:.6g} {:.6g} {:.6g}", p.x, p.y, p.z) : "-";
    out +=
        printable(fmt::format("{:>7} {:>11} {:>11} {:>11} {:>11}   {:<40} {}", kContinuityClassNames[static_cast<std::size_t>(row.known)],
                              shown(row, Measure::gap), shown(row, Measure::off), shown(row, Measure::normal),
                              shown(row, Measure::curvature), place, faces_text(row, report.parts.size() > 1))) +
        "\n";
  }
  if (rows.size() > shown_rows) out += fmt::format("... and {} more; --rows shows them\n", rows.size() - shown_rows);
}

}  // namespace

ContinuityClass class_of(const EdgeContinuity& edge, const ContinuitySettings& settings) {
  const auto within = [&](Measure m) { return edge[m].max <= settings.tolerance[static_cast<std::size_t>(m)]; };
  if (edge.kind != EdgeKind::shared && edge.kind != EdgeKind::seam) return ContinuityClass::unknown;
  if (!within(Measure::gap)) return ContinuityClass::apart;
  if (!edge[Measure::normal].known()) return ContinuityClass::unknown;
  if (!within(Measure::normal)) return ContinuityClass::G0;
  return within(Measure::curvature) ? ContinuityClass::G2 : ContinuityClass::G1;
}

ContinuityReport report_of(const Model& model, const ContinuitySettings& settings) {
  ContinuityReport report;
  report.file = model.file;
  report.unit = model.unit;
  report.diagonal = box_of(model).diagonal();
  report.settings = settings;
  for (const Part& part : model.parts) report.parts.push_back({&part, {}, 0, measure_continuity(part, {settings.sew})});
  for (const Instance& instance : model.instances) {
    PartContinuity& part = report.parts[static_cast<std::size_t>(instance.part)];
    if (part.placements++ == 0) part.to_model = instance.to_model;
  }
  return report;
}

ContinuityTotals totals_of(const ContinuityReport& report) {
  ContinuityTotals totals;
  for (const PartContinuity& part : report.parts) {
    totals.faces += static_cast<long>(part.part->faces.size());
    totals.copies += part.continuity.copies;
    for (const EdgeContinuity& edge : part.continuity.edges) {
      ++totals.kinds[static_cast<std::size_t>(edge.kind)];
      totals.sewn += edge.sewn;
      totals.misoriented += edge.misoriented;
      if (edge.kind == EdgeKind::shared || edge.kind == EdgeKind::seam)
        ++totals.classes[static_cast<std::size_t>(class_of(edge, report.settings))];
    }
  }
  return totals;
}

double largest(const ContinuityReport& report, Measure measure) {
  double most = 0;
  for (const Row& row : measured_rows(report)) most = std::max(most, height(row, measure));
  return most;
}

std::string value_text(double value, Measure measure, const std::string& unit) {
  if (measure == Measure::normal) return fmt::format("{:.3g} deg", value * kDegrees);
  if (measure == Measure::curvature) return fmt::format("{:.3g} /{}", value, unit.empty() ? "unit" : unit);
  return unit.empty() ? fmt::format("{:.3g}", value) : fmt::format("{:.3g} {}", value, unit);
}

std::string continuity_table(const ContinuityReport& report) {
  const ContinuityTotals t = totals_of(report);
  const auto tolerance = [&](Measure m) { return value_text(report.settings.tolerance[static_cast<std::size_t>(m)], m, report.unit); };
  const long all = std::accumulate(t.kinds.begin(), t.kinds.end(), 0l);
  std::string out = fmt::format("{}: {}, {}: {} between faces ({} sewn), {}, {} free, {} non-manifold, {} degenerate\n", report.file,
                                counted(t.faces, "face", "faces"), counted(all, "edge", "edges"), t.kinds[0], t.sewn,
                                counted(t.kinds[1], "seam", "seams"), t.kinds[2], t.kinds[3], t.kinds[4]);
  out += fmt::format("  {} G2 (curvature within {}), {} G1 (normal within {}), {} G0 (gap within {}), {} apart", t.classes[3],
                     tolerance(Measure::curvature), t.classes[2], tolerance(Measure::normal), t.classes[1], tolerance(Measure::gap),
                     t.classes[0]);
  if (t.classes[4] > 0) out += fmt::format(", {} without a normal", t.classes[4]);
  if (t.misoriented > 0) out += fmt::format("; along {} outward normals disagree", t.misoriented);
  if (t.copies > 0) out += fmt::format("; {} left out that repeat others", counted(t.copies, "face", "faces"));
  out += "\n";
  append_rows(out, report, measured_rows(report));
  return out;
}

std::vector<std::string> broken_limits(const ContinuityReport& report) {
  std::vector<std::string> broken;
  for (const Measure m : {Measure::gap, Measure::normal, Measure::curvature}) {
    const auto& limit = report.settings.limit[static_cast<std::size_t>(m)];
    if (!limit) continue;
    long above = 0;
    for (const Row& row : measured_rows(report)) above += height(row, m) > *limit;
    if (above > 0)
      broken.push_back(fmt::format("{} of up to {} along {}, more than --fail-above-{} {}", kMeasureNames[static_cast<std::size_t>(m)],
                                   value_text(largest(report, m), m, report.unit), counted(above, "edge", "edges"),
                                   kMeasureNames[static_cast<std::size_t>(m)], value_text(*limit, m, report.unit)));
  }
  const auto& kinds = totals_of(report).kinds;
  const long free = kinds[static_cast<std::size_t>(EdgeKind::free)], several = kinds[static_cast<std::size_t>(EdgeKind::non_manifold)];
  if (report.settings.fail_open && free + several > 0) broken.push_back(fmt::format("{} free and {} non-manifold edges", free, several));
  return broken;
}

}  // namespace iso
