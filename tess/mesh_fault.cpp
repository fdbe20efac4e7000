// The names of what can be wrong with a mesh.
#include "patches/base/check.h"
#include "tess/mesh_comparison.h"

namespace iso {

const char* name_of(MeshFault fault) {
  switch (fault) {
    case MeshFault::unit:
      return "unit";
    case MeshFault::size:
      return "size";
    case MeshFault::placement:
      return "placement";
    case MeshFault::missing_face:
      return "missing-face";
    case MeshFault::foreign_triangles:
      return "foreign-triangles";
    case MeshFault::inside_out:
      return "inside-out";
    case MeshFault::turned_face:
      return "turned-face";
    case MeshFault::turned_triangles:
      return "turned-triangles";
    case MeshFault::far_points:
      return "far-points";
    case MeshFault::doubled_triangles:
      return "doubled-triangles";
    case MeshFault::zero_area:
      return "zero-area";
    case MeshFault::open_edges:
      return "open-edges";
    case MeshFault::non_manifold:
      return "non-manifold";
  }
  ISO_CHECK(!"a fault of a mesh");
}

}  // namespace iso
