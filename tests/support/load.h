// Models for tests, read and built once.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "patches/io/read_model.h"
#include "raytracer/tracer.h"
#include "tests/support/paths.h"

namespace iso::test {

// A model that must be readable: the test fails if it is not.
inline std::shared_ptr<const Model> load(const std::string& path) {
  auto model = read_model(path);
  if (!model) {
    ADD_FAILURE() << model.error().text();
    return nullptr;
  }
  return std::make_shared<const Model>(std::move(*model));
}

inline Tracer tracer_of(std::shared_ptr<const Model> model, const Affine3& placed = {}) {
  TraceScene scene;
  add_model(scene, std::move(model), placed);
  return Tracer(std::move(scene));
}

// A file of the package occt-misc ("step/linkrods.step"); it must be there.
inline std::string occt_data(const std::string& name) {
  const auto dir = occt_data_dir();
  if (!dir || !std::filesystem::exists(*dir / name)) {
    ADD_FAILURE() << "missing " << name << ": install the package occt-misc";
    return {};
  }
  return (*dir / name).string();
}

}  // namespace iso::test
