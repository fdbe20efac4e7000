#include "patches/control_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace iso {
namespace {

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

struct VertexNormal {
  Vec3 stated{0.0}, sum{0.0};
  bool is_stated = false, agreed = true;
};

struct VertexNormals {
  std::vector<Vec3> normal;  // unit; zero: each polygon has its own
  int differing = 0, none = 0;
};

VertexNormals normals_of(const ControlMesh& mesh, const std::vector<const ControlPolygon*>& used) {
  std::vector<VertexNormal> found(mesh.points.size());
  for (const ControlPolygon* polygon : used) {
    const Vec3 own = unit_or_zero(newell(mesh, *polygon));
    for (std::size_t i = 0; i < polygon->corners.size(); ++i) {
      VertexNormal& v = found[static_cast<std::size_t>(polygon->corners[i])];
      v.sum += angle_at(mesh, *polygon, i) * own;
      const Vec3 stated = polygon->normals.empty() ? Vec3(0.0) : unit_or_zero(polygon->normals[i]);
      if (!v.is_stated) v.stated = stated;
      v.agreed = v.agreed && stated != Vec3(0.0) && glm::length(stated - v.stated) <= kSameNormal;
      v.is_stated = true;
    }
  }
  VertexNormals normals;
  for (const VertexNormal& v : found) {
    normals.differing += v.is_stated && !v.agreed && v.stated != Vec3(0.0);
    const bool mean_vanishes = glm::length(v.sum) <= 1e-6;  // of an angle: directions so nearly cancelled are rounding
    normals.normal.push_back(v.is_stated && v.agreed ? v.stated : mean_vanishes ? Vec3(0.0) : unit_or_zero(v.sum));
    normals.none += v.is_stated && normals.normal.back() == Vec3(0.0);
  }
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

}  // namespace
