// Refinement of a face's triangles, and what is done where the surface has no area.
#include "tess/face_mesher.h"

namespace iso {

namespace {

// Places within this share of their coordinates are one place of a line: what rounding makes of it, where a surface is evaluated.
constexpr double kOnLine = 1e-12;

// Triangles without area that are joined, for each node of the border at most; a line of n samples takes up to about 2 n for each, and one
// of more samples than this serves stays as it is.
constexpr std::size_t kMostJoins = 256;

// Borders of folded triangles are not split below this share of the tolerance.
constexpr double kLeastFold = 1e-3;

// Triangles smaller than this share of the tolerance are not divided further.
constexpr double kLeastSize = 0.05;

}  // namespace

Point3 FaceMesher::placed(std::uint32_t vertex) const {
  const std::uint32_t p = node(vertex).point;
  return p < FaceMesh::kInner ? net_.points()[p] : mesh_.inner[p - FaceMesh::kInner];
}

// Whether the side opposite of corner k is a segment of the border; creases are constrained too, but may be divided.
bool FaceMesher::is_border(const Corners& t, int k) const {
  return (t.constrained >> k & 1) &&
         border_.count(key_of(t.v[static_cast<std::size_t>((k + 1) % 3)], t.v[static_cast<std::size_t>((k + 2) % 3)]));
}

bool FaceMesher::is_collapsed(const Corners& t) const {
  return same_point(t.v[0], t.v[1]) || same_point(t.v[1], t.v[2]) || same_point(t.v[2], t.v[0]);
}

double FaceMesher::sliver_of(const Corners& t) const {
  double sliver = 0;
  for (int k = 0; k < 3; ++k)
    if (t.constrained >> k & 1)
      if (const auto at = border_.find(key_of(t.v[static_cast<std::size_t>((k + 1) % 3)], t.v[static_cast<std::size_t>((k + 2) % 3)]));
          at != border_.end())
        sliver = std::max(sliver, static_cast<double>(at->second.sliver));
  return sliver;
}

// What was proven of a triangle is kept as long as it has the same corners.
FaceShape::Verdict FaceMesher::verdict_of(std::uint32_t triangle, double most) const {
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

bool FaceMesher::turns_too_far(const Corners& t) const {
  if (!(policy_.angle < kPi)) return false;
  const double least = std::cos(policy_.angle);
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = node(t.v[static_cast<std::size_t>(k)]).normal, &b = node(t.v[static_cast<std::size_t>((k + 1) % 3)]).normal;
    if (a != Vec3(0.0) && b != Vec3(0.0) && glm::dot(a, b) < least) return true;
  }
  return false;
}

// Whether a triangle is beyond what it is allowed and needs a point.
bool FaceMesher::exceeds(std::uint32_t triangle) const {
  const Corners& t = triangulation_->triangles()[triangle];
  return !verdict_of(triangle, policy_.distance - sliver_of(t)).within || turns_too_far(t) || is_folded(t);
}

void FaceMesher::refine() {
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
bool FaceMesher::has_turning_border(const Corners& t) const {
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = node(t.v[static_cast<std::size_t>((k + 1) % 3)]).normal, &b = node(t.v[static_cast<std::size_t>((k + 2) % 3)]).normal;
    if (is_border(t, k) && glm::dot(a, b) < 0) return true;
  }
  return false;
}

// A triangle turned against the surface that no point inside can mend needs a finer border.
void FaceMesher::ask_for_borders(const std::vector<std::uint32_t>& triangles) {
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

// Puts a point where the triangle is longest; false if it must stay as it is.
bool FaceMesher::divide(const Corners& t) {
  double longest3 = 0;
  for (int k = 0; k < 3; ++k)
    longest3 =
        std::max(longest3, glm::length(corner(t.v[static_cast<std::size_t>(k)]).S - corner(t.v[static_cast<std::size_t>((k + 1) % 3)]).S));
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

// ---- parts without area ----

// Whether it is a line in space because the surface is one there: spans whose poles repeat, or lie on one line.
bool FaceMesher::is_without_area(const Corners& t) const {
  if (!shape_.is_line_somewhere() || is_collapsed(t)) return false;
  const Point3 a = placed(t.v[0]), b = placed(t.v[1]), c = placed(t.v[2]);
  const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  if (glm::length(glm::cross(b - a, c - a)) > kOnLine * (glm::length(a) + longest) * longest) return false;
  return !shape_.is_regular(shape_.eval().at((node(t.v[0]).uv + node(t.v[1]).uv + node(t.v[2]).uv) / 3.0));
}

// Such a triangle is a line. Its longest side takes the point of the corner between: what is beside that side then meets the two others,
// and the triangle falls into two that have this point twice, as at a pole. False where that side is on the border, or goes another way,
// or the surface over the triangle is not proven to keep to the line.
bool FaceMesher::join(const Corners& t) {
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

}  // namespace iso
