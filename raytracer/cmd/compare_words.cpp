#include "raytracer/cmd/compare_words.h"

#include <fmt/format.h>

#include "raytracer/cmd/mesh_report.h"

namespace iso {
namespace {

constexpr double kDegrees = 180 / kPi;

// "48 310".
std::string counted(std::uint64_t n) {
  std::string text = std::to_string(n);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, " ");
  return text;
}

std::string face_text(const CompareReport& report, int face) {
  const auto f = static_cast<std::size_t>(face);
  return "face " + (f < report.face_names.size() ? report.face_names[f] : std::to_string(face));
}

// What makes all else meaningless: the mesh is not where the model is.
const FaultFound* misplaced(const MeshComparison& c) {
  for (const FaultFound& fault : c.faults)
    if (fault.fault <= MeshFault::placement) return &fault;
  return nullptr;
}

}  // namespace

std::string verdict_of(const ReportMesh& mesh, const CompareReport& report) {
  const MeshComparison& c = mesh.comparison;
  const std::string start = mesh.ours ? fmt::format("{} gives {} triangles", mesh.label, counted(mesh.triangles))
                                      : fmt::format("{}: {} triangles", mesh.label, counted(mesh.triangles));
  if (const FaultFound* fault = misplaced(c)) return fmt::format("{}; {}", start, fault->text);
  const double worst = c.all.worst(), bound = std::max(c.all.to_surface.bound, c.all.to_mesh.bound);
  std::string text = fmt::format("{}, true distance {}", start, length_text(worst, report.unit));
  if (c.worst_face >= 0 && worst > 0) text += " at " + face_text(report, c.worst_face);
  if (!mesh.ours && report.diagonal > 0) text += fmt::format(" ({:.2g} diagonals)", worst / report.diagonal);
  // Bounds leave the rounding of the coordinates out.
  text +=
      fmt::format(", at most {}", length_text(std::max(worst, mesh.guaranteed ? std::min(bound, *mesh.guaranteed) : bound), report.unit));
  if (!mesh.pictures.empty())
    text += fmt::format("; {} silhouette pixel{} at {} x {}", counted(mesh.images.silhouette_pixels),
                        mesh.images.silhouette_pixels == 1 ? " differs" : "s differ", report.size.width, report.size.height);
  if (!c.faults.empty()) {
    text += "; " + c.faults.front().text;
    if (c.faults.size() > 1) text += fmt::format(" (and {} more finding{})", c.faults.size() - 1, c.faults.size() == 2 ? "" : "s");
  }
  return text;
}

std::vector<std::string> failures_of(const ReportMesh& mesh, const CompareReport& report, const FailLimits& limits) {
  const MeshComparison& c = mesh.comparison;
  std::vector<std::string> failures;
  const auto fails = [&](const std::string& text) { failures.push_back(mesh.label + ": " + text); };
  if (const FaultFound* fault = misplaced(c)) {
    fails(fault->text);
    return failures;
  }
  if (limits.distance && c.all.worst() > *limits.distance)
    fails(fmt::format("{} at {} is above {}", length_text(c.all.worst(), report.unit), face_text(report, c.worst_face),
                      length_text(*limits.distance, report.unit)));
  if (limits.angle && c.all.worst_angle > *limits.angle)
    fails(fmt::format("normals are {:.3g} degrees apart at {}, above {:.3g}", c.all.worst_angle * kDegrees,
                      face_text(report, c.worst_angle_face), *limits.angle * kDegrees));
  for (const FaultFound& fault : c.faults) {
    const bool open = fault.fault == MeshFault::open_edges || fault.fault == MeshFault::non_manifold;
    if (limits.faults || (limits.open && open)) fails(fault.text);
  }
  if (c.unmeasured_faces)
    fails(fmt::format("{} of {} faces could not be measured: our own mesh of them has no triangles", c.unmeasured_faces, c.faces.size()));
  for (const std::string& broken : mesh.broken) fails(broken);
  return failures;
}

std::string verdict_of_all(const CompareReport& report) {
  if (!report.failures.empty()) return report.failures.front();
  if (report.meshes.empty()) return "nothing was compared";
  return report.advice.empty() ? report.meshes.front().verdict : report.meshes.back().verdict;
}

}  // namespace iso
