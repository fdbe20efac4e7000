// The JSON of a mesh report. Faces are written one a line, so that large models need no tree of all of them.
#include "raytracer/cmd/mesh_report.h"

namespace iso {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180 / 3.14159265358979323846;

// Names from files need not be valid UTF-8; numbers that are not finite become null.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

Json json_of(const DistanceFigures& d) {
  return {{"max", d.max}, {"mean", d.mean}, {"rms", d.rms}, {"p99.9", d.p999}, {"samples", d.samples}};
}

Json json_of(const Finding& finding) {
  Json places = Json::array();
  for (const MeshPlace& place : finding.places) {
    Json at{{"at", json_of(place.at)}};
    if (place.face >= 0) at["face"] = place.face;
    if (place.triangle >= 0) at["triangle"] = place.triangle;
    places.push_back(std::move(at));
  }
  return {{"count", finding.count}, {"places", std::move(places)}};
}

Json json_of(const MeshReport& check) {
  const TopologyReport& t = check.topology;
  return {{"sound", check.sound()},
          {"points", t.points},
          {"triangles", t.triangles},
          {"edges", t.edges},
          {"open_edges", t.open_edges.count},
          {"free_edges", json_of(check.free_edges)},
          {"cracks", json_of(check.cracks)},
          {"non_manifold_edges", json_of(t.non_manifold_edges)},
          {"misoriented_edges", json_of(t.misoriented_edges)},
          {"non_manifold_points", json_of(t.non_manifold_points)},
          {"zero_area", json_of(t.zero_area)},
          {"duplicates", json_of(t.duplicates)},
          {"t_junctions", json_of(t.t_junctions)},
          {"folded", json_of(check.folded)},
          {"turned", json_of(check.turned)},
          {"overlapping", json_of(check.overlapping)},
          {"empty_faces", json_of(check.empty_faces)},
          {"slivers", check.shapes.slivers},
          {"smallest_angle", check.shapes.smallest_angle}};
}

Json json_of(const CurvatureError& error) {
  return {{"points", error.points}, {"max", error.max}, {"rms", error.rms}, {"largest", error.largest}};
}

// What faces and parts have in common.
void add_figures(Json& json, const FaceFigures& f) {
  json["triangles"] = f.report.triangles;
  json["bound"] = f.report.bound;
  json["offset"] = f.report.offset;
  json["kept"] = f.within;
  json["measured"] = f.measured;
  json["to_surface"] = json_of(f.to_surface);
  json["to_mesh"] = json_of(f.to_mesh);
  json["worst"] = {{"uv", {f.worst_uv.x, f.worst_uv.y}}, {"place", json_of(f.worst_place)}};
  json["normal_angle"] = {{"max", kDegrees * f.worst_angle}, {"mean", kDegrees * f.mean_angle}};
  json["unresolved"] = f.report.unresolved;
  json["collapsed"] = f.report.collapsed;
  json["folded"] = f.report.folded;
  json["at_folds"] = f.report.at_folds;
  if (f.report.at_folds > 0) json["fold"] = json_of(f.report.fold);
  json["crossings"] = f.report.crossings;
}

// The longest list of open borders that is told.
constexpr std::size_t kBordersTold = 100;

Json json_of(const JoinReport& joins) {
  Json open = Json::array();
  for (const OpenBorder& border : joins.open) {
    if (open.size() == kBordersTold) break;
    open.push_back({{"face", border.face},
                    {"edge", border.part_edge < 0 ? Json() : Json(border.part_edge)},
                    {"from", json_of(border.from)},
                    {"to", json_of(border.to)},
                    {"length", border.length},
                    {"width", border.width}});
  }
  return {{"free_edges", joins.free_edges}, {"joined", joins.joined},       {"split", joins.split},
          {"collapsed", joins.collapsed},   {"tolerance", joins.tolerance}, {"widest", joins.widest},
          {"looked", joins.looked},         {"open", joins.open.size()},    {"open_borders", open}};
}

std::string face_line(const PartFigures& part, std::size_t f) {
  const Face& face = part.part->faces[f];
  Json json{{"index", f}, {"name", face.name}, {"kind", kind_name(face.surface)}};
  add_figures(json, part.faces[f]);
  const TriangleShapes& shapes = part.check.shapes_of_face[f];
  json["turned"] = part.faces[f].report.turned;
  json["copy_of"] = part.faces[f].report.copy_of < 0 ? Json() : Json(part.faces[f].report.copy_of);
  json["slivers"] = shapes.slivers;
  json["smallest_angle"] = shapes.triangles > 0 ? Json(shapes.smallest_angle) : Json();
  json["failure"] = part.faces[f].report.failure.empty() ? Json() : Json(part.faces[f].report.failure);
  return dumped(json);
}

// The members of an object one a line, without the closing brace.
std::string open_object(const Json& json, const std::string& indent) {
  std::string text = indent + "{\n";
  for (const auto& [key, value] : json.items()) text += indent + "  " + dumped(key) + ": " + dumped(value) + ",\n";
  return text;
}

std::string part_text(const PartFigures& part) {
  Json json{{"name", part.part->name},
            {"placements", part.placements},
            {"stretch", part.stretch},
            {"rounds", part.rounds},
            {"unresolved_edges", part.unresolved_edges},
            {"worst_face", part.worst_face < 0 ? Json() : Json(part.worst_face)}};
  add_figures(json, part.all);
  json["levels"] = part.most_level > 0 ? Json{part.least_level, part.most_level} : Json();
  json["quads"] = part.most_level > 0 ? Json(part.quads) : Json();
  json["mean_curvature"] = part.curvature ? json_of(*part.curvature) : Json();
  json["turned_faces"] = part.turned;
  json["sewing"] = json_of(part.joins);
  json["topology"] = json_of(part.check);
  std::string text = open_object(json, "    ") + "      \"faces\": [";
  for (std::size_t f = 0; f < part.faces.size(); ++f) text += (f == 0 ? "\n        " : ",\n        ") + face_line(part, f);
  return text + "\n      ]\n    }";
}

Json json_of(const WrittenMesh* written) {
  if (!written) return {};
  return {{"files", written->files}, {"bytes", written->bytes}, {"triangles", written->triangles}, {"without_area", written->collapsed}};
}

}  // namespace

nlohmann::ordered_json totals_json(const MeshFigures& figures) {
  const MeshTotals all = totals_of(figures);
  return {{"parts", figures.parts.size()},
          {"placements", all.placements},
          {"faces", all.faces},
          {"triangles", all.triangles},
          {"points", all.points},
          {"open_edges", all.open_edges},
          {"free_edges", all.free_edges},
          {"cracks", all.cracks},
          {"bound", all.bound},
          {"offset", all.offset},
          {"measured", all.measured},
          {"worst_part", all.worst_part < 0 ? Json() : Json(all.worst_part)},
          {"normal_angle", kDegrees * all.worst_angle}};
}

std::string report_json(const MeshFigures& figures, const std::vector<std::string>& broken, const ReportHead& head) {
  const MeshSettings& s = figures.settings;
  const Json json{{"isophote", head.version},
                  {"file", head.file},
                  {"unit", figures.unit.empty() ? Json() : Json(figures.unit)},
                  {"strategy", strategy_name(s.pattern)},
                  {"level", s.pattern && s.pattern->level > 0 ? Json(s.pattern->level) : Json()},
                  {"tolerance", s.distance > 0 ? Json(s.distance) : Json()},
                  {"trim_tolerance", s.pattern ? Json() : Json(s.trim > 0 ? s.trim : s.distance)},
                  {"angle", kDegrees * s.angle},
                  {"sampling", s.sampling == Sampling::quick ? "quick" : "fine"},
                  {"kept", broken.empty()},
                  {"broken", broken},
                  {"written", json_of(head.written)},
                  {"seconds",
                   {{"read", head.read_seconds},
                    {"mesh", figures.mesh_seconds},
                    {"measure", figures.measure_seconds},
                    {"verify", figures.verify_seconds},
                    {"write", head.write_seconds},
                    {"all", head.all_seconds}}},
                  {"peak_bytes", head.peak_bytes},
                  {"totals", totals_json(figures)}};
  std::string text = open_object(json, "") + "  \"parts\": [\n";
  for (std::size_t p = 0; p < figures.parts.size(); ++p) text += (p == 0 ? "" : ",\n") + part_text(figures.parts[p]);
  return text + "\n  ]\n}\n";
}

}  // namespace iso
