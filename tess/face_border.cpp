// The border of a face: its loops as nodes, and their segments as sides of triangles.
#include "tess/face_mesher.h"

namespace iso {

namespace {

// Segments of the border that cross others are not split below this share of the tolerance.
constexpr double kLeastSegment = 0.02;

}  // namespace

void FaceMesher::collect_border(const std::vector<std::vector<int>>& loops) {
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
void FaceMesher::find_poles() {
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
UV FaceMesher::settled(std::uint32_t point, const UV& uv) {
  const auto [first, last] = settled_.equal_range(point);
  const Vec2 rounding = kOnCrease * shape_.face().domain.size();
  for (auto at = first; at != last; ++at)
    if (const Vec2 d = glm::abs(uv - at->second); d.x <= rounding.x && d.y <= rounding.y) return at->second;
  settled_.emplace(point, uv);
  return uv;
}

void FaceMesher::add_border_node(std::uint32_t point, const UV& sampled) {
  const UV uv = settled(point, sampled);
  const FaceShape::Placed at = shape_.place(uv);
  mesh_.nodes.push_back({point, uv, at.normal});
  surface_points_.push_back(at.S);
  mesh_.offset = std::max(mesh_.offset, glm::length(at.S - net_.points()[point]));
  domain_.include(uv);
}

void FaceMesher::make_triangulation() {
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

void FaceMesher::constrain(std::uint32_t a, std::uint32_t b, const BorderSegment& segment) {
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
bool FaceMesher::ask_for(const BorderSegment& segment, std::uint32_t a, std::uint32_t b) {
  if (policy_.borders_are_final || glm::length(placed(a) - placed(b)) < kLeastSegment * policy_.distance) return false;
  mesh_.to_split.push_back(segment.at);
  return true;
}

// A segment that runs through another vertex is no side of a triangle.
void FaceMesher::check_sides() {
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

}  // namespace iso
