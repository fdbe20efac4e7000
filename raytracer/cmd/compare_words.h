// The sentences of a comparison.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raytracer/cmd/compare_report.h"

namespace iso {

// World units, radians; what is beyond them fails.
struct FailLimits {
  std::optional<double> distance, angle;
  bool open = false, faults = false;
};

// "0.02 mm gives 48 000 triangles, true distance 0.0197 mm at face 17, at most 0.0199 mm; 12 silhouette pixels differ at 1920 x 1080".
std::string verdict_of(const ReportMesh& mesh, const CompareReport& report);

// What fails, a line each: limits, meshes that do not stand where the model is, promises of our own that are not kept.
std::vector<std::string> failures_of(const ReportMesh& mesh, const CompareReport& report, const FailLimits& limits);

// Of all meshes: the first that fails, or the advised one, or the first.
std::string verdict_of_all(const CompareReport& report);

}  // namespace iso
