#include "raytracer/cmd/load_models.h"

#include <fmt/format.h>

#include <map>

#include "patches/io/read_model.h"

namespace iso {
namespace {

constexpr double kFarthest = 1e30;  // world units; boxes beyond would leave the range of float

// [Fowler, Noll, Vo; FNV-1a, 64 bits]
std::uint64_t hash_bytes(std::uint64_t h, std::string_view bytes) {
  for (const char c : bytes) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return h;
}

// What was dropped or approximated, told once per file.
void note_problems(const Model& model, std::vector<std::string>& notes) {
  int dropped = 0, other = 0;
  for (const Problem& problem : model.problems) {
    if (problem.kind == Problem::Kind::dropped) dropped += problem.count;
    if (problem.kind == Problem::Kind::repaired || problem.kind == Problem::Kind::approximated) other += problem.count;
  }
  if (dropped > 0) notes.push_back(fmt::format("{}: {} entities could not be used; `isophote info` names them", model.file, dropped));
  if (other > 0)
    notes.push_back(fmt::format("{}: {} entities were repaired or approximated; `isophote info` names them", model.file, other));
}

}  // namespace

Result<LoadedModels> load_models(const std::vector<ModelEntry>& models, const std::string& hash_text) {
  LoadedModels loaded;
  std::uint64_t hash = hash_bytes(0xcbf29ce484222325ull, hash_text);
  std::map<std::pair<std::string, std::optional<MeshPatches>>, std::shared_ptr<const Model>> read;
  for (const ModelEntry& entry : models) {
    auto& model = read[{entry.file, entry.patches}];
    if (!model) {
      auto result = read_model(entry.file, {entry.patches, entry.polygons_needed});
      if (!result) return result.error();
      model = std::make_shared<const Model>(std::move(*result));
      note_problems(*model, loaded.notes);
      const auto bytes = read_text(entry.file);
      if (!bytes) return bytes.error();
      hash = hash_bytes(hash, *bytes);
      if (entry.patches) hash = hash_bytes(hash, kMeshPatchNames[static_cast<std::size_t>(*entry.patches)]);
    }
    if (&entry == models.data()) loaded.unit = model->unit;
    if (loaded.unit != model->unit) loaded.unit.clear();
    add_model(loaded.scene, model, entry.to_world, entry.colour);
  }

  const Box3 box = loaded.scene.box();
  if (!box.empty() && !(std::max(glm::length(box.lo), glm::length(box.hi)) < kFarthest))
    return bad_input(models.front().file, {},
                     fmt::format("the scene reaches beyond {:g}; expected coordinates that are smaller", kFarthest));
  loaded.hash = fmt::format("{:016x}", hash);
  return loaded;
}

}  // namespace iso
