#include "tests/support/mesh_distance.h"

#include <optional>

#include "patches/trim.h"

namespace iso::test {

namespace {

double distance_to_segment(const Point3& p, const Point3& a, const Point3& b) {
  const Vec3 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  return glm::length(p - a - (length2 > 0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) : 0.0) * ab);
}

}  // namespace

// Of the sides, or of the plane where the foot lies inside: needles lose no digits.
double distance_to_triangle(const Point3& p, const Point3& a, const Point3& b, const Point3& c) {
  const double sides = std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
  const Vec3 n = glm::cross(b - a, c - a);
  const double area = glm::length(n);
  const auto left_of = [&](const Point3& from, const Point3& to) { return glm::dot(glm::cross(to - from, p - from), n) >= 0; };
  if (!(area > 0 && left_of(a, b) && left_of(b, c) && left_of(c, a))) return sides;
  return std::min(sides, std::abs(glm::dot(p - a, n)) / area);
}

TriangleTree::TriangleTree(const PartMesh& mesh) {
  for (const Triangle& t : mesh.triangles) triangles_.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
  if (!triangles_.empty()) build(0, triangles_.size());
}

void TriangleTree::build(std::size_t begin, std::size_t end) {
  constexpr std::size_t kLeaf = 4;
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), 0});
  for (std::size_t i = begin; i < end; ++i)
    for (const Point3& p : triangles_[i]) nodes_[self].box.include(p);
  if (end - begin <= kLeaf) return;
  const Vec3 size = nodes_[self].box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const auto at = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t half = begin + (end - begin) / 2;
  std::nth_element(at(begin), at(half), at(end), [&](const auto& a, const auto& b) {
    return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
  });
  build(begin, half);
  nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
  build(half, end);
}

void TriangleTree::visit(std::size_t self, const Point3& p, double& best) const {
  const Node& node = nodes_[self];
  const auto gap = [&](std::size_t n) { return glm::length(glm::max(glm::max(nodes_[n].box.lo - p, p - nodes_[n].box.hi), Vec3(0.0))); };
  if (gap(self) >= best) return;
  if (node.right == 0) {
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      best = std::min(best, distance_to_triangle(p, triangles_[i][0], triangles_[i][1], triangles_[i][2]));
    return;
  }
  const bool right_first = gap(node.right) < gap(self + 1);
  visit(right_first ? node.right : self + 1, p, best);
  visit(right_first ? self + 1 : node.right, p, best);
}

double TriangleTree::distance(const Point3& p) const {
  double best = kInf;
  if (!nodes_.empty()) visit(0, p, best);
  return best;
}

namespace {

// Gauss-Newton steps, halved until they lead downhill, within the box.
double descend(const AnySurface& surface, const Point3& p, UV uv, const Box2& within) {
  constexpr int kSteps = 30, kHalvings = 8;
  double best = glm::length(point(surface, uv) - p);
  for (int i = 0; i < kSteps; ++i) {
    const Jet2 at = jet2(surface, uv);
    const Vec3 r = p - at.S;
    const double a = glm::dot(at.Su, at.Su), b = glm::dot(at.Su, at.Sv), c = glm::dot(at.Sv, at.Sv);
    const double ridge = 1e-12 * (a + c), det = (a + ridge) * (c + ridge) - b * b;
    if (!(det > 0)) break;
    const double x = glm::dot(at.Su, r), y = glm::dot(at.Sv, r);
    UV step((x * (c + ridge) - y * b) / det, (y * (a + ridge) - x * b) / det);
    bool moved = false;
    for (int h = 0; h < kHalvings && !moved; ++h, step *= 0.5) {
      const UV next = glm::clamp(uv + step, within.lo, within.hi);
      const double d = glm::length(point(surface, next) - p);
      if (!(d < best)) continue;
      moved = best - d > 1e-9 * best;
      best = d;
      uv = next;
    }
    if (!moved) break;
  }
  return best;
}

double searched(const AnySurface& surface, const Point3& p, const Box2& box, const Box2& within) {
  constexpr int kGrid = 40;
  constexpr std::size_t kRefined = 6;
  std::vector<std::pair<double, UV>> places;
  for (int i = 0; i <= kGrid; ++i)
    for (int j = 0; j <= kGrid; ++j) {
      const UV uv = box.lo + box.size() * Vec2(i, j) / double(kGrid);
      places.push_back({glm::length(point(surface, uv) - p), uv});
    }
  std::partial_sort(places.begin(), places.begin() + kRefined, places.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  double best = kInf;
  for (std::size_t i = 0; i < kRefined; ++i) best = std::min(best, descend(surface, p, places[i].second, within));
  return best;
}

UV mixed(const PartMesh& mesh, const Triangle& t, const Vec3& l) {
  return l.x * mesh.nodes[t[0]].uv + l.y * mesh.nodes[t[1]].uv + l.z * mesh.nodes[t[2]].uv;
}
Vec3 random_shares(Random& random) {
  double a = between(random, 0, 1), b = between(random, 0, 1);
  if (a + b > 1) a = 1 - a, b = 1 - b;
  return {1 - a - b, a, b};
}

class Searcher {
 public:
  Searcher(const Part& part, const PartMesh& mesh, Random& random) : part_(part), mesh_(mesh), tree_(mesh), random_(random) {}

  void search(std::size_t f, double allowed, int samples) {
    const Face& face = part_.faces[f];
    const std::uint32_t begin = mesh_.first_triangle[f], end = mesh_.first_triangle[f + 1];
    FarSample from_mesh{static_cast<int>(f), false, {}, 0, allowed}, from_surface{static_cast<int>(f), true, {}, 0, allowed};
    const auto surface_sample = [&](const UV& uv) {
      const double d = tree_.distance(point(face.surface, uv));
      ++result_.samples;
      if (d > from_surface.distance) from_surface.distance = d, from_surface.uv = uv;
    };
    for (int i = 0; i < samples && begin < end; ++i) {
      const Triangle& t = mesh_.triangles[static_cast<std::size_t>(whole(random_, static_cast<int>(begin), static_cast<int>(end) - 1))];
      const Vec3 l = random_shares(random_);
      const UV uv = mixed(mesh_, t, l);
      Box2 near;
      for (const std::uint32_t n : t) near.include(mesh_.nodes[n].uv);
      const Point3 p = l.x * mesh_.corner(t, 0) + l.y * mesh_.corner(t, 1) + l.z * mesh_.corner(t, 2);
      const double d = distance_to_surface(face, p, uv, near, allowed);
      ++result_.samples;
      if (d > from_mesh.distance) from_mesh.distance = d, from_mesh.uv = uv;
      surface_sample(uv);
    }
    const TrimRegion region = face.loops.empty() ? TrimRegion() : TrimRegion(face, part_.edges, 0);
    for (int i = 0, tries = 0; i < samples && tries < 20 * samples; ++tries) {
      const UV uv = point_in(random_, face.domain);
      const TrimRegion::Answer answer = region.contains(uv, face.surface);
      if (!region.untrimmed() && (!answer.inside || answer.by_tolerance)) continue;
      ++i;
      surface_sample(uv);
    }
    for (const FarSample& s : {from_mesh, from_surface}) {
      result_.worst_share = std::max(result_.worst_share, s.distance / s.allowed);
      if (!(s.distance <= s.allowed)) result_.beyond.push_back(s);
    }
  }
  DistanceSearch result() && { return std::move(result_); }

 private:
  const Part& part_;
  const PartMesh& mesh_;
  TriangleTree tree_;
  Random& random_;
  DistanceSearch result_;
};

}  // namespace

double distance_to_surface(const Face& face, const Point3& p, UV start, const Box2& near, double enough) {
  constexpr double kWider = 0.5;
  const Box2 wide{near.lo - kWider * near.size(), near.hi + kWider * near.size()};
  Box2 within = face.domain;
  within.include(wide);
  if (const auto* nurbs = std::get_if<NurbsSurface>(&face.surface)) {  // it ends where its knots do
    const Box2 all = natural_domain(*nurbs);
    within = {glm::max(within.lo, all.lo), glm::min(within.hi, all.hi)};
  }
  double best = descend(face.surface, p, start, within);
  if (best > enough) best = std::min(best, searched(face.surface, p, wide, within));
  if (best > enough) best = std::min(best, searched(face.surface, p, face.domain, within));
  return best;
}

DistanceSearch search_distances(const Part& part, const PartMesh& mesh, const std::vector<double>& allowed, int samples, Random& random) {
  Searcher searcher(part, mesh, random);
  for (std::size_t f = 0; f < part.faces.size(); ++f) searcher.search(f, allowed[f], samples);
  return std::move(searcher).result();
}

}  // namespace iso::test
