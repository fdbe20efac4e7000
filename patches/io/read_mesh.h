// Reads triangle meshes of any origin. Coordinates keep the precision of the file: text is read to doubles, and nothing is rounded on the
// way.
//   .stl         binary or text; which one is told by the size and not by the word `solid`.
//   .obj         polygons (`v`, `f`), cut into triangles; free-form surfaces, lines and points are left out and noted.
//   .ply         text or binary of either byte order, any types of numbers; `face` lists (vertex_indices or vertex_index) and `tristrips`.
//   .glb .gltf   glTF 2.0 with its buffers: in the file, beside it, or as data URIs. The meshes of the nodes of the default scene (without
//                scenes, of all nodes), each where it stands; triangles, strips and fans; sparse and quantised accessors. glTF is y up:
//                coordinates are turned back to z up, (x, y, z) becomes (x, -z, y), so that they match a CAD model's but for the unit,
//                which is "m". Skins and morph targets are not applied, and noted. Compressed meshes are refused.
//
// Points at equal places become one (equal to the last bit, but what is below the file's rounding equals 0, and so does -0), points that no
// triangle uses are left out. Order is that of the
// file. Triangles with a corner twice stay, they are findings; only strips and fans, which need them to go on, lose theirs. Whatever was
// cut, left out or found is told in `notes`.
//
// `rounding` bounds how far a point may have been moved by the format: for floats half a unit in the last place of the largest coordinate,
// in three directions; for text the same of the last digit where numbers with a decimal point have 5 to 15 digits, else 0; for doubles 0.
#pragma once

#include <string>

#include "patches/base/result.h"
#include "patches/triangle_mesh.h"

namespace iso {

// Errors: an ending that is not known (bad_command_line); a file or one of its buffers that cannot be opened (read_write); anything in it
// that is not as its format says, numbers that are not finite or beyond 1e15, a mesh without triangles, more than 2^32 - 2 points, corners
// of polygons or triangles, polygons of more than 20 000 corners (bad_input, with line, byte, or path in the JSON).
Result<ForeignMesh> read_mesh(const std::string& path);

}  // namespace iso
