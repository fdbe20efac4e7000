#include "raytracer/cmd/mesh_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "patches/io/text_input.h"

namespace iso {
namespace {

using Json = nlohmann::ordered_json;

// The findings, as both kinds of output call them.
struct Named {
  const char *key, *words;  // in JSON, and for people
  const Finding& finding;
};
std::vector<Named> findings_of(const TopologyReport& t) {
  return {{"open_edges", "open edge", t.open_edges},
          {"non_manifold_edges", "edge of more than two triangles", t.non_manifold_edges},
          {"misoriented_edges", "edge whose triangles face opposite ways", t.misoriented_edges},
          {"non_manifold_points", "point with more than one fan of triangles", t.non_manifold_points},
          {"t_junctions", "end of an open edge inside another one", t.t_junctions},
          {"zero_area", "triangle without area", t.zero_area},
          {"duplicates", "triangle that is there twice", t.duplicates}};
}

// "3 open edges": the first word that is a noun takes the s.
std::string counted(std::uint64_t n, std::string words) {
  const std::size_t noun = words.starts_with("open ") ? words.size() : words.find(' ');
  if (n != 1) words.insert(std::min(noun, words.size()), "s");
  return fmt::format("{} {}", n, words);
}

std::string line(const char* label, const std::string& value) { return fmt::format("{:<13}{}\n", label, value); }
std::string place_text(const Point3& p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p.x, p.y, p.z); }
Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

// Statements of an .obj that tell what it is.
struct ObjKinds {
  bool surfaces = false, polygons = false;
};
ObjKinds kinds_in_obj(std::string_view text) {
  ObjKinds kinds;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view statement = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    statement.remove_prefix(std::min(statement.find_first_not_of(" \t"), statement.size()));
    const std::string_view word = statement.substr(0, statement.find_first_of(" \t\r"));
    kinds.surfaces = kinds.surfaces || word == "surf";
    kinds.polygons = kinds.polygons || word == "f" || word == "fo";
  }
  return kinds;
}

}  // namespace

bool is_mesh_file(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".stl" || ending == ".ply" || ending == ".glb" || ending == ".gltf") return true;
  if (ending != ".obj") return false;
  const auto text = read_text(path);
  if (!text) return false;
  const ObjKinds kinds = kinds_in_obj(*text);
  return kinds.polygons && !kinds.surfaces;
}

MeshInfo describe(const ForeignMesh& mesh) {
  MeshInfo info;
  info.mesh = &mesh;
  for (const Point3& p : mesh.points) info.box.include(p);
  info.topology = check_topology(mesh.points, mesh.triangles);
  // About the middle of the box, so that a mesh far from the origin keeps its digits.
  const Point3 middle = info.box.middle();
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.points[i] - middle, b = mesh.points[j] - middle, c = mesh.points[k] - middle;
    info.area += 0.5 * glm::length(glm::cross(b - a, c - a));
    info.volume += glm::dot(a, glm::cross(b, c)) / 6;
    add_shape(info.shapes, mesh.points[i], mesh.points[j], mesh.points[k]);
  }
  return info;
}

std::string to_text(const MeshInfo& info) {
  const ForeignMesh& mesh = *info.mesh;
  const TopologyReport& t = info.topology;
  const std::string unit = mesh.unit.empty() ? "" : " " + mesh.unit;
  const auto power = [&](int n) { return mesh.unit.empty() ? "" : fmt::format("{}^{}", unit, n); };
  const Vec3 size = info.box.size();
  std::string text = line("file", mesh.file) + line("format", mesh.format + ", a mesh of triangles");
  text += line("size", fmt::format("{:.6g} x {:.6g} x {:.6g}{}", size.x, size.y, size.z, unit));
  text += line("box", place_text(info.box.lo) + " to " + place_text(info.box.hi));
  text += line("triangles", fmt::format("{}, {} and {} between them", t.triangles, counted(t.points, "point"), counted(t.edges, "edge")));
  text += line("surface", t.closed()  ? "closed, every edge shared by two triangles that face the same way"
                          : t.sound() ? "open, but sound"
                                      : "not sound");
  for (const Named& named : findings_of(t)) {
    if (named.finding.count == 0) continue;
    const auto& places = named.finding.places;
    text += line("", counted(named.finding.count, named.words) + (places.empty() ? "" : ", the first at " + place_text(places.front().at)));
  }
  text += line("area", fmt::format("{:.6g}{}", info.area, power(2)));
  text += line("volume", !t.closed()       ? "unknown: not closed"
                         : info.volume < 0 ? fmt::format("{:.6g}{}: inside out", info.volume, power(3))
                                           : fmt::format("{:.6g}{}", info.volume, power(3)));
  if (info.shapes.triangles > 0)
    text += line("angles", fmt::format("{:.3g} degrees the smallest; {} under {:g} degree", info.shapes.smallest_angle,
                                       counted(info.shapes.slivers, "triangle"), kSliver));
  text +=
      line("rounding", mesh.rounding > 0 ? fmt::format("points are right to {:.3g}{}, as their numbers are written", mesh.rounding, unit)
                                         : "none that is known: numbers are written in full");
  for (const std::string& note : mesh.notes) text += line("note", note);
  return text;
}

std::string to_json(const MeshInfo& info) {
  const ForeignMesh& mesh = *info.mesh;
  const TopologyReport& t = info.topology;
  Json j;
  j["file"] = mesh.file;
  j["format"] = mesh.format;
  j["unit"] = mesh.unit.empty() ? Json() : Json(mesh.unit);
  j["box"] = {{"lo", json_of(info.box.lo)}, {"hi", json_of(info.box.hi)}};
  j["points"] = t.points;
  j["triangles"] = t.triangles;
  j["edges"] = t.edges;
  j["closed"] = t.closed();
  j["sound"] = t.sound();
  for (const Named& named : findings_of(t)) {
    const auto& places = named.finding.places;
    j[named.key] = {{"count", named.finding.count}, {"at", places.empty() ? Json() : json_of(places.front().at)}};
  }
  j["area"] = info.area;
  j["volume"] = t.closed() ? Json(info.volume) : Json();
  j["smallest_angle"] = info.shapes.triangles > 0 ? Json(info.shapes.smallest_angle) : Json();
  j["slivers"] = info.shapes.slivers;
  j["rounding"] = mesh.rounding;
  j["notes"] = mesh.notes;
  // Names from files need not be valid UTF-8.
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace iso
