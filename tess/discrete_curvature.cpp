#include "tess/discrete_curvature.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <unordered_map>

namespace iso {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Points that are on open edges, or on edges of more than two triangles.
std::vector<bool> not_closed(const PartMesh& mesh) {
  std::unordered_map<std::uint64_t, int> uses;
  const auto key = [](std::uint32_t a, std::uint32_t b) { return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b); };
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[key(mesh.nodes[t[k]].point, mesh.nodes[t[(k + 1) % 3]].point)];
  std::vector<bool> open(mesh.points.size(), false);
  for (const auto& [edge, count] : uses)
    if (count != 2) open[edge >> 32] = open[edge & 0xffffffffu] = true;
  return open;
}

// What a triangle adds to its corners.
struct Sums {
  std::vector<Vec3> K, normal;
  std::vector<double> area;

  explicit Sums(std::size_t points) : K(points, Vec3(0.0)), normal(points, Vec3(0.0)), area(points, 0.0) {}

  void add(const std::array<std::uint32_t, 3>& i, const std::array<Point3, 3>& x) {
    const Vec3 n = glm::cross(x[1] - x[0], x[2] - x[0]);
    const double twice = glm::length(n);
    if (!(twice > 0)) return;
    double cot[3];
    int obtuse = -1;
    for (int k = 0; k < 3; ++k) {
      const double cosine = glm::dot(x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
      cot[k] = cosine / twice;
      if (cosine < 0) obtuse = k;
    }
    for (int k = 0; k < 3; ++k) {
      const int b = (k + 1) % 3, c = (k + 2) % 3;
      const Vec3 to_b = x[k] - x[b], to_c = x[k] - x[c];
      K[i[k]] += cot[c] * to_b + cot[b] * to_c;
      normal[i[k]] += n;
      const double voronoi = (cot[c] * glm::dot(to_b, to_b) + cot[b] * glm::dot(to_c, to_c)) / 8;
      area[i[k]] += obtuse < 0 ? voronoi : 0.5 * twice / (obtuse == k ? 2 : 4);
    }
  }
};

}  // namespace

std::vector<SurfacePlace> places_of(const Part& part, const PartMesh& mesh) {
  std::vector<SurfacePlace> places(mesh.points.size());
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const auto* chart = std::get_if<PatchChart>(&part.faces[f].surface);
    for (std::uint32_t i = mesh.first_node[f]; i < mesh.first_node[f + 1]; ++i) {
      SurfacePlace& place = places[mesh.nodes[i].point];
      const bool side = chart && (mesh.nodes[i].uv.x == 0 || mesh.nodes[i].uv.y == 0);
      if (place.face < 0) {
        place = {static_cast<int>(f), mesh.nodes[i].uv, !side};
        continue;
      }
      const auto* other = std::get_if<PatchChart>(&part.faces[static_cast<std::size_t>(place.face)].surface);
      place.inside = place.inside && !side && chart && other && chart->patch == other->patch;
    }
  }
  return places;
}

std::vector<double> discrete_mean_curvature(const PartMesh& mesh) {
  Sums sums(mesh.points.size());
  for (const Triangle& t : mesh.triangles)
    sums.add({mesh.nodes[t[0]].point, mesh.nodes[t[1]].point, mesh.nodes[t[2]].point},
             {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
  const std::vector<bool> open = not_closed(mesh);
  std::vector<double> H(mesh.points.size(), kNaN);
  for (std::size_t i = 0; i < H.size(); ++i) {
    if (open[i] || !(sums.area[i] > 0)) continue;
    const double length = glm::length(sums.K[i]) / (4 * sums.area[i]);
    H[i] = glm::dot(sums.K[i], sums.normal[i]) > 0 ? -length : length;
  }
  return H;
}

double mean_curvature(const Part& part, const SurfacePlace& place) {
  const Face& face = part.faces[static_cast<std::size_t>(place.face)];
  const Jet2 jet = jet2(face.surface, place.uv);
  const Vec3 n = glm::cross(jet.Su, jet.Sv);
  if (!(glm::length(n) > 0)) return kNaN;
  const Curvatures k = principal_curvatures(jet, (face.reversed ? -1.0 : 1.0) * glm::normalize(n));
  return 0.5 * (k.k1 + k.k2);
}

CurvatureError curvature_error(const Part& part, const std::vector<double>& discrete, const std::vector<SurfacePlace>& places) {
  std::vector<double> exact(places.size(), kNaN);
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    if (places[i].inside && finite(discrete[i])) exact[i] = mean_curvature(part, places[i]);
  });
  CurvatureError error;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!finite(exact[i])) continue;
    const double off = std::abs(discrete[i] - exact[i]);
    ++error.points;
    error.max = std::max(error.max, off);
    error.rms += off * off;
    error.largest = std::max(error.largest, std::abs(exact[i]));
  }
  if (error.points > 0) error.rms = std::sqrt(error.rms / static_cast<double>(error.points));
  return error;
}

}  // namespace iso
