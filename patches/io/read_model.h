// Reads any supported model file; the kind is told from the content, the name's ending decides where content cannot.
#pragma once

#include <optional>
#include <string>

#include "patches/base/result.h"
#include "patches/brep.h"
#include "patches/control_mesh.h"

namespace iso {

struct ReadOptions {
  std::optional<MeshPatches> patches;  // of the polygons of a control mesh (OBJ); none: they are left out
  bool polygons_needed = true;         // an OBJ file that has none is an error where `patches` asks for them
};

// STEP, IGES, BREP (Open CASCADE), OBJ (free-form surfaces, and control meshes where `patches` asks for them), Newell .bpt, and patches
// with any number of sides: .ipatch, .gbp, .lop, .mp (patches/io/patch_set.h). `patches` with another format is an error. The result has at
// least one face, all numbers finite, `finish` done. Errors: missing or unreadable file (Exit::read_write), not such a file, damaged, or
// nothing in it that can be used (Exit::bad_input).
Result<Model> read_model(const std::string& path, const ReadOptions& options = {});

// The single readers; `path` must exist. They do not call `finish`.
Result<Model> read_step(const std::string& path);
Result<Model> read_iges(const std::string& path);
Result<Model> read_brep(const std::string& path);
Result<Model> read_obj(const std::string& path, const ReadOptions& options = {});
Result<Model> read_bpt(const std::string& path);
Result<Model> read_ipatch(const std::string& path);
Result<Model> read_gbp(const std::string& path);
Result<Model> read_lop(const std::string& path);
Result<Model> read_mp(const std::string& path);

}  // namespace iso
