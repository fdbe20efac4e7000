// Meshes as Embree's own triangles.
#pragma once

#include <embree3/rtcore.h>

#include "patches/triangle_mesh.h"

namespace iso {

// A scene of one geometry: the triangles of a mesh, their points rounded to float. `filter` is asked about every triangle that a ray
// passes, whatever the query, and finds `user` beside it. A mesh without triangles makes an empty scene.
RTCScene new_triangle_scene(RTCDevice device, const PartMesh& mesh, void* user, RTCFilterFunctionN filter);

}  // namespace iso
