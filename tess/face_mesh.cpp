#include "tess/face_mesh.h"

#include "tess/face_mesher.h"
#include "tess/topology.h"

namespace iso {

namespace {

// A triangle of which a side is longer than this many cells of the sampling grid takes another point without a look at its bound.
constexpr double kManyCells = 2.0;

}  // namespace

FaceMesh FaceMesher::mesh(const std::vector<std::vector<int>>& loops, const std::vector<UV>& extra) {
  collect_border(loops);
  if (mesh_.nodes.size() < 3) return std::move(mesh_);
  const SampleGrids grids = sample_grids(shape_, domain_, grid_share() * policy_.distance);
  scale_ = grids.scale;
  make_triangulation();
  if (!mesh_.to_split.empty()) return std::move(mesh_);
  triangulation_->mark_inside();
  for (const UV& uv : extra) add_inner(uv, true);
  for (const SampleGrid& grid : grids.grids) add_grid(grid);
  constrain_creases();
  refine();
  if (!mesh_.to_split.empty()) return std::move(mesh_);
  collect_triangles();
  return std::move(mesh_);
}

// ---- points inside ----

void FaceMesher::set_node(std::uint32_t vertex, std::uint32_t node) {
  if (vertex >= node_of_.size()) node_of_.resize(vertex + 1, Triangulation::kNone);
  if (node_of_[vertex] == Triangulation::kNone) node_of_[vertex] = node;
}

std::uint32_t FaceMesher::add_inner(const UV& uv, bool check_inside) {
  const Vec2 p = uv * scale_;
  if (check_inside && !inside_at(p)) return Triangulation::kNone;
  const TangentJet jet = shape_.eval().at(uv);
  // Where there is no area there is nothing to come nearer to.
  if (shape_.is_line_somewhere() && !shape_.is_regular(jet)) return Triangulation::kNone;
  const std::uint32_t vertex = triangulation_->insert(p, near_);
  near_ = vertex;
  if (vertex < node_of_.size() && node_of_[vertex] != Triangulation::kNone) return vertex;  // there was a node already
  const FaceShape::Placed at = shape_.place(uv, jet);
  set_node(vertex, static_cast<std::uint32_t>(mesh_.nodes.size()));
  mesh_.nodes.push_back({FaceMesh::kInner + static_cast<std::uint32_t>(mesh_.inner.size()), uv, at.normal});
  mesh_.inner.push_back(at.S);
  surface_points_.push_back(at.S);
  return vertex;
}

// Whether p lies on a side or at a corner of the border but for rounding: triangles between them would have no area.
bool FaceMesher::is_beside_border(const Corners& t, const Vec2& p) const {
  const double rounding = kOnCrease * (std::abs(p.x) + std::abs(p.y));
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = t.v[static_cast<std::size_t>((k + 1) % 3)], w = t.v[static_cast<std::size_t>((k + 2) % 3)];
    const Vec2 a = triangulation_->points()[v], ab = triangulation_->points()[w] - a, ap = p - a;
    if (node_of_[v] < mesh_.border && glm::length(ap) <= rounding) return true;
    if (is_border(t, k) && std::abs(ab.x * ap.y - ab.y * ap.x) <= rounding * glm::length(ab)) return true;
  }
  return false;
}

// Whether p lies inside the loops, and neither on them nor at a vertex.
bool FaceMesher::inside_at(const Vec2& p) {
  const Triangulation::Location at = triangulation_->locate(p, near_);
  if (at.place == Triangulation::Place::Outside) return false;
  located_ = at.triangle;
  const Corners& t = triangulation_->triangles()[at.triangle];
  if (at.place == Triangulation::Place::Vertex) return false;
  if (at.place == Triangulation::Place::Edge && is_border(t, at.k)) return false;
  return t.inside && !is_beside_border(t, p);
}

// Whether the triangle found last is in need of a point: large, or beyond the tolerance.
bool FaceMesher::wants_point(std::uint32_t triangle) const {
  const auto& t = triangulation_->triangles()[triangle];
  const auto points = triangulation_->points();
  for (int k = 0; k < 3; ++k) {
    const Vec2 d = points[t.v[static_cast<std::size_t>(k)]] - points[t.v[static_cast<std::size_t>((k + 1) % 3)]];
    if (glm::dot(d, d) > kManyCells * kManyCells) return true;
  }
  return exceeds(triangle);
}

// The corners of the grid's cells; of its border those on the low sides, unless that is the border of the face's box.
void FaceMesher::add_grid(const SampleGrid& grid) {
  const Vec2 size = grid.box.size();
  for (int i = 0; i < grid.columns; ++i) {
    const double u = grid.box.lo.x + size.x * i / grid.columns;
    if (!(u > domain_.lo.x)) continue;
    for (int j = 0; j < grid.rows; ++j) {
      const int row = i % 2 ? grid.rows - 1 - j : j;
      const double v = grid.box.lo.y + size.y * row / grid.rows;
      if (!(v > domain_.lo.y)) continue;
      if (inside_at(UV(u, v) * scale_) && wants_point(located_)) add_inner({u, v}, false);
      near_ = triangulation_->triangles()[located_].v[0];
    }
  }
}

// The surface has no second derivative across a crease: no triangle may lie on both its sides.
void FaceMesher::constrain_creases() {
  for (int axis = 0; axis < 2; ++axis)
    for (const double crease : shape_.creases(axis)) constrain_crease(axis, crease);
}

void FaceMesher::constrain_crease(int axis, double crease) {
  const double slack = kOnCrease * std::max(std::abs(domain_.lo[axis]), std::abs(domain_.hi[axis]));
  std::vector<std::pair<double, std::uint32_t>> along;
  for (std::uint32_t vertex = 0; vertex < node_of_.size(); ++vertex)
    if (node_of_[vertex] != Triangulation::kNone && std::abs(node(vertex).uv[axis] - crease) <= slack)
      along.push_back({node(vertex).uv[1 - axis], vertex});
  std::sort(along.begin(), along.end());
  for (std::size_t i = 0; i + 1 < along.size(); ++i) {
    const std::uint32_t a = along[i].second, b = along[i + 1].second;
    if (border_.count(key_of(a, b))) continue;
    near_ = a;
    const Triangulation::Location at = triangulation_->locate(0.5 * (node(a).uv + node(b).uv) * scale_, a);
    if (at.place != Triangulation::Place::Outside && triangulation_->triangles()[at.triangle].inside) triangulation_->constrain(a, b);
  }
}

// ---- result ----

void FaceMesher::collect_triangles() {
  for (std::uint32_t i = 0; i < triangulation_->triangles().size(); ++i) {
    const Corners& t = triangulation_->triangles()[i];
    if (!t.inside) continue;
    if (is_collapsed(t)) {
      ++mesh_.collapsed;
      continue;
    }
    const double sliver = sliver_of(t), bound = verdict_of(i, policy_.distance - sliver).bound + sliver;
    mesh_.bound = std::max(mesh_.bound, bound);
    mesh_.unresolved += bound > policy_.distance;
    if (is_folded(t)) count_folded(t);
    Triangle corners{node_of_[t.v[0]], node_of_[t.v[1]], node_of_[t.v[2]]};
    if (shape_.face().reversed) std::swap(corners[1], corners[2]);
    mesh_.triangles.push_back(corners);
  }
}

// Whether the surface has area where the triangle lies.
bool FaceMesher::covers_area(const Corners& t) const {
  const UV &a = node(t.v[0]).uv, ab = node(t.v[1]).uv - a, ac = node(t.v[2]).uv - a;
  const TangentJet at = shape_.eval().at(a + (ab + ac) / 3.0);
  const Vec3 side = at.Su * ab.x + at.Sv * ab.y, other = at.Su * ac.x + at.Sv * ac.y;
  return !has_no_area(at.S, at.S + side, at.S + other);
}

// Whether it is turned away from the mean of the surface's normals at its corners, or toward no side at all.
bool FaceMesher::is_folded(const Corners& t) const {
  if (is_collapsed(t)) return false;
  if (has_no_area(placed(t.v[0]), placed(t.v[1]), placed(t.v[2]))) return covers_area(t);
  Vec3 n = glm::cross(placed(t.v[1]) - placed(t.v[0]), placed(t.v[2]) - placed(t.v[0]));
  if (shape_.face().reversed) n = -n;
  return !(glm::dot(n, node(t.v[0]).normal + node(t.v[1]).normal + node(t.v[2]).normal) > 0);
}

void FaceMesher::count_folded(const Corners& t) {
  ++mesh_.folded;
  const std::optional<Point3> fold = shape_.fold_within({node(t.v[0]).uv, node(t.v[1]).uv, node(t.v[2]).uv});
  if (!fold) return;
  if (mesh_.at_folds++ == 0) mesh_.fold = *fold;
}

FaceMesh mesh_face(const FaceShape& shape, const std::vector<std::vector<int>>& loops, const Boundary& boundary, const EdgeNet& net,
                   const FacePolicy& policy, const std::vector<UV>& extra) {
  return FaceMesher(shape, boundary, net, policy).mesh(loops, extra);
}

}  // namespace iso
