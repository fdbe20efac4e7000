#include "tess/mesh_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "patches/base/units.h"

namespace iso {
namespace {

std::string length_of(double length, const std::string& unit) { return fmt::format("{:.3g}{}{}", length, unit.empty() ? "" : " ", unit); }
std::string place_of(const Point3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }
const char* plural(std::uint64_t n) { return n == 1 ? "" : "s"; }

FaultFound found_of(MeshFault fault, std::uint64_t count, std::string text, const Point3& at) {
  FaultFound found;
  found.fault = fault;
  found.count = count;
  found.text = std::move(text);
  found.at = at;
  return found;
}

// Sizes are called alike up to this: meshes are a little smaller than what they stand for.
constexpr double kAlike = 0.02;
bool alike(double a, double b) { return std::abs(a - b) <= kAlike * std::max(a, b); }

// Whether two boxes have the same proportions, once the mesh's is divided by `ratio`.
bool same_form(const Vec3& model, const Vec3& mesh, double ratio) {
  const double slack = kAlike * glm::length(model);
  for (int k = 0; k < 3; ++k)
    if (std::abs(mesh[k] / ratio - model[k]) > slack) return false;
  return true;
}

// The ratio of two units that is nearest to the one found: first of those from the model's own unit, then of any two.
struct UnitGuess {
  std::string_view mesh;   // the numbers are those of this unit,
  std::string_view model;  // taken for this one
};
UnitGuess unit_with(double ratio, const std::string& unit) {
  for (const LengthUnit& a : kLengthUnits)
    for (const LengthUnit& b : kLengthUnits)
      if (b.name == unit && &a != &b && alike(ratio, b.metres / a.metres)) return {a.name, b.name};
  for (const LengthUnit& a : kLengthUnits)
    for (const LengthUnit& b : kLengthUnits)
      if (&a != &b && unit.empty() && alike(ratio, b.metres / a.metres)) return {a.name, b.name};
  return {};
}

FaultFound size_fault(double ratio, const std::string& unit) {
  FaultFound fault = found_of(MeshFault::size, 1, {}, Point3(0.0));
  fault.ratio = ratio;
  const std::string times =
      ratio >= 1 ? fmt::format("{:.6g} times as large as", ratio) : fmt::format("{:.6g} times smaller than", 1 / ratio);
  const UnitGuess direct = unit_with(ratio, unit);
  // A mesh that was converted once too often is as much too large as its unit is small.
  const UnitGuess twice = unit_with(1 / ratio, unit);
  if (!direct.mesh.empty()) {
    fault.fault = MeshFault::unit;
    fault.unit = direct.mesh;
    fault.text =
        fmt::format("the mesh is {} the model: its numbers look like {} where the model's are {}", times, direct.mesh, direct.model);
  } else if (!twice.mesh.empty()) {
    fault.fault = MeshFault::unit;
    fault.text =
        fmt::format("the mesh is {} the model: as if it had been converted from {} to {} once too often", times, twice.mesh, twice.model);
  } else {
    fault.text = fmt::format("the mesh is {} the model, which is not the ratio of two usual units", times);
  }
  return fault;
}

class Finder {
 public:
  Finder(const FaultInput& in, const MeshComparison& measured) : in_(in), measured_(measured) {}

  std::vector<FaultFound> found() {
    missing_faces();
    foreign_triangles();
    turned();
    far_points();
    topology();
    return std::move(faults_);
  }

 private:
  FaultFound& add(MeshFault fault, std::uint64_t count, std::string text, const Point3& at, std::int64_t face = -1) {
    FaultFound found = found_of(fault, count, std::move(text), at);
    if (face >= 0) {
      const ExactFaces::Known& known = in_.faces.faces()[static_cast<std::size_t>(face)];
      found.placed = known.placed;
      found.face = known.face;
    }
    return faults_.emplace_back(std::move(found));
  }
  std::string face_name(std::size_t face) const {
    const ExactFaces::Known& known = in_.faces.faces()[face];
    const bool one = in_.faces.faces().back().placed == 0;
    return one ? fmt::format("face {}", known.face) : fmt::format("face {} of instance {}", known.face, known.placed);
  }
  Point3 middle(std::size_t t) const {
    const auto& [a, b, c] = in_.mesh.triangles[t];
    return (in_.mesh.points[a] + in_.mesh.points[b] + in_.mesh.points[c]) / 3.0;
  }
  std::string length(double x) const { return length_of(x, in_.settings.unit); }

  void missing_faces();
  void foreign_triangles();
  void turned();
  void far_points();
  void topology();

  const FaultInput& in_;
  const MeshComparison& measured_;
  std::vector<FaultFound> faults_;
};

void Finder::missing_faces() {
  constexpr double kMost = 0.5, kPart = 0.02;  // of a face's area
  constexpr double kTwice = 2;                 // neighbours' triangles may be nearest to it
  constexpr std::size_t kNamed = 8;
  std::size_t named = 0, more = 0;
  for (std::size_t f = 0; f < in_.missing_shares.size(); ++f) {
    // Of what is far from the mesh no triangles can lie on the face: a coarse mesh of a round face is far from it, but all of it is there.
    const FaceComparison& face = measured_.faces[f];
    const double share = std::min(in_.missing_shares[f], kTwice * (1 - face.covered / face.area));
    const bool part = share > kPart && !in_.cracks.empty();
    if (!(share > kMost || part)) continue;
    if (named == kNamed) {
      ++more;
      continue;
    }
    ++named;
    const OneSided& to_mesh = measured_.faces[f].to_mesh;
    add(MeshFault::missing_face, 1,
        share > kMost ? fmt::format("{} has no mesh near it: {:.0f} % of it is farther than {}, up to {} at {}", face_name(f), 100 * share,
                                    length(in_.far), length(to_mesh.max), place_of(to_mesh.at))
                      : fmt::format("a part of {} has no mesh near it: {:.2g} % of it is farther than {}, up to {} at {}", face_name(f),
                                    100 * share, length(in_.far), length(to_mesh.max), place_of(to_mesh.at)),
        to_mesh.at, static_cast<std::int64_t>(f));
  }
  if (more) faults_.back().text += fmt::format("; and {} more faces", more);
}

void Finder::foreign_triangles() {
  std::uint64_t count = 0;
  std::size_t worst = 0;
  for (std::size_t t = 0; t < in_.nearest_of_triangle.size(); ++t) {
    if (!(double(in_.nearest_of_triangle[t]) > in_.far)) continue;
    if (!count++ || in_.nearest_of_triangle[t] > in_.nearest_of_triangle[worst]) worst = t;
  }
  if (count)
    add(MeshFault::foreign_triangles, count,
        fmt::format("{} triangle{} no surface near {}: all of the worst one, triangle {} at {}, is farther than {}", count,
                    count == 1 ? " has" : "s have", count == 1 ? "it" : "them", worst, place_of(middle(worst)),
                    length(double(in_.nearest_of_triangle[worst]))),
        middle(worst));
}

void Finder::turned() {
  constexpr double kMost = 0.9;  // of an area
  if (measured_.all.inward > kMost * measured_.all.covered) {
    add(MeshFault::inside_out, 1,
        fmt::format("the mesh is inside out: the normals of {:.0f} % of its area look inward",
                    100 * measured_.all.inward / measured_.all.covered),
        measured_.all.to_surface.at);
    return;
  }
  std::vector<std::uint64_t> count(measured_.faces.size(), 0);
  std::vector<std::size_t> first(measured_.faces.size(), 0);
  for (std::size_t t = in_.triangles.size(); t-- > 0;)
    if (in_.triangles[t].inward) ++count[in_.triangles[t].face], first[in_.triangles[t].face] = t;
  std::uint64_t single = 0;
  std::size_t example = 0, named = 0;
  constexpr std::size_t kNamed = 8;
  for (std::size_t f = measured_.faces.size(); f-- > 0;) {
    const FaceComparison& face = measured_.faces[f];
    if (count[f] == 0) continue;
    const bool all = face.inward > kMost * face.covered && 2 * count[f] > face.triangles;
    if (all && named++ < kNamed) {
      add(MeshFault::turned_face, count[f],
          fmt::format("the triangles of {} are turned: {} of {} look inward", face_name(f), count[f], face.triangles), middle(first[f]),
          static_cast<std::int64_t>(f));
    } else if (!all) {
      single += count[f];
      example = first[f];
    }
  }
  if (named > kNamed) faults_.back().text += fmt::format("; and so are {} more faces", named - kNamed);
  if (single)
    add(MeshFault::turned_triangles, single,
        fmt::format("{} triangle{} turned against the surface, triangle {} at {} on {}", single, single == 1 ? " is" : "s are", example,
                    place_of(middle(example)), face_name(in_.triangles[example].face)),
        middle(example), in_.triangles[example].face);
}

void Finder::far_points() {
  std::uint64_t count = 0;
  std::size_t worst = 0;
  for (std::size_t p = 0; p < in_.points.size(); ++p) {
    if (!(in_.points[p].distance > in_.far_point)) continue;
    if (!count++ || in_.points[p].distance > in_.points[worst].distance) worst = p;
  }
  if (!count) return;
  const std::uint32_t face = in_.faces.face_of(in_.points[worst].reference);
  add(MeshFault::far_points, count,
      fmt::format("{} point{} far off the surface among points on it: the worst is {} from {}, at {}", count, count == 1 ? " is" : "s are",
                  length(in_.points[worst].distance), face_name(face), place_of(in_.mesh.points[worst])),
      in_.mesh.points[worst], face);
}

void Finder::topology() {
  const TopologyReport& t = measured_.topology;
  const auto first = [](const Finding& finding) { return finding.places.empty() ? Point3(0.0) : finding.places.front().at; };
  if (t.duplicates.count)
    add(MeshFault::doubled_triangles, t.duplicates.count,
        fmt::format("{} triangle{} there twice, triangle {} at {}", t.duplicates.count, t.duplicates.count == 1 ? " is" : "s are",
                    t.duplicates.places.front().triangle, place_of(first(t.duplicates))),
        first(t.duplicates));
  if (t.zero_area.count)
    add(MeshFault::zero_area, t.zero_area.count,
        fmt::format("{} triangle{} no area, the first at {}", t.zero_area.count, t.zero_area.count == 1 ? " has" : "s have",
                    place_of(first(t.zero_area))),
        first(t.zero_area));
  if (!in_.cracks.empty()) {
    const OpenEdge& edge = in_.cracks.front();
    const PointTriangle& corners = in_.mesh.triangles[edge.triangle];
    const auto k = static_cast<std::size_t>(edge.corner);
    const Point3 at = 0.5 * (in_.mesh.points[corners[k]] + in_.mesh.points[corners[(k + 1) % 3]]);
    add(MeshFault::open_edges, in_.cracks.size(),
        fmt::format("{} edge{} open where the model is closed, up to {} wide, the first at {}", in_.cracks.size(),
                    in_.cracks.size() == 1 ? " is" : "s are", length(measured_.widest_gap), place_of(at)),
        at, in_.triangles[edge.triangle].face);
  }
  if (t.non_manifold_edges.count)
    add(MeshFault::non_manifold, t.non_manifold_edges.count,
        fmt::format("{} edge{} of more than two triangles, the first at {}", t.non_manifold_edges.count, plural(t.non_manifold_edges.count),
                    place_of(first(t.non_manifold_edges))),
        first(t.non_manifold_edges));
}

}  // namespace

const char* name_of(MeshFault fault) {
  constexpr std::array kNames{"unit",       "size",        "placement",        "missing-face", "foreign-triangles",
                              "inside-out", "turned-face", "turned-triangles", "far-points",   "doubled-triangles",
                              "zero-area",  "open-edges",  "non-manifold"};
  return kNames[static_cast<std::size_t>(fault)];
}

std::vector<FaultFound> faults_of_place(const Box3& model, const Box3& mesh, const std::string& unit) {
  const Vec3 a = model.size(), b = mesh.size();
  const double diagonal = model.diagonal(), ratio = mesh.diagonal() / diagonal;
  if (!(ratio > 0) || !std::isfinite(ratio)) return {};
  if (!alike(ratio, 1) && same_form(a, b, ratio)) return {size_fault(ratio, unit)};

  const Vec3 shift = mesh.middle() - model.middle();
  const double off = glm::length(shift);
  if (same_form(a, b, 1) && off > kAlike * diagonal) {
    return {found_of(MeshFault::placement, 1,
                     fmt::format("the mesh has the model's size, but stands {} away, moved by {}", length_of(off, unit), place_of(shift)),
                     mesh.middle())};
  }
  // The same sizes along other axes: y up, most often.
  constexpr std::array<std::array<int, 3>, 5> kOrders{{{0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  constexpr const char* kAxes = "xyz";
  if (!same_form(a, b, 1))
    for (const auto& order : kOrders)
      if (same_form(a, Vec3(b[order[0]], b[order[1]], b[order[2]]), 1)) {
        return {found_of(MeshFault::placement, 1,
                         fmt::format("the mesh has the model's size along other axes: its {}, {}, {} are the model's x, y, z",
                                     kAxes[order[0]], kAxes[order[1]], kAxes[order[2]]),
                         mesh.middle())};
      }
  return {};
}

std::vector<FaultFound> faults_of_mesh(const FaultInput& input, const MeshComparison& measured) { return Finder(input, measured).found(); }

}  // namespace iso
