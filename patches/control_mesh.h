// Control meshes: polygons of any number of sides whose vertices, with their normals, are interpolated by patches, one a polygon.
//
// Every vertex has one normal, so that all patches around it touch there: the mesh's own where all polygons state the same one (up to
// kSameNormal), else the mean of the polygons' normals [Newell: sums of the edges' cross products], weighted by their angles there
// [Thuermer, Wuethrich 1998]. Where that vanishes, the normal of the first polygon there. So patches on both sides of an edge are made from
// the same points and normals, and meet in one curve (patches/surface/patch_construct.h).
//
// At a sharp vertex the mean may see a corner of a polygon from behind: there the patch would leave the vertex turned over, and the surface
// fold. Then the normal that sees all corners best is taken, which has the smallest largest angle to theirs [Aubry, Loehner 2008]; it is
// told. If even that sees one from behind, the mean stays: patches with one tangent plane at the vertex, whose sides leave it over the
// edges, fold there whatever the plane.
//
// Left out and reported: polygons of fewer than 3 or more than kMostSides sides, with a vertex twice, a side of no length, or no area.
// Edges of one polygon only stay free, edges of more than two are one edge with as many uses.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "patches/n_sided_part.h"

namespace iso {

inline constexpr double kSameNormal = 1e-4;  // between unit vectors: what five digits keep

struct ControlPolygon {
  std::vector<int> corners;   // indices of points, counter-clockwise seen from outside
  std::vector<Vec3> normals;  // of the corners, of any length; empty: none
  std::string place;          // in its file: "line 17"
  std::string name;           // of the group it belongs to, may be empty
};
struct ControlMesh {
  std::vector<Vec3> points;  // finite
  std::vector<ControlPolygon> polygons;
};

// Which kind the patches are of; boundaries are cubic, and the same in all of them.
//   gregory             Gregory triangles, Gregory quads, and generalised Gregory patches from five sides on
//   generalised_bezier  tangent planes of neighbours are one at the vertices, along edges only about
//   charrot_gregory     any number of sides
// Side parameters are Wachspress's coordinates; those of the others are told by the name (SideParameters).
enum class MeshPatches : std::uint8_t {
  gregory,
  generalised_bezier,
  charrot_gregory,
  gregory_mean_value,
  generalised_bezier_mean_value,
  charrot_gregory_mean_value,
  charrot_gregory_distance,
};
inline constexpr std::array kMeshPatchNames{"gregory",
                                            "generalised-bezier",
                                            "charrot-gregory",
                                            "gregory-mean-value",
                                            "generalised-bezier-mean-value",
                                            "charrot-gregory-mean-value",
                                            "charrot-gregory-distance"};

struct MeshOfPatches {
  std::vector<PatchEntry> patches;  // in the order of the polygons and named by their numbers; corners are the indices of points
  std::vector<Problem> problems;
};
// `mesh`: indices in range.
MeshOfPatches patches_of_mesh(const ControlMesh& mesh, MeshPatches kind);

}  // namespace iso
