// Reports of comparisons that never were: any number of meshes and faces, names and numbers as bad as files can have them.
#pragma once

#include <cmath>
#include <limits>

#include "raytracer/cmd/compare_report.h"

namespace iso::test {

// Markup, quotes, line ends, an ending of a script, control characters, cut-off and overlong UTF-8, a surrogate, and plain letters.
inline const std::string kNasty = std::string("=</title><script>alert(\"1\")</script>'&amp;,\r\n\t") + '\0' +
                                  "\x01\x7F\xFF\xC0\xAF\xED\xA0\x80\xE2\x82 -->]]> \xC3\xBC \xE2\x86\x92";

inline OneSided made_up_distance(double max) { return {max, 0.2 * max, 0.31 * max, 0.9 * max, 1.1 * max, {1, 2.5, -3}, 812.25}; }

inline FaceComparison made_up_face(int face, double max, std::uint64_t triangles) {
  FaceComparison f;
  f.placed = face / 100;
  f.face = face % 100;
  f.triangles = triangles;
  f.area = 120.5 + face;
  f.covered = 0.97 * f.area;
  f.to_surface = made_up_distance(max);
  f.to_mesh = made_up_distance(0.93 * max);
  f.worst_angle = 0.4 * std::sqrt(std::abs(max));
  f.mean_angle = 0.1 * std::sqrt(std::abs(max));
  f.shapes = {triangles, triangles / 90, 11.23};
  f.open_edges = static_cast<std::uint64_t>(face % 3);
  return f;
}

inline ReportMesh made_up_mesh(int number, int faces, bool ours) {
  const double max = 0.87654 / std::pow(9.7, number);
  const auto triangles = static_cast<std::uint64_t>(600 * std::pow(9.1, number));
  ReportMesh mesh;
  mesh.label = ours ? "1e-" + std::to_string(number + 2) + " d" : "theirs.stl";
  mesh.ours = ours;
  if (ours) mesh.tolerance = 1.03 * max, mesh.guaranteed = 1.01 * max;
  if (!ours) mesh.file = "out/theirs.stl";
  mesh.points = triangles / 2 + 2;
  mesh.triangles = triangles;
  for (int f = 0; f < faces; ++f) mesh.comparison.faces.push_back(made_up_face(f, max * (f * 37 % faces + 1) / faces, triangles));
  mesh.comparison.all = made_up_face(0, max, triangles);
  mesh.comparison.topology.edges = 3 * triangles / 2;
  mesh.comparison.reference_bound = 0.02 * max;
  mesh.comparison.reference_triangles = 31 * triangles;
  mesh.comparison.model_gap = 1.47e-13;
  mesh.comparison.seconds = 1.25;
  mesh.verdict = "Keeps its promise.";
  mesh.cost = {ours ? 0.034 * (number + 1) : 0, 0.0021, 33.75, 18.5, 180 * triangles};
  mesh.images.difference = {0.75, {412, 233}, 0.00125, 0.00325, 41.5, 20011};
  mesh.images.flip_ldr = 0.0175;
  mesh.images.flip_hdr = 0.0275;
  mesh.images.silhouette_pixels = 87;
  const std::string png = "\x89PNG not really";
  mesh.pictures = {{"tessellated", "Smooth normals", "a.exr", png},
                   {"silhouette", "Silhouettes", "", png, ReportLegend{"silhouette", "", 0, 0, {Colour(0), Colour(1)}, {"one", "other"}}},
                   {"deviation", "Distance", "b c.exr", png}};
  return mesh;
}

// `meshes` of them, the last of three or more foreign.
inline CompareReport made_up_report(int meshes, int faces = 12) {
  CompareReport r;
  r.version = "0.0";
  r.model = "model.stp";
  r.unit = "mm";
  r.command = "isophote compare model.stp -o report";
  r.machine = "a machine";
  r.diagonal = 89.0971;
  r.faces = static_cast<std::uint64_t>(faces);
  r.view = "iso, perspective 28 degrees";
  r.size = {640, 480};
  r.samples = 16;
  r.seed = 18446744073709551615ull;
  r.pixel = 0.0925;
  r.slope = 2.0312;
  r.verdict = "1e-3 d keeps its promise.";
  r.direct = {0, 0.0432, 21.125, 11.5, 3964211};
  r.pictures = {{"direct", "The exact surface", "direct.exr", "\x89PNG not really"}};
  r.legends = {{"deviation", "mm", 0, 0.125, {Colour(0.2f), Colour(0.9f)}}};
  for (int m = 0; m < meshes; ++m) r.meshes.push_back(made_up_mesh(m, faces, m < 2));
  for (int f = 0; f < faces; ++f) r.face_names.push_back(std::to_string(f) + " top");
  return r;
}

// Every text nasty, every other number not finite.
inline CompareReport nasty_report() {
  CompareReport r = made_up_report(3);
  for (std::string* text : {&r.version, &r.model, &r.unit, &r.command, &r.machine, &r.view, &r.verdict, &r.advice}) *text = kNasty;
  r.failures = {kNasty};
  for (std::string& name : r.face_names) name = kNasty;
  r.diagonal = r.pixel = kInf;
  r.legends[0].unit = kNasty;
  r.legends[0].hi = std::numeric_limits<double>::quiet_NaN();
  for (ReportMesh& mesh : r.meshes) {
    for (std::string* text : {&mesh.label, &mesh.file, &mesh.verdict}) *text = kNasty;
    mesh.broken = mesh.notes = {kNasty};
    FaultFound fault;
    fault.text = fault.unit = kNasty;
    fault.ratio = kInf;
    for (int kind = 0; kind <= static_cast<int>(MeshFault::non_manifold); ++kind)
      fault.fault = static_cast<MeshFault>(kind), mesh.comparison.faults.push_back(fault);
    for (ReportPicture& picture : mesh.pictures) picture.title = picture.file = picture.key = kNasty;
    mesh.comparison.all.to_surface.max = std::numeric_limits<double>::quiet_NaN();
    mesh.comparison.all.to_mesh.bound = kInf;
    mesh.comparison.faces[1].to_mesh.max = -kInf;
    mesh.comparison.faces[2].worst_angle = std::numeric_limits<double>::quiet_NaN();
    mesh.comparison.faces[3].area = 0;
    mesh.cost.primary_rate = mesh.images.difference.psnr = kInf;
  }
  return r;
}

}  // namespace iso::test
