// Reads any supported model file; the kind is told from the content, the name's ending decides where content cannot.
#pragma once

#include <string>

#include "patches/base/result.h"
#include "patches/brep.h"

namespace iso {

// STEP, IGES, BREP (Open CASCADE), OBJ free-form, Newell .bpt. The result has at least one face, all numbers finite, `finish` done.
// Errors: missing or unreadable file (Exit::read_write), not such a file, damaged, or nothing in it that can be used (Exit::bad_input).
Result<Model> read_model(const std::string& path);

// The single readers; `path` must exist. They do not call `finish`.
Result<Model> read_step(const std::string& path);
Result<Model> read_iges(const std::string& path);
Result<Model> read_brep(const std::string& path);
Result<Model> read_obj(const std::string& path);
Result<Model> read_bpt(const std::string& path);

}  // namespace iso
