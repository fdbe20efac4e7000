// What is traced: parts placed in the world. Built from models (a model may be placed several times) and handed to the tracer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"

namespace iso {

struct Placed {
  std::shared_ptr<const Part> part;
  Affine3 to_world;
  std::optional<Colour> colour;   // used by faces without a colour of their own
  bool colour_overrides = false;  // the scene file asked for this colour: it wins over the file's
  std::string name;
  // If set, rays meet these triangles in place of the part's surfaces. Its faces are those of the part.
  std::shared_ptr<const PartMesh> mesh = nullptr;
};

// The normals of meshes: interpolated from those of the nodes, or the triangles' own.
enum class MeshShading { smooth, flat };

// Where rays start that leave a smooth mesh: on the triangle, so that facets show where light grazes; or moved off it to the tangent planes
// of its corners, which hides that [Hanika 2021, Hacking the Shadow Terminator].
enum class Terminator { faceted, softened };

struct TraceScene {
  std::vector<Placed> placed;
  MeshShading mesh_shading = MeshShading::smooth;
  Terminator terminator = Terminator::faceted;

  Box3 box() const;
};

// Adds all instances of a model, under `to_world`.
void add_model(TraceScene& scene, std::shared_ptr<const Model> model, const Affine3& to_world, std::optional<Colour> override_colour = {});

// Traces the parts of `model` that are in the scene by their meshes.
void use_mesh(TraceScene& scene, const Model& model, const std::shared_ptr<const ModelMesh>& mesh);

}  // namespace iso
