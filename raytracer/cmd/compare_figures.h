// Figures of a comparison that follow from others: the page and the JSON take them from here, so that they agree.
#pragma once

#include <cstdint>
#include <limits>

#include "raytracer/cmd/compare_report.h"

namespace iso {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// How far a mesh is from the surface, of both ways the larger one. World units but where told.
struct MeshDistance {
  double max = 0, mean = 0, rms = 0, p999 = 0;
  double bound = 0;      // no point is farther
  double diagonals = 0;  // `max` in the model's
  double pixels = 0;     // and in pixels of the camera; unknown without one
};
MeshDistance distance_of(const CompareReport& report, const MeshComparison& comparison);

// The larger of a face's two ways; unknown if one is.
double worst_distance(const FaceComparison& face);

// Of a face's area, the share that is under triangles which lie nearest to it; unknown for a face without area.
double covered_share(const FaceComparison& face);

// Faces with area but no triangle near them. What is missing in parts of faces is told by the faults.
std::uint64_t missing_faces(const MeshComparison& comparison);

// Indices into `faces`, the largest distance first, unknown ones before all; at most `count`.
std::vector<std::size_t> worst_faces(const MeshComparison& comparison, std::size_t count);

// The smallest angle of the triangles, degrees; unknown without triangles.
double smallest_angle(const TriangleShapes& shapes);

// Whether the mesh is wrong because of it, or only poor.
enum class Severity { fault, warning };
Severity severity_of(MeshFault fault);
const char* name_of(Severity severity);  // "fault", "warning"

// The name of a face for people: the report's, or its number.
std::string face_name(const CompareReport& report, const MeshComparison& comparison, std::size_t face);

// The scale of a picture: its own, or the report's of the same key; null: none.
const ReportLegend* legend_of(const CompareReport& report, const ReportPicture& picture);

}  // namespace iso
