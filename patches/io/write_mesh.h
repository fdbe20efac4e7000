// Writes triangle meshes as STL, OBJ, PLY or binary glTF. Coordinates are those of the model unless said otherwise; each instance is
// written where it stands, and mirrored ones keep their outward side outside.
//   .stl  binary. One list of triangles in float, with the normals of the triangles in space. No names, no colours.
//   .obj  text, coordinates to the last bit. An `o` per instance, a `g` per face (`face_12`, or `face_12_name`; numbers count from 0 in the
//         part), points shared across faces: watertight by index where the mesh is. Colours go into an .mtl beside it, as values for a
//         screen (sRGB curve), which is what most programs take Kd for.
//   .ply  binary, little endian. A vertex is a node (x y z in double, normal in float), so vertices repeat along the edges of faces, bit
//   for
//         bit: joining equal places restores the watertight mesh. Triangles carry `face_id`, which runs over the faces of all instances in
//         order, and `red green blue` (sRGB curve) if anything has a colour.
//   .glb  glTF 2.0. A mesh per part in float about the part's own origin, placed by nodes; a primitive per colour, with the face's number
//         in the part as the vertex attribute _FACE_ID (float: integers are not allowed there in 32 bits, and floats hold them up to 2^24).
//         A node at the root turns z up to y up, and millimetres to metres where the unit is known. Materials are two-sided, as shells are.
//         Instances that are sheared, which nodes cannot be, get a mesh of their own.
// A node without a normal (pole, apex) is written with the mean normal of the triangles about it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "patches/base/result.h"
#include "patches/brep.h"
#include "patches/triangle_mesh.h"

namespace iso {

enum class MeshFormat { stl, obj, ply, glb };

// By the ending of the name, in capitals or not. Error: any other ending (Exit::bad_command_line).
Result<MeshFormat> mesh_format_of(const std::string& path);

struct WriteMeshOptions {
  std::string version;  // of the program, told in the file; may be empty
};

struct WrittenMesh {
  std::vector<std::string> files;
  std::uint64_t bytes = 0;      // of all files
  std::uint64_t triangles = 0;  // as placed; .glb: as stored
  std::uint64_t collapsed = 0;  // of them without area after rounding to float (.stl, .glb); written all the same, or they would be holes
};

// `mesh.parts` are parallel to `model.parts`; numbers finite, indices valid, no instance singular (ISO_CHECK). The files appear whole or
// not at all. Errors: an ending that is not known (bad_command_line); numbers beyond float's, a mesh too large for its format (bad_input);
// a file that cannot be written (read_write).
Result<WrittenMesh> write_mesh(const std::string& path, const Model& model, const ModelMesh& mesh, const WriteMeshOptions& options = {});

}  // namespace iso
