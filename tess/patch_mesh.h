// Patches with any number of sides as triangles by the uniform strategies (multisided.h), watertight over many patches.
//
// A part of patches has a face for each corner of each patch: its charts, in order (patches/surface/patch_chart.h). Sides are the pairs of
// half sides that the faces' loops name as edges; patches that share a side agree on its level, and its points are made once, by the first.
// So are corners. Nothing else is joined: what the part does not share stays apart, and `sew` is the other tessellator's (tessellate.h).
//
// Bounds are proven (patch_bounds.h), of triangles that pass from chart to chart, too.
#pragma once

#include <vector>

#include "tess/discrete_curvature.h"
#include "tess/multisided.h"
#include "tess/patch_sides.h"
#include "tess/tessellate.h"

namespace iso {

struct PatchMeshOptions {
  Strategy strategy = Strategy::symmetric_triangles;
  int level = 0;        // segments a side, of all sides; 0: the smallest for `distance`
  double distance = 0;  // world units; with a level: only counts what is beyond it, 0: nothing
  int most = 128;       // levels above are not tried
};

struct PatchMesh {
  // The strategy's triangles. A face's are those whose middle is over its chart; nodes that lie in another chart have the nearest (u, v) of
  // this one, and the normal of their own. `rounds`: how often levels were raised.
  PartTessellation made;
  // The same triangles, cut where they pass from a chart to the next: every piece within one face. The points of
  // `made` come first.
  PartMesh cut;
  std::vector<SurfacePlace> places;   // of the points of `made`
  std::vector<PatternLevels> levels;  // of each patch: inner, and of its sides
  std::uint64_t quads = 0;
  std::size_t tables = 0, table_bytes = 0;  // coordinate tables
};

// ISO_CHECK: patches_of(part) is no error; a level or a distance is given. Patches are evaluated in parallel; same input, same mesh.
PatchMesh mesh_patches(const Part& part, const PatchMeshOptions& options);

// Topology and shapes of `made`; orientation and overlaps in the polygon of `cut`, chart by chart.
MeshReport verify(const Part& part, const PatchMesh& mesh);

}  // namespace iso
