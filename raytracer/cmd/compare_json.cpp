// report.json and table.csv. Faces are written one a line, so that large models need no tree of all of them.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "raytracer/cmd/compare_figures.h"
#include "raytracer/cmd/page_text.h"

namespace iso {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180 / kPi;

// Names from files need not be valid UTF-8; numbers that are not finite become null.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }
Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }
Json positive_or_null(double x) { return x > 0 ? Json(x) : Json(); }
Json index_or_null(int i) { return i < 0 ? Json() : Json(i); }

Json json_of(const OneSided& d) {
  return {{"max", d.max}, {"at", json_of(d.at)}, {"mean", d.mean}, {"rms", d.rms}, {"p99.9", d.p999}, {"bound", d.bound}, {"area", d.area}};
}

Json json_of(const ReportLegend& legend) {
  Json colours = Json::array();
  for (const Colour& c : legend.colours) colours.push_back(hex_of(c));
  const bool kinds = !legend.labels.empty();
  return {{"key", legend.key},
          {"unit", text_or_null(legend.unit)},
          {"lo", kinds ? Json() : Json(legend.lo)},
          {"hi", kinds ? Json() : Json(legend.hi)},
          {"colours", colours},
          {"labels", legend.labels}};
}

Json json_of(const std::vector<ReportPicture>& pictures) {
  Json list = Json::array();
  for (const ReportPicture& picture : pictures)
    list.push_back({{"key", picture.key},
                    {"title", picture.title},
                    {"file", text_or_null(picture.file)},
                    {"legend", picture.legend ? json_of(*picture.legend) : Json()}});
  return list;
}

Json json_of(const ReportCost& cost) {
  return {{"tessellate_seconds", positive_or_null(cost.tessellate_seconds)},
          {"build_seconds", positive_or_null(cost.build_seconds)},
          {"primary_rate", positive_or_null(cost.primary_rate)},
          {"bounce_rate", positive_or_null(cost.bounce_rate)},
          {"bytes", cost.bytes > 0 ? Json(cost.bytes) : Json()}};
}

Json json_of(const ReportImages& images) {
  const ImageDifference& d = images.difference;
  return {{"max", d.max},
          {"at", {{"x", d.worst.x}, {"y", d.worst.y}}},
          {"mean", d.mean},
          {"rmse", d.rmse},
          {"psnr", d.psnr},
          {"differ", d.differ},
          {"flip", images.flip_ldr},
          {"flip_hdr", images.flip_hdr},
          {"silhouette_pixels", images.silhouette_pixels}};
}

Json json_of(const std::optional<CurvatureError>& error) {
  if (!error) return {};
  return {{"points", error->points}, {"max", error->max}, {"rms", error->rms}, {"largest", error->largest}};
}

Json faults_json(const MeshComparison& comparison) {
  Json list = Json::array();
  for (const FaultFound& f : comparison.faults)
    list.push_back({{"fault", name_of(f.fault)},
                    {"severity", name_of(severity_of(f.fault))},
                    {"count", f.count},
                    {"text", f.text},
                    {"at", json_of(f.at)},
                    {"placed", index_or_null(f.placed)},
                    {"face", index_or_null(f.face)},
                    {"ratio", positive_or_null(f.ratio)},
                    {"unit", text_or_null(f.unit)}});
  return list;
}

Json topology_json(const MeshComparison& comparison) {
  const TopologyReport& t = comparison.topology;
  return {{"points", t.points},
          {"triangles", t.triangles},
          {"edges", t.edges},
          {"open_edges", t.open_edges.count},
          {"free_edges", comparison.free_edges},
          {"widest_gap", comparison.widest_gap},
          {"non_manifold_edges", t.non_manifold_edges.count},
          {"misoriented_edges", t.misoriented_edges.count},
          {"non_manifold_points", t.non_manifold_points.count},
          {"zero_area", t.zero_area.count},
          {"duplicates", t.duplicates.count},
          {"isolated_points", t.isolated_points.count},
          {"t_junctions", t.t_junctions.count},
          {"slivers", comparison.all.shapes.slivers},
          {"smallest_angle", smallest_angle(comparison.all.shapes)}};
}

// What a face and all of them have in common.
void add_figures(Json& json, const FaceComparison& f) {
  json["area"] = f.area;
  json["covered"] = f.covered;
  json["covered_share"] = covered_share(f);
  json["inward"] = f.inward;
  json["to_surface"] = json_of(f.to_surface);
  json["to_mesh"] = json_of(f.to_mesh);
  json["normal_angle"] = {{"max", kDegrees * f.worst_angle}, {"at", json_of(f.worst_angle_at)}, {"mean", kDegrees * f.mean_angle}};
}

std::string face_line(const CompareReport& report, const MeshComparison& comparison, std::size_t i) {
  const FaceComparison& f = comparison.faces[i];
  Json json{{"placed", f.placed},
            {"face", f.face},
            {"name", face_name(report, comparison, i)},
            {"triangles", f.triangles},
            {"max", worst_distance(f)}};
  add_figures(json, f);
  json["slivers"] = f.shapes.slivers;
  json["smallest_angle"] = smallest_angle(f.shapes);
  json["open_edges"] = f.open_edges;
  return dumped(json);
}

// The members of an object one a line, without the closing brace.
std::string open_object(const Json& json, const std::string& indent) {
  std::string text = indent + "{\n";
  for (const auto& [key, value] : json.items()) text += indent + "  " + dumped(key) + ": " + dumped(value) + ",\n";
  return text;
}

Json mesh_json(const CompareReport& report, const ReportMesh& mesh) {
  const MeshComparison& c = mesh.comparison;
  const MeshDistance d = distance_of(report, c);
  Json json{{"label", mesh.label},
            {"file", text_or_null(mesh.file)},
            {"ours", mesh.ours},
            {"tolerance", positive_or_null(mesh.tolerance)},
            {"guaranteed", mesh.guaranteed ? Json(*mesh.guaranteed) : Json()},
            {"kept", mesh.broken.empty()},
            {"broken", mesh.broken},
            {"notes", mesh.notes},
            {"verdict", mesh.verdict},
            {"points", mesh.points},
            {"triangles", mesh.triangles},
            {"strategy", text_or_null(mesh.strategy)},
            {"level", mesh.level ? Json(*mesh.level) : Json()},
            {"mean_curvature", json_of(mesh.curvature)},
            {"width", positive_or_null(mesh.width)},
            {"faults", faults_json(c)},
            {"distance",
             {{"max", d.max},
              {"mean", d.mean},
              {"rms", d.rms},
              {"p99.9", d.p999},
              {"bound", d.bound},
              {"diagonals", d.diagonals},
              {"pixels", d.pixels}}}};
  add_figures(json, c.all);
  json["worst_face"] = index_or_null(c.worst_face);
  json["worst_angle_face"] = index_or_null(c.worst_angle_face);
  json["missing_faces"] = missing_faces(c);
  json["unmeasured_faces"] = c.unmeasured_faces;
  json["topology"] = topology_json(c);
  json["reference"] = {{"bound", c.reference_bound}, {"triangles", c.reference_triangles}};
  json["model_gap"] = c.model_gap;
  json["seconds"] = c.seconds;
  json["cost"] = json_of(mesh.cost);
  json["images"] = mesh.pictures.empty() ? Json() : json_of(mesh.images);
  json["pictures"] = json_of(mesh.pictures);
  return json;
}

std::string mesh_text(const CompareReport& report, const ReportMesh& mesh) {
  std::string text = open_object(mesh_json(report, mesh), "    ") + "      \"faces\": [";
  for (std::size_t f = 0; f < mesh.comparison.faces.size(); ++f)
    text += (f == 0 ? "\n        " : ",\n        ") + face_line(report, mesh.comparison, f);
  return text + "\n      ]\n    }";
}

// ---- CSV ---------------------------------------------------------------------------------------------------------------

// [RFC 4180]: quoted where it must be.
std::string cell(const std::string& text) {
  const std::string valid = valid_utf8(text);
  if (valid.find_first_of(",\"\r\n") == std::string::npos) return valid;
  std::string out = "\"";
  for (const char c : valid) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

constexpr const char* kColumns =
    "mesh,scope,placed,face,name,triangles,area,covered,inward,distance,to_surface_max,to_surface_mean,to_surface_rms,to_surface_p99.9,"
    "to_surface_bound,to_mesh_max,to_mesh_mean,to_mesh_rms,to_mesh_p99.9,to_mesh_bound,normal_angle_max,normal_angle_mean,slivers,"
    "smallest_angle,open_edges,strategy,level,mean_curvature_max,mean_curvature_rms\r\n";

// The last columns: of meshes.
std::string strategy_cells(const ReportMesh& mesh) {
  std::string row = "," + mesh.strategy + "," + (mesh.level ? std::to_string(*mesh.level) : "");
  if (!mesh.curvature) return row + ",,";
  return row + "," + json_number(mesh.curvature->max) + "," + json_number(mesh.curvature->rms);
}

// What rows of faces and of meshes have in common: the columns from `triangles` on, but for the last four.
std::string figure_cells(const FaceComparison& f, std::uint64_t triangles, std::uint64_t open_edges) {
  std::string row = fmt::format(",{}", triangles);
  const auto add = [&](double x) { row += "," + json_number(x); };
  for (const double x : {f.area, f.covered, f.inward, worst_distance(f)}) add(x);
  for (const OneSided* d : {&f.to_surface, &f.to_mesh})
    for (const double x : {d->max, d->mean, d->rms, d->p999, d->bound}) add(x);
  for (const double x : {kDegrees * f.worst_angle, kDegrees * f.mean_angle}) add(x);
  row += fmt::format(",{}", f.shapes.slivers);
  add(smallest_angle(f.shapes));
  return row + fmt::format(",{}", open_edges);
}

}  // namespace

std::string compare_json(const CompareReport& report) {
  Json legends = Json::array();
  for (const ReportLegend& legend : report.legends) legends.push_back(json_of(legend));
  const Json json{{"isophote", report.version},
                  {"command", text_or_null(report.command)},
                  {"machine", text_or_null(report.machine)},
                  {"model", report.model},
                  {"unit", text_or_null(report.unit)},
                  {"diagonal", report.diagonal},
                  {"faces", report.faces},
                  {"verdict", report.verdict},
                  {"advice", text_or_null(report.advice)},
                  {"failures", report.failures},
                  {"slope", report.slope == 0 ? Json() : Json(report.slope)},
                  {"camera",
                   {{"view", report.view},
                    {"width", report.size.width},
                    {"height", report.size.height},
                    {"samples", report.samples},
                    {"seed", report.seed},
                    {"pixel", positive_or_null(report.pixel)}}},
                  {"direct", json_of(report.direct)},
                  {"pictures", json_of(report.pictures)},
                  {"legends", std::move(legends)}};
  std::string text = open_object(json, "") + "  \"meshes\": [\n";
  for (std::size_t m = 0; m < report.meshes.size(); ++m) text += (m == 0 ? "" : ",\n") + mesh_text(report, report.meshes[m]);
  return text + "\n  ]\n}\n";
}

std::string compare_csv(const CompareReport& report) {
  std::string text = kColumns;
  for (const ReportMesh& mesh : report.meshes) {
    const MeshComparison& c = mesh.comparison;
    text +=
        cell(mesh.label) + ",mesh,,," + figure_cells(c.all, mesh.triangles, c.topology.open_edges.count) + strategy_cells(mesh) + "\r\n";
    for (std::size_t i = 0; i < c.faces.size(); ++i) {
      const FaceComparison& f = c.faces[i];
      text += cell(mesh.label) + fmt::format(",face,{},{},", f.placed, f.face) + cell(face_name(report, c, i)) +
              figure_cells(f, f.triangles, f.open_edges) + ",,,,\r\n";
    }
  }
  return text;
}

}  // namespace iso
