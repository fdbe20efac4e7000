#include "raytracer/trace_scene.h"

#include "patches/base/check.h"

namespace iso {

Box3 TraceScene::box() const {
  Box3 box;
  for (const Placed& p : placed)
    if (!p.part->box.empty()) box.include(transformed(p.to_world, p.part->box));
  return box;
}

void add_model(TraceScene& scene, std::shared_ptr<const Model> model, const Affine3& to_world, std::optional<Colour> override_colour) {
  for (const Instance& instance : model->instances) {
    // The part lives as long as its model.
    std::shared_ptr<const Part> part(model, &model->parts[static_cast<std::size_t>(instance.part)]);
    scene.placed.push_back({std::move(part), to_world * instance.to_model, override_colour ? override_colour : instance.colour,
                            override_colour.has_value(), instance.name});
  }
}

void use_mesh(TraceScene& scene, const Model& model, const std::shared_ptr<const ModelMesh>& mesh) {
  ISO_CHECK(mesh->parts.size() == model.parts.size());
  for (Placed& placed : scene.placed)
    for (std::size_t i = 0; i < model.parts.size(); ++i)
      if (placed.part.get() == &model.parts[i]) placed.mesh = std::shared_ptr<const PartMesh>(mesh, &mesh->parts[i]);
}

}  // namespace iso
