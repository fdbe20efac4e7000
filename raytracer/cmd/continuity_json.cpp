// The JSON of `isophote continuity --json`; continuity_report.md describes it. Edges are written one a line.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "raytracer/cmd/continuity_report.h"

namespace iso {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180 / kPi;

// Names from files need not be valid UTF-8; numbers that are not finite become null.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }
double in_shown_unit(double value, std::size_t measure) {
  return measure == static_cast<std::size_t>(Measure::normal) ? value * kDegrees : value;
}

Json json_of(const Jump& jump, std::size_t measure, const Affine3& to_model) {
  if (!jump.known()) return nullptr;
  const Point3 p = to_model.point(jump.place);
  return {{"max", in_shown_unit(jump.max, measure)},
          {"rms", in_shown_unit(jump.rms, measure)},
          {"at", {p.x, p.y, p.z}},
          {"share", jump.share},
          {"uv", {jump.uv.x, jump.uv.y}}};
}

Json json_of(const EdgeContinuity::Side& side, const Part& part) {
  const Face& face = part.faces[static_cast<std::size_t>(side.face)];
  return {{"face", side.face},
          {"name", text_or_null(face.name)},
          {"edge", side.part_edge < 0 ? Json(nullptr) : Json(side.part_edge)},
          {"from", side.from},
          {"to", side.to}};
}

Json json_of(const EdgeContinuity& edge, std::size_t index, const PartContinuity& of, const ContinuitySettings& settings) {
  const ContinuityClass known = class_of(edge, settings);
  Json json{{"index", index},
            {"kind", kEdgeKindNames[static_cast<std::size_t>(edge.kind)]},
            {"class", known == ContinuityClass::unknown ? Json(nullptr) : Json(kContinuityClassNames[static_cast<std::size_t>(known)])},
            {"sewn", edge.sewn},
            {"misoriented", edge.misoriented},
            {"length", edge.length},
            {"evaluations", edge.evaluations}};
  Json sides = Json::array();
  for (const EdgeContinuity::Side& side : edge.sides) sides.push_back(json_of(side, *of.part));
  json["sides"] = std::move(sides);
  for (std::size_t m = 0; m < kMeasureNames.size(); ++m) json[kMeasureNames[m]] = json_of(edge.jumps[m], m, of.to_model);
  return json;
}

// How many edges of all parts there are of each kind and class.
Json totals_json(const ContinuityReport& report) {
  const ContinuityTotals t = totals_of(report);
  Json json{{"faces", t.faces}, {"copies", t.copies}};
  for (std::size_t k = 0; k < t.kinds.size(); ++k) json[kEdgeKindNames[k]] = t.kinds[k];
  json["sewn"] = t.sewn;
  json["misoriented"] = t.misoriented;
  for (const ContinuityClass c : {ContinuityClass::apart, ContinuityClass::G0, ContinuityClass::G1, ContinuityClass::G2})
    json[kContinuityClassNames[static_cast<std::size_t>(c)]] = t.classes[static_cast<std::size_t>(c)];
  for (const Measure m : {Measure::gap, Measure::normal, Measure::curvature})
    json["largest_" + std::string(kMeasureNames[static_cast<std::size_t>(m)])] =
        in_shown_unit(largest(report, m), static_cast<std::size_t>(m));
  return json;
}

Json tolerances_json(const ContinuitySettings& settings) {
  Json json;
  for (const Measure m : {Measure::gap, Measure::normal, Measure::curvature}) {
    const auto i = static_cast<std::size_t>(m);
    json[kMeasureNames[i]] = in_shown_unit(settings.tolerance[i], i);
  }
  return json;
}

}  // namespace

std::string continuity_json(const ContinuityReport& report) {
  const Json head{{"isophote", report.version},
                  {"file", report.file},
                  {"unit", text_or_null(report.unit)},
                  {"diagonal", report.diagonal},
                  {"tolerances", tolerances_json(report.settings)},
                  {"broken", broken_limits(report)},
                  {"totals", totals_json(report)}};
  std::string out = dumped(head);
  out.pop_back();
  out += ",\n\"parts\":[";
  for (std::size_t p = 0; p < report.parts.size(); ++p) {
    const PartContinuity& part = report.parts[p];
    const Json part_head{{"index", p},
                         {"name", text_or_null(part.part->name)},
                         {"placements", part.placements},
                         {"faces", part.part->faces.size()},
                         {"sew_tolerance", part.continuity.joins.tolerance}};
    std::string text = dumped(part_head);
    text.pop_back();
    out += (p ? ",\n" : "\n") + text + ",\"edges\":[";
    const auto& edges = part.continuity.edges;
    for (std::size_t e = 0; e < edges.size(); ++e) out += (e ? ",\n" : "\n") + dumped(json_of(edges[e], e, part, report.settings));
    out += "]}";
  }
  return out + "]}\n";
}

}  // namespace iso
