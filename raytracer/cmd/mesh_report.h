// What is told of a mesh: its closing line, the promises it does not keep, and the JSON of `tessellate --report`, which
// mesh_report.md describes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "patches/io/write_mesh.h"
#include "raytracer/cmd/mesh_parts.h"

namespace iso {

// All parts together.
struct MeshTotals {
  std::uint64_t placements = 0, faces = 0, triangles = 0, points = 0;  // the last three as stored: each part once
  std::uint64_t open_edges = 0, free_edges = 0, cracks = 0;
  double bound = 0, offset = 0, measured = 0, worst_angle = 0;
  int worst_part = -1;  // where `measured` is
};
MeshTotals totals_of(const MeshFigures& figures);

// "0.0498 mm"; a length that is not finite is "unknown".
std::string length_text(double length, const std::string& unit);

// "214 faces, 48 310 triangles, 0 open edges; distance bound 0.0498 mm, measured 0.0441 mm at face 17 (0.31, 0.88); ..."
std::string summary_text(const MeshFigures& figures);

// One line for each promise that is not kept: a bound beyond the tolerance, faces without triangles, folds, cracks. Empty: all are kept.
std::vector<std::string> broken_promises(const MeshFigures& figures);

// The totals as an object.
nlohmann::ordered_json totals_json(const MeshFigures& figures);

struct ReportHead {
  std::string version, file;
  double read_seconds = 0, write_seconds = 0, all_seconds = 0;
  std::uint64_t peak_bytes = 0;
  const WrittenMesh* written = nullptr;  // null: no mesh was written
};

// The whole report; numbers that are not finite are null.
std::string report_json(const MeshFigures& figures, const std::vector<std::string>& broken, const ReportHead& head);

}  // namespace iso
