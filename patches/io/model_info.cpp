#include "patches/io/model_info.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

namespace iso {
namespace {

constexpr std::array kKinds{Problem::Kind::note, Problem::Kind::repaired, Problem::Kind::approximated, Problem::Kind::dropped};
constexpr size_t kProblemsShown = 12;  // of each kind, in the text

const char* name_of(Problem::Kind kind) {
  switch (kind) {
    case Problem::Kind::note:
      return "note";
    case Problem::Kind::repaired:
      return "repaired";
    case Problem::Kind::approximated:
      return "approximated";
    case Problem::Kind::dropped:
      return "dropped";
  }
  return "";
}

void count_surface(const AnySurface& surface, ModelInfo& info) {
  const auto* nurbs = std::get_if<NurbsSurface>(&surface);
  if (!nurbs) return;
  info.max_degree_u = std::max(info.max_degree_u, nurbs->degree_u);
  info.max_degree_v = std::max(info.max_degree_v, nurbs->degree_v);
  info.poles += static_cast<long>(nurbs->poles.size());
  info.max_poles = std::max(info.max_poles, static_cast<long>(nurbs->poles.size()));
  info.rational += nurbs->rational();
}

// A patch is counted with its first chart.
void count_chart(const AnySurface& surface, long times, ModelInfo& info) {
  const auto* chart = std::get_if<PatchChart>(&surface);
  if (!chart) return;
  ++info.charts;
  info.max_chart_error = std::max(info.max_chart_error, chart->error);
  if (chart->corner != 0) return;
  const auto key = [](const PatchCount& c) { return std::pair(c.kind, c.sides); };
  const PatchCount wanted{chart->basis.kind, chart->basis.sides, 0, 0};
  auto it = std::lower_bound(info.patches.begin(), info.patches.end(), wanted,
                             [&](const PatchCount& a, const PatchCount& b) { return key(a) < key(b); });
  if (it == info.patches.end() || key(*it) != key(wanted)) it = info.patches.insert(it, wanted);
  ++it->stored;
  it->placed += times;
}

void count_face(const Face& face, long times, ModelInfo& info) {
  const std::string kind = kind_name(face.surface);
  auto it = std::find_if(info.kinds.begin(), info.kinds.end(), [&](const FaceCount& c) { return c.kind == kind; });
  if (it == info.kinds.end()) it = info.kinds.insert(info.kinds.end(), FaceCount{kind, 0, 0});
  ++it->stored;
  it->placed += times;
  ++info.faces_stored;
  info.faces_placed += times;
  info.untrimmed += face.loops.empty();
  info.loops += static_cast<long>(face.loops.size());
  info.max_approximation_error = std::max(info.max_approximation_error, face.approximation_error);
  count_surface(face.surface, info);
  count_chart(face.surface, times, info);
}

void count_edge(const Edge& edge, ModelInfo& info) {
  ++info.edges;
  if (edge.degenerate)
    ++info.edge_uses[0];
  else if (edge.uses > 0)
    ++info.edge_uses[static_cast<size_t>(std::min(edge.uses, 3))];
  info.max_file_tolerance = std::max(info.max_file_tolerance, edge.file_tolerance);
  info.max_gap = std::max(info.max_gap, edge.gap);
}

long count_colours(const Model& model) {
  std::set<std::tuple<float, float, float>> colours;
  const auto add = [&](const std::optional<Colour>& c) {
    if (c) colours.insert({c->r, c->g, c->b});
  };
  for (const Part& part : model.parts)
    for (const Face& face : part.faces) add(face.colour);
  for (const Instance& instance : model.instances) add(instance.colour);
  return static_cast<long>(colours.size());
}

std::string counted(long n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::string line(const char* label, const std::string& value) { return fmt::format("{:<13}{}\n", label, value); }

std::string text_of_faces(const ModelInfo& info) {
  std::string text =
      line("faces", info.faces_placed == info.faces_stored ? fmt::format("{}", info.faces_placed)
                                                           : fmt::format("{} placed, {} stored", info.faces_placed, info.faces_stored));
  for (const FaceCount& c : info.kinds)
    text += c.placed == c.stored ? fmt::format("{:<13}{:>7}  {}\n", "", c.placed, c.kind)
                                 : fmt::format("{:<13}{:>7}  {} ({} stored)\n", "", c.placed, c.kind, c.stored);
  return text;
}

std::string text_of_patches(const ModelInfo& info, const std::string& unit) {
  if (info.patches.empty()) return {};
  long stored = 0;
  for (const PatchCount& c : info.patches) stored += c.stored;
  std::string text = line("patches", fmt::format("{} in {}; splines beside them at most {:.3g}{} away", stored,
                                                 counted(info.charts, "chart"), info.max_chart_error, unit));
  for (const PatchCount& c : info.patches)
    text += fmt::format("{:<13}{:>7}  {}, {} sides{}\n", "", c.placed, name_of(c.kind), c.sides,
                        c.placed == c.stored ? "" : fmt::format(" ({} stored)", c.stored));
  return text;
}

std::string text_of_problems(const ModelInfo& info) {
  std::string text;
  for (const Problem::Kind kind : kKinds) {
    size_t shown = 0, more = 0;
    for (const Problem& p : info.problems) {
      if (p.kind != kind) continue;
      if (shown++ >= kProblemsShown) {
        ++more;
        continue;
      }
      text += line(name_of(kind), fmt::format("{}: {}{}", p.entity, p.what, p.count > 1 ? fmt::format(" ({} times)", p.count) : ""));
    }
    if (more > 0) text += line("", fmt::format("and {} more ({}); all of them with --json", more, name_of(kind)));
  }
  return text;
}

nlohmann::ordered_json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

ModelInfo describe(const Model& model) {
  ModelInfo info;
  info.file = model.file;
  info.format = model.format;
  info.file_unit = model.file_unit;
  info.unit = model.unit;
  info.box = box_of(model);
  info.parts = static_cast<long>(model.parts.size());
  info.instances = static_cast<long>(model.instances.size());
  info.problems = model.problems;
  std::vector<long> times(model.parts.size(), 0);
  for (const Instance& instance : model.instances) ++times[static_cast<size_t>(instance.part)];
  for (size_t i = 0; i < model.parts.size(); ++i) {
    info.solids += model.parts[i].solids * times[i];
    for (const Face& face : model.parts[i].faces) count_face(face, times[i], info);
    for (const Edge& edge : model.parts[i].edges) count_edge(edge, info);
  }
  std::sort(info.kinds.begin(), info.kinds.end(), [](const FaceCount& a, const FaceCount& b) { return a.placed > b.placed; });
  info.colours = count_colours(model);
  return info;
}

std::string to_text(const ModelInfo& info) {
  const std::string unit = info.unit.empty() ? "" : " " + info.unit;
  const Vec3 size = info.box.empty() ? Vec3(0.0) : info.box.size();
  std::string text = line("file", info.file);
  text += line("format", info.format + (info.file_unit.empty() ? "" : ", lengths in the file: " + info.file_unit));
  text += line("size", fmt::format("{:.6g} x {:.6g} x {:.6g}{}", size.x, size.y, size.z, unit));
  if (!info.box.empty())
    text += line("box", fmt::format("({:.9g}, {:.9g}, {:.9g}) to ({:.9g}, {:.9g}, {:.9g})", info.box.lo.x, info.box.lo.y, info.box.lo.z,
                                    info.box.hi.x, info.box.hi.y, info.box.hi.z));
  text += line("parts", fmt::format("{}, {}, {}", counted(info.parts, "part"), counted(info.instances, "instance"),
                                    counted(info.solids, "closed solid")));
  text += text_of_faces(info);
  text += text_of_patches(info, unit);
  text += line("loops", fmt::format("{}, {} without", counted(info.loops, "trim loop"), counted(info.untrimmed, "face")));
  if (info.poles > 0)
    text += line("NURBS", fmt::format("degree up to {} x {}, {} (largest {}), {} rational", info.max_degree_u, info.max_degree_v,
                                      counted(info.poles, "pole"), info.max_poles, info.rational));
  text += line("edges", fmt::format("{}: {} shared by two uses, {} free, {} with more, {} points", info.edges, info.edge_uses[2],
                                    info.edge_uses[1], info.edge_uses[3], info.edge_uses[0]));
  text += line("tolerance", fmt::format("{:.3g}{} largest in the file; {:.3g}{} largest gap measured", info.max_file_tolerance, unit,
                                        info.max_gap, unit));
  if (info.max_approximation_error > 0)
    text += line("error", fmt::format("{:.3g}{} largest of approximated surfaces", info.max_approximation_error, unit));
  text += line("colours", fmt::format("{}", info.colours));
  return text + text_of_problems(info);
}

std::string to_json(const ModelInfo& info) {
  nlohmann::ordered_json j;
  j["file"] = info.file;
  j["format"] = info.format;
  j["file_unit"] = info.file_unit;
  j["unit"] = info.unit;
  if (!info.box.empty()) j["box"] = {{"lo", json_of(info.box.lo)}, {"hi", json_of(info.box.hi)}};
  j["parts"] = info.parts;
  j["instances"] = info.instances;
  j["solids"] = info.solids;
  j["faces"] = {{"stored", info.faces_stored}, {"placed", info.faces_placed}, {"untrimmed", info.untrimmed}, {"loops", info.loops}};
  j["kinds"] = nlohmann::ordered_json::object();
  for (const FaceCount& c : info.kinds) j["kinds"][c.kind] = {{"stored", c.stored}, {"placed", c.placed}};
  auto patches = nlohmann::ordered_json::array();
  for (const PatchCount& c : info.patches)
    patches.push_back({{"kind", name_of(c.kind)}, {"sides", c.sides}, {"stored", c.stored}, {"placed", c.placed}});
  j["patches"] = {{"charts", info.charts}, {"largest_chart_error", info.max_chart_error}, {"kinds", std::move(patches)}};
  j["nurbs"] = {{"max_degree_u", info.max_degree_u},
                {"max_degree_v", info.max_degree_v},
                {"poles", info.poles},
                {"max_poles", info.max_poles},
                {"rational", info.rational}};
  j["edges"] = {{"all", info.edges},
                {"points", info.edge_uses[0]},
                {"free", info.edge_uses[1]},
                {"shared", info.edge_uses[2]},
                {"more_uses", info.edge_uses[3]}};
  j["largest_file_tolerance"] = info.max_file_tolerance;
  j["largest_gap"] = info.max_gap;
  j["largest_approximation_error"] = info.max_approximation_error;
  j["colours"] = info.colours;
  j["problems"] = nlohmann::ordered_json::object();
  for (const Problem::Kind kind : kKinds) {
    auto list = nlohmann::ordered_json::array();
    for (const Problem& p : info.problems)
      if (p.kind == kind) list.push_back({{"entity", p.entity}, {"what", p.what}, {"count", p.count}});
    j["problems"][name_of(kind)] = std::move(list);
  }
  // Names from files need not be valid UTF-8.
  return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace iso
