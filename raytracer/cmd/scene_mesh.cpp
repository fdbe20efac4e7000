#include "raytracer/cmd/scene_mesh.h"

#include <fmt/format.h>

#include <map>

#include "raytracer/cmd/mesh_report.h"

namespace iso {

Result<MeshFigures> tessellate_scene(LoadedModels& loaded, const MeshRequest& request, const std::function<void(int, int)>& progress,
                                     const std::optional<PatternSettings>& pattern) {
  MeshSettings settings;
  settings.pattern = pattern;
  const auto distance = in_units(request.tolerance, loaded.scene.box().diagonal(), loaded.unit, request.tolerance_name);
  if (!distance) return distance.error();
  settings.distance = pattern && pattern->level > 0 ? 0 : *distance;

  std::vector<PartToMesh> parts;
  std::map<const Part*, std::size_t> known;
  for (const Placed& placed : loaded.scene.placed) {
    const auto [at, is_new] = known.try_emplace(placed.part.get(), parts.size());
    if (is_new) parts.push_back({placed.part.get(), {}});
    parts[at->second].placements.push_back(placed.to_world);
  }
  const auto meshes = std::make_shared<ModelMesh>();
  MeshFigures figures = mesh_parts(parts, settings, *meshes, progress);
  figures.unit = loaded.unit;
  for (Placed& placed : loaded.scene.placed)
    placed.mesh = std::shared_ptr<const PartMesh>(meshes, &meshes->parts[known.at(placed.part.get())]);
  loaded.scene.mesh_shading = request.shading;
  loaded.scene.terminator = request.terminator;
  return figures;
}

std::string mesh_comment(const MeshFigures& figures, const MeshRequest& request) {
  const MeshTotals all = totals_of(figures);
  const auto length = [&](double x) { return length_text(x, figures.unit); };
  std::string text = fmt::format(
      "Tessellated to {}: {} triangles; no point of them is farther than {} from its exact surface, nor the surface from them, apart from "
      "the "
      "model's own gaps at edges, {} ({} measured). ",
      length(figures.settings.distance), all.triangles, length(all.bound), length(all.offset), length(all.measured));
  const auto broken = broken_promises(figures);
  if (!broken.empty())
    text += fmt::format("Not kept: {}{}. ", broken.front(), broken.size() > 1 ? fmt::format("; and {} more", broken.size() - 1) : "");
  text += "N, P, Z, uv, id: unfiltered, at pixel centres; N is outward, ";
  text += request.shading == MeshShading::flat ? "the triangle's own." : "interpolated from the surface's at the triangle's corners.";
  return text + (request.terminator == Terminator::softened ? " Shadows' ends are softened." : "");
}

std::string mesh_statistics(const MeshFigures& figures) {
  const MeshTotals all = totals_of(figures);
  std::string text = "mesh\n";
  for (const auto& [name, value] : {std::pair{"tolerance", figures.settings.distance},
                                    {"bound", all.bound},
                                    {"measured", all.measured},
                                    {"offset", all.offset},
                                    {"mesh seconds", figures.mesh_seconds},
                                    {"measure seconds", figures.measure_seconds},
                                    {"verify seconds", figures.verify_seconds}})
    text += fmt::format("  {:<24}{:>16.6g}\n", name, value);
  for (const auto& [name, value] : {std::pair{"faces", all.faces}, {"triangles", all.triangles}, {"open edges", all.open_edges}})
    text += fmt::format("  {:<24}{:>16}\n", name, value);
  return text;
}

}  // namespace iso
