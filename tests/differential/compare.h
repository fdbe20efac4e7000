// One CAD file, two programs: our exact surfaces and Open CASCADE's fine mesh, seen by the same rays.
#pragma once

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

enum class Verdict : std::uint8_t {
  both_miss,
  same_depth,
  rim_hit_miss,   // one hits, the other misses, and a pixel next to it shows the change on the same side of the comparison
  hit_miss,       // one hits, the other misses, without such a neighbour
  rim_depth,      // depths differ, and each depth lies within what the other shows in the pixels around
  depth,          // depths differ without such a reason
};

struct PixelPair {
  Hit ours;
  MeshHit theirs;
  double allowed = 0;  // depth difference
  bool loose = false;  // the mesh is off by more than twice its deflection here
  Verdict verdict = Verdict::both_miss;
};

struct Comparison {
  std::string file;
  std::string refused;  // why nothing could be compared, else empty
  int faces = 0, our_faces = 0;
  std::size_t triangles = 0;
  std::vector<int> unmeshed;
  std::string mesh_status;
  double diagonal = 0, deflection = 0;
  long hits = 0;  // of either
  long hit_miss = 0, hit_miss_off_rim = 0, depth = 0, depth_off_rim = 0, loose = 0;
  double worst_depth = 0;  // largest difference over allowed difference, off rims
  double read_ms = 0, mesh_ms = 0, build_ms = 0, our_ms = 0, their_ms = 0;
  ImageSize size{640, 480};
  std::vector<PixelPair> pixels;  // row by row

  double share(long pixels_of_a_kind) const { return double(pixels_of_a_kind) / double(size.width) / double(size.height); }
};

Comparison compare_with_occt(const std::string& path, const MeshFineness& fineness, View view = View::iso);

// The table that the test prints.
std::string table_head();
std::string table_row(const Comparison& c);

}  // namespace iso::test
