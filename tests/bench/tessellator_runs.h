// One run of a tessellator: a model, a tolerance, a mesher, in a process of its own, so that its memory is known, a run that takes too long
// can be ended, and one that crashes is a row that says so.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "patches/base/result.h"
#include "patches/brep.h"
#include "tess/tessellate.h"
#include "tests/bench/occt_mesher.h"

namespace iso::bench {

enum class Mesher { ours, watson, delabella };
inline constexpr Mesher kMeshers[] = {Mesher::ours, Mesher::watson, Mesher::delabella};
const char* name_of(Mesher mesher);

// A model as both see it.
struct MeshedModel {
  std::string name;
  Model ours;
  OcctMesher theirs;
};
Result<MeshedModel> read_meshed_model(const std::string& name, const std::string& path);

// Lengths are shares of the tolerance.
struct TessellatorRow {
  std::string model;
  int faces = 0;
  double tolerance = 0;  // share of the diagonal
  Mesher mesher = Mesher::ours;
  std::string failure;  // why there is nothing below, if so

  std::uint64_t triangles = 0;
  double seconds = 0;        // CPU time of one thread, meshing only
  int runs = 0;              // of which that is the median
  double max = 0, p999 = 0;  // measured: mesh_deviation.h
  std::uint64_t sampled_triangles = 0;
  int worst_face = -1;  // where the largest distance is; of ours the one with the largest `beyond_gap`
  std::string worst_kind;
  UV worst_uv{0.0};
  double worst = 0;

  // Of ours only.
  double bound = 0;       // proven, over all faces, their gaps included
  double gap = 0;         // the model's own: the largest FaceReport::offset
  double beyond_gap = 0;  // the largest over the faces of what was measured less the face's gap
  int rounds = 0, unresolved = 0, failed_faces = 0;

  std::uint64_t open_edges = 0, non_manifold_edges = 0, misoriented_edges = 0, zero_area = 0, folded = 0, slivers = 0;
  double smallest_angle = 0;  // degrees
  double peak_bytes = 0;      // memory that the process took more while it meshed

  double triangles_per_second() const { return seconds > 0 ? static_cast<double>(triangles) / seconds : 0; }
  double bytes_per_triangle() const { return triangles ? peak_bytes / static_cast<double>(triangles) : 0; }
  double sliver_share() const { return triangles ? static_cast<double>(slivers) / static_cast<double>(triangles) : 0; }
  // Triangles that would do for a 99.9 % of 1 T: in a plane grid the error goes as one over their number.
  double triangles_at_tolerance() const { return static_cast<double>(triangles) * p999; }
};

inline constexpr const char* kLeftOut = "left out";  // a failure of rows that nobody asked for
inline constexpr double kMostMeshSeconds = 60;       // CPU: runs are ended then

// This process never uses threads itself, so that its children may.
//
// Runs, measures and verifies in a child process.
TessellatorRow measured_in_child(MeshedModel& model, double tolerance, Mesher mesher, std::uint64_t sampled_triangles);

// CPU seconds of runs of these meshers, in rounds that take turns, in one child process; by mesher. Empty if that fails.
std::vector<std::vector<double>> seconds_in_turns(MeshedModel& model, double tolerance, std::span<const Mesher> meshers, int rounds);

// Wall-clock seconds of our tessellator with one thread and with two, the least of some runs that take turns; in a child process.
struct ThreadTimes {
  double one = 0, two = 0;
};
std::optional<ThreadTimes> thread_times(MeshedModel& model, double tolerance, int runs);

}  // namespace iso::bench
