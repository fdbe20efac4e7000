// Verifies a part's mesh, independently of how it was made: topology by its points, orientation and overlaps by (u, v) and normals, borders
// by the model's edges. It measures no distances to the surface. Same input, same report, for any number of threads; O(n log n).
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"
#include "tess/topology.h"

namespace iso {

inline constexpr double kSliver = 1;  // degrees: triangles with a smaller angle are counted as slivers

// The triangles of one face, or of all.
struct TriangleShapes {
  std::uint64_t triangles = 0;
  std::uint64_t slivers = 0;    // with an angle under kSliver
  double smallest_angle = 180;  // degrees, of triangles with area

  double sliver_share() const { return triangles == 0 ? 0.0 : static_cast<double>(slivers) / static_cast<double>(triangles); }
};

// Counts one more triangle.
void add_shape(TriangleShapes& shapes, const Point3& a, const Point3& b, const Point3& c);

struct MeshReport {
  std::uint64_t nodes = 0, faces = 0;
  TopologyReport topology;  // by index of point
  // The open edges of the topology, in two kinds.
  Finding free_edges;   // where the model is open: on an edge that one face uses once, a trim curve of no edge, or the side of an untrimmed
                        // domain that does not close
  Finding cracks;       // all others
  Finding folded;       // triangles whose normal in space is not on the side of the mean of their nodes' normals
  Finding turned;       // triangles that run the wrong way round in (u, v), for the face's orientation, or have no area there
  Finding overlapping;  // pairs of triangles of a face whose interiors meet in (u, v); the place is the second one's
  Finding empty_faces;  // faces without triangles; `face` says which
  TriangleShapes shapes;
  std::vector<TriangleShapes> shapes_of_face;

  // A manifold, oriented mesh, open only where the model is, without folds, overlaps, triangles without area and missing faces.
  bool sound() const;
};

// What the maker of a mesh knows of it, which (u, v) alone do not tell for certain.
struct MakersNotes {
  std::span<const std::array<std::uint32_t, 2>> free_sides;  // pairs of points where the model is open, the smaller first, sorted
  std::vector<bool> turned;                                  // faces that were turned against their surface, empty: none
  std::vector<bool> copies;                                  // faces that another one is meshed for, empty: none
};

// The mesh must belong to the part: as many faces, valid indices, finite numbers (ISO_CHECK).
MeshReport verify(const Part& part, const PartMesh& mesh, const TopologyOptions& options = {});
MeshReport verify(const Part& part, const PartMesh& mesh, const MakersNotes& notes, const TopologyOptions& options = {});

// For people: a line for the counts and one for each kind that was found, with its first places.
std::string text_of(const TopologyReport& report);
std::string text_of(const MeshReport& report);

}  // namespace iso
