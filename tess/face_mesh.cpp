#include "tess/face_mesh.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "tess/sample_grid.h"
#include "tess/topology.h"
#include "tess/triangulation.h"

namespace iso {

namespace {

// Segments of the border by their two vertices in the triangulation.
struct BorderSegment {
  EdgeSegment at;
  float sliver = 0;
  bool degenerate = false;
};
std::uint64_t key_of(std::uint32_t a, std::uint32_t b) { return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b); }

// A triangle of which a side is longer than this many cells of the sampling grid takes another point without a look at its bound.
constexpr double kManyCells = 2.0;

// Nearer than this share of the coordinates' size to a crease is on it.
constexpr double kOnCrease = 1e-12;

// Places within this share of their coordinates are one place of a line: what rounding makes of it, where a surface is evaluated.
constexpr double kOnLine = 1e-12;

// Triangles without area that are joined, for each node of the border at most; a line of n samples takes up to about 2 n for each, and one
// of more samples than this serves stays as it is.
constexpr std::size_t kMostJoins = 256;

// Segments of the border that cross others are not split below this share of the tolerance.
constexpr double kLeastSegment = 0.02;

// Borders of folded triangles are not split below this share of the tolerance.
constexpr double kLeastFold = 1e-3;

// Triangles smaller than this share of the tolerance are not divided further.
constexpr double kLeastSize = 0.05;

class FaceMesher {
 public:
  FaceMesher(const FaceShape& shape, const Boundary& boundary, const EdgeNet& net, const FacePolicy& policy)
      : shape_(shape), boundary_(boundary), net_(net), policy_(policy) {}

  FaceMesh mesh(const std::vector<std::vector<int>>& loops, const std::vector<UV>& extra) {
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

 private:
  using Corners = Triangulation::Triangle;

  // Closed forms are sampled by the grid alone, with a little left for what the triangulation makes of it. Elsewhere the bound over a whole
  // cell is far above what a triangle in it needs: the grid only starts what refinement ends (at 8 there are a tenth more triangles).
  double grid_share() const { return shape_.bend().cells() == 0 ? 0.95 : 16.0; }

  // ---- border ----

  void collect_border(const std::vector<std::vector<int>>& loops) {
    for (const auto& loop : loops) {
      const std::size_t first = mesh_.nodes.size();
      for (int u : loop) {
        const EdgeUse& use = boundary_.uses[static_cast<std::size_t>(u)];
        const auto& edge = net_.edge(use.edge);
        const auto k = static_cast<std::size_t>(net_.place_of(u));
        const bool degenerate = boundary_.edges[static_cast<std::size_t>(use.edge)].degenerate;
        const std::size_t n = edge.share.size();
        for (std::size_t i = 0; i + 1 < n; ++i) {  // each use brings all its samples but its last
          const std::size_t at = use.forward ? i : n - 1 - i, segment = use.forward ? i : n - 2 - i;
          add_border_node(edge.point[at], edge.uv[k][at]);
          segments_.push_back({{use.edge, static_cast<std::uint32_t>(segment)}, edge.sliver[k][segment], degenerate});
        }
      }
      loop_ends_.push_back({first, mesh_.nodes.size()});
    }
    mesh_.border = mesh_.nodes.size();
    find_poles();
  }

  // Along a collapsed segment the surface is one point, whatever the parameter that runs along it.
  void find_poles() {
    pole_axis_.assign(mesh_.border, -1);
    for (const auto& [first, last] : loop_ends_)
      for (std::size_t i = first; i < last; ++i) {
        if (!segments_[i].degenerate) continue;
        const std::size_t next = i + 1 < last ? i + 1 : first;
        const Vec2 d = glm::abs(mesh_.nodes[next].uv - mesh_.nodes[i].uv);
        const int axis = d.x > d.y ? 0 : 1;
        if (d[1 - axis] <= kOnCrease * d[axis]) pole_axis_[i] = pole_axis_[next] = static_cast<std::int8_t>(axis);
      }
  }

  // A point that the border comes back to is where it was, and not beside it by rounding.
  UV settled(std::uint32_t point, const UV& uv) {
    const auto [first, last] = settled_.equal_range(point);
    const Vec2 rounding = kOnCrease * shape_.face().domain.size();
    for (auto at = first; at != last; ++at)
      if (const Vec2 d = glm::abs(uv - at->second); d.x <= rounding.x && d.y <= rounding.y) return at->second;
    settled_.emplace(point, uv);
    return uv;
  }

  void add_border_node(std::uint32_t point, const UV& sampled) {
    const UV uv = settled(point, sampled);
    const FaceShape::Placed at = shape_.place(uv);
    mesh_.nodes.push_back({point, uv, at.normal});
    surface_points_.push_back(at.S);
    mesh_.offset = std::max(mesh_.offset, glm::length(at.S - net_.points()[point]));
    domain_.include(uv);
  }

  void make_triangulation() {
    Box2 box{domain_.lo * scale_, domain_.hi * scale_};
    triangulation_.emplace(box);
    std::uint32_t near = Triangulation::kNone;
    std::vector<std::uint32_t> vertex_of(mesh_.border);
    for (std::size_t i = 0; i < mesh_.border; ++i) {
      near = triangulation_->insert(mesh_.nodes[i].uv * scale_, near);
      vertex_of[i] = near;
      set_node(near, static_cast<std::uint32_t>(i));
    }
    for (const auto& [first, last] : loop_ends_)
      for (std::size_t i = first; i < last; ++i) constrain(vertex_of[i], vertex_of[i + 1 < last ? i + 1 : first], segments_[i]);
    if (mesh_.to_split.empty()) check_sides();
  }

  void constrain(std::uint32_t a, std::uint32_t b, const BorderSegment& segment) {
    if (a == b) return;
    if (const auto hit = triangulation_->constrain(a, b)) {
      const auto other = border_.find(key_of((*hit)[0], (*hit)[1]));
      bool asked = ask_for(segment, a, b);
      if (other != border_.end()) asked = ask_for(other->second, (*hit)[0], (*hit)[1]) || asked;
      mesh_.crossings += !asked;
      return;
    }
    border_[key_of(a, b)] = segment;
  }

  // Asks for a finer segment, unless it is so short already that this would not help.
  bool ask_for(const BorderSegment& segment, std::uint32_t a, std::uint32_t b) {
    if (policy_.borders_are_final || glm::length(placed(a) - placed(b)) < kLeastSegment * policy_.distance) return false;
    mesh_.to_split.push_back(segment.at);
    return true;
  }

  // A segment that runs through another vertex is no side of a triangle.
  void check_sides() {
    std::size_t found = 0;
    std::vector<std::uint64_t> sides;
    for (const auto& t : triangulation_->triangles())
      for (int k = 0; k < 3; ++k)
        if (t.constrained >> k & 1)
          sides.push_back(key_of(t.v[static_cast<std::size_t>((k + 1) % 3)], t.v[static_cast<std::size_t>((k + 2) % 3)]));
    std::sort(sides.begin(), sides.end());
    for (const auto& [key, segment] : border_)
      if (std::binary_search(sides.begin(), sides.end(), key))
        ++found;
      else if (!ask_for(segment, static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)))
        ++mesh_.crossings;
  }

  // ---- points inside ----

  void set_node(std::uint32_t vertex, std::uint32_t node) {
    if (vertex >= node_of_.size()) node_of_.resize(vertex + 1, Triangulation::kNone);
    if (node_of_[vertex] == Triangulation::kNone) node_of_[vertex] = node;
  }

  std::uint32_t add_inner(const UV& uv, bool check_inside) {
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
  bool is_beside_border(const Corners& t, const Vec2& p) const {
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
  bool inside_at(const Vec2& p) {
    const Triangulation::Location at = triangulation_->locate(p, near_);
    if (at.place == Triangulation::Place::Outside) return false;
    located_ = at.triangle;
    const Corners& t = triangulation_->triangles()[at.triangle];
    if (at.place == Triangulation::Place::Vertex) return false;
    if (at.place == Triangulation::Place::Edge && is_border(t, at.k)) return false;
    return t.inside && !is_beside_border(t, p);
  }

  // Whether the triangle found last is in need of a point: large, or beyond the tolerance.
  bool wants_point(std::uint32_t triangle) const {
    const auto& t = triangulation_->triangles()[triangle];
    const auto points = triangulation_->points();
    for (int k = 0; k < 3; ++k) {
      const Vec2 d = points[t.v[static_cast<std::size_t>(k)]] - points[t.v[static_cast<std::size_t>((k + 1) % 3)]];
      if (glm::dot(d, d) > kManyCells * kManyCells) return true;
    }
    return exceeds(triangle);
  }

  // The corners of the grid's cells; of its border those on the low sides, unless that is the border of the face's box.
  void add_grid(const SampleGrid& grid) {
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
  void constrain_creases() {
    for (int axis = 0; axis < 2; ++axis)
      for (const double crease : shape_.creases(axis)) constrain_crease(axis, crease);
  }

  void constrain_crease(int axis, double crease) {
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

  // ---- refinement ----

  const MeshNode& node(std::uint32_t vertex) const { return mesh_.nodes[node_of_[vertex]]; }
  SurfaceCorner corner(std::uint32_t vertex) const { return {node(vertex).uv, surface_points_[node_of_[vertex]]}; }
  Point3 placed(std::uint32_t vertex) const {
    const std::uint32_t p = node(vertex).point;
    return p < FaceMesh::kInner ? net_.points()[p] : mesh_.inner[p - FaceMesh::kInner];
  }
  bool same_point(std::uint32_t a, std::uint32_t b) const { return node(a).point == node(b).point; }

  // Whether the side opposite of corner k is a segment of the border; creases are constrained too, but may be divided.
  bool is_border(const Corners& t, int k) const {
    return (t.constrained >> k & 1) &&
           border_.count(key_of(t.v[static_cast<std::size_t>((k + 1) % 3)], t.v[static_cast<std::size_t>((k + 2) % 3)]));
  }

  bool is_collapsed(const Corners& t) const {
    return same_point(t.v[0], t.v[1]) || same_point(t.v[1], t.v[2]) || same_point(t.v[2], t.v[0]);
  }

  double sliver_of(const Corners& t) const {
    double sliver = 0;
    for (int k = 0; k < 3; ++k)
      if (t.constrained >> k & 1)
        if (const auto at = border_.find(key_of(t.v[static_cast<std::size_t>((k + 1) % 3)], t.v[static_cast<std::size_t>((k + 2) % 3)]));
            at != border_.end())
          sliver = std::max(sliver, static_cast<double>(at->second.sliver));
    return sliver;
  }

  // What was proven of a triangle is kept as long as it has the same corners.
  FaceShape::Verdict verdict_of(std::uint32_t triangle, double most) const {
    const Corners& t = triangulation_->triangles()[triangle];
    // Two corners at one pole: the triangle is a segment, and its neighbours cover what lies over it.
    if (is_collapsed(t)) return {true, 0};
    if (triangle >= proven_.size()) proven_.resize(triangulation_->triangles().size());
    Proven& known = proven_[triangle];
    if (known.v == t.v && known.bound <= most) return {true, known.bound};
    std::array<SurfaceCorner, 3> c{corner(t.v[0]), corner(t.v[1]), corner(t.v[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t n = node_of_[t.v[k]];
      const int axis = n < mesh_.border ? pole_axis_[n] : -1;
      if (axis >= 0) c[k].uv[axis] = 0.5 * (c[(k + 1) % 3].uv[axis] + c[(k + 2) % 3].uv[axis]);
    }
    const FaceShape::Verdict verdict = shape_.keeps(c[0], c[1], c[2], most);
    if (verdict.within) known = {t.v, verdict.bound};
    return verdict;
  }

  bool turns_too_far(const Corners& t) const {
    if (!(policy_.angle < kPi)) return false;
    const double least = std::cos(policy_.angle);
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = node(t.v[static_cast<std::size_t>(k)]).normal, &b = node(t.v[static_cast<std::size_t>((k + 1) % 3)]).normal;
      if (a != Vec3(0.0) && b != Vec3(0.0) && glm::dot(a, b) < least) return true;
    }
    return false;
  }

  // Whether a triangle is beyond what it is allowed and needs a point.
  bool exceeds(std::uint32_t triangle) const {
    const Corners& t = triangulation_->triangles()[triangle];
    return !verdict_of(triangle, policy_.distance - sliver_of(t)).within || turns_too_far(t) || is_folded(t);
  }

  void refine() {
    std::vector<std::uint32_t> work;
    for (std::uint32_t i = 0; i < triangulation_->triangles().size(); ++i)
      if (triangulation_->triangles()[i].inside) work.push_back(i);
    std::size_t inserted = 0, joins = 0;
    std::vector<std::uint32_t> left;  // still beyond what is allowed, perhaps
    const std::size_t most = 1000000 + 100 * mesh_.nodes.size();
    for (std::size_t i = 0; i < work.size() && inserted < most; ++i) {
      const Corners t = triangulation_->triangles()[work[i]];
      const bool joined = t.inside && joins < kMostJoins * mesh_.border && is_without_area(t) && join(t);
      joins += joined;
      if (!joined && (!t.inside || !exceeds(work[i]))) continue;
      if (!joined && !divide(t)) {
        left.push_back(work[i]);
        continue;
      }
      ++inserted;
      for (std::uint32_t changed : triangulation_->changed())
        if (triangulation_->triangles()[changed].inside) work.push_back(changed);
    }
    if (mesh_.to_split.empty() && !policy_.borders_are_final) ask_for_borders(left);
  }

  // Whether the surface's normal turns by more than a right angle along a side on the border: only a finer border helps.
  bool has_turning_border(const Corners& t) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = node(t.v[static_cast<std::size_t>((k + 1) % 3)]).normal, &b = node(t.v[static_cast<std::size_t>((k + 2) % 3)]).normal;
      if (is_border(t, k) && glm::dot(a, b) < 0) return true;
    }
    return false;
  }

  // A triangle turned against the surface that no point inside can mend needs a finer border.
  void ask_for_borders(const std::vector<std::uint32_t>& triangles) {
    for (std::uint32_t i : triangles) {
      const Corners& t = triangulation_->triangles()[i];
      if (!t.inside || !is_folded(t)) continue;
      int best = -1;
      double longest = kLeastFold * policy_.distance;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = t.v[static_cast<std::size_t>((k + 1) % 3)], b = t.v[static_cast<std::size_t>((k + 2) % 3)];
        const double length = glm::length(placed(a) - placed(b));
        if (!is_border(t, k) || length <= longest) continue;
        longest = length;
        best = k;
      }
      if (best < 0) continue;
      mesh_.to_split.push_back(
          border_.at(key_of(t.v[static_cast<std::size_t>((best + 1) % 3)], t.v[static_cast<std::size_t>((best + 2) % 3)])).at);
    }
  }

  // ---- parts without area ----

  // Whether it is a line in space because the surface is one there: spans whose poles repeat, or lie on one line.
  bool is_without_area(const Corners& t) const {
    if (!shape_.is_line_somewhere() || is_collapsed(t)) return false;
    const Point3 a = placed(t.v[0]), b = placed(t.v[1]), c = placed(t.v[2]);
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    if (glm::length(glm::cross(b - a, c - a)) > kOnLine * (glm::length(a) + longest) * longest) return false;
    return !shape_.is_regular(shape_.eval().at((node(t.v[0]).uv + node(t.v[1]).uv + node(t.v[2]).uv) / 3.0));
  }

  // Such a triangle is a line. Its longest side takes the point of the corner between: what is beside that side then meets the two others,
  // and the triangle falls into two that have this point twice, as at a pole. False where that side is on the border, or goes another way,
  // or the surface over the triangle is not proven to keep to the line.
  bool join(const Corners& t) {
    int k = 0;
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      const double length =
          glm::length(placed(t.v[static_cast<std::size_t>((i + 1) % 3)]) - placed(t.v[static_cast<std::size_t>((i + 2) % 3)]));
      if (length > longest) longest = length, k = i;
    }
    if (is_border(t, k)) return false;
    const std::uint32_t between = t.v[static_cast<std::size_t>(k)];
    const SurfaceCorner a = corner(t.v[static_cast<std::size_t>((k + 1) % 3)]), b = corner(t.v[static_cast<std::size_t>((k + 2) % 3)]);
    const double sliver = sliver_of(t);
    const FaceShape::Verdict verdict = shape_.stays_near(a.S, b.S, {node(between).uv, a.uv, b.uv}, policy_.distance - sliver);
    if (!verdict.within) return false;
    const UV uv = shape_.place_between(a, b, corner(between).S);
    const FaceShape::Placed at = shape_.place(uv);
    if (glm::length(at.S - corner(between).S) > kOnLine * (glm::length(at.S) + longest)) return false;
    near_ = t.v[0];
    if (!inside_at(uv * scale_)) return false;  // at an end of the side, or on the border
    near_ = triangulation_->insert(uv * scale_, near_);
    set_node(near_, static_cast<std::uint32_t>(mesh_.nodes.size()));
    mesh_.nodes.push_back({node(between).point, uv, at.normal});
    surface_points_.push_back(at.S);
    mesh_.bound = std::max(mesh_.bound, verdict.bound + sliver);
    return true;
  }

  // Puts a point where the triangle is longest; false if it must stay as it is.
  bool divide(const Corners& t) {
    double longest3 = 0;
    for (int k = 0; k < 3; ++k)
      longest3 = std::max(longest3,
                          glm::length(corner(t.v[static_cast<std::size_t>(k)]).S - corner(t.v[static_cast<std::size_t>((k + 1) % 3)]).S));
    if (longest3 < kLeastSize * policy_.distance) return false;
    const bool folded = is_folded(t);
    if (folded && has_turning_border(t)) return false;
    // Sides of the border are not split here: a collapsed one that is too long is asked for, else the longest other side takes the point.
    int best = -1;
    double longest = 0;
    const auto points = triangulation_->points();
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t.v[static_cast<std::size_t>((k + 1) % 3)], b = t.v[static_cast<std::size_t>((k + 2) % 3)];
      const Vec2 d = points[a] - points[b];
      const double length = folded ? glm::length(placed(a) - placed(b)) : glm::dot(d, d);
      if (length <= longest) continue;
      if (is_border(t, k) && !folded && (length < 1 || !border_.at(key_of(a, b)).degenerate)) continue;
      longest = length;
      best = k;
    }
    UV uv;
    if (best < 0) {
      uv = (node(t.v[0]).uv + node(t.v[1]).uv + node(t.v[2]).uv) / 3.0;
    } else {
      const std::uint32_t a = t.v[static_cast<std::size_t>((best + 1) % 3)], b = t.v[static_cast<std::size_t>((best + 2) % 3)];
      if (is_border(t, best) && folded) return false;  // only a finer border helps
      if (is_border(t, best) && policy_.borders_are_final) return false;
      if (is_border(t, best)) {
        mesh_.to_split.push_back(border_.at(key_of(a, b)).at);
        return false;
      }
      uv = 0.5 * (node(a).uv + node(b).uv);
    }
    near_ = t.v[0];
    const std::size_t before = mesh_.nodes.size();
    if (!inside_at(uv * scale_)) return false;
    add_inner(uv, false);
    return mesh_.nodes.size() > before;
  }

  // ---- result ----

  void collect_triangles() {
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
  bool covers_area(const Corners& t) const {
    const UV &a = node(t.v[0]).uv, ab = node(t.v[1]).uv - a, ac = node(t.v[2]).uv - a;
    const TangentJet at = shape_.eval().at(a + (ab + ac) / 3.0);
    const Vec3 side = at.Su * ab.x + at.Sv * ab.y, other = at.Su * ac.x + at.Sv * ac.y;
    return !has_no_area(at.S, at.S + side, at.S + other);
  }

  // Whether it is turned away from the mean of the surface's normals at its corners, or toward no side at all.
  bool is_folded(const Corners& t) const {
    if (is_collapsed(t)) return false;
    if (has_no_area(placed(t.v[0]), placed(t.v[1]), placed(t.v[2]))) return covers_area(t);
    Vec3 n = glm::cross(placed(t.v[1]) - placed(t.v[0]), placed(t.v[2]) - placed(t.v[0]));
    if (shape_.face().reversed) n = -n;
    return !(glm::dot(n, node(t.v[0]).normal + node(t.v[1]).normal + node(t.v[2]).normal) > 0);
  }

  void count_folded(const Corners& t) {
    ++mesh_.folded;
    const std::optional<Point3> fold = shape_.fold_within({node(t.v[0]).uv, node(t.v[1]).uv, node(t.v[2]).uv});
    if (!fold) return;
    if (mesh_.at_folds++ == 0) mesh_.fold = *fold;
  }

  const FaceShape& shape_;
  const Boundary& boundary_;
  const EdgeNet& net_;
  FacePolicy policy_;
  FaceMesh mesh_;
  Box2 domain_;
  Vec2 scale_{1.0};
  std::vector<BorderSegment> segments_;  // from border node i to the next of its loop
  std::vector<std::pair<std::size_t, std::size_t>> loop_ends_;
  std::unordered_multimap<std::uint32_t, UV> settled_;  // places of the border's points
  std::vector<std::int8_t> pole_axis_;                  // of border nodes: the parameter that has no meaning there, -1 where both have
  std::vector<Point3> surface_points_;                  // of the nodes: on this face's own surface
  std::optional<Triangulation> triangulation_;
  struct Proven {
    std::array<std::uint32_t, 3> v{};
    double bound = kInf;
  };
  mutable std::vector<Proven> proven_;  // of each triangle of the triangulation
  std::vector<std::uint32_t> node_of_;  // of each vertex of the triangulation
  std::unordered_map<std::uint64_t, BorderSegment> border_;
  std::uint32_t near_ = Triangulation::kNone, located_ = 0;
};

}  // namespace

FaceMesh mesh_face(const FaceShape& shape, const std::vector<std::vector<int>>& loops, const Boundary& boundary, const EdgeNet& net,
                   const FacePolicy& policy, const std::vector<UV>& extra) {
  return FaceMesher(shape, boundary, net, policy).mesh(loops, extra);
}

}  // namespace iso
