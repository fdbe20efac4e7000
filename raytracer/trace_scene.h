// What is traced: parts placed in the world. Built from models (a model may be placed several times) and handed to the tracer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "patches/brep.h"

namespace iso {

struct Placed {
  std::shared_ptr<const Part> part;
  Affine3 to_world;
  std::optional<Colour> colour;   // used by faces without a colour of their own
  bool colour_overrides = false;  // the scene file asked for this colour: it wins over the file's
  std::string name;
};

struct TraceScene {
  std::vector<Placed> placed;
  Box3 box() const;
};

// Adds all instances of a model, under `to_world`.
void add_model(TraceScene& scene, std::shared_ptr<const Model> model, const Affine3& to_world, std::optional<Colour> override_colour = {});

}  // namespace iso
