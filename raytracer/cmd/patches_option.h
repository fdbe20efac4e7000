// `--patches`, for all commands that read models: the polygons of control meshes (OBJ) become patches of this kind.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <set>
#include <string>

#include "patches/control_mesh.h"

namespace iso {

struct PatchesOption {
  std::optional<std::string> name;  // one of kMeshPatchNames

  std::optional<MeshPatches> kind() const {
    for (std::size_t i = 0; i < kMeshPatchNames.size(); ++i)
      if (name && *name == kMeshPatchNames[i]) return static_cast<MeshPatches>(i);
    return {};
  }
};

inline void declare_patches_option(CLI::App& command, PatchesOption& option) {
  command
      .add_option("--patches", option.name,
                  "make the polygons of a control mesh (OBJ) patches: gregory generalised-bezier charrot-gregory, the same with "
                  "side parameters by mean value (NAME-mean-value), or charrot-gregory-distance")
      ->check(CLI::IsMember(std::set<std::string>(kMeshPatchNames.begin(), kMeshPatchNames.end())));
}

}  // namespace iso
