#include "raytracer/cmd/compare_figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace iso {
namespace {

// An unknown number wins: it must not hide behind a known one.
double larger(double a, double b) { return std::isnan(a) || std::isnan(b) ? kUnknown : std::max(a, b); }

}  // namespace

double worst_distance(const FaceComparison& face) { return larger(face.to_surface.max, face.to_mesh.max); }

MeshDistance distance_of(const CompareReport& report, const MeshComparison& comparison) {
  const OneSided &there = comparison.all.to_surface, &back = comparison.all.to_mesh;
  MeshDistance d{.max = larger(there.max, back.max),
                 .mean = larger(there.mean, back.mean),
                 .rms = larger(there.rms, back.rms),
                 .p999 = larger(there.p999, back.p999),
                 .bound = larger(there.bound, back.bound)};
  d.diagonals = report.diagonal > 0 ? d.max / report.diagonal : kUnknown;
  d.pixels = report.pixel > 0 ? d.max / report.pixel : kUnknown;
  return d;
}

double covered_share(const FaceComparison& face) { return face.area > 0 ? face.covered / face.area : kUnknown; }

std::uint64_t missing_faces(const MeshComparison& comparison) {
  return static_cast<std::uint64_t>(std::count_if(comparison.faces.begin(), comparison.faces.end(),
                                                  [](const FaceComparison& face) { return face.area > 0 && face.triangles == 0; }));
}

std::vector<std::size_t> worst_faces(const MeshComparison& comparison, std::size_t count) {
  std::vector<std::size_t> order(comparison.faces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t f) {
    const double worst = worst_distance(comparison.faces[f]);
    return std::isnan(worst) ? kInf : worst;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) > key(b); });
  order.resize(std::min(count, order.size()));
  return order;
}

double smallest_angle(const TriangleShapes& shapes) { return shapes.triangles > 0 ? shapes.smallest_angle : kUnknown; }

Severity severity_of(MeshFault fault) {
  switch (fault) {
    case MeshFault::doubled_triangles:
    case MeshFault::zero_area:
      return Severity::warning;
    default:
      return Severity::fault;
  }
}

const char* name_of(Severity severity) { return severity == Severity::fault ? "fault" : "warning"; }

std::string face_name(const CompareReport& report, const MeshComparison& comparison, std::size_t face) {
  if (face < report.face_names.size() && !report.face_names[face].empty()) return report.face_names[face];
  const FaceComparison& f = comparison.faces[face];
  return f.placed > 0 ? std::to_string(f.placed) + "/" + std::to_string(f.face) : std::to_string(f.face);
}

const ReportLegend* legend_of(const CompareReport& report, const ReportPicture& picture) {
  if (picture.legend) return &*picture.legend;
  for (const ReportLegend& legend : report.legends)
    if (legend.key == picture.key) return &legend;
  return nullptr;
}

}  // namespace iso
