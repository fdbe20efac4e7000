// Reads triangle meshes of any origin: STL (binary and text), OBJ (polygons), PLY (text and binary, both byte orders), glTF 2.0 (.glb and
// .gltf with its buffers; nodes placed, z up restored is not done: coordinates are those of the file's own world). Coordinates keep the
// precision of the file: text is read to doubles.
//
// Polygons are cut into triangles, points at equal places become one, triangles with a corner twice stay (they are findings). Degenerate
// input is told in `notes`.
#pragma once

#include <string>

#include "patches/base/result.h"
#include "patches/triangle_mesh.h"

namespace iso {

// Errors: an ending that is not known (bad_command_line); a file that cannot be opened (read_write); anything in it that is not as its
// format says, numbers that are not finite, a mesh without triangles, more than 2^32 - 2 points or triangles (bad_input, with line or
// byte).
Result<ForeignMesh> read_mesh(const std::string& path);

}  // namespace iso
