// What a model holds, counted: the content of `isophote info`.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/surface/patch_chart.h"

namespace iso {

// Faces of one surface kind: as stored, and as placed by the instances.
struct FaceCount {
  std::string kind;
  long stored = 0, placed = 0;
};

// Patches of one kind and number of sides; each has as many charts as sides.
struct PatchCount {
  PatchKind kind;
  int sides = 0;
  long stored = 0, placed = 0;
};

struct ModelInfo {
  std::string file, format, file_unit, unit;
  Box3 box;  // of all instances, in `unit`
  long parts = 0, instances = 0;
  long solids = 0;  // as placed, closed ones
  long faces_stored = 0, faces_placed = 0, untrimmed = 0, loops = 0;
  std::vector<FaceCount> kinds;                // only those that occur
  std::vector<PatchCount> patches;             // with any number of sides; by kind, then sides
  long charts = 0;                             // stored
  double max_chart_error = 0;                  // world units: largest distance between a chart and the spline beside it
  int max_degree_u = 0, max_degree_v = 0;      // of NURBS surfaces
  long poles = 0, max_poles = 0;               // all NURBS surfaces together; the largest one
  long rational = 0;                           // NURBS surfaces with weights
  long edges = 0;                              // stored
  std::array<long, 4> edge_uses{};             // edges: points in space; used once (free), twice, more often
  double max_file_tolerance = 0, max_gap = 0;  // world units
  double max_approximation_error = 0;
  long colours = 0;  // different ones
  std::vector<Problem> problems;
};

ModelInfo describe(const Model& model);

// Aligned lines for people; and the same for programs.
std::string to_text(const ModelInfo& info);
std::string to_json(const ModelInfo& info);

}  // namespace iso
