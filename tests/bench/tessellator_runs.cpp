#include "tests/bench/tessellator_runs.h"

#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <iostream>

#include "patches/io/read_model.h"
#include "tests/bench/timing.h"
#include "tests/support/child.h"
#include "tests/support/occt_shape.h"

namespace iso::bench {
namespace {

using Json = nlohmann::ordered_json;

// All parts of a model as they are placed, in one mesh; its faces are numbered through.
struct WholeMesh {
  PartMesh mesh;
  std::vector<FaceReport> reports;
  std::vector<std::pair<const Face*, const Affine3*>> faces;
  int rounds = 0;
};

std::vector<PartTessellation> tessellated(const Model& model, double distance) {
  std::vector<PartTessellation> parts;
  TessellationOptions options;
  options.distance = distance;
  for (const Part& part : model.parts) parts.push_back(tessellate(part, options));
  return parts;
}

void append(PartMesh& mesh, const PartMesh& part, const Affine3& to_model) {
  const auto points = static_cast<std::uint32_t>(mesh.points.size()), nodes = static_cast<std::uint32_t>(mesh.nodes.size()),
             triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  const Affine3 back = inverse(to_model);
  for (const Point3& p : part.points) mesh.points.push_back(to_model.point(p));
  for (const MeshNode& n : part.nodes)
    mesh.nodes.push_back({n.point + points, n.uv, n.normal == Vec3(0.0) ? n.normal : transform_normal(back, n.normal)});
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({a + nodes, b + nodes, c + nodes});
  for (std::size_t f = 1; f < part.first_node.size(); ++f) {
    mesh.first_node.push_back(part.first_node[f] + nodes);
    mesh.first_triangle.push_back(part.first_triangle[f] + triangles);
  }
}

WholeMesh assembled(const Model& model, const std::vector<PartTessellation>& parts) {
  WholeMesh whole;
  for (const PartTessellation& part : parts) whole.rounds = std::max(whole.rounds, part.rounds);
  for (const Instance& instance : model.instances) {
    const auto p = static_cast<std::size_t>(instance.part);
    append(whole.mesh, parts[p].mesh, instance.to_model);
    whole.reports.insert(whole.reports.end(), parts[p].faces.begin(), parts[p].faces.end());
    for (const Face& face : model.parts[p].faces) whole.faces.push_back({&face, &instance.to_model});
  }
  return whole;
}

MeasuredSurfaces surfaces_of(const WholeMesh& whole) {
  MeasuredSurfaces surfaces;
  for (const auto& face : whole.faces) surfaces.flat.push_back(std::holds_alternative<Plane>(face.first->surface));
  surfaces.point = [&whole](int face, const UV& uv) {
    const auto& [at, to_model] = whole.faces[static_cast<std::size_t>(face)];
    return to_model->point(point(at->surface, uv));
  };
  return surfaces;
}

double status_bytes(const std::string& entry) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(entry)) return 1024 * std::stod(line.substr(entry.size() + 1));
  return 0;
}

// CPU seconds and bytes of what runs in a child process, which the system ends after too long.
struct Cost {
  double seconds = 0, bytes = 0;
};
template <class Work>
Cost cost_of(const Work& work) {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto limit = static_cast<rlim_t>(std::ceil(kMostMeshSeconds)) + static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
  const rlimit some{limit, RLIM_INFINITY}, any{RLIM_INFINITY, RLIM_INFINITY};
  ::setrlimit(RLIMIT_CPU, &some);
  const double before = status_bytes("VmRSS");
  const double seconds = seconds_of(work);
  ::setrlimit(RLIMIT_CPU, &any);
  return {seconds, status_bytes("VmHWM") - before};
}

void take(TessellatorRow& row, const PartMesh& mesh, const Cost& cost) {
  const MeshQuality quality = mesh_quality(mesh);
  row.triangles = mesh.triangles.size();
  row.seconds = cost.seconds;
  row.runs = 1;
  row.peak_bytes = cost.bytes;
  row.open_edges = quality.topology.open_edges.count;
  row.non_manifold_edges = quality.topology.non_manifold_edges.count;
  row.misoriented_edges = quality.topology.misoriented_edges.count;
  row.zero_area = quality.topology.zero_area.count;
  row.folded = quality.folded;
  row.slivers = quality.shapes.slivers;
  row.smallest_angle = quality.shapes.smallest_angle;
}

// Distances below this share of the tolerance are not looked at closer.
constexpr double kNegligible = 0.05;

void take(TessellatorRow& row, const MeshDeviation& measured, double distance, int worst_face) {
  row.max = measured.max / distance;
  row.p999 = measured.p999 / distance;
  row.sampled_triangles = measured.triangles;
  row.worst_face = worst_face;
  if (worst_face < 0) return;
  const FaceExtreme& worst = measured.faces[static_cast<std::size_t>(worst_face)];
  row.worst_uv = worst.uv;
  row.worst = worst.distance / distance;
}

void measure_ours(TessellatorRow& row, const Model& model, double distance, std::uint64_t sampled) {
  std::vector<PartTessellation> parts;
  const Cost cost = cost_of([&] { parts = tessellated(model, distance); });
  const WholeMesh whole = assembled(model, parts);
  take(row, whole.mesh, cost);
  row.rounds = whole.rounds;
  for (const FaceReport& face : whole.reports) {
    row.bound = std::max(row.bound, (face.bound + face.offset) / distance);
    row.gap = std::max(row.gap, face.offset / distance);
    row.unresolved += face.unresolved;
    row.failed_faces += !face.failure.empty();
  }
  const MeshDeviation measured = mesh_deviation(whole.mesh, surfaces_of(whole), {kNegligible * distance, sampled});
  int worst = -1;
  for (std::size_t f = 0; f < whole.reports.size(); ++f) {
    const double beyond = (measured.faces[f].distance - whole.reports[f].offset) / distance;
    if (worst >= 0 && beyond <= row.beyond_gap) continue;
    row.beyond_gap = beyond;
    worst = static_cast<int>(f);
  }
  take(row, measured, distance, worst);
  if (worst >= 0) row.worst_kind = kind_name(whole.faces[static_cast<std::size_t>(worst)].first->surface);
}

OcctAlgorithm algorithm_of(Mesher mesher) { return mesher == Mesher::watson ? OcctAlgorithm::watson : OcctAlgorithm::delabella; }

void measure_theirs(TessellatorRow& row, OcctMesher& theirs, double distance, std::uint64_t sampled) {
  const Cost cost = cost_of([&] { theirs.mesh(distance, algorithm_of(row.mesher)); });
  const PartMesh mesh = theirs.result();
  take(row, mesh, cost);
  for (int f = 0; f < mesh.face_count(); ++f)
    row.failed_faces += mesh.first_triangle[static_cast<std::size_t>(f)] == mesh.first_triangle[static_cast<std::size_t>(f) + 1];
  const MeshDeviation measured = mesh_deviation(mesh, theirs.surfaces(), {kNegligible * distance, sampled});
  take(row, measured, distance, measured.worst_face);
  if (measured.worst_face >= 0) row.worst_kind = theirs.kind_of(measured.worst_face);
}

// What a child process tells of its row.
Json told(const TessellatorRow& r) {
  return {r.triangles,
          r.seconds,
          r.runs,
          r.max,
          r.p999,
          r.sampled_triangles,
          r.worst_face,
          r.worst_kind,
          r.worst_uv.x,
          r.worst_uv.y,
          r.worst,
          r.bound,
          r.gap,
          r.beyond_gap,
          r.rounds,
          r.unresolved,
          r.open_edges,
          r.zero_area,
          r.folded,
          r.non_manifold_edges,
          r.misoriented_edges,
          r.slivers,
          r.failed_faces,
          r.smallest_angle,
          r.peak_bytes};
}

void read_told(const Json& json, TessellatorRow& r) {
  std::size_t next = 0;
  const auto get = [&](auto&... to) { (json.at(next++).get_to(to), ...); };
  get(r.triangles, r.seconds, r.runs, r.max, r.p999, r.sampled_triangles, r.worst_face, r.worst_kind, r.worst_uv.x, r.worst_uv.y, r.worst,
      r.bound, r.gap, r.beyond_gap, r.rounds, r.unresolved, r.open_edges, r.zero_area, r.folded, r.non_manifold_edges, r.misoriented_edges,
      r.slivers, r.failed_faces, r.smallest_angle, r.peak_bytes);
}

// Long enough for any measurement: what is too long is the mesher's CPU time.
constexpr double kMostChildSeconds = 3600;

// Memory that is free before the fork would count as taken in the child.
template <class Work>
test::ChildResult run_measured(const Work& work) {
  malloc_trim(0);
  test::ChildLimits limits;
  limits.seconds = kMostChildSeconds;
  return test::run_in_child(
      [&] {
        std::cout << work().dump() << std::flush;
        return 0;
      },
      {}, limits);
}

double mesh_seconds(MeshedModel& model, double tolerance, Mesher mesher) {
  const double distance = tolerance * model.theirs.diagonal();
  if (mesher != Mesher::ours) return model.theirs.mesh(distance, algorithm_of(mesher));
  return seconds_of([&] { tessellated(model.ours, distance); });
}

}  // namespace

const char* name_of(Mesher mesher) {
  return mesher == Mesher::ours ? "Isophote" : mesher == Mesher::watson ? "OCCT Watson" : "OCCT Delabella";
}

Result<MeshedModel> read_meshed_model(const std::string& name, const std::string& path) {
  auto ours = read_model(path);
  if (!ours) return ours.error();
  try {
    return MeshedModel{name, std::move(*ours), OcctMesher(path)};
  } catch (const test::OcctFailure& failure) {
    return bad_input(path, {}, failure.what());
  }
}

TessellatorRow measured_in_child(MeshedModel& model, double tolerance, Mesher mesher, std::uint64_t sampled_triangles) {
  TessellatorRow row;
  row.model = model.name;
  row.faces = model.theirs.faces();
  row.tolerance = tolerance;
  row.mesher = mesher;
  const double distance = tolerance * model.theirs.diagonal();
  const test::ChildResult child = run_measured([&] {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    if (mesher == Mesher::ours)
      measure_ours(row, model.ours, distance, sampled_triangles);
    else
      measure_theirs(row, model.theirs, distance, sampled_triangles);
    return told(row);
  });
  if (child.code == 0)
    read_told(Json::parse(child.out), row);
  else
    row.failure = child.signal == SIGXCPU ? fmt::format("more than {} s", kMostMeshSeconds) : child.summary();
  return row;
}

std::vector<std::vector<double>> seconds_in_turns(MeshedModel& model, double tolerance, std::span<const Mesher> meshers, int rounds) {
  const test::ChildResult child = run_measured([&] {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    Json seconds = Json::array();
    for (std::size_t i = 0; i < meshers.size(); ++i) seconds.push_back(Json::array());
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < meshers.size(); ++i) seconds[i].push_back(mesh_seconds(model, tolerance, meshers[i]));
    return seconds;
  });
  if (child.code != 0) return std::vector<std::vector<double>>(meshers.size());
  return Json::parse(child.out).get<std::vector<std::vector<double>>>();
}

std::optional<ThreadTimes> thread_times(MeshedModel& model, double tolerance, int runs) {
  const double distance = tolerance * model.theirs.diagonal();
  const auto wall = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const auto start = std::chrono::steady_clock::now();
    tessellated(model.ours, distance);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const test::ChildResult child = run_measured([&] {
    ThreadTimes times{kInf, kInf};
    for (int i = 0; i < runs; ++i) {
      times.two = std::min(times.two, wall(2));
      times.one = std::min(times.one, wall(1));
    }
    return Json{times.one, times.two};
  });
  if (child.code != 0) return std::nullopt;
  const Json json = Json::parse(child.out);
  return ThreadTimes{json.at(0).get<double>(), json.at(1).get<double>()};
}

}  // namespace iso::bench
