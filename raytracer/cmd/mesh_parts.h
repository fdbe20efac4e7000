// Parts to triangle meshes, each made once, measured and verified: the work that `tessellate` and `render --mode tessellated` share.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "patches/brep.h"
#include "patches/triangle_mesh.h"
#include "tess/deviation.h"
#include "tess/patch_mesh.h"
#include "tess/tessellate.h"
#include "tess/verify.h"

namespace iso {

// Uniform patterns for patches with any number of sides, in place of triangles where the surface needs them.
struct PatternSettings {
  Strategy strategy = Strategy::symmetric_triangles;
  int level = 0;  // segments a side; 0: the smallest for the distance
};
// "adaptive" without.
inline const char* strategy_name(const std::optional<PatternSettings>& pattern) {
  return pattern ? name_of(pattern->strategy) : "adaptive";
}

struct MeshSettings {
  double distance = 0;  // world units, positive; 0: none is asked for, of patterns with a level
  double trim = 0;      // world units; 0: as `distance`
  double angle = kInf;  // radians, between normals in the coordinates of the part
  Sampling sampling = Sampling::quick;
  double sew = 0;                          // world units; 0: within the file's tolerances; negative: nothing is joined
  std::optional<PatternSettings> pattern;  // every part must be of patches (patches_of)
};

// A part and where it stands; the first place is the one that is told. Without any it stands where its own coordinates say.
struct PartToMesh {
  const Part* part = nullptr;
  std::vector<Affine3> placements;
};

struct DistanceFigures {
  double max = 0, mean = 0, rms = 0, p999 = 0;
  std::uint64_t samples = 0;
};

// What is known of a face's triangles, or of all of a part. Lengths are world units: those of the part times its stretch.
struct FaceFigures {
  FaceReport report;         // of a part: the largest lengths, the sums of the counts
  bool within = true;        // the bound is at most the tolerance
  bool contradicts = false;  // measured farther than the bound allows: a defect of ours
  DistanceFigures to_surface, to_mesh;
  double measured = 0;  // the larger of both maxima, with its place
  UV worst_uv{0.0};
  Point3 worst_place{0.0};
  double worst_angle = 0, mean_angle = 0;  // radians
};

struct PartFigures {
  const Part* part = nullptr;
  int placements = 1;
  double stretch = 1;  // the largest factor by which a placement lengthens; the part was meshed finer by it
  int rounds = 0, unresolved_edges = 0;
  JoinReport joins;  // lengths and places in coordinates of the world, as all here
  int turned = 0;    // faces that looked to the other side than their neighbours
  std::vector<FaceFigures> faces;
  FaceFigures all;
  int worst_face = -1;  // where `all.measured` is
  MeshReport check;
  std::optional<CurvatureError> curvature;  // of parts of patches; 1 / world unit
  int least_level = 0, most_level = 0;      // of patterns: over sides and insides; 0: none
  std::uint64_t quads = 0;                  // of patterns: pairs of triangles
};

struct MeshFigures {
  std::string unit;  // of the lengths, may be empty
  MeshSettings settings;
  std::vector<PartFigures> parts;
  double mesh_seconds = 0, measure_seconds = 0, verify_seconds = 0;
};

// Error: a part with faces that are no patches with any number of sides, so that patterns have no meaning for it; `option` names them.
Status check_patches(std::span<const Part* const> parts, const std::string& file, const std::string& option);

// One part after the other, each with all threads; `meshes.parts` receives a mesh for each. `progress` hears how many of how many steps are
// done. The meshes do not depend on the number of threads.
MeshFigures mesh_parts(const std::vector<PartToMesh>& parts, const MeshSettings& settings, ModelMesh& meshes,
                       const std::function<void(int, int)>& progress);

}  // namespace iso
