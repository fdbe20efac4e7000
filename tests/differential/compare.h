// One CAD file, two programs: our exact surfaces and Open CASCADE's fine mesh, seen by the same rays.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "raytracer/camera.h"
#include "raytracer/tracer.h"
#include "tests/support/mesh_scene.h"

namespace iso::test {

// Depths may differ by this many times what the mesh is off, along the normal. The deviation is measured at four points of a triangle
// only, so the largest one inside it may be greater: for a patch of second degree by 4/3, more at inflections.
inline constexpr double kDeviationFactor = 3;

// Where a ray meets the surface at less than this cosine, depth says nothing more.
inline constexpr double kLeastCosine = 0.02;

// A rim: a silhouette, a border, or the edge of a face behind which another one shows. Where a mesh that is off by a little puts a rim a
// little beside the true one, single rays differ. A difference counts as `rim` only if the same ray, moved sideways by no more than
// kDeviationFactor times what the mesh is off, agrees with what the other program saw. A hit of ours that closes the gap of a loose edge
// may be as far off as the gap is wide, in addition.
enum class Verdict : std::uint8_t { both_miss, same_depth, rim_hit_miss, hit_miss, rim_depth, depth };

struct PixelPair {
  Hit ours;
  MeshHit theirs;
  std::int32_t their_face = -1;  // OcctMesh's number; not that of our part
  double off = 0;                // what the mesh is off at most, along the normal and sideways
  double allowed = 0;            // difference of depth, where both hit
  bool loose = false;            // the mesh is off by more than twice its deflection here
  Verdict verdict = Verdict::both_miss;
};

// All rays of one camera.
struct Picture {
  std::string from;  // where the camera stands
  ImageSize size;
  long hits = 0;  // of either
  long hit_miss = 0, hit_miss_off_rim = 0, depth = 0, depth_off_rim = 0, loose = 0;
  double our_ms = 0, their_ms = 0;  // one thread each; Embree's single rays
  std::vector<PixelPair> pixels;    // row by row

  double share(long pixels_of_a_kind) const { return double(pixels_of_a_kind) / double(pixels.size()); }
};

struct Comparison {
  std::string file;
  std::string refused;  // why nothing could be compared, else empty
  int faces = 0, our_faces = 0;
  std::size_t triangles = 0;
  std::vector<int> unmeshed;
  std::string mesh_status;
  double deflection = 0;  // over the diagonal
  double mesh_ms = 0;     // reading and meshing
  std::vector<Picture> pictures;
};

inline constexpr ImageSize kComparedSize{640, 480};

// Parallel rays of unit direction that just hold the box, from the `iso` view; and the same rays run through from their other ends, which
// see the sides that were hidden.
std::vector<Ray> rays_from_above(const Box3& box, const ImageSize& size);
std::vector<Ray> rays_from_below(const Box3& box, const ImageSize& size);

Picture compare(const OcctMesh& mesh, const Tracer& tracer, std::span<const Ray> rays, const ImageSize& size);

// Both cameras, framed on their mesh, not on our model.
Comparison compare_with_occt(const std::string& path, const MeshFineness& fineness = {});

// The table that the tests print: a line for each picture.
std::string table_head();
std::string table_rows(const Comparison& c);

}  // namespace iso::test
