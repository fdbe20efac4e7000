#include "patches/control_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "patches/surface/patch_construct.h"

namespace iso {
namespace {

// Cosine: a corner that is seen less from the front is not seen, but for rounding.
constexpr double kFromTheSide = 1e-6;
constexpr double kNoArea = 1e-12;  // of a polygon, as a share of its diagonal squared: rounding decides what is less

Vec3 unit_or_zero(const Vec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : Vec3(0.0);
}

// Twice the area, times the normal [Newell]; about a corner, so that a place far away costs no digits.
Vec3 newell(const ControlMesh& mesh, const ControlPolygon& polygon) {
  const Vec3& origin = mesh.points[static_cast<std::size_t>(polygon.corners[0])];
  Vec3 sum(0.0);
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const Vec3 a = mesh.points[static_cast<std::size_t>(polygon.corners[i])] - origin;
    const Vec3 b = mesh.points[static_cast<std::size_t>(polygon.corners[(i + 1) % polygon.corners.size()])] - origin;
    sum += glm::cross(a, b);
  }
  return sum;
}

double diagonal(const ControlMesh& mesh, const ControlPolygon& polygon) {
  Box3 box;
  for (const int c : polygon.corners) box.include(mesh.points[static_cast<std::size_t>(c)]);
  return box.diagonal();
}

// Why a polygon cannot be a patch, or nothing.
std::string unusable(const ControlMesh& mesh, const ControlPolygon& polygon) {
  const std::size_t n = polygon.corners.size();
  if (n < 3) return "polygons of fewer than 3 sides";
  if (n > static_cast<std::size_t>(kMostSides)) return "polygons of more than " + std::to_string(kMostSides) + " sides";
  std::vector<int> sorted = polygon.corners;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return "polygons with a vertex twice";
  for (std::size_t i = 0; i < n; ++i)
    if (mesh.points[static_cast<std::size_t>(polygon.corners[i])] == mesh.points[static_cast<std::size_t>(polygon.corners[(i + 1) % n])])
      return "polygons with a side of no length";
  const double d = diagonal(mesh, polygon);
  if (!(glm::length(newell(mesh, polygon)) > kNoArea * d * d)) return "polygons without area";
  return {};
}

double angle_at(const ControlMesh& mesh, const ControlPolygon& polygon, std::size_t i) {
  const std::size_t n = polygon.corners.size();
  const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(polygon.corners[k % n])]; };
  const Vec3 a = at(i + 1) - at(i), b = at(i + n - 1) - at(i);
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// ---- normals of vertices -------------------------------------------------------------------------------------------------

// Twice the area of the triangle that a corner and its neighbours make, times its normal.
Vec3 across_corner(const ControlMesh& mesh, const ControlPolygon& polygon, std::size_t i) {
  const std::size_t n = polygon.corners.size();
  const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(polygon.corners[k % n])]; };
  return glm::cross(at(i + 1) - at(i), at(i + n - 1) - at(i));
}

double least_cosine(const Vec3& normal, const std::vector<Vec3>& directions) {
  double least = 1;
  for (const Vec3& d : directions) least = std::min(least, glm::dot(normal, d));
  return least;
}

// The middle of the smallest cap of the unit sphere that holds all directions, if they have one of less than a half: it is held by two or
// three of them, which are found as for the smallest circle about points of the plane [Welzl 1991].
Vec3 middle_of_smallest_cap(const std::vector<Vec3>& directions) {
  constexpr double kRounding = 1e-12;
  struct Cap {
    Vec3 middle{0.0};
    double cosine = 1;
    bool holds(const Vec3& d) const { return glm::dot(middle, d) >= cosine - kRounding; }
  };
  const auto cap_about = [](const Vec3& towards, const Vec3& on) {
    const Vec3 middle = unit_or_zero(glm::dot(towards, on) < 0 ? -towards : towards);
    return Cap{middle, glm::dot(middle, on)};
  };
  Cap cap = cap_about(directions[0], directions[0]);
  for (std::size_t i = 1; i < directions.size(); ++i) {
    const Vec3& a = directions[i];
    if (cap.holds(a)) continue;
    cap = cap_about(a, a);
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3& b = directions[j];
      if (cap.holds(b)) continue;
      cap = cap_about(a + b, a);
      for (std::size_t k = 0; k < j; ++k)
        if (!cap.holds(directions[k])) cap = cap_about(glm::cross(b - a, directions[k] - a), a);
    }
  }
  return cap.middle;
}

// What the polygons around a vertex say.
struct VertexNormal {
  Vec3 stated{0.0}, sum{0.0}, first{0.0};
  std::vector<Vec3> corners;  // unit normals of the polygons' corners there
  bool used = false, agreed = true;

  void include(const Vec3& stated_here, const Vec3& own, double angle, const Vec3& corner) {
    if (!used) {
      stated = stated_here;
      first = own;
    }
    used = true;
    agreed = agreed && stated_here != Vec3(0.0) && glm::length(stated_here - stated) <= kSameNormal;
    sum += angle * own;
    if (corner != Vec3(0.0)) corners.push_back(corner);
  }
  bool vanishes() const { return glm::length(sum) <= 1e-6; }  // a share of an angle: what so nearly cancels is rounding
  Vec3 mean() const { return vanishes() ? first : unit_or_zero(sum); }
  // That sees all corners best, if the mean sees one from behind and this does not; else zero.
  Vec3 best() const {
    if (corners.empty() || least_cosine(mean(), corners) > 0) return Vec3(0.0);
    const Vec3 middle = middle_of_smallest_cap(corners);
    return least_cosine(middle, corners) > kFromTheSide ? middle : Vec3(0.0);
  }
};

// One unit normal a vertex; of those that no polygon uses: zero.
std::vector<Vec3> normals_of(const ControlMesh& mesh, const std::vector<const ControlPolygon*>& used, std::vector<Problem>& problems) {
  std::vector<VertexNormal> found(mesh.points.size());
  for (const ControlPolygon* polygon : used) {
    const Vec3 own = unit_or_zero(newell(mesh, *polygon));
    for (std::size_t i = 0; i < polygon->corners.size(); ++i)
      found[static_cast<std::size_t>(polygon->corners[i])].include(polygon->normals.empty() ? Vec3(0.0) : unit_or_zero(polygon->normals[i]),
                                                                   own, angle_at(mesh, *polygon, i),
                                                                   unit_or_zero(across_corner(mesh, *polygon, i)));
  }
  std::vector<Vec3> normals;
  int differing = 0, vanishing = 0, sharp = 0;
  for (const VertexNormal& v : found) {
    const Vec3 best = v.used && !v.agreed ? v.best() : Vec3(0.0);
    sharp += best != Vec3(0.0);
    normals.push_back(!v.used ? Vec3(0.0) : v.agreed ? v.stated : best != Vec3(0.0) ? best : v.mean());
    differing += v.used && !v.agreed && v.stated != Vec3(0.0);
    vanishing += v.used && !v.agreed && v.vanishes();
  }
  if (differing > 0)
    problems.push_back(
        {Problem::Kind::note, "vertices", "polygons state different normals: the mean of the polygons' own normals is taken", differing});
  if (vanishing > 0)
    problems.push_back({Problem::Kind::note, "vertices", "the polygons' normals cancel: that of the first polygon is taken", vanishing});
  if (sharp > 0)
    problems.push_back({Problem::Kind::note, "vertices",
                        "the mean of the polygons' normals sees a corner from behind: the normal that sees all corners best is taken",
                        sharp});
  return normals;
}

// ---- what is told ----------------------------------------------------------------------------------------------------------

void report(std::vector<Problem>& problems, Problem::Kind kind, const std::string& place, const std::string& what) {
  for (Problem& p : problems)
    if (p.kind == kind && p.what == what) {
      ++p.count;
      return;
    }
  problems.push_back({kind, place, what, 1});
}

// Edges that are used by more than two polygons, or twice in one direction.
void report_edges(const std::vector<const ControlPolygon*>& used, std::vector<Problem>& problems) {
  std::map<std::pair<int, int>, std::array<int, 2>> uses;
  for (const ControlPolygon* polygon : used)
    for (std::size_t i = 0; i < polygon->corners.size(); ++i) {
      const int a = polygon->corners[i], b = polygon->corners[(i + 1) % polygon->corners.size()];
      ++uses[std::minmax(a, b)][a > b];
    }
  int many = 0, turned = 0;
  for (const auto& [edge, count] : uses) {
    many += count[0] + count[1] > 2;
    turned += count[0] + count[1] == 2 && count[0] != 1;
  }
  if (many > 0) problems.push_back({Problem::Kind::note, "edges", "used by more than two polygons", many});
  if (turned > 0) problems.push_back({Problem::Kind::note, "edges", "between polygons of opposite orientation", turned});
}

// In the order of MeshPatches.
constexpr std::pair<PatchKind, SideParameters> kOfMesh[] = {
    {PatchKind::generalised_gregory, SideParameters::wachspress}, {PatchKind::generalised_bezier, SideParameters::wachspress},
    {PatchKind::charrot_gregory, SideParameters::wachspress},     {PatchKind::generalised_gregory, SideParameters::mean_value},
    {PatchKind::generalised_bezier, SideParameters::mean_value},  {PatchKind::charrot_gregory, SideParameters::mean_value},
    {PatchKind::charrot_gregory, SideParameters::distance},
};
static_assert(std::size(kOfMesh) == kMeshPatchNames.size());

PatchBasis basis_for(MeshPatches kind, int sides) {
  const auto& [patch, parameters] = kOfMesh[static_cast<std::size_t>(kind)];
  // Triangles and quads are Gregory patches of their own, without a choice.
  PatchBasis basis = patch == PatchKind::generalised_gregory ? gregory_basis(sides) : PatchBasis{patch, sides, 3};
  if (basis.kind == patch) basis.parameters = parameters;
  return basis;
}

}  // namespace

MeshOfPatches patches_of_mesh(const ControlMesh& mesh, MeshPatches kind) {
  MeshOfPatches made;
  std::vector<const ControlPolygon*> used;
  for (const ControlPolygon& polygon : mesh.polygons) {
    const std::string reason = unusable(mesh, polygon);
    if (reason.empty())
      used.push_back(&polygon);
    else
      report(made.problems, Problem::Kind::dropped, polygon.place, reason);
  }
  const std::vector<Vec3> normals = normals_of(mesh, used, made.problems);
  report_edges(used, made.problems);
  for (const ControlPolygon* polygon : used) {
    std::vector<PatchCorner> corners;
    PatchEntry entry;
    for (const int c : polygon->corners) {
      corners.push_back({mesh.points[static_cast<std::size_t>(c)], normals[static_cast<std::size_t>(c)]});
      entry.corners.push_back(c);
    }
    auto patch = patch_over(basis_for(kind, static_cast<int>(corners.size())), corners);
    if (!patch) {
      report(made.problems, Problem::Kind::dropped, polygon->place, "polygons that no patch can be made of: " + patch.error().message);
      continue;
    }
    entry.patch = std::move(*patch);
    entry.name = (polygon->name.empty() ? "" : polygon->name + "/") + "patch " + std::to_string(polygon - mesh.polygons.data() + 1);
    made.patches.push_back(std::move(entry));
  }
  if (!made.patches.empty() && made.patches.front().patch.basis.kind == PatchKind::generalised_bezier)
    made.problems.push_back({Problem::Kind::note, "patches",
                             "generalised Bezier patches of control meshes: tangent planes meet at vertices, along edges only about", 1});
  return made;
}

}  // namespace iso
