// What `compare` tells, as plain data: compare_json.cpp writes report.json and table.csv, compare_page.cpp the page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raytracer/camera.h"
#include "raytracer/image_metrics.h"
#include "tess/discrete_curvature.h"
#include "tess/mesh_comparison.h"

namespace iso {

// A false colour scale: from `lo` to `hi` in `unit`.
struct ReportLegend {
  std::string key, unit;
  double lo = 0, hi = 0;
  std::vector<Colour> colours;           // display-encoded, evenly spaced from lo to hi; without `labels`, they are blended
  std::vector<std::string> labels = {};  // if any, one for each colour: the colours mean kinds, and there is no scale
};

// One picture: kept as EXR beside the page, and shown in it.
struct ReportPicture {
  std::string key;                          // "direct", "tessellated", "difference", "silhouette", "deviation", "normals", "facets", ...
  std::string title;                        // for people
  std::string file;                         // the EXR's name in the report's folder; may be empty
  std::string png;                          // bytes, display-encoded
  std::optional<ReportLegend> legend = {};  // of this picture; else the report's of the same key, if there is one
};

// What is 0 was not measured.
struct ReportCost {
  double tessellate_seconds = 0;  // 0: not ours
  double build_seconds = 0;
  double primary_rate = 0, bounce_rate = 0;  // Mray/s
  std::uint64_t bytes = 0;                   // of what is traced
};

// How a mesh's picture differs from the direct one; told of meshes that have pictures.
struct ReportImages {
  ImageDifference difference;
  double flip_ldr = 0, flip_hdr = 0;  // means
  std::uint64_t silhouette_pixels = 0;
};

struct ReportMesh {
  std::string label;  // "1e-3 d" or the file's name
  std::string file;   // of a foreign mesh
  bool ours = false;
  double tolerance = 0;              // ours: world units
  std::optional<double> guaranteed;  // ours: the tessellator's own bound, with the edges' gap
  std::vector<std::string> broken;   // ours: promises not kept
  std::string strategy;              // ours, of a comparison of strategies: "adaptive" or a pattern's name
  std::optional<int> level;          // of a pattern that was asked for by level
  // Of points inside patches with any number of sides: the mesh's mean curvature against the surface's, 1 / world unit.
  std::optional<CurvatureError> curvature;
  std::uint64_t points = 0, triangles = 0;
  double width = 0;  // ours: of the triangles on curved faces, compare_slope.h; 0: unknown
  MeshComparison comparison;
  std::string verdict;             // a sentence
  std::vector<std::string> notes;  // of a foreign mesh: what its reader mended or left out; of ours: what was not looked at
  ReportCost cost;
  ReportImages images;
  std::vector<ReportPicture> pictures;
};

struct CompareReport {
  std::string version, model, unit;
  std::string command;  // the command line; may be empty
  std::string machine;  // where the costs were measured, "AMD EPYC, 2 threads"; may be empty
  double diagonal = 0;
  std::uint64_t faces = 0;
  std::string view;  // of the camera, for people: "iso, perspective 28 degrees"
  ImageSize size;
  int samples = 0;
  std::uint64_t seed = 0;
  double pixel = 0;                   // world units a pixel at the middle of the model
  std::string verdict;                // a sentence: the first mesh that fails, or the coarsest that keeps its promise
  std::string advice;                 // of --advise; may be empty
  std::vector<std::string> failures;  // limits and promises that are not kept, meshes that do not stand where the model is
  double slope = 0;                   // of error against width, of our meshes; 0: unknown
  ReportCost direct;
  std::vector<ReportPicture> pictures;  // of the exact surface
  std::vector<ReportLegend> legends;
  std::vector<ReportMesh> meshes;
  std::vector<std::string> face_names;  // parallel to the comparisons' faces: "3", or "3 top" with its name
};

std::string compare_json(const CompareReport& report);  // whole numbers and finite ones; what is not finite is null
std::string compare_csv(const CompareReport& report);   // a row per mesh and face, and one per mesh for all
std::string compare_page(const CompareReport& report);  // self-contained HTML

// Texts may hold anything, bytes that are no UTF-8 included, and numbers anything. compare_report.md describes the JSON and the CSV. Every
// number that the page shows stands in the JSON too. Same report, same bytes.

}  // namespace iso
